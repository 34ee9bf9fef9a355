// Reports a surface: sizes, cracks, histogram of edges, and the faults of check_surface() (declared
// in info/files.h).
#include <algorithm>

#include <kerf/check.h>
#include <kerf/error.h>
#include <kerf/pieces.h>
#include "info/files.h"
#include "tool.h"

namespace info {
namespace {

std::vector<double> edge_lengths(const geo::TriangleMesh& mesh) {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> edges;
  for (const auto& t : mesh.triangles)
    for (std::size_t k = 0; k < 3; ++k) edges.push_back(std::minmax(t[k], t[(k + 1) % 3]));
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  std::vector<double> lengths;
  for (const auto& [a, b] : edges) lengths.push_back((mesh.vertices[a] - mesh.vertices[b]).norm());
  return lengths;
}

std::string corner(const geo::Vec3& p) { return list({tool::number(p.x()), tool::number(p.y()), tool::number(p.z())}); }

}  // namespace

std::string report_surface(const geo::SurfaceFile& file, const ReportOptions& options, Report& report) {
  const auto& mesh = file.mesh;
  const auto result =
      geo::check_surface(mesh, options.check ? geo::SelfIntersections::find : geo::SelfIntersections::ignore);
  const auto cracks =
      static_cast<std::size_t>(std::count_if(mesh.patch.begin(), mesh.patch.end(), [](auto p) { return p > 0; }));
  std::size_t pieces = 0, front_edges = 0;
  std::int32_t crack_count = 0;
  const bool sound = result.closed && result.manifold && result.oriented;
  if (sound) try {
      const auto complex = geo::Complex::from_two_sided(mesh);
      pieces = geo::find_pieces(complex).count;
      crack_count = complex.crack_count();
      for (std::uint32_t f = 0; f < complex.face_count(); ++f)
        for (int k = 0; k < 3; ++k)
          if (complex.face(geo::FaceId(f)).crack > 0)
            front_edges +=
                complex.faces_around(complex.face(geo::FaceId(f)).v[k], complex.face(geo::FaceId(f)).v[(k + 1) % 3])
                    .size() == 1;
    } catch (const geo::InputError&) {
    }
  const double volume = geo::signed_volume(mesh);
  const geo::Box3 box =
      mesh.vertices.empty() ? geo::Box3{geo::Vec3::Zero(), geo::Vec3::Zero()} : geo::bounding_box(mesh);
  const geo::Vec3 size = box.hi - box.lo;
  report.headline = (sound ? "A closed surface: " : "A surface that is not closed or not sound: ") +
                    counted(mesh.triangles.size() - 2 * cracks, "triangle") + " of skin" +
                    (crack_count > 0 ? ", " + counted(static_cast<std::size_t>(crack_count), "crack") + " of " +
                                           counted(cracks, "triangle") + (front_edges > 0 ? " that ends inside" : "")
                                     : "") +
                    (pieces > 0 ? ", " + counted(pieces, "piece") : "") + "; " + rounded(size.x()) + " × " +
                    rounded(size.y()) + " × " + rounded(size.z()) + ", volume " + rounded(volume) +
                    (mesh.unit > 0 && mesh.unit != 1 ? ", unit " + rounded(mesh.unit) + " m" : "") + "." +
                    (file.fronts.empty() ? "" : " " + counted(file.fronts.size(), "front") + " can go on.");
  report.add_text("kind", "surface");
  report.add("vertices", mesh.vertices.size());
  report.add("faces", mesh.triangles.size());
  report.add("skin_faces", mesh.triangles.size() - 2 * cracks);
  report.add("crack_faces", cracks);
  report.add("pieces", pieces);
  report.add("closed", result.closed);
  report.add("manifold", result.manifold);
  report.add("oriented", result.oriented);
  report.add("self_intersections", result.self_intersections ? std::to_string(*result.self_intersections) : "null");
  report.add_number("volume", volume);
  report.add_number("area", geo::area(mesh));
  report.add("low", corner(box.lo));
  report.add("high", corner(box.hi));
  if (mesh.unit > 0) report.add_number("unit", mesh.unit);
  report.add("front_edges", front_edges);
  report.add("degenerate_faces", result.degenerate_faces);
  report.add("fronts", file.fronts.size());
  auto names = mesh.attributes.names();
  if (!mesh.source.empty()) names.push_back("source");
  for (auto& name : names) name = tool::quoted(name);
  report.add("attributes", list(names));
  if (options.histograms) report.add_histogram("edge_lengths", edge_lengths(mesh));
  const std::string problem = result.good() && options.check && !mesh.two_sided() && volume <= 0
                                  ? "the surface is inside out; reverse its triangles"
                                  : result.first_problem;
  return problem.empty() || mesh.two_sided() ? problem : problem + ", or try kerf-repair";
}

}  // namespace info
