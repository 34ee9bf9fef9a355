// Files of bodies: .kerf with its sections, and exports for other programs.
#include <sstream>

#include "arguments.h"
#include "bind.h"
#include "body.h"
#include "kerf/body_file.h"
#include "kerf/error.h"
#include "kerf/export.h"
#include "kerf/files.h"
#include "kerf/peridynamics.h"

namespace kerf_python {
namespace {

using File = geo::KerfFile;

std::string bytes_of(const geo::Body& body) {
  std::ostringstream out;
  geo::write_body(out, body);
  return std::move(out).str();
}

// Writes the body, or appends what changed to a file of an earlier state.
std::uint64_t save(Body& self, const Path& path, bool update) {
  const Reading reading(self.busy);
  const GilRelease release;
  if (update) {
    geo::KerfUpdate file(path.text);
    return geo::write_body(file, self.body);
  }
  std::uint64_t size = 0;
  geo::write_all(path, [&](std::ostream& out) {
    const auto bytes = bytes_of(self.body);
    size = bytes.size();
    out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  });
  return size;
}

void save_graph(Body& self, const Path& path) {
  if (path.text.ends_with(".vtkhdf") || path.text.ends_with(".hdf")) {
    py::module_::import("kerf._formats").attr("write_vtkhdf")(self.shared_from_this(), path);
    return;
  }
  if (!path.text.ends_with(".ply") && !path.text.ends_with(".vtu"))
    throw geo::InputError(path.text + ": ends in no known format; give .ply, .vtu or .hdf");
  const Reading reading(self.busy);
  const GilRelease release;
  geo::write_all(path, [&](std::ostream& out) {
    path.text.ends_with(".ply") ? geo::write_graph_ply(out, self.body) : geo::write_vtu(out, self.body);
  });
}

void export_file(const File& file, const Path& path) {
  if (!path.text.ends_with(".npz") && !path.text.ends_with(".json"))
    throw geo::InputError(path.text + ": ends in no known format; give .npz or .json");
  const GilRelease release;
  geo::write_all(path, [&](std::ostream& out) {
    path.text.ends_with(".npz") ? geo::write_npz(out, file) : geo::write_json(out, file);
  });
}

void export_body(Body& self, const Path& path, double horizon) {
  const Reading reading(self.busy);
  if (geo::is_bond_folder(path.text)) {
    const GilRelease release;
    return geo::write_bond_folder(path.text, self.body, horizon);
  }
  std::string bytes;
  {
    const GilRelease release;
    bytes = bytes_of(self.body);
  }
  export_file(File(geo::Input(std::move(bytes), "body")), path);
}

std::shared_ptr<Body> loaded(const Path& path) {
  const GilRelease release;
  return std::make_shared<Body>(geo::read_body(path));
}

std::shared_ptr<Body> parsed(const py::bytes& bytes) {
  const auto text = bytes.cast<std::string>();
  const GilRelease release;
  return std::make_shared<Body>(geo::parse_body(text, "bytes"));
}

py::bytes to_bytes(Body& self) {
  const Reading reading(self.busy);
  std::string bytes;
  {
    const GilRelease release;
    bytes = bytes_of(self.body);
  }
  return py::bytes(bytes);
}

// NumPy's name of a section's type.
std::string dtype_of(const std::string& section) { return section == "u1" ? "u1" : "<" + section; }

py::object read_section(const File& file, const std::string& name) {
  const auto at = file.sections().find(name);
  if (at == file.sections().end()) {
    std::vector<std::string> names;
    for (const auto& [known, section] : file.sections()) names.push_back(known);
    throw geo::InputError(file.name() + ": has no section '" + name + "'" + geo::did_you_mean(name, names));
  }
  const auto& section = at->second;
  if (section.dtype == "json") return py::module_::import("json").attr("loads")(file.text(name));
  std::vector<py::ssize_t> shape(section.shape.begin(), section.shape.end());
  py::array out(py::dtype(dtype_of(section.dtype)), shape);
  if (static_cast<std::uint64_t>(out.nbytes()) != section.bytes) file.fail("section " + name);
  const std::span<std::byte> bytes(static_cast<std::byte*>(out.mutable_data()), section.bytes);
  const GilRelease release;
  file.read(name, bytes);
  return out;
}

py::dict sections_of(const File& file) {
  py::dict out;
  for (const auto& [name, section] : file.sections()) {
    py::tuple shape(section.shape.size());
    for (std::size_t i = 0; i < section.shape.size(); ++i) shape[i] = section.shape[i];
    out[py::str(name)] = py::make_tuple(section.dtype, shape, section.bytes);
  }
  return out;
}

void compact(const Path& path) {
  const GilRelease release;
  geo::KerfUpdate(path.text).compact();
}

void write_compacted(const File& file, const Path& path) {
  const GilRelease release;
  geo::write_all(path, [&](std::ostream& out) { geo::write_compacted(out, file); });
}

}  // namespace

void bind_kerf_file(py::module_& module) {
  py::class_<File, std::shared_ptr<File>>(
      module, "KerfFile",
      "A .kerf file in the state of its last complete commit (docs/formats.md). It never changes.\n\n"
      "KerfFile(path): checks everything but the arrays, each of which is checked when it is read. Raises InputError\n"
      "for another file, a newer version, or damage.")
      .def(py::init([](const Path& path) {
             const GilRelease release;
             return std::make_shared<File>(geo::Input(path.text));
           }),
           py::arg("path"), "See the class.")
      .def_property_readonly("name", &File::name, "The path.")
      .def_property_readonly("sections", &sections_of, "Type, shape and bytes of each section, by name: a dict.")
      .def("__getitem__", &read_section, py::arg("name"),
           "A section as an array; of type json as Python's objects. Raises InputError: no such section, or damage.")
      .def("__contains__", [](const File& file, const std::string& name) { return file.sections().contains(name); })
      .def("__len__", [](const File& file) { return file.sections().size(); })
      .def(
          "keys",
          [](const File& file) {
            py::list out;
            for (const auto& [name, section] : file.sections()) out.append(name);
            return out;
          },
          "Names of all sections, sorted.")
      .def_property_readonly("updates", &File::updates, "How many times the file was appended to.")
      .def_property_readonly("committed", &File::committed, "Bytes up to the end of the last complete commit.")
      .def_property_readonly("fingerprint", &File::fingerprint, "Hash that identifies the state of the file.")
      .def_property_readonly("version", &File::version, "Version of the format.")
      .def("export", &export_file, py::arg("path"),
           "Writes all sections as a NumPy archive (.npz) or JSON (.json). Raises OutputError.")
      .def("save", &write_compacted, py::arg("path"),
           "Writes a file with the same sections, without the history of updates. Raises OutputError.")
      .def("__repr__", [](const File& file) {
        return "<kerf.KerfFile " + file.name() + " of " + std::to_string(file.sections().size()) + " sections>";
      });
  module.def("compact", &compact, py::arg("path"),
             "Rewrites a .kerf file without the history of its updates. Raises InputError, OutputError.");
}

void add_files(py::class_<Body, std::shared_ptr<Body>>& body) {
  body.def("save", &save, py::arg("path"), py::kw_only(), py::arg("update") = false,
           "Writes a .kerf file; the same body gives the same bytes. update: appends what changed to the file of an\n"
           "earlier state, which stays valid if this is interrupted. Returns the bytes written. Raises OutputError.")
      .def_static("load", &loaded, py::arg("path"), "Reads a .kerf file. Raises InputError for damage.")
      .def_static("from_bytes", &parsed, py::arg("data"), "Reads the bytes of a .kerf file. Raises InputError.")
      .def("to_bytes", &to_bytes, "The bytes of its .kerf file.")
      .def("save_graph", &save_graph, py::arg("path"),
           "Writes nodes, with all their fields, and edges: .ply, .vtu (VTK) or .hdf (VTKHDF). Raises OutputError.")
      .def("export", &export_body, py::arg("path"), py::arg("horizon") = 3.015,
           "Writes all arrays as a NumPy archive (.npz) or JSON (.json); or the bonds for peridynamics as a folder:\n"
           ".peridigm, .perilab or .peridynamics. horizon: of a node, in node spacings. Raises OutputError, and\n"
           "InputError for a horizon out of range.")
      .def("__copy__",
           [](Body& self) {
             const Reading reading(self.busy);
             return std::make_shared<Body>(self.body, self.model);
           })
      .def(
          "__deepcopy__",
          [](Body& self, const py::dict&) {
            const Reading reading(self.busy);
            return std::make_shared<Body>(self.body, self.model);
          },
          py::arg("memo"))
      .def(py::pickle(&to_bytes, &parsed));
}

}  // namespace kerf_python
