// Pairs of boxes that meet: AabbTree beside CGAL's box intersection (Zomorodian, Edelsbrunner
// 2002).
#include <CGAL/box_intersection_d.h>

#include "contact_peers.h"
#include "geometry/aabb_tree.h"

namespace bench {

double cgal_pairs_seconds(const std::vector<geo::Box3>& boxes, std::size_t& pairs) {
  struct Numbered : CGAL::Box_intersection_d::Box_d<double, 3, CGAL::Box_intersection_d::ID_EXPLICIT> {
    using Base = CGAL::Box_intersection_d::Box_d<double, 3, CGAL::Box_intersection_d::ID_EXPLICIT>;
    Numbered(const geo::Box3& b, std::uint32_t row)
        : Base(CGAL::Bbox_3(b.lo[0], b.lo[1], b.lo[2], b.hi[0], b.hi[1], b.hi[2])), row(row) {}
    std::uint32_t row;
  };
  return least([] {},
               [&] {
                 std::vector<Numbered> all;
                 all.reserve(boxes.size());
                 for (std::uint32_t i = 0; i < boxes.size(); ++i) all.emplace_back(boxes[i], i);
                 std::vector<std::pair<std::uint32_t, std::uint32_t>> found;
                 CGAL::box_self_intersection_d(all.begin(), all.end(), [&](const Numbered& a, const Numbered& b) {
                   found.push_back({a.row, b.row});
                 });
                 pairs = found.size();
               });
}

double own_pairs_seconds(const std::vector<geo::Box3>& boxes, std::size_t& pairs) {
  return least([] {}, [&] { pairs = geo::AabbTree(boxes).pairs().size(); });
}

}  // namespace bench
