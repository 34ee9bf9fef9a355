// cut_out() of kerf/score.h.
//
// Marching squares link the points where edges of the grid of pixels pass from black to white.
// Where a cell has two outlines, the mean of its corners decides which corners are one area.
// Outlines are simplified (Douglas 1973). Where that makes two of them meet (exact test), the
// points that they leave out farthest away come back.
#include <algorithm>
#include <cmath>
#include <string>

#include "crack/index_map.h"
#include "geometry/aabb_tree.h"
#include "geometry/predicates.h"
#include "kerf/error.h"
#include "kerf/score.h"
#include "score/walls.h"

namespace geo {
namespace {

// Points of an outline, in pixels to the right and down; the plane's third coordinate is 0.
struct Outline {
  std::vector<Vec3> points;
  bool closed = false;            // the last point is joined to the first, which it does not repeat
  std::vector<std::size_t> kept;  // points that a simplified outline has, ascending
};

[[noreturn]] void refuse(const CutOutOptions& o) {
  throw InputError("the image's outlines have more than " + std::to_string(o.max_segments) +
                   " segments; give a smaller or smoother image");
}

// The outlines of an image, in order of the lowest edge of the grid that they cross.
class MarchingSquares {
 public:
  // Throws InputError where outlines pass between more than a hundred times as many pixels as they
  // may have segments.
  MarchingSquares(const GrayImage& image, const CutOutOptions& o)
      : image_(image), threshold_(o.threshold), max_nodes_(100 * static_cast<std::size_t>(o.max_segments)) {
    for (int y = 0; y + 1 < image.height; ++y) {
      for (int x = 0; x + 1 < image.width; ++x) march(x, y);
      if (nodes_.size() > max_nodes_) refuse(o);
    }
  }

  std::vector<Outline> run() {
    std::vector<Outline> outlines;
    // Open ones first, from one end; what is left then is closed.
    for (const bool closed : {false, true})
      for (std::uint32_t n = 0; n < nodes_.size(); ++n)
        if (!nodes_[n].used && (closed || nodes_[n].next[1] == ~0u)) outlines.push_back(follow(n, closed));
    return outlines;
  }

 private:
  struct Node {
    Vec3 point;
    std::array<std::uint32_t, 2> next{~0u, ~0u};
    bool used = false;
  };

  double brightness(int x, int y) const {
    return static_cast<double>(image_.brightness[static_cast<std::size_t>(y) * static_cast<std::size_t>(image_.width) +
                                                 static_cast<std::size_t>(x)]);
  }
  bool black(int x, int y) const { return brightness(x, y) < threshold_; }

  // The outlines' pieces in the cell with the corners (x, y) and (x + 1, y + 1).
  void march(int x, int y) {
    const std::array<std::array<int, 2>, 4> corner{{{x, y}, {x + 1, y}, {x + 1, y + 1}, {x, y + 1}}};
    std::array<bool, 4> is_black{};
    double mean = 0;
    for (std::size_t k = 0; k < 4; ++k) {
      is_black[k] = black(corner[k][0], corner[k][1]);
      mean += 0.25 * brightness(corner[k][0], corner[k][1]);
    }
    std::array<std::size_t, 4> crossed{};
    std::size_t count = 0;
    for (std::size_t k = 0; k < 4; ++k)
      if (is_black[k] != is_black[(k + 1) % 4]) crossed[count++] = k;
    const auto link = [&](std::size_t a, std::size_t b) {
      const auto from = node(corner[a], corner[(a + 1) % 4]), to = node(corner[b], corner[(b + 1) % 4]);
      for (const auto& [n, other] : {std::pair{from, to}, {to, from}})
        nodes_[n].next[nodes_[n].next[0] == ~0u ? 0 : 1] = other;
    };
    if (count == 2) link(crossed[0], crossed[1]);
    if (count == 4) {
      const bool second_alone = (mean < threshold_) == is_black[0];  // corners 0 and 2 are one area
      link(second_alone ? 0 : 3, second_alone ? 1 : 0);
      link(second_alone ? 2 : 1, second_alone ? 3 : 2);
    }
  }

  // The point between two neighbouring pixels, at least a 64th away from both: outlines through a
  // pixel of exactly the threshold would touch there.
  std::uint32_t node(std::array<int, 2> a, std::array<int, 2> b) {
    if (b < a) std::swap(a, b);
    const bool across = a[1] == b[1];
    const std::uint64_t name = (static_cast<std::uint64_t>(a[1]) << 32 | static_cast<std::uint64_t>(a[0])) << 1 |
                               static_cast<std::uint64_t>(across);
    std::uint32_t& index = index_[name];
    if (index != ~0u) return index;
    index = static_cast<std::uint32_t>(nodes_.size());
    const double from = brightness(a[0], a[1]), to = brightness(b[0], b[1]);
    const double share = std::clamp((threshold_ - from) / (to - from), 1.0 / 64, 63.0 / 64);
    nodes_.push_back({.point = Vec3(a[0] + (across ? share : 0), a[1] + (across ? 0 : share), 0)});
    return index;
  }

  Outline follow(std::uint32_t n, bool closed) {
    Outline outline;
    outline.closed = closed;
    for (std::uint32_t at = n; at != ~0u;) {
      nodes_[at].used = true;
      outline.points.push_back(nodes_[at].point);
      std::uint32_t next = ~0u;
      for (const auto other : nodes_[at].next)
        if (next == ~0u && other != ~0u && !nodes_[other].used) next = other;
      at = next;
    }
    return outline;
  }

  const GrayImage& image_;
  const double threshold_;
  const std::size_t max_nodes_;
  std::vector<Node> nodes_;
  crack::IndexMap<std::uint64_t, crack::SpreadHash> index_;
};

double distance_from_segment(const Vec3& p, const Vec3& a, const Vec3& b) {
  const double length2 = (b - a).squaredNorm();
  const double s = length2 > 0 ? std::clamp((p - a).dot(b - a) / length2, 0.0, 1.0) : 0;
  return (a + s * (b - a) - p).norm();
}

// Keeps few points of outlines that do not meet, so that they still do not.
class Simplification {
 public:
  Simplification(std::vector<Outline>& outlines, double tolerance) : outlines_(outlines) {
    for (auto& outline : outlines_) {
      const std::size_t end = outline.points.size() - (outline.closed ? 0 : 1);
      outline.kept = outline.closed ? corners_of(outline) : std::vector<std::size_t>{0};
      outline.kept.push_back(end);
      for (std::size_t k = 0, count = outline.kept.size(); k + 1 < count; ++k)
        divide(outline, outline.kept[k], outline.kept[k + 1], tolerance);
      std::sort(outline.kept.begin(), outline.kept.end());
      if (outline.closed) outline.kept.pop_back();
    }
  }

  void run() {
    while (part_meeting()) {
    }
  }

 private:
  // A segment of a simplified outline: from its k-th kept point to the next one.
  struct Segment {
    std::size_t outline, k;
  };
  static const Vec3& point(const Outline& outline, std::size_t i) { return outline.points[i % outline.points.size()]; }
  // The index of the point behind the k-th kept one; the first one again is points.size().
  static std::size_t end_of(const Outline& outline, std::size_t k) {
    return k + 1 < outline.kept.size() ? outline.kept[k + 1] : outline.points.size();
  }

  // The point between `first` and `last` that is farthest from the segment between these.
  static std::pair<std::size_t, double> farthest(const Outline& outline, std::size_t first, std::size_t last) {
    std::pair<std::size_t, double> found{first, -1};
    for (std::size_t i = first + 1; i < last; ++i) {
      const double distance = distance_from_segment(point(outline, i), point(outline, first), point(outline, last));
      if (distance > found.second) found = {i, distance};
    }
    return found;
  }

  // Three points that a closed outline keeps in any case, far from each other.
  static std::vector<std::size_t> corners_of(const Outline& outline) {
    const std::size_t end = outline.points.size(), second = farthest(outline, 0, end).first;
    const auto before = farthest(outline, 0, second), after = farthest(outline, second, end);
    if (before.second > after.second) return {0, before.first, second};
    return {0, second, after.first};
  }

  // Appends what is kept between two points, both left out.
  static void divide(Outline& outline, std::size_t first, std::size_t last, double tolerance) {
    std::vector<std::pair<std::size_t, std::size_t>> spans{{first, last}};
    while (!spans.empty()) {
      const auto [from, to] = spans.back();
      spans.pop_back();
      const auto [at, distance] = farthest(outline, from, to);
      if (!(distance > tolerance)) continue;
      outline.kept.push_back(at);
      spans.push_back({from, at});
      spans.push_back({at, to});
    }
  }

  bool meet(const Segment& s, const Segment& t) const {
    const Outline &one = outlines_[s.outline], &other = outlines_[t.outline];
    const std::size_t ends[2] = {end_of(one, s.k), end_of(other, t.k)};
    const Vec3 &a = point(one, one.kept[s.k]), &b = point(one, ends[0]);
    const Vec3 &c = point(other, other.kept[t.k]), &d = point(other, ends[1]);
    const int shared = (a == c || a == d ? 1 : 0) + (b == c || b == d ? 1 : 0);
    if (shared == 2) return true;
    if (shared == 1) {  // neighbours meet in more than a point where they fold back
      const Vec3& joint = a == c || a == d ? a : b;
      const Vec3 &p = joint == a ? b : a, &q = joint == c ? d : c;
      return orient2d(joint, p, q, 2) == 0 && (p - joint).dot(q - joint) > 0;
    }
    const int abc = orient2d(a, b, c, 2), abd = orient2d(a, b, d, 2);
    const int cda = orient2d(c, d, a, 2), cdb = orient2d(c, d, b, 2);
    if (abc == 0 && abd == 0) return true;  // on one line, and the boxes meet
    return abc != abd && cda != cdb && abc * abd <= 0 && cda * cdb <= 0;
  }

  // Brings back a point of each segment that meets another one. False where none does.
  bool part_meeting() {
    std::vector<Segment> segments;
    std::vector<Box3> boxes;
    for (std::size_t o = 0; o < outlines_.size(); ++o)
      for (std::size_t k = 0; k + (outlines_[o].closed ? 0 : 1) < outlines_[o].kept.size(); ++k) {
        segments.push_back({o, k});
        boxes.emplace_back();
        boxes.back().add(point(outlines_[o], outlines_[o].kept[k]));
        boxes.back().add(point(outlines_[o], end_of(outlines_[o], k)));
      }
    std::vector<std::pair<std::size_t, std::size_t>> back;  // outline, point
    for (const auto& [s, t] : overlapping_pairs(std::move(boxes))) {
      if (!meet(segments[s], segments[t])) continue;
      for (const auto& [o, k] : {segments[s], segments[t]}) {
        const std::size_t first = outlines_[o].kept[k], last = end_of(outlines_[o], k);
        if (last - first > 1) back.push_back({o, farthest(outlines_[o], first, last).first});
      }
    }
    std::sort(back.begin(), back.end());
    back.erase(std::unique(back.begin(), back.end()), back.end());
    for (const auto& [o, i] : back) {
      auto& kept = outlines_[o].kept;
      kept.insert(std::lower_bound(kept.begin(), kept.end(), i), i);
    }
    return !back.empty();
  }

  std::vector<Outline>& outlines_;
};

double area_of(const Outline& outline) {
  double twice = 0;
  for (std::size_t i = 0; i < outline.points.size(); ++i) {
    const Vec3 &a = outline.points[i], &b = outline.points[(i + 1) % outline.points.size()];
    twice += a.x() * b.y() - a.y() * b.x();
  }
  return 0.5 * std::abs(twice);
}

// Where the points of an image are in the model.
class Placement {
 public:
  Placement(const GrayImage& image, const Box3& box, const CutOutOptions& o)
      : size_{image.width, image.height}, middle_(box.center()), beyond_(box.diagonal()) {
    const Vec3 axis = o.axis.normalized();
    const bool along_z = std::abs(axis.z()) > 0.5 * axis.norm() && axis.x() == 0 && axis.y() == 0;
    const Vec3 up = o.up.value_or(along_z ? Vec3::UnitY() : Vec3::UnitZ());
    right_ = up.cross(axis);
    if (!(right_.norm() > 1e-6 * up.norm()))
      throw InputError("what is up in the image is along its axis; give another");
    right_.normalize();
    up_ = axis.cross(right_);
    Mat3 frame;
    frame << right_, up_, axis;
    const Box3 along = box_along(box, frame);
    scale_ = {(along.hi.x() - along.lo.x()) / size_[0], (along.hi.y() - along.lo.y()) / size_[1]};
    if (o.fit == ImageFit::inside) scale_ = Vec2::Constant(scale_.minCoeff());
  }

  // A point in pixels, which are counted from the middle of the first one.
  Vec3 at(const Vec3& p) const {
    return middle_ + scale_.x() * (p.x() + 0.5 - 0.5 * size_[0]) * right_ -
           scale_.y() * (p.y() + 0.5 - 0.5 * size_[1]) * up_;
  }
  // Where an outline goes on that ends at a point of the border.
  Vec3 beyond(const Vec3& p) const {
    const Vec3 out = p.y() == 0 ? up_ : p.y() == size_[1] - 1 ? Vec3(-up_) : p.x() == 0 ? Vec3(-right_) : right_;
    return at(p) + beyond_ * out;
  }

 private:
  const std::array<int, 2> size_;
  const Vec3 middle_;
  const double beyond_;
  Vec3 right_, up_;
  Vec2 scale_;
};

void require(const GrayImage& image, const CutOutOptions& o) {
  if (image.width < 2 || image.height < 2) throw InputError("the image needs two rows and two columns at least");
  if (image.brightness.size() != static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height))
    throw InputError("the image needs a brightness for each pixel");
  if (!std::all_of(image.brightness.begin(), image.brightness.end(), [](float b) { return b >= 0 && b <= 1; }))
    throw InputError("the image has a brightness that is not from 0, black, to 1, white");
  if (!(o.threshold > 0 && o.threshold < 1) || !(o.tolerance >= 0 && o.tolerance <= 1e3) || !(o.least_area >= 0) ||
      o.max_segments < 1)
    throw InputError("the image's threshold must be between 0 and 1, its tolerance from 0 to 1000 pixels");
  if (!(o.axis.norm() > 0) || !o.axis.allFinite()) throw InputError("an axis needs a length");
}

}  // namespace

CutOut cut_out(const GrayImage& image, const Box3& box, const CutOutOptions& o) {
  require(image, o);
  const Placement placement(image, box, o);
  std::vector<Outline> outlines = MarchingSquares(image, o).run();
  CutOut result;
  result.spots = std::erase_if(
      outlines, [&](const Outline& outline) { return outline.closed && area_of(outline) < o.least_area; });
  if (outlines.empty())
    throw InputError("the image has no border between black and white; give one with black areas on white");
  std::size_t segments = outlines.size();  // at least
  if (segments <= static_cast<std::size_t>(o.max_segments)) {
    Simplification(outlines, o.tolerance).run();
    segments = 0;
    for (const auto& outline : outlines) segments += outline.kept.size() - (outline.closed ? 0 : 1);
  }
  if (segments > static_cast<std::size_t>(o.max_segments)) refuse(o);
  for (const auto& outline : outlines) {
    std::vector<Vec3> curve;
    if (!outline.closed) curve.push_back(placement.beyond(outline.points.front()));
    for (const auto i : outline.kept) curve.push_back(placement.at(outline.points[i]));
    curve.push_back(outline.closed ? curve.front() : placement.beyond(outline.points.back()));
    result.curves.push_back(std::move(curve));
  }
  return result;
}

}  // namespace geo
