// write_bond_folder() of kerf/peridynamics.h. The files are written into a temporary folder, which
// is then renamed.
#include <unistd.h>

#include <filesystem>

#include "kerf/error.h"
#include "kerf/files.h"
#include "kerf/peridynamics.h"

namespace geo {
namespace {

namespace fs = std::filesystem;

std::string without_slash(const std::string& path) {
  return path.ends_with('/') ? path.substr(0, path.size() - 1) : path;
}

}  // namespace

bool is_bond_folder(const std::string& path) {
  const std::string name = without_slash(path);
  return name.ends_with(".peridigm") || name.ends_with(".perilab") || name.ends_with(".peridynamics");
}

void write_bond_folder(const std::string& path, const Body& body, double horizon) {
  if (!is_bond_folder(path)) throw InputError(path + ": must end in .peridigm, .perilab or .peridynamics");
  const std::string name = without_slash(path);
  const BondModel model = find_bond_model(body, horizon);
  const fs::path aside = name + "." + std::to_string(::getpid()) + ".tmp";
  TemporaryOutput unfinished(aside.string());
  std::error_code error;
  if (!fs::create_directories(aside, error)) throw OutputError(name + ": cannot be made (" + error.message() + ")");
  const auto write = [&](const char* file, const auto& put) { write_all((aside / file).string(), put); };
  write("nodes.txt", [&](std::ostream& out) { write_bond_nodes(out, body, model, name.ends_with(".perilab")); });
  write("families.txt", [&](std::ostream& out) { write_families(out, model); });
  if (name.ends_with(".peridynamics")) {
    write("body.jl", [&](std::ostream& out) { write_peridynamics_jl(out, model); });
  } else {
    const auto filters = bond_filters(body, model);
    write("input.yaml", [&](std::ostream& out) {
      name.ends_with(".peridigm") ? write_peridigm(out, model, filters) : write_perilab(out, model, filters);
    });
  }
  unfinished.commit(name);  // replaces an empty folder
}

}  // namespace geo
