// Messages of a page: each kind is read, each fault is refused with a reason, and nothing else
// happens to any bytes.
#include <catch2/catch.hpp>

#include <random>
#include <string>
#include <vector>

#include "cases.h"
#include "live/command.h"
#include "messages.h"

using namespace live;

namespace {

const std::vector<std::string> samples = sample_messages();

std::string reason(const std::string& text) {
  try {
    read_command(text);
    return "";
  } catch (const BadMessage& e) {
    return e.what();
  }
}

}  // namespace

TEST_CASE("each kind of message is read") {
  CHECK(std::get<Acknowledge>(read_command(samples[0])).sequence == 4294967295u);
  const auto want = std::get<Want>(read_command(samples[1]));
  CHECK((want.nodes == true && want.stress == false && want.graph));
  const auto knife = std::get<Stroke>(read_command(samples[2]));
  CHECK((knife.id == 3 && knife.input == 17 && knife.phase == Phase::begin && knife.depth == 12.5));
  CHECK((knife.origin - geo::Vec3(0.5, -5.75, 1e-3)).norm() < 1e-12);
  CHECK(knife.direction == geo::Vec3(0, 1, 0));
  const auto scalpel = std::get<Stroke>(read_command(samples[3]));
  CHECK(scalpel.phase == Phase::move);
  CHECK((scalpel.origin + scalpel.depth * scalpel.direction - geo::Vec3(0, 0, 0.6)).norm() < 1e-12);
  CHECK(scalpel.origin.z() > 1);
  const auto grab = std::get<Grab>(read_command(samples[4]));
  CHECK((grab.spot.face == 12 && grab.spot.bary == geo::Vec3(0.2, 0.3, 0.5) && grab.to == geo::Vec3(1, 2, 3)));
  CHECK(std::get<Grab>(read_command(samples[5])).phase == Phase::end);
  const auto pin = std::get<Pin>(read_command(samples[6]));
  CHECK((pin.on && pin.radius == 0.3 && pin.spot.face == 12));
  const auto set = std::get<Set>(read_command(samples[7]));
  CHECK((set.young == 1e5 && set.gravity == geo::Vec3(0, 0, -9.81) && set.friction == 0.5 && set.damping == 1.0));
  CHECK(std::holds_alternative<Undo>(read_command(samples[8])));
  CHECK(std::holds_alternative<Reset>(read_command(samples[9])));
  CHECK_FALSE(std::get<Pause>(read_command(samples[10])).on);
  CHECK(std::holds_alternative<Step>(read_command(samples[11])));
  const auto path = std::get<Stroke>(read_command(samples[12]));
  REQUIRE(path.way.size() == 2);
  CHECK((path.way[0].origin == geo::Vec3(0, -3, 0) && path.way[0].direction == geo::Vec3(0, 1, 0)));
  CHECK((path.way[1].origin == geo::Vec3(0.5, -6, 0) && path.way[1].direction == geo::Vec3(1, 0, 0)));
  const auto blow = std::get<Blow>(read_command(samples[19]));
  CHECK((blow.spot.face == 12 && blow.cells == 9));
  const auto surface_path = std::get<Stroke>(read_command(samples[13]));
  REQUIRE(surface_path.way.size() == 1);
  CHECK((surface_path.way[0].origin - surface_path.origin - geo::Vec3(1, 0, 0)).norm() < 1e-12);
  CHECK(surface_path.way[0].direction == surface_path.direction);
  CHECK(std::get<Grab>(read_command(samples[14])).held == 2u);
  CHECK(std::get<Grab>(read_command(samples[15])).phase == Phase::hold);
  CHECK(std::holds_alternative<Redo>(read_command(samples[16])));
  CHECK(std::get<Show>(read_command(samples[17])).name == "apple");
  CHECK(std::get<Want>(read_command(samples[18])).rest == true);
  const auto tissue = std::get<Set>(read_command(samples[20]));
  CHECK((tissue.tension == 1.3 && tissue.resistance == 2000.0 && tissue.dullness == 0.5));
}

TEST_CASE("a path that is too long loses every second pose") {
  std::vector<EdgePose> path;
  for (std::size_t i = 0; i < 3 * longest_path; ++i) add_pose(path, {geo::Vec3(double(i), 0, 0)});
  CHECK(path.size() <= longest_path);
  CHECK(path.back().origin.x() == double(3 * longest_path - 1));
  for (std::size_t i = 1; i < path.size(); ++i) REQUIRE(path[i].origin.x() > path[i - 1].origin.x());
}

TEST_CASE("each fault of a message has its reason") {
  CHECK(reason("") == "the message is no JSON");
  CHECK(reason("{\"ack\":1") == "the message is no JSON");
  CHECK(reason("[1]") == "a message is a table with one key");
  CHECK(reason("{\"ack\":1,\"undo\":true}") == "a message is a table with one key");
  CHECK(reason("{\"fly\":1}") == "the message is of no known kind");
  CHECK(reason("{\"ack\":-1}") == "'ack' must be the number of a message");
  CHECK(reason("{\"ack\":4294967296}") == "'ack' must be the number of a message");
  CHECK(reason("{\"undo\":1}") == "'undo' must be true");
  CHECK(reason("{\"pause\":1}") == "'pause' must be true or false");
  CHECK(reason("{\"want\":3}") == "'want' must be a table");
  CHECK(reason("{\"want\":{\"colour\":true}}") == "'want' has a key that is not known");
  CHECK(reason("{\"set\":{\"young\":\"soft\"}}") == "'set.young' must be a number");
  CHECK(reason("{\"set\":{\"friction\":1.5}}").find("'set.friction' must be from 0") == 0);
  CHECK(reason("{\"set\":{\"gravity\":[1,2]}}") == "'set.gravity' must be three numbers");
  CHECK(reason("{\"set\":{\"gravity\":[1,2,1e300]}}").find("'set.gravity' must be from") == 0);
  CHECK(reason("{\"set\":{\"young\":1e999}}") == "the message is no JSON");
  CHECK(reason(R"({"pin":{"face":1,"on":true}})") == "'pin.bary' is missing");
  CHECK(reason(R"({"pin":{"face":1,"bary":[1,1,1],"on":true}})") == "'pin.bary' must be barycentric coordinates");
  CHECK(reason(R"({"break":{"face":1,"bary":[1,0,0],"cells":1}})") == "'break.cells' must be 2 to 64");
  CHECK(reason(R"({"pin":{"face":-1,"bary":[1,0,0],"on":true}})").find("'pin.face' must be a whole number") == 0);
  const std::string knife =
      R"({"knife":{"id":1,"phase":"begin","input":1,"eye":[0,0,0],"ray":[0,1,0],"depth":1,"from":0}})";
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string text = knife;
    return text.replace(text.find(from), from.size(), to);
  };
  CHECK(reason(knife).empty());
  CHECK(reason(with("begin", "start")) == "'knife.phase' must be \"begin\", \"move\" or \"end\"");
  CHECK(reason(with("[0,1,0]", "[0,0,0]")) == "'knife.ray' must be a direction");
  CHECK(reason(with("\"depth\":1", "\"depth\":-1")).find("'knife.depth' must be from") == 0);
  CHECK(reason(with("\"depth\":1", "\"depth\":null")) == "'knife.depth' must be a number");
  CHECK(reason(with("\"id\":1", "\"id\":1.5")).find("'knife.id' must be a whole number") == 0);
  CHECK(reason(with("\"from\":0", "\"from\":0,\"way\":[[0,1,0]]")) == "'knife.way' must be rows of 4 numbers");
  CHECK(reason(with("\"from\":0", "\"from\":0,\"way\":[[0,0,0,1]]")) == "'knife.way' must be a direction");
  CHECK(reason(with("\"from\":0", "\"from\":0,\"way\":[[0,1,0,-1]]")).find("'knife.way' must be from") == 0);
  CHECK(reason(with("\"from\":0", "\"from\":0,\"way\":3")) == "'knife.way' must be a list of at most 64");
  CHECK(reason(with("begin", "hold")) == "'knife.phase' must be \"begin\", \"move\" or \"end\"");
  CHECK(reason(std::string(longest_message + 1, ' ')).find("longer than 4096 bytes") != std::string::npos);
  CHECK(reason(std::string(4000, '[')) == "the message is nested too deeply");
}

// KERF_CASES=100: a million messages.
TEST_CASE("damaged messages are read or refused", "[fuzz]") {
  const Seeds run = seeds(10);
  std::size_t read = 0;
  for (std::uint64_t seed = run.first; seed < run.first + static_cast<std::uint64_t>(run.count); ++seed) {
    CAPTURE(seed);
    std::mt19937_64 random(seed);
    for (int i = 0; i < 1000; ++i) read += reason(damaged_message(samples, random)).empty();
  }
  CHECK(read > 0);
  CHECK(read < 1000 * static_cast<std::size_t>(run.count));
}
