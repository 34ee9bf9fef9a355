// Bonds for peridynamics: random bodies with cracks, compared with a test of every pair of nodes.
// The files are read as their programs read them.
#include <catch2/catch.hpp>
#include <cmath>
#include <map>
#include <numeric>
#include <set>
#include <sstream>

#include "base/random.h"
#include "cases.h"
#include "geometry/predicates.h"
#include "io/samples.h"
#include "kerf/error.h"
#include "kerf/peridynamics.h"

using namespace geo;

namespace {

using Families = std::vector<std::set<std::uint32_t>>;

Vec3 random_point(Random& random, const Vec3& lo, const Vec3& hi) {
  return lo + Vec3(random.uniform(), random.uniform(), random.uniform()).cwiseProduct(hi - lo);
}

// A body, which may be concave, with up to three cracks that end inside or pass through.
Body random_body(Random& random) {
  const TriangleMesh model = random.below(3) == 0   ? make_letter('E', 0.4, 12)
                             : random.below(2) == 0 ? make_pumpkin(5)
                                                    : make_block({1, 1, 0.7}, 0.25);
  const Box3 box = bounding_box(model);
  SampleOptions options;
  options.spacing = (0.07 + 0.05 * random.uniform()) * box.diagonal();
  options.levels = 1 + int(random.below(2));
  options.pattern = random.below(4) ? NodePattern::jitter : NodePattern::grid;
  options.seed = random.below(1000);
  Body body = build_body(Complex::from_skin(model), sample_nodes(model, options));
  for (std::uint32_t crack = 1 + random.below(3); crack > 0; --crack) {
    const Vec3 far = Vec3::Constant(0.2 * box.diagonal());
    const Vec3 from = random_point(random, box.lo - far, box.hi + far);
    const Vec3 along = random_point(random, -Vec3::Ones(), Vec3::Ones()).normalized() * box.diagonal();
    const Vec3 next = random_point(random, box.lo, box.hi) - from;
    FrontState front =
        begin_front(std::vector<Vec3>{from - along, from, from + along}, false, body.surface.crack_count() + 1);
    try {
      split(body, front, std::vector<Vec3>{from - along + next, from + 1.1 * next, from + along + next});
    } catch (const GeometryError&) {
    }
  }
  return body;
}

// All faces of a body, each with its box.
std::vector<std::pair<std::array<Vec3, 3>, Box3>> faces_of(const Body& body) {
  std::vector<std::pair<std::array<Vec3, 3>, Box3>> faces;
  for (std::uint32_t f = 0; f < body.surface.face_count(); ++f) {
    if (!body.surface.alive(FaceId(f))) continue;
    const auto corners = body.surface.corners(FaceId(f));
    faces.push_back({corners, box_of(corners[0], corners[1], corners[2])});
  }
  return faces;
}

bool crossed(const std::vector<std::pair<std::array<Vec3, 3>, Box3>>& faces, const Vec3& p, const Vec3& q) {
  const Box3 box = box_of(p, p, q);
  return std::any_of(faces.begin(), faces.end(), [&](const auto& face) {
    const auto& [a, b, c] = face.first;
    return face.second.meets(box) && segment_meets_triangle(p, q, a, b, c);
  });
}

Families families_of(const BondModel& model) {
  Families result(model.block.size());
  for (std::size_t i = 0; i < result.size(); ++i)
    result[i] = {model.indices.begin() + std::ptrdiff_t(model.indptr[i]),
                 model.indices.begin() + std::ptrdiff_t(model.indptr[i + 1])};
  return result;
}

// The nodes within the horizon of each node: what a program finds without filters.
Families within_horizons(const std::vector<Vec3>& nodes, const std::vector<double>& horizon) {
  Families result(nodes.size());
  for (std::uint32_t i = 0; i < nodes.size(); ++i)
    for (std::uint32_t j = 0; j < nodes.size(); ++j)
      if (i != j && squared_distance(nodes[i], nodes[j]) <= horizon[i] * horizon[i]) result[i].insert(j);
  return result;
}

// A rectangle breaks a bond in Peridigm and PeriLab.
bool breaks(const BondFilter& f, const Vec3& p, const Vec3& q) {
  const double denominator = (q - p).dot(f.normal);
  if (denominator == 0) return false;
  const double t = (f.corner - p).dot(f.normal) / denominator;
  if (t < 0 || t > 1) return false;
  const Vec3 r = p + t * (q - p) - f.corner;
  const double b = r.dot(f.bottom), a = r.dot(f.bottom.cross(f.normal));
  return 0 <= b && b <= f.bottom_length && 0 <= a && a <= f.side_length;
}

// The numbers of a line behind its last colon or bracket.
double number_of(const std::string& line) { return std::stod(line.substr(line.find(": ") + 2)); }

// Filters and horizons of Peridigm's or PeriLab's input.
struct Deck {
  std::vector<BondFilter> filters;
  std::vector<double> horizon;
};
Deck read_input(const std::string& text, char separator) {
  Deck input;
  std::istringstream lines(text);
  const std::string gap(1, separator);
  std::map<std::string, double> value;
  for (std::string line; std::getline(lines, line);) {
    if (line.rfind("      Horizon: ", 0) == 0) input.horizon.push_back(number_of(line));
    if (line.rfind("        ", 0) != 0 || line.find('"') != line.npos) continue;
    value[line.substr(8, line.find(": ") - 8)] = number_of(line);
    if (line.rfind("        Side" + gap + "Length", 0) != 0) continue;
    std::map<std::string, double> spaced;
    for (const auto& [key, x] : value) {
      std::string name = key;
      std::replace(name.begin(), name.end(), separator, ' ');
      spaced[name] = x;
    }
    const auto vector = [&](const std::string& key) {
      return Vec3(spaced.at(key + " X"), spaced.at(key + " Y"), spaced.at(key + " Z"));
    };
    input.filters.push_back({vector("Lower Left Corner"), vector("Bottom Unit Vector"), vector("Normal"),
                             spaced.at("Bottom Length"), spaced.at("Side Length")});
    value.clear();
  }
  return input;
}

// The node table as Peridigm reads it: five numbers on each line.
struct NodeTable {
  std::vector<Vec3> position;
  std::vector<std::size_t> block;
  double volume = 0;
};
NodeTable read_nodes_table(const std::string& text) {
  NodeTable table;
  std::istringstream in(text);
  double x, y, z, block, volume;
  while (in >> x >> y >> z >> block >> volume) {
    table.position.push_back({x, y, z});
    table.block.push_back(std::size_t(block));
    table.volume += volume;
  }
  return table;
}

// Removes what the function of Julia breaks: all bonds between the two sets of each precrack.
void apply_precracks(const std::string& text, Families& families) {
  std::map<std::string, std::vector<std::uint32_t>> sets;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream words(line.substr(line.find(':') == line.npos ? line.size() : line.find(':') + 1));
    std::string first, second;
    words >> first >> second;
    if (line.rfind("    point_set!(body  :", 0) == 0) {
      std::istringstream numbers(line.substr(line.find('[') + 1));
      for (std::uint32_t i; numbers >> i;) sets[first].push_back(i - 1);
    } else if (line.rfind("    precrack!(", 0) == 0) {
      for (const auto i : sets.at(first))
        for (const auto j : sets.at(second.substr(1, second.find(';') - 1))) {
          families[i].erase(j);
          families[j].erase(i);
        }
    }
  }
}

}  // namespace

TEST_CASE("bonds for peridynamics cross no face, and all others are there, in the files of all programs") {
  const Seeds run = seeds(12);
  std::size_t broken = 0, filters = 0;
  for (std::uint64_t seed = run.first; seed < run.first + std::uint64_t(run.count); ++seed) {
    Random random(seed);
    const Body body = random_body(random);
    const double horizon = 2 + 1.2 * random.uniform();
    INFO("KERF_CASE=" << seed << ", " << body.nodes.size() << " nodes");
    const BondModel model = find_bond_model(body, horizon);
    std::vector<double> reach(body.nodes.size());
    for (std::size_t i = 0; i < reach.size(); ++i) {
      reach[i] = model.horizon.at(model.block[i]);
      CHECK(std::abs(std::log2(reach[i] / (horizon * body.nodes.spacing[i]))) <= 0.5 + 1e-9);
    }
    // Every pair of nodes, exactly.
    const Families whole = within_horizons(body.nodes.position, reach);
    Families expected = whole;
    const auto faces = faces_of(body);
    std::set<std::pair<NodeId, NodeId>> cut;
    for (std::uint32_t i = 0; i < whole.size(); ++i)
      for (const auto j : whole[i])
        if (crossed(faces, body.nodes.position[i], body.nodes.position[j])) {
          expected[i].erase(j);
          cut.insert({NodeId(std::min(i, j)), NodeId(std::max(i, j))});
        }
    REQUIRE(families_of(model) == expected);
    CHECK(std::vector(cut.begin(), cut.end()) == model.broken);
    broken += cut.size();
    // The same from the files.
    const auto rectangles = bond_filters(body, model);
    filters += rectangles.size();
    const auto nodes = bytes_of([&](auto& out) { write_bond_nodes(out, body, model, false); });
    CHECK(bytes_of([&](auto& out) { write_bond_nodes(out, body, model, true); }) ==
          "header: x y z block_id volume\n" + nodes);
    const NodeTable table = read_nodes_table(nodes);
    CHECK(table.position == body.nodes.position);
    CHECK(table.volume == Approx(std::accumulate(body.nodes.volume.begin(), body.nodes.volume.end(), 0.0)));
    for (const char separator : {'_', ' '}) {
      const Deck input = read_input(bytes_of([&](auto& out) {
                                      separator == '_' ? write_peridigm(out, model, rectangles)
                                                       : write_perilab(out, model, rectangles);
                                    }),
                                    separator);
      CHECK(input.horizon == model.horizon);
      CHECK(input.filters.size() == rectangles.size());
      for (std::size_t i = 0; i < reach.size(); ++i) reach[i] = input.horizon.at(table.block[i] - 1);
      Families found = within_horizons(table.position, reach);
      for (std::uint32_t i = 0; i < found.size(); ++i)
        std::erase_if(found[i], [&](std::uint32_t j) {
          return std::any_of(input.filters.begin(), input.filters.end(),
                             [&](const BondFilter& f) { return breaks(f, table.position[i], table.position[j]); });
        });
      CHECK(found == expected);
    }
    Families left = whole;
    apply_precracks(bytes_of([&](auto& out) { write_peridynamics_jl(out, model); }), left);
    CHECK(left == expected);
    std::istringstream listed(bytes_of([&](auto& out) { write_families(out, model); }));
    Families read(expected.size());
    for (std::string line; std::getline(listed, line);) {
      std::istringstream numbers(line);
      std::uint32_t i = 0, j = 0;
      for (numbers >> i; numbers >> j;) read.at(i - 1).insert(j - 1);
    }
    CHECK(read == expected);
  }
  CHECK(broken > (run.count > 1 ? 100 : 0));
  CHECK(filters > 0);
}

TEST_CASE("horizons out of range are refused") {
  const TriangleMesh block = make_block({1, 1, 1}, 0.5);
  const Body body = build_body(Complex::from_skin(block), sample_nodes(block, {.spacing = 0.3}));
  CHECK_THROWS_AS(find_bond_model(body, 0.5), InputError);
  CHECK_THROWS_AS(find_bond_model(body, std::nan("")), InputError);
  CHECK(find_bond_model(body).broken.empty());
  CHECK(bond_filters(body, find_bond_model(body)).empty());
}
