// Pieces in glTF have the deformed positions of the surface.
#include "live/save.h"

#include <sstream>

#include <kerf/body_file.h>
#include <kerf/export.h>
#include <kerf/files.h>
#include <kerf/pieces.h>
#include "sim/whole_run.h"

namespace live {
namespace {

void write_pieces(std::ostream& out, const Session& session) {
  const geo::Complex& surface = session.run().body().surface;
  const std::vector<geo::Vec3> living = session.run().surface().vertices;
  std::vector<geo::Vec3> moved(surface.surface_vertex_count(), geo::Vec3::Zero());
  std::size_t next = 0;
  for (std::uint32_t v = 0; v < moved.size(); ++v)
    if (surface.alive(geo::SurfaceVertexId(v))) moved[v] = living[next++];
  const geo::Pieces pieces = geo::find_pieces(surface);
  geo::ChunkLabels labels;
  labels.names = geo::piece_names(pieces.count);
  geo::GlbOptions options;
  options.z_up = sim::up_axis(session.original().gravity) != 'Y';
  geo::TriangleMesh model = session.setup().models.all;
  model.attributes.library = session.setup().materials;
  geo::write_glb(out, geo::make_chunks(surface, pieces, model, 1, moved), geo::find_bonds(surface, pieces, moved),
                 labels, options);
}

}  // namespace

bool is_save_format(const std::string& format) {
  return format == "kerf" || format == "ply" || format == "glb" || format == "stl" || format == "toml" ||
         format == "model";
}

std::string saved_file(const Session& session, const std::string& format, const std::string& folder) {
  std::ostringstream out;
  if (format == "kerf") geo::write_body(out, session.run().body());
  if (format == "ply") geo::write_ply(out, session.run().surface());
  if (format == "stl") geo::write_stl(out, session.run().surface());
  if (format == "glb") write_pieces(out, session);
  if (format == "toml") geo::write_scene(out, session.recording(), folder);
  return std::move(out).str();
}

}  // namespace live
