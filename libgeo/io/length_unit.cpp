// length_unit() of kerf/files.h.
#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <string_view>

#include "kerf/files.h"

namespace geo {
namespace {

struct Unit {
  std::string_view sign;
  double metres;
  std::array<std::string_view, 5> names;
};
constexpr std::array<Unit, 8> units = {{{"m", 1, {"meter", "metre", "meters", "metres", ""}},
                                        {"cm", 0.01, {"centimeter", "centimetre", "centimeters", "centimetres", ""}},
                                        {"mm", 0.001, {"millimeter", "millimetre", "millimeters", "millimetres", ""}},
                                        {"um", 1e-6, {"micron", "microns", "micrometer", "micrometre", "micrometers"}},
                                        {"km", 1000, {"kilometer", "kilometre", "kilometers", "kilometres", ""}},
                                        {"in", 0.0254, {"inch", "inches", "", "", ""}},
                                        {"ft", 0.3048, {"foot", "feet", "", "", ""}},
                                        {"yd", 0.9144, {"yard", "yards", "", "", ""}}}};

}  // namespace

std::optional<double> length_unit(std::string_view name) {
  if (name.empty()) return {};
  for (const Unit& unit : units)
    if (name == unit.sign || std::find(unit.names.begin(), unit.names.end(), name) != unit.names.end())
      return unit.metres;
  return {};
}

std::string length_unit_names() {
  std::string text;
  for (const Unit& unit : units) text += (text.empty() ? "" : ", ") + std::string(unit.sign);
  return text;
}

}  // namespace geo
