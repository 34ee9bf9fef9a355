// A face is known by its id and corners: ids are used again after a step is undone.
#include "mechanics/discretisation/occluding_faces.h"

#include <algorithm>
#include <numeric>

#include "sampling/lattice.h"

namespace geo {
namespace {

// Cells are cubes, 2¹⁰ along the longest side. More affect speed alone.
constexpr double cells_per_side = 1024;

// The faces in the order of the Morton codes of their centres.
std::vector<FaceId> along_curve(const Complex& surface, std::span<const FaceId> ids) {
  Box3 box;
  std::vector<Vec3> centers;
  centers.reserve(ids.size());
  for (const FaceId f : ids) {
    const auto [a, b, c] = surface.corners(f);
    centers.push_back(box_of(a, b, c).center());
    box.add(centers.back());
  }
  const double scale = (cells_per_side - 1) / std::max((box.hi - box.lo).maxCoeff(), 1e-300);
  std::vector<std::pair<std::uint64_t, FaceId>> coded;
  coded.reserve(ids.size());
  for (std::size_t i = 0; i < ids.size(); ++i) {
    const Vec3 at = scale * (centers[i] - box.lo);
    coded.emplace_back(
        morton({static_cast<std::int32_t>(at[0]), static_cast<std::int32_t>(at[1]), static_cast<std::int32_t>(at[2])}),
        ids[i]);
  }
  std::sort(coded.begin(), coded.end());
  std::vector<FaceId> sorted;
  sorted.reserve(ids.size());
  for (const auto& [code, f] : coded) sorted.push_back(f);
  return sorted;
}

}  // namespace

OccludingFaces::Tree OccludingFaces::tree_over(const Complex& surface, std::span<const FaceId> ids) {
  Tree tree;
  tree.face = along_curve(surface, ids);
  tree.corners.reserve(ids.size());
  for (const FaceId f : tree.face) tree.corners.push_back(surface.corners(f));
  tree.order.resize(ids.size());
  std::iota(tree.order.begin(), tree.order.end(), 0u);
  tree.boxes = WideBvh(tree.corners, tree.order);
  return tree;
}

void OccludingFaces::remove_changed(const Complex& surface) {
  for (std::uint32_t i = 0; i < known_.face.size(); ++i) {
    const FaceId f = known_.face[i];
    if (!f.valid()) continue;
    if (f.index() < surface.face_count() && surface.alive(f) && surface.corners(f) == known_.corners[i]) continue;
    known_.boxes.remove(i);
    known_.face[i] = FaceId();
    place_[f.index()] = none;
    ++removed_;
  }
}

void OccludingFaces::update(const Complex& surface, std::span<const FaceId> ids) {
  remove_changed(surface);
  std::vector<FaceId> fresh;
  std::copy_if(ids.begin(), ids.end(), std::back_inserter(fresh), [&](FaceId f) { return !is_known(f); });
  // A quarter: larger makes the average small tree larger, smaller builds the large one more often.
  if (4 * (fresh.size() + removed_) <= known_.face.size()) {
    fresh_ = tree_over(surface, fresh);
    return;
  }
  for (const FaceId f : known_.face)
    if (f.valid()) place_[f.index()] = none;
  known_ = tree_over(surface, ids);
  fresh_ = {};
  removed_ = 0;
  place_.resize(std::max<std::size_t>(place_.size(), surface.face_count()), none);
  for (std::uint32_t i = 0; i < known_.face.size(); ++i) place_[known_.face[i].index()] = i;
}

void OccludingFaces::blocks(const Vec3& p, std::span<const Vec3> ends, std::uint8_t* result) const {
  known_.boxes.blocked(known_.corners, known_.order, p, ends, result);
  fresh_.boxes.add_blocked(fresh_.corners, fresh_.order, p, ends, result);
}

}  // namespace geo
