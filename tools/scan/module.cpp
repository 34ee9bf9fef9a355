// scan/module.h: PCL removes outliers, estimates normals and fits the surface; CGAL orients normals
// that were estimated. Coordinates are relative to the middle of the cloud, in units of its box, as
// PCL computes with single precision.
#include "scan/module.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iostream>
#include <limits>
#include <mutex>
#include <numeric>
#include <tuple>
#include <utility>

#include <Eigen/Eigenvalues>

#include <CGAL/Simple_cartesian.h>
#include <CGAL/mst_orient_normals.h>
#include <CGAL/property_map.h>
#include <pcl/console/print.h>
#include <pcl/features/normal_3d_omp.h>
#include <pcl/filters/statistical_outlier_removal.h>
#include <pcl/kdtree/kdtree_flann.h>
#include <pcl/point_types.h>
#include <pcl/search/kdtree.h>
#include <pcl/surface/poisson.h>

#include <kerf/error.h>
#include <kerf/vec.h>

namespace scan {
namespace {

using Points = pcl::PointCloud<pcl::PointNormal>;

// Points of a plane, whose normal is that of a point: with fewer of them it follows their noise.
constexpr int neighbors = 18;
// Surface farther from all points than this many spacings fills a hole.
constexpr double hole_distance = 3;

double squared_to_triangle(const geo::Vec3& p, const geo::Vec3& a, const geo::Vec3& b, const geo::Vec3& c) {
  const geo::Vec3 n = (b - a).cross(c - a);
  double least = std::numeric_limits<double>::infinity();
  bool inside = n.squaredNorm() > 0;
  for (const auto& [from, to] : {std::pair(a, b), std::pair(b, c), std::pair(c, a)}) {
    const geo::Vec3 edge = to - from;
    const double length = edge.squaredNorm(), t = length > 0 ? std::clamp((p - from).dot(edge) / length, 0.0, 1.0) : 0;
    least = std::min(least, (p - from - t * edge).squaredNorm());
    inside = inside && n.cross(edge).dot(p - from) >= 0;
  }
  return inside ? std::pow((p - a).dot(n), 2) / n.squaredNorm() : least;
}

// One fit of a surface at a time, as PCL keeps its octree's nodes in a static allocator. It prints
// details of that octree, and standard output may be the solid's file: meanwhile the streams of C
// and C++ are silent. Descriptors stay, by which others write: Python goes on after Ctrl-C while a
// fit ends.
class SilentFit {
 public:
  SilentFit() : lock_(mutex()), out_(stdout), err_(stderr) {
    std::cout.flush();
    std::fflush(stdout);
    std::fflush(stderr);
    cout_ = std::cout.rdbuf(nullptr);
    cerr_ = std::cerr.rdbuf(nullptr);
    if (std::FILE* const null = std::fopen("/dev/null", "we")) stdout = stderr = null;
  }
  ~SilentFit() {
    if (stdout != out_) std::fclose(stdout);
    stdout = out_;
    stderr = err_;
    std::cout.rdbuf(cout_);
    std::cerr.rdbuf(cerr_);
  }
  SilentFit(const SilentFit&) = delete;
  SilentFit& operator=(const SilentFit&) = delete;

 private:
  static std::mutex& mutex() {
    static std::mutex one;
    return one;
  }
  std::unique_lock<std::mutex> lock_;
  std::FILE *out_, *err_;
  std::streambuf *cout_ = nullptr, *cerr_ = nullptr;
};

class Reconstruction {
 public:
  Reconstruction(const geo::PointCloud& cloud, const Options& options) : cloud_(cloud), options_(options) {}

  Result run() {
    constexpr std::size_t least = 10;
    if (cloud_.position.size() < least)
      throw geo::InputError("has fewer than ten points with finite coordinates; give a scan");
    place();
    remove_outliers();
    if (points_->size() < least) throw geo::InputError("has fewer than ten points without outliers; give --outliers 0");
    tree_.setInputCloud(points_);
    measure_spacing();
    require_space();
    if (cloud_.normal.empty()) estimate_normals();
    fit();
    drop_blobs();
    if (result_.mesh.triangles.empty())
      throw geo::InputError("has points that make no surface; is it a scan of a surface?");
    color();
    measure_holes();
    measure_distances();
    return std::move(result_);
  }

 private:
  geo::Vec3 at(const pcl::PointNormal& p) const { return middle_ + size_ * geo::Vec3(p.x, p.y, p.z); }
  pcl::PointNormal local(const geo::Vec3& p) const {
    const geo::Vec3 q = (p - middle_) / size_;
    pcl::PointNormal point;
    point.x = float(q.x());
    point.y = float(q.y());
    point.z = float(q.z());
    return point;
  }

  void place() {
    geo::Box3 box;
    for (const geo::Vec3& p : cloud_.position) box.add(p);
    middle_ = box.center();
    size_ = (box.hi - box.lo).maxCoeff();
    if (!(size_ > 0)) throw geo::InputError("has all its points at one place; give a scan");
    for (std::size_t i = 0; i < cloud_.position.size(); ++i) {
      pcl::PointNormal point = local(cloud_.position[i]);
      if (!cloud_.normal.empty()) {
        point.normal_x = float(cloud_.normal[i].x());
        point.normal_y = float(cloud_.normal[i].y());
        point.normal_z = float(cloud_.normal[i].z());
      }
      points_->push_back(point);
    }
    rows_.resize(points_->size());
    std::iota(rows_.begin(), rows_.end(), 0);
  }

  void remove_outliers() {
    if (options_.outliers > 0) {
      pcl::StatisticalOutlierRemoval<pcl::PointNormal> filter;
      filter.setInputCloud(points_);
      filter.setMeanK(neighbors);
      filter.setStddevMulThresh(options_.outliers);
      filter.filter(rows_);
      Points::Ptr kept(new Points);
      for (const int row : rows_) kept->push_back((*points_)[std::size_t(row)]);
      result_.stats.outliers = points_->size() - kept->size();
      points_ = kept;
    }
    result_.stats.points = points_->size();
  }

  // Refuses points of one plane, up to the rounding of coordinates, which floats of the box have.
  void require_space() const {
    constexpr double thinnest = 0x1p-20;  // sixteen distances of floats
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    for (const auto& p : *points_) mean += p.getVector3fMap().cast<double>() / double(points_->size());
    Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
    for (const auto& p : *points_) {
      const Eigen::Vector3d d = p.getVector3fMap().cast<double>() - mean;
      spread += d * d.transpose();
    }
    const Eigen::Vector3d squared = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(spread).eigenvalues();
    if (squared[0] <= thinnest * thinnest * squared[2])
      throw geo::InputError("has all its points in a plane, which encloses no volume; give a scan from all sides");
  }

  void measure_spacing() {
    std::vector<float> distance;
    pcl::Indices found;
    std::vector<float> squared;
    for (const pcl::PointNormal& p : *points_)
      if (tree_.nearestKSearch(p, 5, found, squared) > 1) distance.push_back(std::sqrt(squared.back()));
    std::nth_element(distance.begin(), distance.begin() + std::ptrdiff_t(distance.size() / 2), distance.end());
    spacing_ = double(distance[distance.size() / 2]);
    if (!(spacing_ > 0)) throw geo::InputError("has most of its points several times; remove the copies");
    result_.stats.spacing = spacing_ * size_;
  }

  // Neighbours get normals of one sense along a spanning tree of each connected part. Its points
  // farthest out in many directions then decide whether that is outwards.
  void estimate_normals() {
    result_.stats.estimated = true;
    pcl::NormalEstimationOMP<pcl::PointNormal, pcl::PointNormal> estimation;
    estimation.setNumberOfThreads(1);
    estimation.setInputCloud(points_);
    estimation.setSearchMethod(pcl::search::KdTree<pcl::PointNormal>::Ptr(new pcl::search::KdTree<pcl::PointNormal>));
    estimation.setKSearch(neighbors);
    Points normals;
    estimation.compute(normals);
    using Kernel = CGAL::Simple_cartesian<double>;
    using Row = std::tuple<Kernel::Point_3, Kernel::Vector_3, std::size_t>;
    std::vector<Row> rows;
    for (std::size_t i = 0; i < points_->size(); ++i) {
      const auto& p = (*points_)[i];
      const auto& n = normals[i];
      const bool finite = std::isfinite(n.normal_x);
      const Kernel::Vector_3 normal =
          finite ? Kernel::Vector_3(n.normal_x, n.normal_y, n.normal_z) : Kernel::Vector_3(0, 0, 1);
      rows.emplace_back(Kernel::Point_3(p.x, p.y, p.z), normal, i);
    }
    // Orients the part with the highest point, and puts all other parts behind it.
    for (auto part = rows.begin(); part != rows.end();) {
      const auto count = std::size_t(rows.end() - part);
      auto end = rows.end();
      if (count > neighbors) {
        CGAL::Iterator_range range(part, rows.end());
        end = CGAL::mst_orient_normals(range, neighbors,
                                       CGAL::parameters::point_map(CGAL::Nth_of_tuple_property_map<0, Row>())
                                           .normal_map(CGAL::Nth_of_tuple_property_map<1, Row>()));
        if (end == part) end = rows.end();
      }
      std::vector<std::size_t> members;
      for (auto row = part; row != end; ++row) {
        const auto& [place, normal, index] = *row;
        auto& p = (*points_)[index];
        p.normal_x = float(normal.x());
        p.normal_y = float(normal.y());
        p.normal_z = float(normal.z());
        members.push_back(index);
      }
      if (points_inwards(members))
        for (const auto i : members) (*points_)[i].getNormalVector3fMap() *= -1;
      part = end;
    }
  }

  bool points_inwards(const std::vector<std::size_t>& members) const {
    double outwards = 0;
    for (int x = -1; x <= 1; ++x)
      for (int y = -1; y <= 1; ++y)
        for (int z = -1; z <= 1; ++z) {
          const Eigen::Vector3f direction = Eigen::Vector3i(x, y, z).cast<float>();
          if (direction.isZero()) continue;
          const auto reach = [&](std::size_t i) { return (*points_)[i].getVector3fMap().dot(direction); };
          const auto farthest = std::max_element(members.begin(), members.end(),
                                                 [&](std::size_t a, std::size_t b) { return reach(a) < reach(b); });
          outwards += (*points_)[*farthest].getNormalVector3fMap().dot(direction.normalized());
        }
    return outwards < 0;
  }

  void fit() {
    // The octree's edge is 1.1 times that of the cloud. Its finest cells are about as wide as the
    // points are apart.
    constexpr double scale = 1.1;
    constexpr int coarsest = 4, finest = 10;
    const int depth =
        options_.depth > 0 ? options_.depth : std::clamp(int(std::ceil(std::log2(scale / spacing_))), coarsest, finest);
    result_.stats.depth = depth;
    pcl::Poisson<pcl::PointNormal> poisson;
    poisson.setDepth(depth);
    poisson.setSolverDivide(std::min(depth, 8));
    poisson.setIsoDivide(std::min(depth, 8));
    poisson.setScale(float(scale));
    poisson.setSamplesPerNode(1.5F);
    poisson.setManifold(true);
    poisson.setThreads(1);
    poisson.setInputCloud(points_);
    Points vertices;
    std::vector<pcl::Vertices> polygons;
    {
      const SilentFit silent;
      poisson.reconstruct(vertices, polygons);
    }
    geo::TriangleMesh& mesh = result_.mesh;
    for (const auto& v : vertices) mesh.vertices.push_back(at(v));
    for (const auto& polygon : polygons)
      for (std::size_t k = 2; k < polygon.vertices.size(); ++k) {
        const auto corner = [&](std::size_t i) { return static_cast<std::uint32_t>(polygon.vertices[i]); };
        mesh.triangles.push_back({corner(0), corner(k - 1), corner(k)});
      }
    if (geo::signed_volume(mesh) < 0)
      for (auto& triangle : mesh.triangles) std::swap(triangle[1], triangle[2]);
  }

  // Connected parts to which no point is near come from the fit alone.
  void drop_blobs() {
    geo::TriangleMesh& mesh = result_.mesh;
    std::vector<std::uint32_t> part(mesh.vertices.size());
    std::iota(part.begin(), part.end(), 0);
    const auto root = [&](std::uint32_t v) {
      while (part[v] != v) v = part[v] = part[part[v]];
      return v;
    };
    for (const auto& [a, b, c] : mesh.triangles) {
      part[root(a)] = root(b);
      part[root(b)] = root(c);
    }
    std::vector<char> near(mesh.vertices.size(), 0), used(mesh.vertices.size(), 0);
    for (const auto& triangle : mesh.triangles)
      for (const auto v : triangle) {
        used[root(v)] = 1;
        if (!near[root(v)] && nearest(mesh.vertices[v]) < spacing_) near[root(v)] = 1;
      }
    for (std::size_t v = 0; v < part.size(); ++v) result_.stats.blobs += used[v] && part[v] == v && !near[v];
    std::erase_if(mesh.triangles, [&](const geo::Triangle& t) { return !near[root(t[0])]; });
  }

  // The distance to the nearest point, in units of the box.
  double nearest(const geo::Vec3& place) {
    tree_.nearestKSearch(local(place), 1, found_, squared_);
    return std::sqrt(double(squared_[0]));
  }

  // A corner has the mean colour of the nearest points, nearer ones with more weight.
  void color() {
    if (cloud_.color.empty()) return;
    constexpr int count = 4;
    const geo::TriangleMesh& mesh = result_.mesh;
    std::vector<geo::Color> at_vertex(mesh.vertices.size());
    const double least = 1e-6 * spacing_ * spacing_;
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
      tree_.nearestKSearch(local(mesh.vertices[v]), count, found_, squared_);
      geo::Color sum = geo::Color::Zero();
      double weights = 0;
      for (std::size_t i = 0; i < found_.size(); ++i) {
        const double weight = 1 / (double(squared_[i]) + least);
        sum += weight * cloud_.color[std::size_t(rows_[std::size_t(found_[i])])];
        weights += weight;
      }
      at_vertex[v] = sum / weights;
    }
    for (const auto& [a, b, c] : mesh.triangles)
      result_.mesh.attributes.color.push_back({at_vertex[a], at_vertex[b], at_vertex[c]});
  }

  // Connected triangles far from all points.
  void measure_holes() {
    const geo::TriangleMesh& mesh = result_.mesh;
    std::vector<std::uint32_t> region(mesh.vertices.size());
    std::iota(region.begin(), region.end(), 0);
    const auto root = [&](std::uint32_t v) {
      while (region[v] != v) v = region[v] = region[region[v]];
      return v;
    };
    std::vector<double> area(mesh.vertices.size(), 0);
    std::vector<char> far(mesh.triangles.size(), 0);
    double whole = 0;
    const auto corners = geo::corners_of(mesh);
    const auto area_of = [&](std::size_t t) {
      return (corners[t][1] - corners[t][0]).cross(corners[t][2] - corners[t][0]).norm() / 2;
    };
    for (std::size_t t = 0; t < corners.size(); ++t) {
      whole += area_of(t);
      const geo::Vec3 middle = (corners[t][0] + corners[t][1] + corners[t][2]) / 3;
      if (nearest(middle) < hole_distance * spacing_) continue;
      far[t] = 1;
      const auto& [a, b, c] = mesh.triangles[t];
      region[root(a)] = root(b);
      region[root(b)] = root(c);
    }
    double filled = 0;
    for (std::size_t t = 0; t < corners.size(); ++t)
      if (far[t]) {
        area[root(mesh.triangles[t][0])] += area_of(t);
        filled += area_of(t);
      }
    const double least = std::pow(result_.stats.spacing, 2);  // smaller ones are chance
    result_.stats.holes = std::size_t(std::count_if(area.begin(), area.end(), [&](double a) { return a > least; }));
    result_.stats.hole_share = result_.stats.holes > 0 ? filled / whole : 0;
  }

  void measure_distances() {
    std::vector<geo::Vec3> places;
    for (const auto& p : *points_) places.push_back(at(p));
    const auto rows = geo::nearest_triangles(result_.mesh, places);
    const auto corners = geo::corners_of(result_.mesh);
    std::vector<double> distance;
    for (std::size_t i = 0; i < places.size(); ++i) {
      const auto& [a, b, c] = corners[rows[i]];
      distance.push_back(std::sqrt(squared_to_triangle(places[i], a, b, c)));
    }
    std::sort(distance.begin(), distance.end());
    result_.stats.median = distance[distance.size() / 2];
    result_.stats.upper = distance[std::min(distance.size() - 1, distance.size() * 95 / 100)];
  }

  const geo::PointCloud& cloud_;
  const Options& options_;
  geo::Vec3 middle_ = geo::Vec3::Zero();
  double size_ = 1, spacing_ = 0;  // the spacing is in units of the box
  Points::Ptr points_{new Points};
  pcl::Indices rows_;  // of the points in the cloud
  pcl::KdTreeFLANN<pcl::PointNormal> tree_;
  pcl::Indices found_;
  std::vector<float> squared_;
  Result result_;
};

}  // namespace
}  // namespace scan

bool kerf_scan_reconstruct(const geo::PointCloud* cloud, const scan::Options* options, scan::Result* result,
                           std::string* message) {
  pcl::console::setVerbosityLevel(pcl::console::L_ALWAYS);
  try {
    *result = scan::Reconstruction(*cloud, *options).run();
    return true;
  } catch (const std::bad_alloc&) {
    *message = "needs more memory than there is; give a smaller depth";
  } catch (const std::exception& error) {
    *message = error.what();
  }
  return false;
}
