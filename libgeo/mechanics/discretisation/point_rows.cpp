#include "mechanics/discretisation/point_rows.h"

#include <algorithm>
#include <utility>

#include "geometry/predicates.h"
#include "kerf/parallel.h"

namespace geo {
namespace {

constexpr std::size_t few = 8;  // a point with fewer nodes, or a worse moment matrix, widens its support
constexpr double ill_conditioned = 500;
constexpr double hopeless = 1e7;  // linear fields would be off by 1e-9 of their size
constexpr std::size_t most_in_run = 32;

bool on_face(const Complex& surface, const Vec3& p) {
  std::vector<FaceId> near;
  surface.faces_near({p, p}, near);
  return std::any_of(near.begin(), near.end(), [&](FaceId f) {
    const auto [a, b, c] = surface.corners(f);
    return segment_meets_triangle(p, p, a, b, c);
  });
}

// Jobs of points near each other, and what may concern these.
struct Run {
  std::span<const RowJob> jobs;
  std::vector<std::uint32_t> nodes;  // ascending
  std::vector<FrontEdge> fronts;
  Box3 reach;                // with all ways to nodes
  std::vector<RowJob> left;  // for which supports must be wider

  void find_nodes(const Body& body, double grown, double longest) {
    const auto& position = body.nodes.position;
    const auto& radius = body.nodes.radius;
    Box3 box;
    for (const RowJob& job : jobs) box.add(job.point->position);
    body.grid.within(position, box.center(), 0.5 * (box.hi - box.lo).norm() + grown * longest, nodes);
    std::erase_if(nodes, [&](auto j) { return !box.grown(grown * radius[j]).meets({position[j], position[j]}); });
    double most = 0;
    for (const auto j : nodes) most = std::max(most, radius[j]);
    reach = box.grown(grown * most);
  }

  void make_rows(const Body& body, std::span<const double> growth, const Obstacles& obstacles) {
    for (const FrontEdge& e : obstacles.fronts)
      if (const Vec3 middle = 0.5 * (e.a + e.b); reach.grown((e.b - e.a).norm()).meets({middle, middle}))
        fronts.push_back(e);
    Sights sights;
    for (const RowJob& job : jobs)
      if (std::none_of(growth.begin(), growth.end(),
                       [&](double grown) { return make_row(body, job, grown, obstacles.faces, sights); }))
        left.push_back(job);
  }

 private:
  struct Sights {
    std::vector<std::uint32_t> nodes;
    std::vector<Vec3> ends;
    std::vector<std::uint8_t> hidden;
    std::vector<Sight> seen;
  };
  // True where the nodes seen are enough.
  bool make_row(const Body& body, const RowJob& job, double grown, const TriangleBvh& faces, Sights& found) const {
    MaterialPoint& point = *job.point;
    ShapeRow& row = *job.row;
    const Vec3& x = point.position;
    found.nodes.clear(), found.ends.clear(), found.seen.clear(), row.to.clear();
    for (const auto j : nodes)
      if (const Vec3& y = body.nodes.position[j]; (y - x).norm() < grown * body.nodes.radius[j])
        found.nodes.push_back(j), found.ends.push_back(y);
    found.hidden.assign(found.ends.size(), 0);
    if (!faces.empty()) faces.blocks(x, found.ends, found.hidden.data());
    point.growth = static_cast<std::uint8_t>(std::find(support_growth.begin(), support_growth.end(), grown) -
                                             support_growth.begin());
    point.blinded = std::find(found.hidden.begin(), found.hidden.end(), 1) != found.hidden.end();
    for (std::size_t q = 0; q < found.nodes.size(); ++q) {
      const double support = grown * body.nodes.radius[found.nodes[q]], straight = (found.ends[q] - x).norm();
      // No way to the node that is shorter than its support leads farther off than half of both.
      point.reach = std::max(point.reach, found.hidden[q] ? 0.5 * (straight + support) : straight);
      const auto node =
          found.hidden[q] ? sight_round(x, found.ends[q], support, fronts, faces) : sight(x, found.ends[q], support);
      if (node) row.to.push_back(found.nodes[q]), found.seen.push_back(*node);
    }
    const double condition = shape_gradients(x, found.seen, row.gradient);
    point.rung = condition <= ill_conditioned ? Rung::full : condition <= hopeless ? Rung::regularised : Rung::rigid;
    const bool enough = row.to.size() >= few && point.rung == Rung::full;
    if (point.rung == Rung::rigid) row.to.clear(), row.gradient.clear();
    return enough;
  }
};

std::vector<Run> runs_of(std::span<const RowJob> jobs, double apart) {
  std::vector<Run> runs;
  for (std::size_t begin = 0, end; begin < jobs.size(); begin = end) {
    const Vec3& first = jobs[begin].point->position;
    for (end = begin + 1;
         end < std::min(begin + most_in_run, jobs.size()) && (jobs[end].point->position - first).norm() < apart;)
      ++end;
    runs.emplace_back().jobs = jobs.subspan(begin, end - begin);
  }
  return runs;
}

double volume(const Box3& box) { return (box.hi - box.lo).prod(); }

Obstacles near_obstacles(const Complex& surface, std::span<const Run> runs) {
  // Boxes that have more in common than what lies between them are asked about together.
  std::vector<Box3> boxes;
  for (const Run& run : runs) {
    boxes.push_back(run.reach);
    while (boxes.size() > 1) {
      Box3 both = boxes.end()[-2];
      both.add(boxes.back());
      if (volume(both) > volume(boxes.back()) + volume(boxes.end()[-2])) break;
      boxes.pop_back(), boxes.back() = both;
    }
  }
  std::vector<std::vector<FaceId>> near(boxes.size());
  parallel_for(boxes.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t b = begin; b < end; ++b) surface.faces_near(boxes[b], near[b]);
  });
  std::vector<FaceId> ids;
  std::vector<char> found(surface.face_count(), 0);
  for (const auto& of_box : near)
    for (const FaceId f : of_box)
      if (!std::exchange(found[f.index()], 1)) ids.push_back(f);
  return {surface, ids};
}

}  // namespace

Obstacles::Obstacles(const Complex& surface, std::span<const FaceId> ids) {
  parallel_invoke([&] { fronts = front_edges(surface, ids); },
                  [&] {
                    std::vector<std::array<Vec3, 3>> corners;
                    for (const FaceId f : ids) corners.push_back(surface.corners(f));
                    faces = TriangleBvh(corners);
                  });
}

Obstacles all_obstacles(const Complex& surface) {
  std::vector<FaceId> ids;
  for (std::uint32_t f = 0; f < surface.face_count(); ++f)
    if (surface.alive(FaceId(f))) ids.push_back(FaceId(f));
  return {surface, ids};
}

Vec3 off_faces(const Body& body, const Vec3& p) {
  if (!on_face(body.surface, p)) return p;
  const auto near = body.grid.nearest(body.nodes.position, p, 1, ~0u, [](auto) { return true; })[0];
  const Vec3 way = body.nodes.position[near] - p;
  if (!(way.norm() < support_growth.back() * body.nodes.radius[near])) return p;
  for (double step = 1e-3; step < 0.5; step *= 4)
    if (const Vec3 aside = p + step * way; !on_face(body.surface, aside)) return aside;
  return p;
}

void build_rows(const Body& body, std::vector<RowJob> jobs, const Obstacles* obstacles) {
  const double longest = *std::max_element(body.nodes.radius.begin(), body.nodes.radius.end());
  const std::span all(support_growth);
  for (const auto growth : {all.first(1), all.subspan(1)}) {
    std::vector<Run> runs = runs_of(jobs, longest);
    parallel_for(runs.size(), 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t r = begin; r < end; ++r) runs[r].find_nodes(body, growth.back(), longest);
    });
    const Obstacles near = obstacles ? Obstacles() : near_obstacles(body.surface, runs);
    parallel_for(runs.size(), 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t r = begin; r < end; ++r) runs[r].make_rows(body, growth, obstacles ? *obstacles : near);
    });
    std::vector<RowJob> left;
    for (const Run& run : runs) left.insert(left.end(), run.left.begin(), run.left.end());
    jobs.swap(left);
  }
}

}  // namespace geo
