// The extension kerf._kerf: the order in which classes are registered, so that signatures name
// them.
#include "apart.h"
#include "bind.h"
#include "gil.h"

PYBIND11_MODULE(_kerf, module) {
  using namespace kerf_python;
  module.doc() = "Classes and functions of the package kerf; import that.";
  module.attr("__version__") = KERF_VERSION;
  py::options options;
  options.disable_enum_members_docstring();
  bind_errors(module);
  bind_threads(module);
  bind_mesh(module);
  bind_deltas(module);
  bind_complex(module);
  bind_complex_queries(module);
  bind_fronts(module);
  bind_score(module);
  bind_crack(module);
  bind_pieces(module);
  bind_hierarchy(module);
  bind_impact(module);
  bind_crack_edits(module);
  bind_checks(module);
  bind_mesh_methods(module);
  bind_mesh_space(module);
  bind_imports(module);
  bind_surface_files(module);
  bind_front_files(module);
  bind_shapes(module);
  bind_nodes(module);
  bind_graph(module);
  bind_body_changes(module);
  bind_body(module);
  bind_kerf_file(module);
  bind_material(module);
  bind_state(module);
  bind_solid_fields(module);
  bind_solid(module);
  bind_scene(module);
  bind_frame_stats(module);
  bind_simulation(module);
  bind_run_files(module);
  bind_pickles(module);
  wait_for_threads_at_exit();
  stop_calls_at_exit();
}
