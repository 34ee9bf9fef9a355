// A vertex slot that is empty has the place of the first vertex, so that pages can draw it.
#include "live/surface_view.h"

namespace live {

void SurfaceView::update(const geo::Simulation& run) {
  slots_.update(run.body().surface, painter_);
  const std::vector<geo::Vec3> surface = run.state().surface.empty() ? run.surface().vertices : run.state().surface;
  const auto& slot = slots_.slot_of_living();
  positions_.assign(slots_.topology()->vertices, surface.empty() ? geo::Vec3(geo::Vec3::Zero()) : surface[0]);
  for (std::size_t i = 0; i < slot.size(); ++i) positions_[slot[i]] = surface[i];
}

void SurfaceView::show(Snapshot& snapshot) const {
  snapshot.topology = slots_.topology();
  snapshot.positions = positions_;
  snapshot.look = look_;
}

PickedPoint SurfaceView::pick(const geo::Complex& surface, const Spot& spot) const {
  const geo::Side side = slots_.side(spot.face);
  if (!side.face.valid()) throw BadMessage("there is no such triangle now");
  PickedPoint picked;
  picked.side = side;
  int most = 0;
  for (int k = 0; k < 3; ++k) {
    // A side is seen from its own side: its corners 1 and 2 are exchanged.
    const int corner = side.which == 1 && k > 0 ? 3 - k : k;
    const auto v = surface.surface_vertex(side, corner);
    picked.material += spot.bary[k] * surface.point(surface.site(v));
    if (k == 0 || spot.bary[k] > spot.bary[most]) {
      most = k;
      picked.nearest = v;
    }
  }
  return picked;
}

geo::Vec3 SurfaceView::world_point(const Spot& spot) const {
  const geo::Triangle& t = slots_.topology()->triangle.at(spot.face);
  return spot.bary[0] * positions_[t[0]] + spot.bary[1] * positions_[t[1]] + spot.bary[2] * positions_[t[2]];
}

const geo::Vec3* SurfaceView::place_of(geo::SurfaceVertexId vertex) const {
  const auto slot = slots_.slot(vertex);
  return slot && *slot < positions_.size() ? &positions_[*slot] : nullptr;
}

}  // namespace live
