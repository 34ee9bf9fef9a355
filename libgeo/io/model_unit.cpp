// io/model_unit.h. Attributes of XML are found as text: a whole parser would add nothing, as the
// elements that state a unit stand once, near the beginning.
#include "io/model_unit.h"

#include <zlib.h>

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <cstring>
#include <string_view>

#include "kerf/files.h"

namespace geo {
namespace {

// The value of an attribute of the first element of that name; empty where there is none.
std::string attribute_of(std::string_view text, std::string_view element, std::string_view attribute) {
  for (std::size_t at = text.find('<'); at != text.npos; at = text.find('<', at + 1)) {
    const std::string_view rest = text.substr(at + 1);
    const auto name_end = rest.find_first_of(" \t\r\n/>");
    std::string_view name = rest.substr(0, name_end);
    if (const auto colon = name.find(':'); colon != name.npos) name.remove_prefix(colon + 1);
    if (name != element) continue;
    const std::string_view tag = rest.substr(0, rest.find('>'));
    for (auto found = tag.find(attribute); found != tag.npos; found = tag.find(attribute, found + 1)) {
      std::string_view value = tag.substr(found + attribute.size());
      const bool whole = found > 0 && std::string_view(" \t\r\n").find(tag[found - 1]) != std::string_view::npos;
      value.remove_prefix(std::min(value.find_first_not_of(" \t\r\n"), value.size()));
      if (!whole || !value.starts_with('=')) continue;
      value.remove_prefix(std::min(value.find_first_of("\"'"), value.size()));
      if (value.empty()) return {};
      const char quote = value[0];
      value.remove_prefix(1);
      return std::string(value.substr(0, value.find(quote)));
    }
    return {};
  }
  return {};
}

double number_in(const std::string& text) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && value > 0 && value <= 1e12 ? value : 0;
}

std::uint32_t little(std::string_view bytes, std::size_t at, std::size_t size) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < size && at + i < bytes.size(); ++i)
    value |= std::uint32_t(static_cast<unsigned char>(bytes[at + i])) << 8 * i;
  return value;
}

// The first bytes of the entry of a ZIP archive whose name has that ending, from its central
// directory. Sizes in local headers may be missing. Empty where there is none.
std::string beginning_of_entry(const std::string& bytes, std::string_view ending) {
  constexpr std::size_t wanted = 1 << 16;                // bytes, which hold the first element of a model
  constexpr std::size_t end_size = 22, entry_size = 46;  // bytes of the records without their texts
  if (bytes.size() < end_size) return {};
  const auto end = bytes.rfind("PK\5\6");
  if (end == bytes.npos) return {};
  for (std::size_t at = little(bytes, end + 16, 4);
       at + entry_size <= bytes.size() && bytes.compare(at, 4, "PK\1\2") == 0;) {
    const std::size_t name_size = little(bytes, at + 28, 2);
    const std::string_view name = std::string_view(bytes).substr(at + entry_size, name_size);
    const std::size_t method = little(bytes, at + 10, 2), local = little(bytes, at + 42, 4);
    const std::size_t size = little(bytes, at + 20, 4);
    at += entry_size + name_size + little(bytes, at + 30, 2) + little(bytes, at + 32, 2);
    if (!name.ends_with(ending) || local + 30 > bytes.size()) continue;
    const std::size_t first = local + 30 + little(bytes, local + 26, 2) + little(bytes, local + 28, 2);
    if (first >= bytes.size()) return {};
    const std::string_view packed = std::string_view(bytes).substr(first, size);
    if (method == 0) return std::string(packed.substr(0, wanted));
    z_stream stream{};
    std::string text(wanted, '\0');
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(packed.data()));
    stream.avail_in = static_cast<uInt>(packed.size());
    stream.next_out = reinterpret_cast<Bytef*>(text.data());
    stream.avail_out = static_cast<uInt>(text.size());
    if (::inflateInit2(&stream, -MAX_WBITS) != Z_OK) return {};
    ::inflate(&stream, Z_SYNC_FLUSH);
    text.resize(wanted - stream.avail_out);
    ::inflateEnd(&stream);
    return text;
  }
  return {};
}

// The unit of a named length; `otherwise` where the text is empty.
double named_unit(const std::string& name, const char* otherwise) {
  return length_unit(name.empty() ? otherwise : name).value_or(0);
}

}  // namespace

double unit_in(const std::string& bytes, const std::string& ending) {
  if (ending == "dae") {
    const std::string metres = attribute_of(bytes, "unit", "meter");
    return metres.empty() ? 1 : number_in(metres);
  }
  if (ending == "zae") {
    const std::string metres = attribute_of(beginning_of_entry(bytes, ".dae"), "unit", "meter");
    return metres.empty() ? 1 : number_in(metres);
  }
  if (ending == "x3d") {
    const bool length = attribute_of(bytes, "unit", "category") == "length";
    return length ? number_in(attribute_of(bytes, "unit", "conversionFactor")) : 1;
  }
  if (ending == "amf") return named_unit(attribute_of(bytes, "amf", "unit"), "millimeter");
  if (ending == "3mf")
    return named_unit(attribute_of(beginning_of_entry(bytes, ".model"), "model", "unit"), "millimeter");
  return 0;
}

}  // namespace geo
