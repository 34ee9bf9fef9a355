// Visibility of the edges of the graph of nearest nodes: ours beside Embree's occlusion (floats,
// robust) and CGAL's tree of boxes (exact). Trees of boxes are made before the clock starts, for
// all three; there is nothing else to prepare.
#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/AABB_triangle_primitive.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <embree3/rtcore.h>

#include <cstdio>

#include "geometry/predicates.h"
#include "graph.h"
#include "graph/nearest.h"
#include "graph/visibility.h"
#include "kerf/parallel.h"

namespace bench {
namespace {

using Soup = std::vector<std::array<geo::Vec3, 3>>;
using Pairs = std::vector<std::pair<geo::NodeId, geo::NodeId>>;
using Answers = std::vector<std::uint8_t>;

Pairs edges_of(const std::vector<geo::Vec3>& x) {
  constexpr int k = 26;
  const auto near = geo::nearest_nodes(x, k);
  Pairs pairs;
  for (std::size_t e = 0; e < near.size(); ++e)
    if (near[e].valid()) pairs.push_back(std::minmax(geo::NodeId(e / k), near[e]));
  std::sort(pairs.begin(), pairs.end());
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  return pairs;
}

class Embree {
 public:
  explicit Embree(const Soup& soup) : device_(rtcNewDevice("threads=1")), scene_(rtcNewScene(device_)) {
    rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_ROBUST);
    rtcSetSceneBuildQuality(scene_, RTC_BUILD_QUALITY_HIGH);
    RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* v = static_cast<float*>(
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 12, 3 * soup.size()));
    auto* t = static_cast<unsigned*>(
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 12, soup.size()));
    for (std::size_t i = 0; i < 3 * soup.size(); ++i) {
      for (int d = 0; d < 3; ++d) v[3 * i + static_cast<std::size_t>(d)] = static_cast<float>(soup[i / 3][i % 3][d]);
      t[i] = static_cast<unsigned>(i);
    }
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene_, geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(scene_);
  }
  ~Embree() {
    rtcReleaseScene(scene_);
    rtcReleaseDevice(device_);
  }
  Embree(const Embree&) = delete;
  void blocked(const std::vector<geo::Vec3>& x, const Pairs& pairs, Answers& result) const {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    for (std::size_t e = 0; e < pairs.size(); ++e) {
      const Eigen::Vector3f p = x[pairs[e].first.index()].cast<float>(),
                            way = x[pairs[e].second.index()].cast<float>() - p;
      RTCRay ray{};
      ray.org_x = p.x();
      ray.org_y = p.y();
      ray.org_z = p.z();
      ray.dir_x = way.x();
      ray.dir_y = way.y();
      ray.dir_z = way.z();
      ray.tfar = 1;
      ray.mask = ~0u;
      rtcOccluded1(scene_, &context, &ray);
      result[e] = ray.tfar < 0;
    }
  }

 private:
  RTCDevice device_;
  RTCScene scene_;
};

class Cgal {
  using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
  using Iterator = std::vector<Kernel::Triangle_3>::const_iterator;
  using Tree = CGAL::AABB_tree<CGAL::AABB_traits<Kernel, CGAL::AABB_triangle_primitive<Kernel, Iterator>>>;
  static Kernel::Point_3 point(const geo::Vec3& p) { return {p.x(), p.y(), p.z()}; }

 public:
  explicit Cgal(const Soup& soup) {
    for (const auto& t : soup) triangles_.push_back({point(t[0]), point(t[1]), point(t[2])});
    tree_.rebuild(triangles_.cbegin(), triangles_.cend());
    tree_.build();
  }
  /// Every `stride`-th pair.
  void blocked(const std::vector<geo::Vec3>& x, const Pairs& pairs, std::size_t stride, Answers& result) const {
    for (std::size_t e = 0; e < pairs.size(); e += stride)
      result[e] =
          tree_.do_intersect(Kernel::Segment_3(point(x[pairs[e].first.index()]), point(x[pairs[e].second.index()])));
  }

 private:
  std::vector<Kernel::Triangle_3> triangles_;
  Tree tree_;
};

bool touched(const Soup& soup, const geo::Vec3& p, const geo::Vec3& q) {
  geo::Box3 box{p, p};
  box.add(q);
  return std::any_of(soup.begin(), soup.end(), [&](const auto& t) {
    return geo::box_of(t[0], t[1], t[2]).meets(box) && geo::segment_meets_triangle(p, q, t[0], t[1], t[2]);
  });
}

// Nodes on a lattice and, over it, the triangles of all its planes: segments through corners, along
// edges, in planes.
std::size_t degenerate_disagreements(std::size_t& asked) {
  constexpr int cells = 8;
  std::vector<geo::Vec3> x;
  for (int i = 0; i < 17 * 17 * 17; ++i) x.push_back(0.5 * geo::Vec3(i % 17, i / 17 % 17, i / 289));
  Soup soup;
  for (int axis = 0; axis < 3; ++axis)
    for (const double at : {0.0, 3.0, 5.5, 8.0})
      for (int i = 0; i < cells * cells; ++i) {
        const auto corner = [&](int u, int v) {
          geo::Vec3 p = geo::Vec3::Constant(at);
          p[(axis + 1) % 3] = i % cells + u;
          p[(axis + 2) % 3] = i / cells + v;
          return p;
        };
        if ((i + axis) % 3 == 0) continue;  // holes
        soup.push_back({corner(0, 0), corner(1, 0), corner(1, 1)});
        soup.push_back({corner(0, 0), corner(1, 1), corner(0, 1)});
      }
  const auto pairs = edges_of(x);
  const geo::TriangleBvh tree(soup);
  const auto ours = geo::Visibility(x, tree).blocked(pairs);
  asked = pairs.size();
  std::size_t wrong = 0;
  for (std::size_t e = 0; e < pairs.size(); ++e)
    wrong += (ours[e] != 0) != touched(soup, x[pairs[e].first.index()], x[pairs[e].second.index()]);
  return wrong;
}

// As the case, but every node of some is put on the surface: at a corner, within an edge, or within
// a triangle.
geo::NodeSet on_surface(const GraphCase& c) {
  geo::NodeSet nodes = c.nodes;
  for (std::size_t i = 0; i < nodes.size(); i += 7) {
    const auto& t = c.surface.triangles[i * 2654435761u % c.surface.triangles.size()];
    const auto& v = c.surface.vertices;
    nodes.position[i] = i % 3 == 0   ? v[t[0]]
                        : i % 3 == 1 ? geo::Vec3(0.5 * (v[t[0]] + v[t[1]]))
                                     : geo::Vec3((v[t[0]] + v[t[1]] + v[t[2]]) / 3);
  }
  return nodes;
}

std::size_t differences(const Answers& a, const Answers& b, std::size_t stride) {
  std::size_t count = 0;
  for (std::size_t e = 0; e < a.size(); e += stride) count += a[e] != b[e];
  return count;
}

}  // namespace

void measure_visibility(const GraphCase& c, const Options& options, Figures& figures) {
  const auto soup = geo::corners_of(c.surface);
  const auto& x = c.nodes.position;
  const auto pairs = edges_of(x);
  const double n = double(pairs.size());
  const std::size_t stride = pairs.size() > 3000000 ? 10 : 1;
  const geo::TriangleBvh tree(soup);
  const geo::Visibility sight(x, tree);
  Answers ours;
  const double speedup =
      threads_speedup([&] { ours = sight.blocked(pairs); });  // before Embree, which keeps all to one thread
  const Embree embree(soup);
  const Cgal cgal(soup);
  Answers of_embree(pairs.size()), of_cgal(pairs.size());
  double t_ours = 1e300, t_embree = 1e300, t_cgal = 1e300;
  const auto lower = [](double& least_yet, double t) { least_yet = std::min(least_yet, t); };
  geo::set_threads(1);
  for (int round = 0; round < 3; ++round) {
    lower(t_ours, least([] {}, [&] { ours = sight.blocked(pairs); }, 3));
    lower(t_embree, least([] {}, [&] { embree.blocked(x, pairs, of_embree); }, 3));
  }
  lower(t_cgal, least([] {}, [&] { cgal.blocked(x, pairs, stride, of_cgal); }, 3) * double(stride));
  // Against exact predicates: on all edges by CGAL's tree (a tenth of very many), on some by a scan
  // of all triangles.
  std::size_t wrong = differences(ours, of_cgal, stride), asked = 0;
  for (std::size_t e = 0; e < pairs.size(); e += pairs.size() / 20000 + 1)
    wrong += (ours[e] != 0) != touched(soup, x[pairs[e].first.index()], x[pairs[e].second.index()]);
  const std::size_t generic = wrong;
  wrong += degenerate_disagreements(asked);
  const auto lying = on_surface(c);
  auto lying_pairs = edges_of(lying.position);  // CGAL does not answer for segments of no length
  std::erase_if(lying_pairs,
                [&](const auto& e) { return lying.position[e.first.index()] == lying.position[e.second.index()]; });
  Answers of_lying(lying_pairs.size());
  cgal.blocked(lying.position, lying_pairs, stride, of_lying);
  const auto ours_lying = geo::Visibility(lying.position, tree).blocked(lying_pairs);
  wrong += differences(ours_lying, of_lying, stride);
  Answers embree_lying(lying_pairs.size());
  embree.blocked(lying.position, lying_pairs, embree_lying);

  figures["visibility_ns"] = 1e9 * t_ours / n;
  figures["visibility_vs_embree"] = t_ours / t_embree;
  figures["visibility_vs_cgal"] = t_ours / t_cgal;
  figures["visibility_disagreements"] = double(wrong);
  figures["visibility_threads_speedup"] = speedup;
  if (options.json) return;
  std::printf("visibility, ns a segment (%zu, %.1f %% blocked): ours %.1f, Embree %.1f, CGAL %.1f\n", pairs.size(),
              100 * double(std::count(ours.begin(), ours.end(), 1)) / n, 1e9 * t_ours / n, 1e9 * t_embree / n,
              1e9 * t_cgal / n);
  std::printf(
      "  differ from exact predicates: ours %zu, Embree %zu; %zu more on a lattice and with nodes on the surface, "
      "where Embree %zu of %zu\n",
      generic, differences(of_embree, of_cgal, stride), wrong - generic, differences(embree_lying, of_lying, stride),
      lying_pairs.size());
}

}  // namespace bench
