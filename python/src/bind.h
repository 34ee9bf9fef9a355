// The parts of the extension kerf._kerf: each source adds its classes and functions to the module.
#pragma once

#include <pybind11/pybind11.h>

namespace kerf_python {

namespace py = pybind11;

void bind_errors(py::module_& module);           ///< exceptions; first
void bind_threads(py::module_& module);          ///< number of threads
void bind_mesh(py::module_& module);             ///< Mesh and Solid
void bind_deltas(py::module_& module);           ///< CrackDelta and ComplexEdit
void bind_complex(py::module_& module);          ///< Complex
void bind_complex_queries(py::module_& module);  ///< faces, radial cycles, sides
void bind_fronts(py::module_& module);           ///< Front and FrontState
void bind_score(py::module_& module);            ///< scores
void bind_crack(py::module_& module);            ///< cracks given whole
void bind_pieces(py::module_& module);           ///< pieces, bonds and hulls
void bind_hierarchy(py::module_& module);        ///< crumbs and clusters of pieces
void bind_impact(py::module_& module);           ///< solids that break where they are hit
void bind_crack_edits(py::module_& module);      ///< remeshing, roughening, decimation
void bind_checks(py::module_& module);           ///< reports, predicates, crossings
void bind_mesh_methods(py::module_& module);     ///< repair, refinement, hulls
void bind_mesh_space(py::module_& module);       ///< planes, transformation, points inside
void bind_imports(py::module_& module);          ///< meshes of trimesh and Open3D
void bind_surface_files(py::module_& module);    ///< files of surfaces
void bind_front_files(py::module_& module);      ///< files of fronts
void bind_shapes(py::module_& module);           ///< procedural models
void bind_nodes(py::module_& module);            ///< NodeSet and sample
void bind_graph(py::module_& module);            ///< VisibilityGraph
void bind_body_changes(py::module_& module);     ///< fronts, changes and statistics of bodies
void bind_body(py::module_& module);             ///< Body
void bind_kerf_file(py::module_& module);        ///< KerfFile
void bind_material(py::module_& module);         ///< Material, Materials and their laws
void bind_state(py::module_& module);            ///< State and Environment
void bind_solid_fields(py::module_& module);     ///< StepReport, and nodal fields of solids
void bind_solid(py::module_& module);            ///< DeformingSolid
void bind_scene(py::module_& module);            ///< Scene
void bind_frame_stats(py::module_& module);      ///< statistics of frames
void bind_simulation(py::module_& module);       ///< Simulation
void bind_run_files(py::module_& module);        ///< files of runs
void bind_pickles(py::module_& module);          ///< pickling and copying; last

}  // namespace kerf_python
