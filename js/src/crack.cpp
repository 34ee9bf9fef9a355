// Scores, cracks, pieces, bonds.
#include <algorithm>
#include <array>
#include <sstream>

#include <kerf/check.h>
#include <kerf/export.h>
#include <kerf/hierarchy.h>
#include <kerf/pieces.h>
#include <kerf/score.h>
#include "bind.h"

namespace kerf_js {
namespace {

geo::Vec3 axis_from(const val& axis) {
  if (axis.isString()) {
    const auto name = axis.as<std::string>();
    if (name.size() != 1 || name[0] < 'x' || name[0] > 'z')
      throw geo::InputError("axis: '" + name + "' is not 'x', 'y', 'z' or three numbers");
    return geo::Vec3::Unit(name[0] - 'x');
  }
  const geo::Vec3 direction = point_from(axis, "axis");
  if (!(direction.norm() > 0)) throw geo::InputError("axis: has no length");
  return direction;
}

// A channel of the model's colours, or a value for each vertex.
geo::Density density_from(const val& density, const geo::TriangleMesh& model) {
  if (!density.isString()) return geo::painted_density(model, numbers_from<double>(density));
  constexpr std::array channels{"red", "green", "blue", "alpha", "luminance"};
  const auto name = density.as<std::string>();
  const auto found = std::find(channels.begin(), channels.end(), name);
  if (found == channels.end())
    throw geo::InputError("density: '" + name +
                          "' is not red, green, blue, alpha or luminance; or give a value for each vertex");
  return geo::painted_density(model, static_cast<geo::ColorChannel>(found - channels.begin()));
}

// Throws InputError where an option is given that changes nothing without its companion.
void require(const val& options, const char* option, const char* companion) {
  if (has(options, option) && !has(options, companion))
    throw geo::InputError(std::string("score: ") + option + " changes nothing without " + companion + "; give both");
}

// The outlines of an image (brightness from 0 to 1, width, height) in the middle of a model.
void add_image(const val& options, const geo::TriangleMesh& model, geo::ScoreOptions& o) {
  constexpr int widest = 65536;
  if ((o.pattern.pattern == geo::Pattern::curves) != has(options, "image"))
    throw geo::InputError("image: goes with the pattern curves, which needs one");
  if (!has(options, "image")) return;
  const val given = options["image"];
  geo::GrayImage image;
  take(given, "width", image.width, 1, widest);
  take(given, "height", image.height, 1, widest);
  image.brightness = numbers_from<float>(given["brightness"]);
  geo::CutOutOptions cut;
  if (o.pattern.axis) cut.axis = *o.pattern.axis;
  o.pattern.curves = geo::cut_out(image, geo::bounding_box(model), cut).curves;
}

geo::ScoreOptions score_options(const val& options, const geo::TriangleMesh& model) {
  geo::ScoreOptions o;
  if (has(options, "pattern")) o.pattern.pattern = geo::pattern_named(options["pattern"].as<std::string>());
  take(options, "pieces", o.pieces, 1, 1000000);
  take(options, "attempts", o.attempts, 1, 1000000);
  take(options, "depth", o.depth, 0, 1);
  take(options, "jagged", o.jagged.amplitude, 0, 1);
  take(options, "frequency", o.jagged.frequency, 0, 1e4);
  take(options, "octaves", o.jagged.octaves, 1, 16);
  take(options, "edge", o.jagged.edge, 0, 1);
  take(options, "cluster", o.pattern.cluster, 0, 10);
  take(options, "grain", o.pattern.grain, 1, 1000);
  take_seed(options, "seed", o.pattern.seed);
  o.jagged.seed = o.pattern.seed;
  require(options, "chipSize", "chips");
  require(options, "edgeWidth", "edgeDetail");
  take(options, "chips", o.chips.count, 0, 100000);
  take(options, "chipSize", o.chips.size, 0.01, 1);
  take(options, "edgeDetail", o.jagged.edge_amplitude, 0, 1);
  take(options, "edgeWidth", o.jagged.edge_width, 1e-3, 1);
  if (has(options, "density")) {
    if (o.pattern.pattern != geo::Pattern::voronoi && o.pattern.pattern != geo::Pattern::wood)
      throw geo::InputError("density: goes with the patterns voronoi and wood");
    o.pattern.density = density_from(options["density"], model);
  }
  if (has(options, "axis")) o.pattern.axis = axis_from(options["axis"]);
  if (has(options, "impact")) o.pattern.impact = point_from(options["impact"], "impact");
  add_image(options, model, o);
  return o;
}

geo::Complex complex_of(const geo::TriangleMesh& mesh) {
  return mesh.two_sided() ? geo::Complex::from_two_sided(mesh) : geo::Complex::from_skin(mesh);
}

val make_complex(const MeshHandle& model) {
  return guarded([&] {
    demand_solid(model->mesh);
    return std::make_shared<Complex>(Complex{complex_of(model->mesh), model});
  });
}

val copy_complex(const ComplexHandle& complex) {
  return guarded([&] { return std::make_shared<Complex>(Complex{complex->complex, complex->model}); });
}

val score(const ComplexHandle& model, const val& options, const val& progress) {
  return guarded([&] {
    geo::Score made =
        geo::make_score(model->complex, score_options(options, model->model->mesh), progress_to(progress));
    val result = val::object();
    result.set("pieces", made.pieces);
    result.set("chips", made.chips);
    result.set("attempts", made.attempts);
    result.set("sheet", handle(std::move(made.sheet)));
    return result;
  });
}

val insert(const ComplexHandle& complex, const MeshHandle& sheet, const val& options) {
  return guarded([&] {
    geo::Complex& k = complex->complex;
    const val made = changes(geo::insert_sheet(k, sheet->mesh, k.crack_count() + 1, crack_options(options)));
    complex->forget_front();
    return made;
  });
}

// A square that parts the extent of the complex, and reaches beyond it by a half.
val plane_sheet(const ComplexHandle& complex, const val& point, const val& normal) {
  return guarded([&] {
    const geo::Vec3 p = point_from(point, "point"), n = point_from(normal, "normal");
    if (!(n.norm() > 0)) throw geo::InputError("normal: has no length");
    const geo::Box3& box = complex->complex.extent();
    const geo::Vec3 up = n.normalized(), u = up.unitOrthogonal(), v = up.cross(u);
    const geo::Vec3 middle = box.center() - up.dot(box.center() - p) * up;
    const double reach = 0.75 * box.diagonal();
    geo::TriangleMesh sheet;
    for (const auto& [a, b] : {std::pair(-1, -1), std::pair(1, -1), std::pair(1, 1), std::pair(-1, 1)})
      sheet.vertices.push_back(middle + reach * (a * u + b * v));
    sheet.triangles = {{0, 1, 2}, {0, 2, 3}};
    return handle(std::move(sheet));
  });
}

val surface(const ComplexHandle& complex) {
  return guarded([&] {
    geo::TriangleMesh mesh = complex->complex.two_sided();
    if (complex->model) geo::transfer_attributes(complex->model->mesh, mesh);
    return handle(std::move(mesh));
  });
}

val counts(const ComplexHandle& complex) {
  val result = val::object();
  result.set("faces", complex->complex.live_face_count());
  result.set("vertices", complex->complex.vertex_count());
  result.set("cracks", complex->complex.crack_count());
  result.set("diagonal", complex->complex.extent().diagonal());
  return result;
}

val check(const ComplexHandle& complex) {
  return guarded([&] { return geo::check_complex(complex->complex, geo::SelfIntersections::find).first_problem; });
}

// ---- Pieces

// A texture tile on inner faces is a fraction of the diagonal, as in kerf-pieces.
double tile_of(const ComplexHandle& complex, const val& options) {
  double tile = 0.25;
  take(options, "tile", tile, 1e-6, 1e6);
  return tile * complex->complex.extent().diagonal();
}

std::vector<geo::Chunk> chunks_of(const ComplexHandle& complex, const geo::Pieces& found, const val& options) {
  const geo::TriangleMesh none;
  const geo::TriangleMesh& original = complex->model ? complex->model->mesh : none;
  return geo::make_chunks(complex->complex, found, original, tile_of(complex, options));
}

val pieces(const ComplexHandle& complex, const val& options) {
  return guarded([&] {
    int corners = 64, parts = 1;
    take(options, "corners", corners, 4, 100000);
    take(options, "parts", parts, 1, 1000);
    const bool with_hulls = has(options, "hulls") && options["hulls"].as<bool>();
    val result = val::array();
    for (geo::Chunk& chunk : chunks_of(complex, geo::find_pieces(complex->complex), options)) {
      val piece = val::object();
      val around = val::array();
      if (with_hulls)
        for (geo::TriangleMesh& hull :
             geo::convex_decomposition(chunk.mesh, static_cast<std::size_t>(parts), static_cast<std::size_t>(corners)))
          append(around, val(handle(std::move(hull))));
      piece.set("volume", chunk.volume);
      piece.set("centroid", array_of(chunk.centroid));
      piece.set("hulls", around);
      piece.set("mesh", handle(std::move(chunk.mesh)));
      append(result, piece);
    }
    return result;
  });
}

val bonds(const ComplexHandle& complex) {
  return guarded([&] {
    val result = val::array();
    for (const geo::Bond& bond : geo::find_bonds(complex->complex, geo::find_pieces(complex->complex))) {
      val item = val::object();
      item.set("a", bond.a);
      item.set("b", bond.b);
      item.set("area", bond.area);
      item.set("normal", array_of(bond.normal));
      item.set("centroid", array_of(bond.centroid));
      item.set("section", bond.section);
      append(result, item);
    }
    return result;
  });
}

val hierarchy(const ComplexHandle& complex, int levels) {
  return guarded([&] {
    if (levels < 1) throw geo::InputError("levels: give at least 1, that of the pieces");
    const geo::Pieces found = geo::find_pieces(complex->complex);
    val result = val::array();
    for (const geo::ClusterLevel& level : geo::make_hierarchy(found.volume, geo::find_bonds(complex->complex, found),
                                                              static_cast<std::size_t>(levels))) {
      val item = val::object();
      item.set("of", array_of(level.of));
      item.set("volume", array_of(level.volume));
      append(result, item);
    }
    return result;
  });
}

val save_pieces(const ComplexHandle& complex, const std::string& format, const val& options) {
  return guarded([&] {
    if (format != "glb" && format != "usda") throw geo::InputError("save: '" + format + "' is none of glb, usda, ply");
    int corners = 64, parts = 1;
    take(options, "corners", corners, 0, 100000);
    take(options, "parts", parts, 1, 1000);
    const bool z_up = has(options, "zUp") && options["zUp"].as<bool>();
    const geo::Pieces found = geo::find_pieces(complex->complex);
    const auto chunks = chunks_of(complex, found, options);
    const auto shared = geo::find_bonds(complex->complex, found);
    geo::ChunkLabels labels;
    labels.kind = "node";
    labels.names = geo::piece_names(found.count);
    std::ostringstream out;
    if (format == "usda")
      geo::write_usd_pieces(out, chunks, shared, labels,
                            {.z_up = z_up, .hull_parts = std::size_t(parts), .image_prefix = ""});
    else
      geo::write_glb(out, chunks, shared, labels,
                     {.hull_corners = std::size_t(corners), .hull_parts = std::size_t(parts), .z_up = z_up});
    return bytes_of(std::move(out).str());
  });
}

}  // namespace

EMSCRIPTEN_BINDINGS(kerf_crack) {
  emscripten::class_<Complex>("ComplexHandle").smart_ptr<ComplexHandle>("ComplexHandle");
  emscripten::function("makeComplex", &make_complex);
  emscripten::function("copyComplex", &copy_complex);
  emscripten::function("score", &score);
  emscripten::function("insert", &insert);
  emscripten::function("planeSheet", &plane_sheet);
  emscripten::function("surface", &surface);
  emscripten::function("counts", &counts);
  emscripten::function("checkComplex", &check);
  emscripten::function("pieces", &pieces);
  emscripten::function("bonds", &bonds);
  emscripten::function("hierarchy", &hierarchy);
  emscripten::function("savePieces", &save_pieces);
}

}  // namespace kerf_js
