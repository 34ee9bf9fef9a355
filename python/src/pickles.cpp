// Pickling, copying and, with them, the passing of objects to other processes. States hold the
// bytes of the arrays, so that every value returns to the bit. Body has a file format of its own
// for this.
#include <pybind11/stl.h>

#include <cstring>
#include <sstream>
#include <type_traits>

#include "bind.h"
#include "busy.h"
#include "complex.h"
#include "kerf/check.h"
#include "kerf/error.h"
#include "kerf/files.h"
#include "kerf/material.h"
#include "kerf/repair.h"
#include "kerf/solid.h"
#include "nodes.h"
#include "pieces.h"
#include "scene.h"
#include "score.h"

namespace kerf_python {
namespace {

// The first entry of every state; a later layout gets the next number.
constexpr int layout = 1;

[[noreturn]] void refuse(const char* what) {
  throw geo::InputError(std::string("the pickle of a ") + what +
                        " is damaged, or of another version of kerf; make it again");
}

// Elements of fixed size without pointers. Eigen's fixed vectors are such, though they have
// constructors.
template <class T>
py::bytes bytes_of(const std::vector<T>& values) {
  static_assert(std::is_trivially_destructible_v<T>);
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
}

template <class T>
std::vector<T> values_of(const py::handle& state, const char* what) {
  if (!py::isinstance<py::bytes>(state)) refuse(what);
  const auto bytes = state.cast<std::string_view>();
  if (bytes.size() % sizeof(T) != 0) refuse(what);
  std::vector<T> values(bytes.size() / sizeof(T));
  if (!values.empty()) std::memcpy(static_cast<void*>(values.data()), bytes.data(), bytes.size());
  return values;
}

// A structure of numbers.
template <class T>
py::bytes bytes_of_struct(const T& value) {
  static_assert(std::is_trivially_copyable_v<T>);
  return {reinterpret_cast<const char*>(&value), sizeof value};
}

template <class T>
T struct_of(const py::handle& state, const char* what) {
  const auto values = values_of<std::array<std::byte, sizeof(T)>>(state, what);
  if (values.size() != 1) refuse(what);
  T value;
  std::memcpy(static_cast<void*>(&value), values[0].data(), sizeof value);
  return value;
}

void require_entries(const py::tuple& state, std::size_t entries, const char* what) {
  if (state.size() != entries || !py::isinstance<py::int_>(state[0]) || state[0].cast<int>() != layout) refuse(what);
}

py::tuple state_of(const geo::TriangleMesh& m) {
  const geo::Attributes& a = m.attributes;
  return py::make_tuple(layout, bytes_of(m.vertices), bytes_of(m.triangles), bytes_of(m.patch), bytes_of(m.site),
                        bytes_of(m.source), bytes_of(a.uv), bytes_of(a.normal), bytes_of(a.color), bytes_of(a.group),
                        a.group_names, a.materials, bytes_of(a.uv2),
                        a.library.glb ? py::object(py::bytes(*a.library.glb)) : py::object(py::none()), m.unit);
}

void require_sound(const geo::TriangleMesh& m) {
  const auto fits = [&](const auto& values) { return values.empty() || values.size() == m.triangles.size(); };
  const geo::Attributes& a = m.attributes;
  bool sound = fits(m.patch) && fits(m.source) && fits(a.uv) && fits(a.uv2) && fits(a.normal) && fits(a.color) &&
               fits(a.group) && (m.site.empty() || m.site.size() == m.vertices.size());
  for (const auto& t : m.triangles)
    for (const auto v : t) sound = sound && v < m.vertices.size();
  for (const auto g : a.group) sound = sound && g >= 0 && static_cast<std::size_t>(g) < a.group_names.size();
  if (!sound) refuse("Mesh");
}

geo::TriangleMesh mesh_of_state(const py::tuple& state) {
  const char* what = "Mesh";
  require_entries(state, 15, what);
  geo::TriangleMesh m;
  m.vertices = values_of<geo::Vec3>(state[1], what);
  m.triangles = values_of<geo::Triangle>(state[2], what);
  m.patch = values_of<std::int32_t>(state[3], what);
  m.site = values_of<std::uint32_t>(state[4], what);
  m.source = values_of<std::uint32_t>(state[5], what);
  m.attributes.uv = values_of<std::array<geo::Vec2, 3>>(state[6], what);
  m.attributes.normal = values_of<std::array<geo::Vec3, 3>>(state[7], what);
  m.attributes.color = values_of<std::array<geo::Color, 3>>(state[8], what);
  m.attributes.group = values_of<std::int32_t>(state[9], what);
  m.attributes.group_names = state[10].cast<std::vector<std::string>>();
  m.attributes.materials = state[11].cast<std::string>();
  m.attributes.uv2 = values_of<std::array<geo::Vec2, 3>>(state[12], what);
  if (!state[13].is_none())
    m.attributes.library.glb = std::make_shared<const std::string>(state[13].cast<std::string>());
  m.unit = state[14].cast<double>();
  require_sound(m);
  return m;
}

// An object that never changes is its own copy.
template <class Class>
void add_copies(Class& made) {
  made.def("__copy__", [](const py::object& self) { return self; })
      .def(
          "__deepcopy__", [](const py::object& self, const py::object&) { return self; }, py::arg("memo"));
}

void bind_meshes(py::module_& module) {
  py::class_<Mesh, std::shared_ptr<Mesh>> mesh(module.attr("Mesh"));
  mesh.def(py::pickle([](const Mesh& self) { return state_of(self.mesh); },
                      [](const py::tuple& state) { return std::make_shared<Mesh>(mesh_of_state(state)); }));
  add_copies(mesh);
  // A solid was tested when it was made; its pickle has the same bytes.
  py::class_<Solid, Mesh, std::shared_ptr<Solid>>(module.attr("Solid"))
      .def(py::pickle([](const Solid& self) { return state_of(self.mesh); },
                      [](const py::tuple& state) { return std::make_shared<Solid>(mesh_of_state(state), true); }));
  py::class_<Piece, Solid, std::shared_ptr<Piece>>(module.attr("Piece"))
      .def(py::pickle(
          [](const Piece& self) {
            py::list hulls;
            for (const auto& hull : self.hulls) hulls.append(state_of(hull->mesh));
            return py::make_tuple(layout, state_of(self.mesh), self.index, self.volume,
                                  bytes_of(std::vector<geo::Vec3>{self.centroid}), hulls);
          },
          [](const py::tuple& state) {
            require_entries(state, 6, "Piece");
            const auto centroid = values_of<geo::Vec3>(state[4], "Piece");
            if (centroid.size() != 1) refuse("Piece");
            auto piece = std::make_shared<Piece>(
                geo::Chunk{mesh_of_state(state[1].cast<py::tuple>()), state[3].cast<double>(), centroid[0]},
                state[2].cast<std::uint32_t>());
            for (const auto& hull : state[5].cast<py::list>())
              piece->hulls.push_back(std::make_shared<Mesh>(mesh_of_state(hull.cast<py::tuple>())));
            return piece;
          }));
  py::class_<ScoreResult, std::shared_ptr<ScoreResult>> score(module.attr("Score"));
  score.def(py::pickle(
      [](const ScoreResult& self) {
        return py::make_tuple(layout, state_of(self.sheet->mesh), self.pieces, self.chips, self.attempts);
      },
      [](const py::tuple& state) {
        require_entries(state, 5, "Score");
        return std::make_shared<ScoreResult>(
            ScoreResult{.sheet = std::make_shared<Mesh>(mesh_of_state(state[1].cast<py::tuple>())),
                        .pieces = state[2].cast<std::uint32_t>(),
                        .chips = state[3].cast<std::uint32_t>(),
                        .attempts = state[4].cast<int>()});
      }));
  add_copies(score);
}

// The surface, and the fronts in the form of a PLY file, which names their contacts by vertices.
py::tuple state_of_complex(Complex& self) {
  const Reading reading(self.busy);
  std::vector<geo::FrontState> fronts;
  py::list options;
  for (const auto& front : self.fronts) {
    fronts.push_back(front->state);
    options.append(bytes_of_struct(front->options));
  }
  std::ostringstream file;
  const geo::TriangleMesh surface = self.surface();
  geo::write_ply(file, self.complex.two_sided(), fronts);
  return py::make_tuple(layout, state_of(surface), py::bytes(std::move(file).str()), options);
}

std::shared_ptr<Complex> complex_of_state(const py::tuple& state) {
  require_entries(state, 4, "Complex");
  const auto file = geo::parse_surface(state[2].cast<std::string>(), "the pickle of a Complex");
  auto made = complex_of(std::make_shared<Mesh>(mesh_of_state(state[1].cast<py::tuple>())));
  const auto options = state[3].cast<py::list>();
  if (options.size() != file.fronts.size()) refuse("Complex");
  for (std::size_t i = 0; i < file.fronts.size(); ++i)
    made->fronts.push_back(std::make_shared<FrontRecord>(
        FrontRecord{file.fronts[i], struct_of<geo::CrackOptions>(options[i], "Complex"), {}}));
  return made;
}

void bind_fronts_and_nodes(py::module_& module) {
  py::class_<Complex, std::shared_ptr<Complex>>(module.attr("Complex"))
      .def(py::pickle(&state_of_complex, &complex_of_state));
  using Front = geo::Front;
  py::class_<Front, std::shared_ptr<Front>> front(module.attr("Front"));
  front.def(py::pickle(
      [](const Front& self) {
        py::list steps;
        for (const auto& step : self.steps) steps.append(bytes_of(step));
        return py::make_tuple(layout, self.name, self.closed, steps, bytes_of(self.triangles));
      },
      [](const py::tuple& state) {
        require_entries(state, 5, "Front");
        Front made{state[1].cast<std::string>(), state[2].cast<bool>(), {}, {}};
        for (const auto& step : state[3].cast<py::list>()) made.steps.push_back(values_of<geo::Vec3>(step, "Front"));
        made.triangles = values_of<geo::Triangle>(state[4], "Front");
        for (const auto& t : made.triangles)
          for (const auto v : t)
            if (made.steps.empty() || v >= made.steps[0].size()) refuse("Front");
        return made;
      }));
  add_copies(front);
  py::class_<NodeSet, std::shared_ptr<NodeSet>> nodes(module.attr("NodeSet"));
  nodes.def(py::pickle(
      [](const NodeSet& self) {
        const geo::NodeSet& n = *self.nodes;
        return py::make_tuple(layout, bytes_of(n.position), bytes_of(n.radius), bytes_of(n.spacing),
                              bytes_of(n.volume));
      },
      [](const py::tuple& state) {
        require_entries(state, 5, "NodeSet");
        geo::NodeSet n;
        n.position = values_of<geo::Vec3>(state[1], "NodeSet");
        n.radius = values_of<double>(state[2], "NodeSet");
        n.spacing = values_of<double>(state[3], "NodeSet");
        n.volume = values_of<double>(state[4], "NodeSet");
        if (n.radius.size() != n.size() || n.spacing.size() != n.size() || n.volume.size() != n.size())
          refuse("NodeSet");
        return std::make_shared<NodeSet>(std::move(n));
      }));
  add_copies(nodes);
}

void bind_materials_and_scenes(py::module_& module) {
  py::class_<geo::Material> material(module.attr("Material"));
  material.def(py::pickle([](const geo::Material& self) { return py::make_tuple(layout, bytes_of_struct(self)); },
                          [](const py::tuple& state) {
                            require_entries(state, 2, "Material");
                            auto made = struct_of<geo::Material>(state[1], "Material");
                            geo::require_material(made);
                            return made;
                          }));
  add_copies(material);
  py::class_<geo::Materials> materials(module.attr("Materials"));
  materials.def(py::pickle(
      [](const geo::Materials& self) {
        py::list table;
        for (const auto& one : self.all()) table.append(bytes_of_struct(one));
        std::vector<std::uint16_t> index;
        for (std::size_t node = 0; self.count() > 1 && !self.fits(index.size()); ++node)
          index.push_back(self.index(node));
        return py::make_tuple(layout, table, bytes_of(index));
      },
      [](const py::tuple& state) {
        require_entries(state, 3, "Materials");
        std::vector<geo::Material> table;
        for (const auto& one : state[1].cast<py::list>()) table.push_back(struct_of<geo::Material>(one, "Materials"));
        return geo::Materials(std::move(table), values_of<std::uint16_t>(state[2], "Materials"));
      }));
  add_copies(materials);
  py::class_<Scene, std::shared_ptr<Scene>> scene(module.attr("Scene"));
  scene.def(py::pickle(
      [](const Scene& self) {
        return py::make_tuple(layout, self.text, self.name, self.folder, self.overrides, self.place.string());
      },
      [](const py::tuple& state) {
        require_entries(state, 6, "Scene");
        auto made = std::make_shared<Scene>(state[1].cast<std::string>(), state[2].cast<std::string>(),
                                            state[3].cast<std::string>(), state[4].cast<geo::SceneOverrides>());
        made->place = state[5].cast<std::string>();
        return made;
      }));
  add_copies(scene);
  using Stats = geo::RepairStats;
  py::class_<Stats> stats(module.attr("RepairStats"));
  stats.def(py::pickle([](const Stats& self) { return py::make_tuple(layout, bytes_of_struct(self)); },
                       [](const py::tuple& state) {
                         require_entries(state, 2, "RepairStats");
                         return struct_of<Stats>(state[1], "RepairStats");
                       }));
  add_copies(stats);
}

}  // namespace

void bind_pickles(py::module_& module) {
  bind_meshes(module);
  bind_fronts_and_nodes(module);
  bind_materials_and_scenes(module);
}

}  // namespace kerf_python
