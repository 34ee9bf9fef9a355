// A test case of fronts on an integer grid, as data: a block, and cracks that cut it in sequence.
#pragma once

#include <fstream>
#include <map>
#include <numeric>
#include <sstream>
#include <string>
#include <vector>

#include "base/random.h"
#include "kerf/check.h"
#include "kerf/crack.h"
#include "kerf/error.h"
#include "kerf/files.h"
#include "kerf/mesh.h"
#include "kerf/pieces.h"

struct GridCrack {
  bool closed = false;
  std::vector<std::vector<geo::Vec3>> rows;  ///< where the front begins, and where each step takes it
};

struct GridCase {
  static constexpr double size = 4;  ///< of the block, along each axis
  int divisions = 1;                 ///< of its edges
  std::vector<GridCrack> cracks;
};

inline geo::Vec3 grid_point(geo::Random& random) {
  const auto c = [&] { return double(random.below(7)) - 1; };
  return {c(), c(), c()};
}

inline GridCase random_case(std::uint64_t seed) {
  using geo::Vec3;
  geo::Random random(seed);
  GridCase grid;
  grid.divisions = 1 + static_cast<int>(random.below(2));
  for (int crack = 0; crack < 3; ++crack) {
    const int points = 2 + static_cast<int>(random.below(2));
    GridCrack c;
    c.closed = points > 2 && random.below(4) == 0;
    std::vector<Vec3> at(static_cast<std::size_t>(points));
    for (auto& p : at) p = grid_point(random);
    c.rows.push_back(at);
    for (int s = 0; s < 3; ++s) {
      for (auto& p : at)
        if (random.below(4)) p = random.below(3) ? Vec3(p + grid_point(random) - Vec3(2, 2, 2)) : grid_point(random);
      c.rows.push_back(at);
    }
    grid.cracks.push_back(std::move(c));
  }
  return grid;
}

/// The first invariant that a step violates: structure and volumes of the whole, crossings of the
/// faces `made` by the step, which alone can cross anything; without `made`, of all faces.
inline std::string fault_of(const geo::Complex& k, double volume, const std::vector<geo::FaceId>* made = nullptr) {
  const auto report =
      geo::check_complex(k, made == nullptr ? geo::SelfIntersections::find : geo::SelfIntersections::ignore);
  if (!report.good()) return report.first_problem;
  if (made)
    if (const auto pairs = geo::self_intersections(k, made); !pairs.empty())
      return "faces " + std::to_string(pairs[0].first.value) + " and " + std::to_string(pairs[0].second.value) +
             " intersect each other";
  const geo::Pieces pieces = geo::find_pieces(k);
  const double sum = std::accumulate(pieces.volume.begin(), pieces.volume.end(), 0.0);
  return std::abs(sum - volume) <= 1e-11 * volume ? std::string() : "the pieces' volumes sum to " + std::to_string(sum);
}

/// A text without its numbers: cases are of one kind when these agree.
inline std::string kind_of(const std::string& text) {
  std::string kind;
  for (const char c : text)
    if (!std::isdigit(static_cast<unsigned char>(c)))
      kind += c;
    else if (kind.empty() || kind.back() != '#')
      kind += '#';
  return kind;
}

struct GridOutcome {
  std::string violation;  ///< empty: every invariant held after every step
  std::string where;      ///< crack and step of the violation
  std::size_t steps = 0, refused = 0;
  std::map<std::string, std::size_t> reasons;  ///< of refusals, by kind
};

/// Makes the cracks of a case. A crack whose step is refused ends there. `strict`: a refused step
/// leaves the derived surface as it was to the bit; else its counts alone are compared.
inline GridOutcome outcome(const GridCase& grid, bool strict = false) {
  using namespace geo;
  GridOutcome result;
  const double volume = GridCase::size * GridCase::size * GridCase::size;
  Complex k = Complex::from_skin(make_block(Vec3::Constant(GridCase::size), GridCase::size / grid.divisions));
  const auto violation = [&](std::size_t crack, std::size_t step, const std::string& what) {
    result.violation = what;
    result.where = "crack " + std::to_string(crack + 1) + ", step " + std::to_string(step);
    return result;
  };
  for (std::size_t c = 0; c < grid.cracks.size(); ++c) {
    const GridCrack& crack = grid.cracks[c];
    FrontState front = begin_front(crack.rows.at(0), crack.closed, static_cast<std::int32_t>(c + 1));
    for (std::size_t s = 1; s < crack.rows.size(); ++s) {
      const std::array<std::uint32_t, 4> counts{k.vertex_count(), k.face_count(), k.live_face_count(),
                                                k.surface_vertex_count()};
      const TriangleMesh before = strict ? k.two_sided() : TriangleMesh{};
      ++result.steps;
      try {
        const CrackDelta delta = advance(k, front, crack.rows[s]);
        if (const auto fault = fault_of(k, volume, &delta.new_faces); !fault.empty()) return violation(c, s, fault);
      } catch (const GeometryError& e) {
        ++result.refused;
        const std::string what = e.what();
        ++result.reasons[kind_of(what.substr(what.find(": ") + 2))];
        const TriangleMesh after = strict ? k.two_sided() : TriangleMesh{};
        if (counts != std::array<std::uint32_t, 4>{k.vertex_count(), k.face_count(), k.live_face_count(),
                                                   k.surface_vertex_count()} ||
            before.vertices != after.vertices || before.triangles != after.triangles || before.patch != after.patch ||
            before.site != after.site)
          return violation(c, s, "a refused step changed the complex");
        break;
      }
    }
  }
  if (const auto fault = fault_of(k, volume); !fault.empty()) return violation(grid.cracks.size() - 1, 0, fault);
  return result;
}

/// A front file whose comments say what the fronts cut and what is expected of it.
inline void write_case(std::ostream& out, const GridCase& grid, const std::string& comment) {
  out << "# " << comment << "\n# block of 4 x 4 x 4, edges divided by " << grid.divisions << '\n';
  std::vector<geo::Front> fronts;
  for (const auto& c : grid.cracks) fronts.push_back({"crack" + std::to_string(fronts.size() + 1), c.closed, c.rows});
  geo::write_fronts(out, fronts);
}

inline GridCase read_case(const std::string& text, const std::string& name) {
  GridCase grid;
  const std::string divided = "divided by ";
  const auto at = text.find(divided);
  if (at == std::string::npos) throw geo::InputError(name + ": has no comment 'divided by N'");
  grid.divisions = std::stoi(text.substr(at + divided.size()));
  for (const auto& f : geo::parse_fronts(text, name)) grid.cracks.push_back({f.closed, f.steps});
  return grid;
}
