// handle.h: a table of all handles of the process.
#include "handle.h"

#include <atomic>
#include <cstdint>
#include <mutex>
#include <string>
#include <unordered_map>

namespace kerf_c {
namespace {

struct Table {
  std::mutex mutex;
  std::unordered_map<std::uintptr_t, std::shared_ptr<Object>> objects;
  std::uintptr_t next = first;
  // Odd numbers are no addresses of objects, and small ones are what programs make up by mistake.
  static constexpr std::uintptr_t first = 0x6b657201, step = 2;
};

// Never destroyed: handles may be freed while the program ends.
Table& table() {
  static auto* all = new Table;
  return *all;
}

}  // namespace

const char* name_of(Kind kind) {
  switch (kind) {
    case Kind::bytes:
      return "kerf_bytes";
    case Kind::mesh:
      return "kerf_mesh";
    case Kind::complex:
      return "kerf_complex";
    case Kind::front:
      return "kerf_front";
    case Kind::pieces:
      return "kerf_pieces";
    case Kind::simulation:
      return "kerf_simulation";
    case Kind::solid:
      return "kerf_solid";
    case Kind::breaking:
      return "kerf_breaking";
  }
  return "";
}

void* handle_for(std::shared_ptr<Object> object) {
  const std::lock_guard lock(table().mutex);
  const std::uintptr_t number = table().next;
  table().next += Table::step;
  table().objects.emplace(number, std::move(object));
  return reinterpret_cast<void*>(number);
}

std::shared_ptr<Object> object_of(const void* handle, Kind kind) {
  if (!handle) throw HandleError(std::string("the ") + name_of(kind) + " is null; make one first");
  const std::lock_guard lock(table().mutex);
  const auto found = table().objects.find(reinterpret_cast<std::uintptr_t>(handle));
  if (found == table().objects.end())
    throw HandleError(std::string("the ") + name_of(kind) + " is no handle, or was freed");
  if (found->second->kind() != kind)
    throw HandleError(std::string("the handle is a ") + name_of(found->second->kind()) + "; give a " + name_of(kind));
  return found->second;
}

void end_handle(const void* handle) {
  std::shared_ptr<Object> object;  // destroyed without the lock
  const std::lock_guard lock(table().mutex);
  const auto found = table().objects.find(reinterpret_cast<std::uintptr_t>(handle));
  if (found == table().objects.end()) throw HandleError("the handle is none, or was freed already");
  object = std::move(found->second);
  table().objects.erase(found);
}

}  // namespace kerf_c
