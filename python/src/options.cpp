// Names and defaults are those of the structures of kerf/crack.h.
#include "options.h"

namespace kerf_python {

geo::CrackOptions crack_options(Keywords& keywords) {
  geo::CrackOptions options;
  keywords.take("snap", options.snap, 0, 1);
  keywords.take("snap_edges", options.snap_edges, 0, 1);
  keywords.take("face_offset", options.face_offset, 0, 1);
  keywords.take("clearance", options.clearance, 0, 1);
  keywords.take("jitter", options.jitter, 0, 1);
  keywords.take("attempts", options.attempts, 1, 1000);
  keywords.seed("seed", options.seed);
  return options;
}

py::dict dict_of(const geo::CrackStats& s) {
  py::dict out;
  out["faces_near"] = s.faces_near;
  out["triangles_cut"] = s.triangles_cut;
  out["new_crack_faces"] = s.new_crack_faces;
  out["attempts"] = s.attempts;
  out["snapped"] = s.snapped;
  out["repairs"] = s.repairs;
  out["near_seconds"] = s.near_seconds;
  out["meet_seconds"] = s.meet_seconds;
  out["split_seconds"] = s.split_seconds;
  out["keep_seconds"] = s.keep_seconds;
  out["stitch_seconds"] = s.stitch_seconds;
  out["guard_seconds"] = s.guard_seconds;
  out["seconds"] = s.seconds();
  return out;
}

}  // namespace kerf_python
