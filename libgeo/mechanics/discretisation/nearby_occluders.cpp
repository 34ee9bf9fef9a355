// Boxes are merged while their union is no larger than their sum: overlapping queries become one.
#include "mechanics/discretisation/nearby_occluders.h"

#include <algorithm>
#include <utility>

#include "kerf/parallel.h"

namespace geo {
namespace {

double volume(const Box3& box) { return (box.hi - box.lo).prod(); }

bool contains(const Box3& outer, const Box3& inner) {
  return (outer.lo.array() <= inner.lo.array()).all() && (inner.hi.array() <= outer.hi.array()).all();
}

std::vector<Box3> merged(std::span<const Box3> boxes) {
  std::vector<Box3> result;
  for (const Box3& box : boxes) {
    result.push_back(box);
    while (result.size() > 1) {
      Box3 both = result.end()[-2];
      both.add(result.back());
      if (volume(both) > volume(result.back()) + volume(result.end()[-2])) break;
      result.pop_back();
      result.back() = both;
    }
  }
  return result;
}

// The faces that meet one of the boxes, each once.
std::vector<FaceId> faces_in(const Complex& surface, std::span<const Box3> boxes) {
  std::vector<std::vector<FaceId>> near(boxes.size());
  parallel_for(boxes.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t b = begin; b < end; ++b) surface.faces_near(boxes[b], near[b]);
  });
  std::vector<FaceId> faces;
  std::vector<char> found(surface.face_count(), 0);
  for (const auto& of_box : near)
    for (const FaceId f : of_box)
      if (!std::exchange(found[f.index()], 1)) faces.push_back(f);
  return faces;
}

}  // namespace

void NearbyOccluders::note_changes(std::span<const FaceId> added) {
  stale_ = true;
  if (!known_.empty()) faces_.insert(faces_.end(), added.begin(), added.end());
}

const Occluders& NearbyOccluders::near(const Complex& surface, std::span<const Box3> boxes, double margin) {
  const std::vector<Box3> wanted = merged(boxes);
  const bool is_known = std::all_of(wanted.begin(), wanted.end(), [&](const Box3& box) {
    return std::any_of(known_.begin(), known_.end(), [&](const Box3& known) { return contains(known, box); });
  });
  if (is_known && !stale_) return occluders_;
  if (is_known) {
    std::erase_if(faces_, [&](FaceId f) { return !surface.alive(f); });
  } else {
    if (stale_) known_.clear();  // else a second query adds to the first
    for (const Box3& box : wanted) known_.push_back(box.grown(margin));
    known_ = merged(known_);
    faces_ = faces_in(surface, known_);
  }
  occluders_.update(surface, faces_);
  stale_ = false;
  return occluders_;
}

}  // namespace geo
