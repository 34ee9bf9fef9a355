// Strokes that divide a model into a heap of pieces, as a hand makes them in kerf-live.
#include "live_heap.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>

#include "cut_times.h"
#include "kerf/mesh.h"
#include "live/bare_model.h"
#include "live/session.h"

namespace bench {
namespace {

constexpr int strokes = 6, frames_each = 60, frames_down = 40;  // the pointer is down for two thirds of a second
constexpr int model_nodes = 800;

// The pose in a frame: level strokes and upright ones in turn, from one end of the box to the
// other.
live::Stroke pose(const geo::Box3& box, int frame) {
  const int k = frame / frames_each, within = frame % frames_each;
  const geo::Vec3 size = box.hi - box.lo;
  const double phase = double(within) / frames_down, way = std::clamp(phase, 0.0, 1.0) * 1.3 - 0.15;
  live::Stroke s;
  s.id = static_cast<std::uint64_t>(k);
  s.origin = box.lo + (k % 2 == 0 ? geo::Vec3(way * size.x(), -0.3 * size.y(), (0.25 + 0.11 * k) * size.z())
                                  : geo::Vec3((0.2 + 0.1 * k) * size.x(), -0.3 * size.y(), (1 - way) * size.z()));
  s.direction = geo::Vec3(0.03, 1, 0.02).normalized();
  s.depth = 1.6 * size.y();
  s.phase = within == 0 ? live::Phase::begin : phase < 1 ? live::Phase::move : live::Phase::end;
  return s;
}

}  // namespace

void heap(const std::string& model, Figures& figures) {
  std::ifstream file(model, std::ios::binary);
  if (!file) throw std::runtime_error(model + ": cannot be read");
  const std::string bytes{std::istreambuf_iterator<char>(file), {}};
  sim::Setup setup = live::bare_model(model, bytes, model_nodes, 'z', {}).setup;
  live::adapt_scene(setup.scene, 60, false);
  live::Session session(setup, {});
  const geo::Box3 box = geo::bounding_box(setup.models.all);
  for (int k = -1; k < strokes; ++k) {
    CutTimes times;
    for (int frame = 0; frame < frames_each; ++frame) {
      if (k >= 0 && frame <= frames_down) session.obey(1, pose(box, k * frames_each + frame));
      if (const std::string why = times.advance(session); !why.empty()) throw std::runtime_error(model + ": " + why);
    }
    const std::string name = std::filesystem::path(model).stem().string() + "_" + std::to_string(k + 1) + "_";
    const geo::Complex& surface = session.run().body().surface;
    std::size_t triangles = 0;
    for (std::uint32_t f = 0; f < surface.face_count(); ++f)
      for (const int which : {0, 1}) triangles += surface.has({geo::FaceId(f), which});
    figures[name + "pieces"] = session.pieces();
    figures[name + "triangles"] = double(triangles);
    figures[name + "nodes"] = double(session.run().body().nodes.size());
    figures[name + "frame_ms"] = 1e3 * times.plain();
    figures[name + "cut_ms"] = 1e3 * times.cut();
  }
}

}  // namespace bench
