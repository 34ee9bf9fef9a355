// A test case of cracks through a body, as data: a model, its sampling, and cracks that cut it in
// sequence.
#pragma once

#include <algorithm>
#include <cmath>
#include <list>
#include <map>
#include <sstream>
#include <string>

#include "base/random.h"
#include "body/incremental_cache.h"
#include "crack/grid_case.h"
#include "crack/shrink.h"
#include "invariants/models.h"
#include "kerf/body.h"
#include "kerf/crack.h"
#include "kerf/nodes.h"

struct BodyCase {
  std::string model = "block";  ///< "block": 4 × 4 × 4, nodes on a regular grid; "pumpkin", or the name of a file
  int faces = 1500;             ///< target of decimation; of a block: divisions of its edges
  int nodes = 900;
  double jitter = 0.15;
  double guides = 0;  ///< how far apart, in spacings; 0: none
  int resize = 0;     ///< seed of other radii for some nodes, after each step that cuts; 0: none
  std::vector<GridCrack> cracks;

  std::string recipe() const {
    std::ostringstream text;
    text << "model=" << model << " faces=" << faces << " nodes=" << nodes << " jitter=" << jitter
         << " guides=" << guides;
    return text.str();
  }
};

namespace body_cases {

using namespace geo;

/// A block whose nodes stand on a regular grid, so that cracks of whole coordinates run exactly
/// through nodes and the planes between them.
inline Body make_block_body(const BodyCase& c, const BodyOptions& options) {
  const int along = static_cast<int>(std::lround(std::cbrt(c.nodes)));
  const double h = GridCase::size / (along + 1);
  NodeSet nodes;
  for (int z = 1; z <= along; ++z)
    for (int y = 1; y <= along; ++y)
      for (int x = 1; x <= along; ++x) {
        nodes.position.push_back(h * Vec3(x, y, z));
        nodes.spacing.push_back(h);
        nodes.radius.push_back(2 * h);
        nodes.volume.push_back(std::pow(GridCase::size / along, 3));
      }
  return build_body(Complex::from_skin(make_block(Vec3::Constant(GridCase::size), GridCase::size / c.faces)), nodes,
                    options);
}

/// A model decimated to about that many faces; cached.
inline const TriangleMesh& coarse_model(const std::string& name, int faces) {
  static std::map<std::pair<std::string, int>, TriangleMesh> known;
  const auto [at, fresh] = known.try_emplace({name, faces});
  if (!fresh) return at->second;
  Complex k = Complex::from_skin(invariants::model(name));
  decimate(k, {}, {.deviation = 0.02, .faces = static_cast<std::size_t>(faces)});
  at->second = k.two_sided();
  at->second.site.clear();
  at->second.source.clear();
  require_solid(at->second);
  return at->second;
}

inline Body make_body(const BodyCase& c) {
  BodyOptions options;
  options.guide_spacing = c.guides;
  if (c.model == "block") return make_block_body(c, options);
  const TriangleMesh& coarse = coarse_model(c.model, c.faces);
  SampleOptions sampling;
  sampling.count = static_cast<std::size_t>(c.nodes);
  sampling.jitter = c.jitter;
  NodeSet nodes = sample_nodes(coarse, sampling);
  return build_body(Complex::from_skin(coarse), std::move(nodes), options);
}

/// The body before the cracks; the last few are cached.
inline const Body& body_of(const BodyCase& c) {
  static std::list<std::pair<std::string, Body>> known;
  for (auto at = known.begin(); at != known.end(); ++at)
    if (at->first == c.recipe()) {
      known.splice(known.begin(), known, at);
      return known.front().second;
    }
  known.emplace_front(c.recipe(), make_body(c));
  if (known.size() > 6) known.pop_back();
  return known.front().second;
}

/// A front file whose comments say what the fronts cut.
inline void write_body_case(std::ostream& out, const BodyCase& c, const std::string& comment) {
  out << "# " << comment << "\n# body: " << c.recipe();
  if (c.resize) out << " resize=" << c.resize;
  out << '\n';
  std::vector<Front> fronts;
  for (const auto& crack : c.cracks)
    fronts.push_back({"crack" + std::to_string(fronts.size() + 1), crack.closed, crack.rows});
  write_fronts(out, fronts);
}

inline BodyCase read_body_case(const std::string& text, const std::string& name) {
  BodyCase c;
  const std::string begin = "# body: ";
  const auto at = text.find(begin);
  if (at == std::string::npos) throw InputError(name + ": has no comment '# body: model=…'");
  std::istringstream words(text.substr(at + begin.size(), text.find('\n', at) - at - begin.size()));
  for (std::string word; words >> word;) {
    const auto equals = word.find('=');
    const std::string key = word.substr(0, equals), value = word.substr(equals + 1);
    if (key == "model")
      c.model = value;
    else if (key == "faces")
      c.faces = std::stoi(value);
    else if (key == "nodes")
      c.nodes = std::stoi(value);
    else if (key == "jitter")
      c.jitter = std::stod(value);
    else if (key == "resize")
      c.resize = std::stoi(value);
    else if (key == "guides")
      c.guides = std::stod(value);
    else
      throw InputError(name + ": " + key + " is not known of a body");
  }
  for (const auto& f : parse_fronts(text, name)) c.cracks.push_back({f.closed, f.steps});
  return c;
}

/// Other radii for the nodes in a ball, all by one factor or each by its own: a superset of what
/// resampling requests.
inline std::vector<std::pair<NodeId, double>> other_radii(const Body& body, std::uint64_t seed) {
  Random random(seed);
  const NodeSet& nodes = body.nodes;
  const Vec3 middle = nodes.position[random.below(static_cast<std::uint32_t>(nodes.size()))];
  const double around = body.cache->grid.cell() * random.uniform(0.1, 4), by = random.uniform(0.4, 1.6);
  const bool alike = random.below(2);
  std::vector<std::uint32_t> near;
  body.cache->grid.within(nodes.position, middle, around, near);
  std::vector<std::pair<NodeId, double>> radii;
  for (const auto i : near)
    radii.push_back({NodeId(i), std::clamp(nodes.radius[i] * (alike ? by : random.uniform(0.4, 1.6)), nodes.spacing[i],
                                           1.2 * body.widest_radius)});
  return radii;
}

/// The smallest such case: see shrink(). Also by coarser models and nodes, and by shorter numbers.
inline BodyCase shrink(BodyCase given, const std::function<bool(const BodyCase&)>& fails) {
  const auto simplify = [](const BodyCase& c, const auto& attempt) {
    bool any = false;
    const auto attempt_with = [&](const auto& change) {
      BodyCase simpler = c;
      change(simpler);
      const bool worked = attempt(simpler);
      any |= worked;
      return worked;
    };
    if (c.resize) attempt_with([](BodyCase& s) { s.resize = 0; });
    if (c.guides > 0) attempt_with([](BodyCase& s) { s.guides = 0; });
    if (c.model == "block") {
      if (c.faces > 1) attempt_with([](BodyCase& s) { s.faces = 1; });
      for (const int nodes : {1, 8, 27, 64, 125})
        if (nodes < c.nodes && attempt_with([&](BodyCase& s) { s.nodes = nodes; })) break;
    } else {
      while (c.nodes > 60 && attempt_with([](BodyCase& s) { s.nodes = s.nodes * 6 / 10; })) {
      }
      while (c.faces > 60 && attempt_with([](BodyCase& s) { s.faces = s.faces * 6 / 10; })) {
      }
    }
    for (std::size_t i = 0; i < c.cracks.size(); ++i) {
      if (c.cracks[i].closed) attempt_with([&](BodyCase& s) { s.cracks[i].closed = false; });
      for (const double unit : {0x1p0, 0x1p-4, 0x1p-8, 0x1p-16}) {
        BodyCase s = c;
        bool differs = false;
        for (auto& row : s.cracks[i].rows)
          for (Vec3& p : row)
            for (double& x : p) {
              const double y = std::round(x / unit) * unit;
              differs |= x != y;
              x = y;
            }
        if (!differs || attempt_with([&](BodyCase& to) { to = s; })) break;
      }
    }
    return any;
  };
  return shrink<BodyCase>(std::move(given), fails, simplify);
}

}  // namespace body_cases
