// Groups of pieces: crumbs that join neighbours, and levels of clusters.
#include "kerf/hierarchy.h"

#include <pybind11/stl.h>

#include <algorithm>

#include "bind.h"
#include "complex.h"
#include "kerf/error.h"
#include "pieces.h"

namespace kerf_python {
namespace {

std::shared_ptr<Delta> heal(Complex& self, const py::object& group) {
  const auto given = integers_from(group, "group", 0, ~std::uint32_t(0));
  const std::vector<std::uint32_t> groups(given.begin(), given.end());
  return self.edit({}, true, [&] { return geo::heal(self.complex, geo::find_pieces(self.complex), groups); });
}

std::shared_ptr<Delta> join_small_pieces(Complex& self, double least) {
  if (!(least >= 0 && least <= 1e300)) throw geo::InputError("join_small_pieces: least must not be negative");
  std::size_t before = 0;
  auto delta = self.edit({}, true, [&] {
    const geo::Pieces pieces = geo::find_pieces(self.complex);
    before = pieces.count;
    const auto groups = geo::join_small_pieces(pieces.volume, geo::find_bonds(self.complex, pieces), least);
    return geo::heal(self.complex, pieces, groups);
  });
  const Reading reading(self.busy);
  const auto after = self.found();
  delta->stats["joined"] = before - after->count;
  delta->stats["isolated"] =
      std::count_if(after->volume.begin(), after->volume.end(), [&](double volume) { return volume < least; });
  return delta;
}

std::vector<geo::ClusterLevel> hierarchy(Complex& self, int levels) {
  if (levels < 1 || levels > 1000) throw geo::InputError("hierarchy: levels must be from 1 to 1000");
  const Reading reading(self.busy);
  const auto found = self.found();
  return without_gil([&] {
    return geo::make_hierarchy(found->volume, geo::find_bonds(self.complex, *found), static_cast<std::size_t>(levels));
  });
}

void bind_level(py::module_& module) {
  py::class_<geo::ClusterLevel>(module, "ClusterLevel",
                                "A level of a hierarchy: clusters of pieces that bonds hold together.")
      .def_property_readonly(
          "of", [](const geo::ClusterLevel& self) { return moved<std::uint32_t>(std::vector<std::uint32_t>(self.of)); },
          "The cluster of each cluster one level below, on the first level of each piece, (n,) uint32.")
      .def_property_readonly(
          "volume", [](const geo::ClusterLevel& self) { return moved<double>(std::vector<double>(self.volume)); },
          "Volume of each cluster, (k,) float64, descending, model units cubed.")
      .def_property_readonly(
          "bonds", [](const geo::ClusterLevel& self) { return bonds_array(std::vector<geo::Bond>(self.bonds)); },
          "Bonds between clusters, with the fields of Complex.bonds. Areas and sections are sums, normals and\n"
          "centroids means weighted by area.")
      .def("__repr__", [](const geo::ClusterLevel& self) {
        return "<kerf.ClusterLevel of " + std::to_string(self.volume.size()) + " clusters>";
      });
}

}  // namespace

void bind_hierarchy(py::module_& module) {
  bind_level(module);
  py::class_<Complex, std::shared_ptr<Complex>>(module.attr("Complex"))
      .def("heal", &heal, py::arg("group"),
           "Removes the crack faces between pieces of one group, so that each group is one piece; returns the\n"
           "CrackDelta. Cracks inside a piece stay. group: (piece_count,) integers. Raises InputError for another\n"
           "length.")
      .def("join_small_pieces", &join_small_pieces, py::arg("least"),
           "Joins pieces smaller than `least`, model units cubed, with the neighbour of the greatest bond, the "
           "smallest\n"
           "first; returns the CrackDelta. Its stats count pieces that joined, and isolated ones, which are small and\n"
           "have no bond. Raises InputError for a negative volume.")
      .def("hierarchy", &hierarchy, py::arg("levels"),
           "Clusters of pieces that bonds hold together: a list of levels - 1 ClusterLevel, from fine to coarse. The "
           "last\n"
           "has one cluster for each connected set of pieces; the numbers in between form a geometric sequence, and\n"
           "volumes are similar. Raises InputError for levels below 1.");
}

}  // namespace kerf_python
