// Surfaces, feature lines and contacts of fronts at the vertices of cut blocks, against their
// definitions.
#include "crack/features.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <set>

#include "base/random.h"
#include "cases.h"
#include "crack/block_cuts.h"
#include "kerf/mesh.h"

using namespace geo;

namespace {

// A block with up to four cracks; the last one's front is kept.
struct CutModel {
  Complex k;
  FrontState front;
  explicit CutModel(Random& random) : k(Complex::from_skin(make_block({1, 1, 1}, 0.35))) {
    // A bent sheet whose two halves are oriented alike or not, and cracks by fronts.
    TriangleMesh sheet;
    for (int i = 0; i < 4; ++i)
      sheet.vertices.push_back({0.3 + 0.4 * (i / 2), 0.3 + 0.4 * (i % 2), random.uniform(0.4, 0.6)});
    sheet.triangles = {{0, 1, 2}, random.below(2) == 0 ? Triangle{1, 3, 2} : Triangle{1, 2, 3}};
    insert_sheet(k, sheet, 9);
    for (std::int32_t c = 1, cracks = 1 + static_cast<std::int32_t>(random.below(3)); c <= cracks; ++c) {
      const auto rows = block_cut(random);
      front = begin_front(rows[0], false, c);
      for (std::size_t s = 1, steps = 1 + random.below(4); s <= steps; ++s) advance(k, front, rows[s]);
    }
  }
  std::set<VertexId> neighbours(VertexId v) const {
    std::set<VertexId> ends;
    for (const FaceId f : k.faces_at(v))
      for (const VertexId w : k.face(f).v)
        if (w != v) ends.insert(w);
    return ends;
  }
};

// Normal of a face with the direction a→b of one of its edges.
Vec3 normal_along(const Complex& k, FaceId f, VertexId a, VertexId b) {
  const auto c = k.corners(f);
  const Vec3 n = (c[1] - c[0]).cross(c[2] - c[0]).normalized();
  for (std::size_t e = 0; e < 3; ++e)
    if (k.face(f).v[e] == a && k.face(f).v[(e + 1) % 3] == b) return n;
  return -n;
}

}  // namespace

TEST_CASE("an edge is a feature by its number of faces, their surfaces, or the angle between them") {
  const auto [first, count] = seeds(20);
  std::size_t features = 0, others = 0;
  for (std::uint64_t seed = first; seed < first + static_cast<std::uint64_t>(count); ++seed) {
    INFO("KERF_CASE=" << seed);
    Random random(seed);
    const CutModel model(random);
    const Complex& k = model.k;
    const crack::FeatureRules rules{random.uniform(0.5, 0.99), random.below(2) == 0};
    for (std::uint32_t i = 0; i < k.vertex_count(); ++i) {
      const VertexId v(i);
      std::set<VertexId> expected;
      for (const VertexId w : model.neighbours(v)) {
        const auto around = k.faces_around(v, w);
        bool feature = around.size() != 2;
        if (!feature) {
          const auto &f = k.face(around[0]), &g = k.face(around[1]);
          feature = f.crack != g.crack || (rules.keep_skin && f.crack == 0 && f.source != g.source) ||
                    normal_along(k, around[0], v, w).dot(-normal_along(k, around[1], v, w)) < rules.crease;
        }
        CHECK(crack::is_feature_edge(k, v, w, rules) == feature);
        CHECK(crack::is_feature_edge(k, w, v, rules) == feature);
        if (feature) expected.insert(w);
        (feature ? features : others) += 1;
      }
      const auto location = crack::location_of(k, v, rules);
      CHECK(std::set<VertexId>(location.features.begin(), location.features.end()) == expected);
      CHECK(location.features.size() == expected.size());
    }
  }
  CHECK(features > 1000);
  CHECK(others > 1000);
}

TEST_CASE("a vertex lies on the surfaces of its faces, and may be merged into one that lies on all of them") {
  const auto [first, count] = seeds(20);
  std::size_t within = 0, beyond = 0;
  for (std::uint64_t seed = first; seed < first + static_cast<std::uint64_t>(count); ++seed) {
    INFO("KERF_CASE=" << seed);
    Random random(seed);
    const CutModel model(random);
    const Complex& k = model.k;
    const crack::FeatureRules rules{0.94, random.below(2) == 0};
    // Surfaces by number: cracks, and input triangles below zero.
    const auto surfaces = [&](VertexId v) {
      std::set<std::int64_t> on;
      for (const FaceId f : k.faces_at(v)) {
        const auto& face = k.face(f);
        on.insert(face.crack == 0 && rules.keep_skin ? -1 - std::int64_t(face.source) : face.crack);
      }
      return on;
    };
    for (std::uint32_t i = 0; i < k.vertex_count(); ++i) {
      const VertexId v(i);
      const auto location = crack::location_of(k, v, rules);
      std::set<std::int64_t> on(location.cracks.begin(), location.cracks.end());
      for (const auto s : location.sources) on.insert(-1 - std::int64_t(s));
      CHECK(on == surfaces(v));
      CHECK(location.cracks.size() + location.sources.size() == on.size());
      for (const VertexId w : model.neighbours(v)) {
        const auto all = surfaces(w);
        const bool included = std::includes(all.begin(), all.end(), on.begin(), on.end());
        CHECK(crack::lies_within(location, crack::location_of(k, w, rules)) == included);
        (included ? within : beyond) += 1;
        // Along a line of two features the next vertex is the other one, and a merge moves the line
        // by the distance of the vertex from its neighbours' connection.
        const auto& ends = location.features;
        const bool on_line = ends.size() == 2 && (ends[0] == w || ends[1] == w);
        const auto next = crack::next_on_line(location, w);
        REQUIRE(next.has_value() == on_line);
        const auto off = crack::distance_off_line(k, location, v, w);
        CHECK(off.has_value() == (on_line || ends.empty()));
        if (ends.empty()) CHECK(*off == 0);
        if (!on_line) continue;
        CHECK(*next == (ends[0] == w ? ends[1] : ends[0]));
        const Vec3 a = k.point(w), d = k.point(*next) - a;
        const double at = std::clamp((k.point(v) - a).dot(d) / d.squaredNorm(), 0.0, 1.0);
        CHECK(*off == Approx((a + at * d - k.point(v)).norm()).margin(1e-12));
      }
    }
  }
  CHECK(within > 1000);
  CHECK(beyond > 1000);
}

TEST_CASE("contacts of a front are known, and one between two others may be omitted into either") {
  const auto [first, count] = seeds(40);
  std::size_t omitted = 0, kept = 0;
  for (std::uint64_t seed = first; seed < first + static_cast<std::uint64_t>(count); ++seed) {
    INFO("KERF_CASE=" << seed);
    Random random(seed);
    CutModel model(random);
    FrontState* const fronts[] = {&model.front};
    crack::FrontContacts contacts(fronts);
    std::set<VertexId> on_front;
    for (const auto& segment : model.front.segments)
      for (const auto& p : segment)
        if (p.id.valid()) on_front.insert(p.id);
    for (std::uint32_t i = 0; i < model.k.vertex_count(); ++i) {
      const VertexId v(i);
      CHECK(contacts.contains(v) == (on_front.count(v) > 0));
      if (on_front.count(v) == 0) CHECK(contacts.may_omit(v, VertexId(random.below(model.k.vertex_count()))));
    }
    for (const auto& segment : std::vector(model.front.segments))
      for (std::size_t i = 0; i < segment.size(); ++i) {
        const VertexId b = segment[i].id;
        if (!b.valid() || !contacts.contains(b)) continue;
        const bool inner = i > 0 && i + 1 < segment.size();
        for (const VertexId a : on_front) {
          const bool next = inner && (segment[i - 1].id == a || segment[i + 1].id == a);
          if (!next && a != b) CHECK_FALSE(contacts.may_omit(b, a));
        }
        if (!inner || !contacts.may_omit(b, segment[i - 1].id)) {
          ++kept;
          continue;
        }
        std::vector<std::vector<VertexId>> expected;
        for (const auto& s : model.front.segments) {
          expected.emplace_back();
          for (const auto& p : s)
            if (p.id != b) expected.back().push_back(p.id);
        }
        contacts.omit(b);
        ++omitted;
        CHECK_FALSE(contacts.contains(b));
        std::vector<std::vector<VertexId>> left;
        for (const auto& s : model.front.segments) {
          left.emplace_back();
          for (const auto& p : s) left.back().push_back(p.id);
        }
        CHECK(left == expected);
        break;  // the copy of this segment no longer tells which contacts are next to each other
      }
  }
  CHECK(omitted > 10);
  CHECK(kept > 10);
}
