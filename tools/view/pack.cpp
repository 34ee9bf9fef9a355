// Positions are quantised to 16 bits in a box. zlib compresses byte planes of differences well.
#include "view/pack.h"

#include <zlib.h>

#include <algorithm>
#include <cmath>

#include <kerf/error.h>

namespace view {
namespace {

std::uint32_t sixteen_bits(double x, double lo, double size) {
  return size > 0 ? static_cast<std::uint32_t>(std::lround(65535 * std::clamp((x - lo) / size, 0.0, 1.0))) : 0;
}

}  // namespace

std::string base64(const std::string& bytes) {
  constexpr char letters[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t word = 0;
    for (std::size_t k = 0; k < 3; ++k)
      word = word << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0);
    for (std::size_t k = 0; k < 4; ++k) text += i + k <= bytes.size() ? letters[word >> (18 - 6 * k) & 63] : '=';
  }
  return text;
}

void Pack::whole(const std::string& name, const std::vector<std::uint32_t>& values, int width, int columns,
                 const std::string& base) {
  const std::size_t n = values.size(), at = bytes_.size(), lag = static_cast<std::size_t>(columns);
  const int bits = 8 * width;
  const std::vector<std::uint32_t>* earlier = base.empty() ? nullptr : &values_.at(base);
  bytes_.resize(at + n * static_cast<std::size_t>(width));
  for (std::size_t i = 0; i < n; ++i) {
    const std::uint32_t before = earlier ? (*earlier)[i] : i >= lag ? values[i - lag] : 0;
    // Differences modulo 2^bits, small ones of either sign as small numbers.
    const auto difference = static_cast<std::int32_t>((values[i] - before) << (32 - bits)) >> (32 - bits);
    const std::uint32_t folded =
        static_cast<std::uint32_t>(difference) << 1 ^ static_cast<std::uint32_t>(difference >> 31);
    for (int k = 0; k < width; ++k)
      bytes_[at + static_cast<std::size_t>(k) * n + i] = static_cast<char>(folded >> (8 * k) & 255);
  }
  nlohmann::ordered_json entry = {{"name", name}, {"at", at}, {"count", n}, {"width", width}, {"columns", columns}};
  if (earlier) entry["base"] = base;
  manifest_.push_back(std::move(entry));
  values_[name] = values;
}

void Pack::scaled(const std::string& name, const std::vector<double>& values) {
  double lo = 0, hi = 0;
  if (!values.empty()) {
    lo = *std::min_element(values.begin(), values.end());
    hi = *std::max_element(values.begin(), values.end());
  }
  scaled(name, values, lo, hi);
}

void Pack::scaled(const std::string& name, const std::vector<double>& values, double lo, double hi,
                  const std::string& base) {
  std::vector<std::uint32_t> steps;
  for (const double x : values) steps.push_back(sixteen_bits(x, lo, hi - lo));
  whole(name, steps, 2, 1, base);
  manifest_.back()["lo"] = {lo};
  manifest_.back()["step"] = {(hi - lo) / 65535};
}

void Pack::points(const std::string& name, const std::vector<geo::Vec3>& values, const geo::Box3& box,
                  const std::string& base) {
  points(name, values, box, box, base);
}

void Pack::points(const std::string& name, const std::vector<geo::Vec3>& values, const geo::Box3& box,
                  const geo::Box3& around, const std::string& base) {
  std::vector<std::uint32_t> steps;
  const geo::Vec3 size = around.hi - around.lo, begin = around.lo - box.center();
  for (const auto& p : values)
    for (int k = 0; k < 3; ++k) steps.push_back(sixteen_bits(p[k], around.lo[k], size[k]));
  whole(name, steps, 2, 3, base);
  auto lo = nlohmann::ordered_json::array(), step = nlohmann::ordered_json::array();
  const double unit = 0.5 * box.diagonal();
  for (int k = 0; k < 3; ++k) {
    lo.push_back(unit > 0 ? begin[k] / unit : 0);
    step.push_back(unit > 0 ? size[k] / unit / 65535 : 0);
  }
  manifest_.back()["lo"] = lo;
  manifest_.back()["step"] = step;
}

std::string Pack::text() const {
  uLongf size = compressBound(bytes_.size());
  std::string deflated(size, '\0');
  if (compress2(reinterpret_cast<Bytef*>(deflated.data()), &size, reinterpret_cast<const Bytef*>(bytes_.data()),
                bytes_.size(), 9) != Z_OK)
    throw geo::OutputError("the page cannot be packed: out of memory");
  deflated.resize(size);
  return base64(deflated);
}

}  // namespace view
