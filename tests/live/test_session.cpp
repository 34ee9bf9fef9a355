// A run under hands: the page shows the run's surface, and the recording gives the same run.
#include <catch2/catch.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <sstream>
#include <tuple>

#include <kerf/body_file.h>
#include <kerf/contact.h>
#include <kerf/files.h>
#include <kerf/mesh.h>
#include <kerf/pieces.h>
#include "cases.h"
#include "live/encode.h"
#include "live/scene_text.h"
#include "live/session.h"
#include "page_model.h"
#include "setup.h"

using namespace live;

namespace {

const geo::TriangleMesh& block() {
  static const geo::TriangleMesh mesh = geo::make_block({1, 1, 1}, 0.2);
  return mesh;
}

sim::Setup setup() {
  return setup_of(R"(
gravity = [0, 0, -3]
[body]
mesh = "cube.ply"
spacing = 0.25
[material]
young = 3e4
damping = 2.0
[ground]
point = [0, 0, -0.01]
)",
                  block());
}

// The pose of an edge through the cube along y, at x.
Stroke knife(std::uint64_t id, Phase phase, double x, double tilt = 0) {
  return {id, 1, phase, {x, -0.5, 0.52}, geo::Vec3(0.02, 1, tilt).normalized(), 2.2};
}

void cut(Session& session, std::uint64_t id, double from, double to, double tilt = 0) {
  session.obey(1, knife(id, Phase::begin, from, tilt));
  for (int i = 1; i <= 12; ++i) {
    session.obey(1, knife(id, i == 12 ? Phase::end : Phase::move, from + (to - from) * i / 12, tilt));
    REQUIRE(session.advance().empty());
  }
  session.advance();
}

Snapshot shown(Session& session) {
  static std::uint64_t number = 0;
  Snapshot s;
  s.number = ++number;
  session.show(s);
  s.scene = std::make_shared<std::string>(scene_text(session, "cube"));
  s.statistics = statistics_text(session, {});
  return s;
}

using Corners = std::array<std::array<double, 3>, 3>;

// The page draws the surface of the run, to the step of its numbers.
void require_same(const PageModel& page, const geo::Simulation& run) {
  const geo::TriangleMesh surface = run.surface();
  std::vector<Corners> drawn, real;
  const auto place = [&](std::vector<Corners>& list, const auto& point) {
    Corners c;
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t k = 0; k < 3; ++k) c[i][k] = point(i, k);
    list.push_back(c);
  };
  for (const auto& t : page.triangles)
    if (t[0] != t[1]) place(drawn, [&](std::size_t i, std::size_t k) { return page.positions[t[i]][k]; });
  for (const auto& t : surface.triangles)
    place(real, [&](std::size_t i, std::size_t k) { return surface.vertices[t[i]][static_cast<int>(k)]; });
  REQUIRE(drawn.size() == real.size());
  // Each real triangle is near a drawn one: compared through the sums of corners, sorted.
  double far = 0;
  std::vector<std::array<double, 3>> a, b;
  for (const auto* list : {&drawn, &real})
    for (const Corners& c : *list) {
      std::array<double, 3> middle{};
      for (std::size_t k = 0; k < 3; ++k) middle[k] = c[0][k] + c[1][k] + c[2][k];
      (list == &drawn ? a : b).push_back(middle);
    }
  for (const auto& m : b) {
    double best = 1e300;
    for (const auto& n : a)
      best = std::min(best, std::max({std::abs(m[0] - n[0]), std::abs(m[1] - n[1]), std::abs(m[2] - n[2])}));
    far = std::max(far, best);
  }
  CHECK(far < 3 * double(*std::max_element(page.step.begin(), page.step.end())));
}

std::string surface_bytes(const geo::Simulation& run) {
  std::ostringstream out;
  geo::write_ply(out, run.surface());
  return std::move(out).str();
}

// The recording as kerf-sim runs it: read from text, with its checkpoints.
std::string replayed(const Session& session) {
  std::ostringstream text;
  geo::write_scene(text, session.recording(), "");
  const geo::Scene scene = geo::parse_scene(text.str(), "recorded.toml");
  const auto through = [&](const geo::Body& body, const geo::RunState& state) {
    std::ostringstream out;
    geo::write_checkpoint(out, body, state, 0);
    return geo::read_checkpoint(geo::KerfFile(geo::Input(out.str(), "checkpoint")));
  };
  geo::RunStart start = geo::begin_run(scene, geo::place_models(scene, {block()}));
  geo::Checkpoint c = through(start.body, start.state);
  geo::Simulation run(scene, std::move(c.body), std::move(c.state));
  for (int frame = 1; frame <= session.run().state().frame; ++frame) {
    run.advance_frame();
    if (!std::binary_search(scene.checkpoints.begin(), scene.checkpoints.end(), frame)) continue;
    c = through(run.body(), run.state());
    run.restore(std::move(c.body), std::move(c.state));
  }
  return surface_bytes(run);
}

}  // namespace

TEST_CASE("a stroke cuts, and the page has the run's surface after each message") {
  Session session(setup(), {});
  PageModel page;
  Snapshot s = shown(session);
  page.take(encode_state(s, {1}));
  CHECK(page.scene["name"] == "cube");
  CHECK(page.scene["ground"]["normal"][2] == 1);
  require_same(page, session.run());
  auto known = s.topology;
  session.obey(7, knife(1, Phase::begin, -0.2));
  std::size_t deltas = 0;
  double force = 0;
  for (int i = 1; i <= 14; ++i) {
    session.obey(7, knife(1, i == 14 ? Phase::end : Phase::move, -0.2 + 1.4 * i / 14));
    REQUIRE(session.advance().empty());
    if (i % 3 == 1) continue;  // a page that misses frames
    s = shown(session);
    page.take(encode_frame(s, *known, {std::uint32_t(i + 1), false, false, 5}));
    for (const auto& [edge, newtons] : session.edges()) force = std::max(force, newtons);
    deltas += page.kind == 2;
    known = s.topology;
    CHECK(page.statistics["ack_input"] == 5);
    require_same(page, session.run());
  }
  CHECK(deltas > 3);
  session.advance();
  session.advance();
  CHECK(force > 0);
  CHECK(session.pieces() == 2);
  CHECK(session.history().strokes() == 1);
  CHECK(session.hands().last_stroke() == 1);
  CHECK(shown(session).taken.at(7) == 1);
  CHECK(geo::count_crossings(session.run().surface()) == 0);
}

TEST_CASE("undo and reset go back, and the recording gives the same bytes") {
  Session session(setup(), {});
  for (int i = 0; i < 3; ++i) session.advance();
  const std::string whole = surface_bytes(session.run());
  cut(session, 1, -0.2, 1.2);
  CHECK(session.pieces() == 2);
  session.undo();
  CHECK(session.pieces() == 1);
  CHECK(session.history().strokes() == 0);
  CHECK(surface_bytes(session.run()) == whole);
  CHECK_THROWS_AS(session.undo(), BadMessage);
  shown(session);
  session.obey(Pin{{0, {0.3, 0.3, 0.4}}, true, 0.3});
  session.obey(Set{2e4, {}, 1.0, geo::Vec3(0.5, 0, -2)});
  Grab grab{9, 3, Phase::begin, {5, {0.4, 0.3, 0.3}}, {0.5, 0.5, 1.5}};
  session.obey(1, grab);
  for (int i = 0; i < 6; ++i) {
    grab.phase = i == 5 ? Phase::end : Phase::move;
    grab.to = {0.5, 0.5, 1.5 + 0.02 * i};
    session.obey(1, grab);
    session.advance();
  }
  CHECK(session.stats().pull_force.at(0).norm() > 0);
  CHECK(session.hands().pins().size() == 1);
  cut(session, 2, -0.2, 1.2);
  cut(session, 3, 1.2, -0.2, 0.1);
  session.undo();
  cut(session, 4, 1.2, 0.6, -0.2);
  CHECK(session.effort() == Effort{0.01, 2});
  session.set_effort({0.02, 1});
  session.advance();
  CHECK(session.effort() == Effort{0.02, 1});
  CHECK(session.stats().steps == 1);
  CHECK(session.recording().checkpoints.size() == 2);
  CHECK(replayed(session) == surface_bytes(session.run()));
  session.reset();
  CHECK(session.run().state().frame == 0);
  CHECK(session.hands().pins().empty());
  CHECK(session.recording().blades.empty());
  CHECK(session.effort() == Effort{0.01, 2});
  session.set_effort({0.014, 1});
  cut(session, 5, -0.2, 0.5);
  session.set_effort({0.014, 3});
  cut(session, 6, 0.5, 1.2);
  CHECK(session.stats().steps == 3);
  CHECK(replayed(session) == surface_bytes(session.run()));
}

TEST_CASE("undo keeps the scene's own changes, and a grab that has not moved is in no recording") {
  sim::Setup with_change = setup();
  with_change.scene.changes = {{.time = 0.3, .gravity = geo::Vec3(0, 0, 1)}};
  Session session(with_change, {});
  session.advance();
  session.obey(Set{2e4, {}, 1.0, geo::Vec3(0.5, 0, -2)});
  cut(session, 1, -0.2, 1.2);
  session.obey(Set{4e4, {}, 1.0, geo::Vec3(0.5, 0, -2)});
  session.undo();
  CHECK(session.recording().changes.size() == 2);
  CHECK(session.run().scene().material.young == 2e4);
  for (int i = 0; i < 20; ++i) session.advance();
  CHECK(session.run().scene().gravity == geo::Vec3(0, 0, 1));
  CHECK(replayed(session) == surface_bytes(session.run()));
  shown(session);
  session.obey(1, Grab{9, 3, Phase::begin, {5, {0.4, 0.3, 0.3}}, {0.5, 0.5, 1.5}});
  CHECK(session.recording().pulls.empty());
  CHECK(replayed(session) == surface_bytes(session.run()));
}

TEST_CASE("a blow breaks the piece that is hit, and no other") {
  Session session(setup(), {});
  Snapshot s = shown(session);
  PageModel page;
  page.take(encode_state(s, {1}));
  CHECK_THROWS_AS(session.obey(Blow{{1u << 30, {1, 0, 0}}, 8}), BadMessage);
  session.obey(1, knife(1, Phase::begin, -0.2));
  CHECK_THROWS_AS(session.obey(Blow{{0, {1, 0, 0}}, 8}), BadMessage);
  session.obey(1, knife(1, Phase::end, -0.2));
  session.advance();
  cut(session, 2, -0.2, 1.2);
  for (int i = 0; i < 5; ++i) session.advance();
  REQUIRE(session.pieces() == 2);
  const std::string before = surface_bytes(session.run());
  const geo::Pieces halves = geo::find_pieces(session.run().body().surface);
  shown(session);
  const std::size_t cuts = session.history().strokes();
  session.obey(Blow{{0, {0.4, 0.3, 0.3}}, 8});
  CHECK(session.history().strokes() == cuts + 1);
  CHECK(session.blows() == 1);
  CHECK(session.pieces() >= 4);
  // One half is as it was: its volume is that of a piece.
  const geo::Pieces parts = geo::find_pieces(session.run().body().surface);
  const auto has = [&](double volume) {
    return std::any_of(parts.volume.begin(), parts.volume.end(),
                       [&](double v) { return std::abs(v - volume) < 1e-9 * volume; });
  };
  CHECK(has(halves.volume.at(0)) != has(halves.volume.at(1)));
  CHECK(geo::check_body(session.run().body()).good());
  CHECK(geo::count_crossings(session.run().surface()) == 0);
  for (int i = 0; i < 20; ++i) {
    REQUIRE(session.advance().empty());
    CHECK(geo::count_crossings(session.run().surface()) == 0);
  }
  s = shown(session);
  page.take(encode_state(s, {2}));
  require_same(page, session.run());
  CHECK(session.recording().blows.size() == 1);
  CHECK(replayed(session) == surface_bytes(session.run()));
  // A part breaks again, and both blows are undone and made again.
  const std::uint32_t once = session.pieces();
  shown(session);
  session.obey(Blow{{0, {0.4, 0.3, 0.3}}, 4});
  CHECK(session.pieces() > once);
  const std::string twice = surface_bytes(session.run());
  session.advance();
  CHECK(session.recording().blows.size() == 2);
  CHECK(replayed(session) == surface_bytes(session.run()));
  // A stroke that cuts nothing leaves the blow before it to be undone.
  session.obey(1, knife(3, Phase::begin, -3));
  session.obey(1, knife(3, Phase::move, -2.9));
  session.advance();
  session.obey(1, knife(3, Phase::end, -2.9));
  for (int i = 0; i < 3; ++i) session.advance();
  CHECK(session.history().strokes() == cuts + 2);
  session.undo();
  session.redo();
  session.undo();
  CHECK(session.blows() == 1);
  CHECK(session.pieces() == once);
  session.undo();
  CHECK(session.blows() == 0);
  CHECK(surface_bytes(session.run()) == before);
  CHECK(replayed(session) == surface_bytes(session.run()));
  CHECK(twice != before);
}

TEST_CASE("requests that cannot be obeyed are refused, and hands of a page that went are let go") {
  Session session(setup(), {});
  CHECK_THROWS_AS(session.obey(1, Grab{1, 1, Phase::begin, {1u << 30, {1, 0, 0}}, {0, 0, 0}}), BadMessage);
  CHECK_THROWS_AS(session.obey(Pin{{1u << 30, {1, 0, 0}}, true, 0.1}), BadMessage);
  shown(session);
  CHECK_THROWS_AS(session.obey(Pin{{0, {1, 0, 0}}, false, 0.1}), BadMessage);
  CHECK_THROWS_AS(session.obey(Set{-1.0, {}, {}, {}}), BadMessage);
  session.obey(1, knife(1, Phase::begin, -0.5));
  CHECK_THROWS_AS(session.obey(1, knife(1, Phase::begin, -0.5)), BadMessage);
  Stroke endless = knife(2, Phase::begin, -0.5);
  endless.depth = 1e8;
  CHECK_THROWS_AS(session.obey(1, endless), BadMessage);
  for (std::uint64_t id = 10; id < 17; ++id) session.obey(2, knife(id, Phase::begin, -0.5));
  CHECK_THROWS_AS(session.obey(2, knife(30, Phase::begin, -0.5)), BadMessage);
  session.advance();
  CHECK(session.edges().empty());  // none has moved
  session.obey(1, knife(1, Phase::move, -0.45));
  for (std::uint64_t id = 10; id < 17; ++id) session.obey(2, knife(id, Phase::move, -0.45));
  session.advance();
  CHECK(session.edges().size() == 8);
  session.leave(1);
  session.leave(2);
  session.advance();
  session.advance();
  session.advance();
  CHECK(session.edges().empty());
  CHECK(session.history().strokes() == 0);      // none has cut
  session.obey(1, knife(1, Phase::move, 0.5));  // of a stroke that is over: nothing
}

TEST_CASE("a stroke far behind its pointer ends a time after it was released, and is recorded as far as it came") {
  Session session(setup(), {});
  session.obey(1, knife(1, Phase::begin, -3));
  session.obey(1, knife(1, Phase::end, 20));
  session.advance();
  CHECK(session.end_late_strokes(0.4, 1) == 0);
  session.advance();
  CHECK(session.end_late_strokes(0.4, 1) == 0);
  REQUIRE(session.edges().size() == 1);
  session.advance();
  CHECK(session.hands().last_stroke() == 0);
  CHECK(session.end_late_strokes(0.4, 1) == 1);
  CHECK(session.hands().last_stroke() == 1);
  session.advance();
  CHECK(session.edges().empty());
  // One that is held is never late.
  session.obey(1, knife(2, Phase::begin, -1));
  session.obey(1, knife(2, Phase::move, 1.2));
  for (int i = 0; i < 5; ++i) {
    session.advance();
    CHECK(session.end_late_strokes(10, 1) == 0);
  }
  CHECK(session.pieces() == 2);
  session.obey(1, knife(2, Phase::end, 1.2));
  session.advance();
  CHECK(session.hands().last_stroke() == 2);
  CHECK(replayed(session) == surface_bytes(session.run()));
}

TEST_CASE("undo states and recordings are bounded") {
  SessionBounds bounds;
  bounds.undo.states = 3;
  {
    Session session(setup(), {}, bounds);
    for (std::uint64_t id = 1; id <= 4; ++id) cut(session, id, -0.3, 0.2 * double(id));
    CHECK(session.history().strokes() == 3);
    for (int k = 0; k < 3; ++k) session.undo();
    CHECK_THROWS_AS(session.undo(), BadMessage);
    CHECK(session.recording().blades.size() == 1);
  }
  bounds.undo.states = 16;
  bounds.undo.bytes = 1;
  bounds.recorded = 2;
  bounds.changes = 1;
  Session session(setup(), {}, bounds);
  cut(session, 1, -0.3, 0.2);
  cut(session, 2, 0.3, 1.2);
  CHECK(session.history().strokes() == 1);
  CHECK_THROWS_AS(session.obey(1, knife(3, Phase::begin, 0)), BadMessage);
  session.obey(Set{2e4, {}, {}, {}});
  CHECK_THROWS_AS(session.obey(Set{3e4, {}, {}, {}}), BadMessage);
  const Effort before = session.effort();
  session.set_effort({0.02, 1});
  CHECK(session.effort() == before);
  session.undo();
  session.obey(1, knife(4, Phase::begin, 0));
  session.reset();
  bounds.recorded = 100;
  bounds.keys = 5;
  Session few_keys(setup(), {}, bounds);
  cut(few_keys, 1, -0.3, 0.2);
  CHECK_THROWS_AS(few_keys.obey(1, knife(2, Phase::begin, 0)), BadMessage);
}

TEST_CASE("an edge follows the whole path that was drawn before a frame, and goes straight where the path is") {
  Session session(setup(), {});
  const auto pose = [](double x, double y) { return EdgePose{{x, y, 1.3}, {0, 0, -1}}; };
  const auto draw = [&](std::uint64_t id, const std::vector<EdgePose>& path) {
    Stroke stroke{id, 1, Phase::begin, path.front().origin, path.front().direction, 0.6};
    session.obey(1, stroke);
    stroke.phase = Phase::end;
    stroke.origin = path.back().origin;
    stroke.way.assign(path.begin() + 1, path.end() - 1);
    session.obey(1, stroke);
    std::vector<geo::Vec3> passed;
    for (int frame = 0; frame < 100; ++frame) {
      REQUIRE(session.advance(true).empty());
      if (session.hands().waiting().empty()) break;
    }
    const auto& blades = session.run().scene().blades;
    for (const geo::Motion::Key& key : blades.back().motion.keys) passed.push_back(key.position);
    return passed;
  };
  std::vector<EdgePose> straight, u;
  for (int i = 0; i <= 20; ++i) straight.push_back(pose(-0.2 + 0.07 * i, 0.9));
  CHECK(draw(1, straight).size() == 2);
  for (int i = 0; i <= 30; ++i) u.push_back(pose(0.5 - 0.35 * std::cos(0.1 * i), 0.15 + 0.5 * std::sin(0.1 * i)));
  const std::vector<geo::Vec3> passed = draw(2, u);
  CHECK(passed.size() < 20);
  // Each pose of the path is an eighth of a node spacing from the way that the edge took, at most.
  for (const EdgePose& p : u) {
    double least = 1e9;
    for (std::size_t i = 0; i + 1 < passed.size(); ++i)
      for (int k = 0; k <= 50; ++k)
        least = std::min(least, (passed[i] + k / 50.0 * (passed[i + 1] - passed[i]) - p.origin).norm());
    CHECK(least < 0.125 * 0.25 + 0.01);
  }
  CHECK(session.history().strokes() == 2);
  CHECK(replayed(session) == surface_bytes(session.run()));
}

TEST_CASE("strokes that begin in one frame are one step of undo, whichever of them cut") {
  for (const auto& [left, right, steps] :
       {std::tuple(-0.2, 1.2, 1u), {-3.0, 1.2, 1u}, {-0.2, 3.0, 1u}, {-3.0, 3.0, 0u}}) {
    CAPTURE(left, right);
    Session session(setup(), {});
    std::string whole;
    for (int i = 0; i <= 12; ++i) {
      const Phase phase = i == 0 ? Phase::begin : i == 12 ? Phase::end : Phase::move;
      session.obey(1, knife(1, phase, left + 0.05 * i));
      session.obey(1, knife(2, phase, right - 0.05 * i));
      REQUIRE(session.advance().empty());
      if (i == 0) whole = surface_bytes(session.run());  // an edge is a blade from its first motion on
    }
    for (int i = 0; i < 2; ++i) session.advance();
    REQUIRE(session.history().strokes() == steps);
    CHECK(replayed(session) == surface_bytes(session.run()));
    if (steps == 0) continue;
    const std::string cut = surface_bytes(session.run());
    session.undo();
    CHECK(surface_bytes(session.run()) == whole);
    CHECK(session.history().strokes() == 0);
    session.redo();
    CHECK(surface_bytes(session.run()) == cut);
  }
}

TEST_CASE("a tight skin is a new beginning, and edges are as dull as was said when they began to cut") {
  Session session(setup(), {});
  const std::string loose = surface_bytes(session.run());
  cut(session, 1, -0.2, 0.4);
  session.obey(Set{.resistance = 20, .dullness = 0.4, .tension = 1.3});
  CHECK(session.history().strokes() == 0);
  CHECK(session.run().state().frame == 0);
  CHECK(session.original().prestretch.skin == 1.3);
  cut(session, 1, -0.2, 0.4);
  CHECK(session.recording().blades.back().resistance == 20);
  CHECK(session.recording().blades.back().friction == 0.4);
  CHECK(replayed(session) == surface_bytes(session.run()));
  session.withhold_weight();
  CHECK(!session.is_weightless());  // it rests in its weight
  session.obey(Set{.resistance = 0, .dullness = 0, .tension = 1});
  CHECK(surface_bytes(session.run()) == loose);
  cut(session, 1, -0.2, 0.4);
  CHECK(session.recording().blades.back().resistance == 0);
}

TEST_CASE("redo makes undone cuts again, to the bit, with all that hands did then") {
  Session session(setup(), {});
  CHECK_THROWS_AS(session.redo(), BadMessage);
  session.withhold_weight();
  cut(session, 1, -0.2, 0.4);
  session.obey(Set{2e4, {}, {}, {}});
  shown(session);
  session.obey(Pin{{0, {0.3, 0.3, 0.4}}, true, 0.3});
  cut(session, 2, 0.3, 1.2);
  session.advance();
  const std::string both = surface_bytes(session.run());
  session.undo();
  CHECK(session.history().undone() == 1);
  CHECK(session.hands().pins().size() == 1);
  for (int i = 0; i < 3; ++i) session.advance();
  const std::string one = surface_bytes(session.run());
  session.undo();
  CHECK(session.history().undone() == 2);
  CHECK(session.run().scene().material.young == 3e4);
  CHECK(session.hands().pins().empty());
  CHECK(session.is_weightless());
  for (int i = 0; i < 2; ++i) session.advance();
  session.redo();
  CHECK(surface_bytes(session.run()) == one);
  CHECK(session.run().scene().material.young == 2e4);
  CHECK(session.hands().pins().size() == 1);
  session.redo();
  CHECK(surface_bytes(session.run()) == both);
  CHECK(session.history().strokes() == 2);
  CHECK(session.history().undone() == 0);
  for (int i = 0; i < 3; ++i) session.advance();
  CHECK(replayed(session) == surface_bytes(session.run()));
  session.undo();
  session.undo();
  session.redo();
  cut(session, 3, 1.2, 0.6, 0.2);
  CHECK(session.history().undone() == 0);
  CHECK_THROWS_AS(session.redo(), BadMessage);
  CHECK(session.history().strokes() == 2);
  CHECK(replayed(session) == surface_bytes(session.run()));
}

TEST_CASE("a grab that stays outlives its page, takes two keys while it rests, and is taken up again") {
  Session session(setup(), {});
  shown(session);
  Grab grab{9, 3, Phase::begin, {5, {0.4, 0.3, 0.3}}, {0.5, 0.5, 1.5}};
  session.obey(1, grab);
  session.advance();
  grab.phase = Phase::hold;
  grab.to = {0.5, 0.5, 1.4};
  session.obey(1, grab);
  session.leave(1);
  for (int i = 0; i < 30; ++i) session.advance();
  shown(session);
  REQUIRE(session.hands().holds().size() == 1);
  const Hold hold = session.hands().holds().at(0);
  CHECK(hold.to == geo::Vec3(0.5, 0.5, 1.4));
  CHECK((hold.at - hold.to).norm() < 0.5);
  CHECK(session.stats().pull_force.at(0).norm() > 0);
  CHECK(session.run().scene().pulls.at(0).motion.keys.size() < 8);
  cut(session, 1, -0.2, 1.2);
  CHECK(session.hands().holds().size() == 1);
  CHECK(replayed(session) == surface_bytes(session.run()));
  session.undo();
  REQUIRE(session.hands().holds().size() == 1);
  for (int i = 0; i < 5; ++i) session.advance();
  CHECK(replayed(session) == surface_bytes(session.run()));
  Grab again{10, 4, Phase::begin, {}, {0.5, 0.5, 1.3}, hold.number};
  session.obey(2, again);
  CHECK_THROWS_AS(session.obey(3, again), BadMessage);
  CHECK(session.hands().holds().size() == 1);
  session.advance();
  again.phase = Phase::end;
  session.obey(2, again);
  session.advance();
  CHECK(session.hands().holds().empty());
  for (int i = 0; i < 5; ++i) session.advance();
  CHECK(replayed(session) == surface_bytes(session.run()));
  shown(session);
  session.obey(1, Grab{11, 3, Phase::begin, {5, {0.4, 0.3, 0.3}}, {0.5, 0.5, 1.5}});
  session.obey(1, Grab{11, 3, Phase::hold, {}, {0.5, 0.5, 1.5}});
  session.reset();
  CHECK(session.hands().holds().empty());
}

TEST_CASE("weight that is withheld acts when the first stroke is over") {
  Session session(setup(), {});
  session.withhold_weight();
  CHECK(session.gravity() == geo::Vec3(0, 0, -3));
  session.obey(1, knife(1, Phase::begin, -0.2));
  double lowest = 0;
  for (int i = 1; i <= 12; ++i) {
    session.obey(1, knife(1, i == 12 ? Phase::end : Phase::move, -0.2 + 0.05 * i));
    session.advance();
    CHECK(session.run().scene().gravity == geo::Vec3(0, 0, 0));
    if (session.has_cut()) continue;
    for (const geo::Vec3& u : session.run().state().motion.displacement) lowest = std::min(lowest, u.z());
  }
  CHECK(lowest == 0);  // before the blade meets the body
  session.advance();
  session.advance();
  CHECK(session.run().scene().gravity == geo::Vec3(0, 0, -3));
  CHECK_FALSE(session.is_weightless());
  CHECK(replayed(session) == surface_bytes(session.run()));
  session.reset();
  session.withhold_weight();
  session.advance();  // no stroke
  CHECK(session.run().scene().gravity == geo::Vec3(0, 0, -3));
}

TEST_CASE("a slow knife does not push along a body without weight, and values set meanwhile act with the weight") {
  Session session(setup(), {});
  session.withhold_weight();
  constexpr int frames = 240;
  session.obey(1, knife(1, Phase::begin, -0.2));
  for (int i = 1; i <= frames; ++i) {
    session.obey(1, knife(1, i == frames ? Phase::end : Phase::move, -0.2 + 1.4 * i / frames));
    if (i == frames / 2) session.obey(Set{.damping = 3, .gravity = geo::Vec3(0, 0, -4)});
    REQUIRE(session.advance().empty());
  }
  CHECK(session.damping() == 3);
  CHECK(session.gravity() == geo::Vec3(0, 0, -4));
  CHECK(session.run().scene().gravity == geo::Vec3(0, 0, 0));
  geo::Vec3 sum = geo::Vec3::Zero();
  for (const geo::Vec3& u : session.run().state().motion.displacement) sum += u;
  CHECK(std::abs(sum.x()) / double(session.run().body().nodes.size()) < 0.01);  // 0.03 without a drag that holds it
  while (session.hands().has_strokes()) session.advance();
  session.advance();
  CHECK(session.run().scene().material.damping == 3);
  CHECK(session.run().scene().gravity == geo::Vec3(0, 0, -4));
  CHECK(replayed(session) == surface_bytes(session.run()));
}

TEST_CASE("twenty steps of undo for a body of 30,000 triangles take less than 300 MB") {
  sim::Setup s;
  s.scene = geo::parse_scene("gravity = [0, 0, 0]\n[body]\nmesh = \"b.ply\"\nspacing = 0.12\n[material]\nyoung = 3e4\n",
                             "s.toml");
  s.models = geo::place_models(s.scene, {geo::make_block({1, 1, 1}, 0.0145)});
  adapt_scene(s.scene, 60, true);
  REQUIRE(s.models.all.triangles.size() > 28000);
  Session session(s, {});
  std::vector<std::string> states;
  for (std::uint64_t id = 1; id <= 20; ++id) {
    std::ostringstream body;
    geo::write_body(body, session.run().body());
    states.push_back(std::move(body).str());
    const double y = 0.02 + 0.047 * double(id);
    Stroke stroke{id, 1, Phase::begin, {-0.1, y, 1.2}, {0, 0, -1}, 0.5};
    session.obey(1, stroke);
    stroke.phase = Phase::end;
    stroke.origin.x() = 0.9;
    session.obey(1, stroke);
    while (!session.hands().waiting().empty()) REQUIRE(session.advance(true).empty());
  }
  REQUIRE(session.history().strokes() == 20);
  INFO(session.history().bytes());
  CHECK(session.history().bytes() < 60'000'000);
  for (std::size_t id = 20; id-- > 0;) {
    session.undo();
    std::ostringstream body;
    geo::write_body(body, session.run().body());
    REQUIRE(body.str() == states[id]);
  }
  CHECK(session.history().undone() == 20);
  CHECK(session.history().bytes() < 100'000'000);
}

// Strokes that reach the bottom of others leave fronts whose points coincide.
TEST_CASE("a front whose points coincide is in a checkpoint as it is in the run") {
  Session session(setup(), {});
  session.obey(1, knife(1, Phase::begin, -0.2));
  for (int i = 1; i <= 6; ++i) {
    session.obey(1, knife(1, Phase::move, -0.2 + 0.1 * i));
    REQUIRE(session.advance().empty());
  }
  geo::RunState state = session.run().state();
  auto& segments = state.fronts.at(0).at(0).front.segments;
  auto& points = state.fronts.at(0).at(0).front.points;
  REQUIRE(segments.size() > 2);
  segments[1] = {segments[1].front()};
  points[2] = points[1];
  segments[2].front() = segments[1].front();
  std::ostringstream out;
  geo::write_checkpoint(out, session.run().body(), state, 0);
  const geo::Checkpoint read = geo::read_checkpoint(geo::KerfFile(geo::Input(out.str(), "checkpoint")));
  const geo::FrontState& front = read.state.fronts.at(0).at(0).front;
  CHECK(front.segments.at(1).size() == 1);
  REQUIRE(front.points.size() == points.size());
  for (std::size_t i = 0; i < points.size(); ++i) CHECK(front.points[i].position == points[i].position);
}

TEST_CASE("random hands: pages, recording and pieces agree", "[hands]") {
  const Seeds run = seeds(2);
  for (std::uint64_t seed = run.first; seed < run.first + static_cast<std::uint64_t>(run.count); ++seed) {
    CAPTURE(seed);
    std::mt19937_64 random(seed);
    const auto uniform = [&](double lo, double hi) { return lo + (hi - lo) * double(random() % 100000) / 100000; };
    Session session(setup(), {});
    PageModel page;
    Snapshot s = shown(session);
    page.take(encode_state(s, {1}));
    auto known = s.topology;
    for (int act = 0; act < 6; ++act) {
      switch (random() % 7) {
        case 0:
          if (session.history().undone() > 0 && random() % 2 == 0)
            session.redo();
          else if (session.history().strokes() > 0)
            session.undo();
          break;
        case 1:
          session.set_effort({uniform(0.01, 0.04), 1 + int(random() % 3)});
          break;
        case 2:
          session.obey(Set{uniform(1e4, 5e4), uniform(0, 1), {}, geo::Vec3(uniform(-1, 1), uniform(-1, 1), -3)});
          break;
        case 3:  // a page that lost its connection gets the whole state
          s = shown(session);
          page = PageModel();
          page.take(encode_state(s, {1}));
          known = s.topology;
          require_same(page, session.run());
          break;
        case 4:
          if (act > 2) session.reset();
          break;
        default:
          cut(session, random() % 1000000, uniform(-0.3, 0.5), uniform(0.5, 1.3), uniform(-0.3, 0.3));
          break;
      }
      session.advance();
      s = shown(session);
      page.take(encode_frame(s, *known, {2}));
      known = s.topology;
      require_same(page, session.run());
      CHECK(geo::count_crossings(session.run().surface()) == 0);
    }
    CHECK(replayed(session) == surface_bytes(session.run()));
  }
}
