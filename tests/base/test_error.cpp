// The hierarchy of exceptions, and suggestions for misspelt words.
#include <catch2/catch.hpp>

#include "kerf/error.h"

using namespace geo;

TEST_CASE("a missing input is an input error, and the others are distinct", "[error]") {
  CHECK_THROWS_AS(throw MissingInputError("x"), InputError);
  STATIC_REQUIRE_FALSE(std::is_base_of_v<InputError, OutputError>);
  STATIC_REQUIRE_FALSE(std::is_base_of_v<InputError, GeometryError>);
  STATIC_REQUIRE_FALSE(std::is_base_of_v<GeometryError, Interrupted>);
  CHECK(std::string(Interrupted().what()) == "interrupted");
  CHECK(std::string(InputError("line 3: no number").what()) == "line 3: no number");
}

TEST_CASE("the nearest known word is suggested", "[error]") {
  const std::vector<std::string> known{"density", "young", "poisson", "damping"};
  CHECK(did_you_mean("densty", known) == "; did you mean 'density'?");    // a letter left out
  CHECK(did_you_mean("densiity", known) == "; did you mean 'density'?");  // one too many
  CHECK(did_you_mean("dansity", known) == "; did you mean 'density'?");   // another letter
  CHECK(did_you_mean("dnesity", known) == "; did you mean 'density'?");   // two exchanged
  CHECK(did_you_mean("pois", known) == "; did you mean 'poisson'?");      // a beginning
  CHECK(did_you_mean("density", known) == "; did you mean 'density'?");
}

TEST_CASE("nothing is suggested if more than a third of the letters differ", "[error]") {
  const std::vector<std::string> known{"density", "young"};
  CHECK(did_you_mean("dxxxity", known).empty());  // three of seven
  CHECK(did_you_mean("yuong", known) == "; did you mean 'young'?");
  CHECK(did_you_mean("yxxng", known).empty());  // two of five
  CHECK(did_you_mean("", known).empty());
  CHECK(did_you_mean(std::string(101, 'd'), known).empty());
  CHECK(did_you_mean("density", {}).empty());
}

TEST_CASE("of equally near words the first is suggested", "[error]") {
  CHECK(did_you_mean("gap", {"gas", "gab"}) == "; did you mean 'gas'?");
  CHECK(did_you_mean("gap", {"gab", "gas"}) == "; did you mean 'gab'?");
}
