// Sections of .kerf files as JSON.
#include <catch2/catch.hpp>
#include <limits>
#include <nlohmann/json.hpp>
#include <sstream>

#include "io/kerf_writer.h"
#include "kerf/body_file.h"
#include "kerf/export.h"
#include "kerf/files.h"

using namespace geo;

namespace {

std::string json_of(const std::vector<KerfArray>& arrays) {
  std::ostringstream file, out;
  write_kerf(file, arrays);
  write_json(out, KerfFile(Input(file.str(), "a.kerf")));
  return out.str();
}

// An array of the given values and shape.
template <class T>
KerfArray shaped(const std::string& name, const std::vector<T>& values, std::vector<std::uint64_t> shape) {
  KerfArray array = kerf_array<T>(name, std::span<const T>(values));
  array.shape = std::move(shape);
  return array;
}

}  // namespace

TEST_CASE("arrays of one and more dimensions are nested lists") {
  std::vector<double> values{0.1, 2, 3, 4, 5, 1e300};
  const auto json = nlohmann::json::parse(json_of({shaped("flat", values, {6}), shaped("rows", values, {3, 2}),
                                                   shaped("deep", values, {1, 3, 2}), shaped("thin", values, {6, 1})}));
  CHECK(json["flat"] == nlohmann::json(values));
  CHECK(json["thin"] == nlohmann::json(values));
  CHECK(json["rows"].dump() == "[[0.1,2],[3,4],[5,1e+300]]");
  CHECK(json["deep"].dump() == "[[[0.1,2],[3,4],[5,1e+300]]]");
}

TEST_CASE("numbers that JSON lacks are null") {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  const std::vector<double> doubles{1.5, std::numeric_limits<double>::quiet_NaN(), infinity, -infinity};
  const std::vector<float> floats{std::numeric_limits<float>::quiet_NaN(), 0.5f};
  const auto json = nlohmann::json::parse(json_of({shaped("doubles", doubles, {4}), shaped("floats", floats, {2})}));
  CHECK(json["doubles"].dump() == "[1.5,null,null,null]");
  CHECK(json["floats"].dump() == "[null,0.5]");
}

TEST_CASE("sections of an unknown type are left out, all of them if need be") {
  const KerfArray later{"later", "c16", {0}, [](KerfSink&) {}};
  const std::vector<std::uint8_t> bytes{1, 2};
  CHECK(json_of({later}) == "{}\n");
  CHECK(nlohmann::json::parse(json_of({later, shaped("known", bytes, {2})})) == nlohmann::json{{"known", {1, 2}}});
}
