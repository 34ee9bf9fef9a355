// Pieces, bonds and hulls (§ 7). Chunks are moved into the objects that Python sees.
#include "pieces.h"

#include <pybind11/stl.h>

#include <atomic>

#include "bind.h"
#include "complex.h"
#include "kerf/error.h"
#include "kerf/parallel.h"

namespace kerf_python {

py::array bonds_array(std::vector<geo::Bond>&& bonds) {
  static_assert(sizeof(geo::Bond) == 72, "two ids, an area, two vectors, a section");
  py::list fields;
  fields.append(py::make_tuple("a", "u4"));
  fields.append(py::make_tuple("b", "u4"));
  fields.append(py::make_tuple("area", "f8"));
  fields.append(py::make_tuple("normal", "f8", py::make_tuple(3)));
  fields.append(py::make_tuple("centroid", "f8", py::make_tuple(3)));
  fields.append(py::make_tuple("section", "f8"));
  auto* kept = new std::vector<geo::Bond>(std::move(bonds));
  py::capsule owner(kept, [](void* at) { delete static_cast<std::vector<geo::Bond>*>(at); });
  py::array out(py::dtype::from_args(fields), {static_cast<py::ssize_t>(kept->size())}, {}, kept->data(), owner);
  py::detail::array_proxy(out.ptr())->flags &= ~py::detail::npy_api::NPY_ARRAY_WRITEABLE_;
  return out;
}

namespace {

using Pieces = std::vector<std::shared_ptr<Piece>>;

// Deformed positions of the vertices of surface(), as the library wants them: by id.
std::vector<geo::Vec3> moved_from(const geo::Complex& complex, const py::object& moved) {
  if (moved.is_none()) return {};
  const auto rows = points_from(moved, "moved");
  std::vector<geo::Vec3> out(complex.surface_vertex_count(), geo::Vec3::Zero());
  std::size_t row = 0;
  for (std::uint32_t v = 0; v < out.size(); ++v) {
    if (!complex.alive(geo::SurfaceVertexId(v))) continue;
    if (row < rows.size()) out[v] = rows[row];
    ++row;
  }
  if (row != rows.size())
    throw geo::InputError("moved: " + std::to_string(rows.size()) + " rows; give one for each of the " +
                          std::to_string(row) + " vertices of surface()");
  return out;
}

void add_hulls(Pieces& pieces, std::size_t parts, std::size_t corners, const geo::Progress& progress) {
  std::atomic<std::size_t> done = 0;
  geo::parallel_for(pieces.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t p = begin; p < end; ++p) {
      const geo::Progress& stop = [&](std::string_view, std::size_t, std::size_t) {
        return !progress || progress("hulls", done, pieces.size());
      };
      for (auto& hull : geo::convex_decomposition(pieces[p]->mesh, parts, corners, stop))
        pieces[p]->hulls.push_back(std::make_shared<Mesh>(std::move(hull)));
      geo::report(progress, "hulls", ++done, pieces.size());
    }
  });
}

struct PieceOptions {
  bool hulls = false;
  int corners = 64, parts = 1;
  double tile = 0.25;
};

Pieces pieces_of(Complex& self, const PieceOptions& o, const py::object& moved, py::object progress) {
  if (o.corners < 4 || o.corners > 100000) throw geo::InputError("pieces: corners must be from 4 to 100000");
  if (o.parts < 1 || o.parts > 1000) throw geo::InputError("pieces: parts must be from 1 to 1000");
  if (!(o.tile > 0 && o.tile <= 1e6)) throw geo::InputError("pieces: tile must be above 0 and at most 1000000");
  ProgressReport report(std::move(progress));
  const Reading reading(self.busy);
  const auto found = self.found();
  const auto at = moved_from(self.complex, moved);
  static const geo::TriangleMesh no_model;
  return report.run([&](const geo::Progress& progress) {
    auto chunks = geo::make_chunks(self.complex, *found, self.model ? self.model->mesh : no_model,
                                   o.tile * self.complex.extent().diagonal(), at);
    Pieces out;
    for (std::uint32_t p = 0; p < chunks.size(); ++p) out.push_back(std::make_shared<Piece>(std::move(chunks[p]), p));
    if (o.hulls) add_hulls(out, static_cast<std::size_t>(o.parts), static_cast<std::size_t>(o.corners), progress);
    return out;
  });
}

py::array bonds_of(Complex& self, const py::object& moved) {
  const Reading reading(self.busy);
  const auto found = self.found();
  const auto at = moved_from(self.complex, moved);
  return bonds_array(without_gil([&] { return geo::find_bonds(self.complex, *found, at); }));
}

void bind_piece(py::module_& module) {
  py::class_<Piece, Solid, std::shared_ptr<Piece>>(
      module, "Piece",
      "A piece of a cut model: the closed boundary of a connected region of material (§ 7). A Solid whose patch is 0\n"
      "on the skin and whose source names the triangle of the model, 2**32 - 1 on cracks. Inner faces have the group\n"
      "\"crack\" and texture coordinates. Where a crack ends inside the piece, its two sides are at one place: calls\n"
      "that need a valid model then raise InputError.")
      .def_readonly("index", &Piece::index, "Its number among the pieces, in descending order of volume.")
      .def(
          "refine",
          [](const std::shared_ptr<Piece>& self, double longest, const py::object& progress) {
            geo::Chunk chunk{refined_mesh(self, longest, progress), self->volume, self->centroid};
            auto out = std::make_shared<Piece>(std::move(chunk), self->index);
            out->hulls = self->hulls;
            return out;
          },
          py::arg("longest"), py::arg_v("progress", py::none()), "As Mesh.refine(): the same piece, with its hulls.")
      .def_readonly("volume", &Piece::volume, "Volume, model units cubed.")
      .def_property_readonly(
          "centroid", [](const Piece& self) { return point(self.centroid); }, "Centroid of the material, (3,) float64.")
      .def_property_readonly(
          "hulls", [](const Piece& self) { return self.hulls; },
          "Convex hulls of it, a list of Mesh; empty unless pieces(hulls=True). The piece sticks out of a hull\n"
          "that has reached the limit of its corners, with 64 by about 1 % of its diagonal at most.");
}

void add_to_complex(py::module_& module) {
  py::class_<Complex, std::shared_ptr<Complex>>(module.attr("Complex"))
      .def(
          "pieces",
          [](Complex& self, bool hulls, int corners, int parts, double tile, const py::object& moved,
             py::object progress) {
            return pieces_of(self, {hulls, corners, parts, tile}, moved, std::move(progress));
          },
          py::arg("hulls") = false, py::arg("corners") = PieceOptions{}.corners,
          py::arg("parts") = PieceOptions{}.parts, py::arg("tile") = PieceOptions{}.tile,
          py::arg_v("moved", py::none()), py::arg_v("progress", py::none()),
          "The pieces, a list of Piece in descending order of volume, with the attributes of the model (§ 7). Their\n"
          "volumes sum to the skin's.\n\n"
          "hulls: also convex hulls, at most `parts` for each piece, of at most `corners` vertices each. tile: size of "
          "a\n"
          "texture tile on inner faces, a fraction of the diagonal. moved: (n, 3) deformed positions of the vertices "
          "of\n"
          "surface(); meshes, volumes and centroids are then deformed ones. progress: a callable of (phase, done,\n"
          "total), or a tqdm bar. Raises InputError for arguments out of range, Interrupted.")
      .def_property_readonly(
          "bonds", [](Complex& self) { return bonds_of(self, py::none()); },
          "The crack faces that two pieces share, ordered by (a, b): a structured array with the\n"
          "fields a and b (pieces, a < b), area (model units squared), normal (mean, a unit vector\n"
          "from a to b; zero where the faces close around one piece), centroid (§ 7) and section (elastic\n"
          "section modulus for the worst axis, model units cubed).")
      .def("find_bonds", &bonds_of, py::arg_v("moved", py::none()),
           "As bonds. moved: (n, 3) deformed positions of the vertices of surface(); then normals and centroids are\n"
           "deformed ones, half way between the two sides, and areas still undeformed ones. Raises InputError.")
      .def_property_readonly(
          "piece_count",
          [](Complex& self) {
            const Reading reading(self.busy);
            return self.found()->count;
          },
          "Number of pieces: connected regions of material.")
      .def_property_readonly(
          "shell_count",
          [](Complex& self) {
            const Reading reading(self.busy);
            return self.found()->shells;
          },
          "Number of connected components of the two-sided surface, inner shells included.")
      .def_property_readonly(
          "piece_volumes",
          [](Complex& self) {
            const Reading reading(self.busy);
            return moved<double>(std::vector<double>(self.found()->volume));
          },
          "Volume of each piece, (piece_count,) float64, model units cubed.")
      .def_property_readonly(
          "piece_of_sides",
          [](Complex& self) {
            const Reading reading(self.busy);
            auto sides = self.found()->of_side;
            const auto faces = static_cast<py::ssize_t>(sides.size() / 2);
            return moved<std::int32_t>(std::move(sides)).reshape({faces, py::ssize_t(2)});
          },
          "Piece of each side of each face, (face_count, 2) int32; -1 for no side.");
}

}  // namespace

void bind_pieces(py::module_& module) {
  bind_piece(module);
  add_to_complex(module);
}

}  // namespace kerf_python
