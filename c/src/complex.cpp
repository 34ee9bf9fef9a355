// Complexes, scores, cracks and pieces of kerf.h.
#include "kerf/complex.h"

#include <algorithm>

#include "call.h"
#include "kerf/check.h"
#include "kerf/files.h"
#include "kerf/hierarchy.h"
#include "kerf/jobs.h"
#include "kerf/pieces.h"
#include "objects.h"

namespace kerf_c {
namespace {

geo::Complex complex_of(const geo::TriangleMesh& mesh) {
  of_solid([&] { geo::require_solid(mesh); });
  return mesh.two_sided() ? geo::Complex::from_two_sided(mesh) : geo::Complex::from_skin(mesh);
}

// An edit that no front makes: it ends what undo() knows of fronts.
void forget_front(ComplexObject& complex) {
  complex.moved.reset();
  complex.changed_whole = false;
}

void insert(ComplexObject& complex, const geo::TriangleMesh& sheet) {
  if (sheet.triangles.empty()) throw geo::InputError("the sheet has no triangles");
  geo::insert_sheet(complex.complex, sheet, complex.numbers.next());
  forget_front(complex);
}

// A square in a plane that covers the box. The part of the plane in the box is in a circle of half
// the diagonal about the foot of the box's middle.
geo::TriangleMesh sheet_across(const geo::Vec3& point, const geo::Vec3& normal, const geo::Box3& box) {
  const double reach = 0.75 * box.diagonal();
  const geo::Vec3 middle = box.center() - normal.dot(box.center() - point) * normal;
  const geo::Vec3 u = reach * normal.unitOrthogonal(), v = normal.cross(u);
  geo::TriangleMesh sheet;
  sheet.vertices = {middle - u - v, middle + u - v, middle + u + v, middle - u + v};
  sheet.triangles = {{0, 1, 2}, {0, 2, 3}};
  return sheet;
}

void sweep(ComplexObject& complex, const geo::Front& front, const geo::Progress& progress) {
  if (front.is_sheet()) {
    geo::TriangleMesh sheet;
    sheet.vertices = front.steps[0];
    sheet.triangles = front.triangles;
    geo::report(progress, "crack " + front.name, 0, 1);
    return insert(complex, sheet);
  }
  if (front.steps.size() < 2) throw geo::InputError("the front '" + front.name + "' has one step; give two at least");
  geo::FrontState state = geo::begin_front(front.steps[0], front.closed, complex.numbers.next());
  for (std::size_t step = 1; step < front.steps.size(); ++step) {
    geo::report(progress, "crack " + front.name, step - 1, front.steps.size() - 1);
    std::vector<geo::Vec3> present;
    for (const geo::FrontState::Point& p : state.points) present.push_back(p.position);
    forget_front(complex);
    geo::advance(complex.complex, state, geo::resample_front(present, front.steps[step], front.closed));
  }
}

void crack(kerf_complex complex, const std::vector<geo::Front>& fronts, const geo::Progress& progress) {
  const Writing<ComplexObject> use(complex);
  for (const geo::Front& front : fronts) sweep(*use, front, progress);
}

}  // namespace

PiecesObject::PiecesObject(geo::PieceSet of) : Object(kind), set(std::move(of)) {
  for (const geo::Bond& from : set.bonds) {
    kerf_bond bond{};
    bond.a = from.a;
    bond.b = from.b;
    bond.area = from.area;
    bond.section = from.section;
    copy_point(from.normal, bond.normal);
    copy_point(from.centroid, bond.centroid);
    bonds.push_back(bond);
  }
}

std::shared_ptr<ComplexObject> complex_for(const std::shared_ptr<const geo::TriangleMesh>& mesh) {
  return std::make_shared<ComplexObject>(complex_of(*mesh), mesh);
}

// The density that a value for each vertex of a model makes.
geo::Density density_of(const kerf_score_options& o, const geo::TriangleMesh& model) {
  if (!o.density) return {};
  if (o.pattern != KERF_VORONOI && o.pattern != KERF_WOOD)
    throw ArgumentError("density: goes with the patterns KERF_VORONOI and KERF_WOOD");
  return geo::painted_density(model, {o.density, o.density_length});
}

// The outlines of the black areas of an image in the middle of a model.
void add_image(const kerf_score_options& o, const geo::TriangleMesh& model, geo::ScoreOptions& options) {
  constexpr int widest = 65536;
  if ((o.pattern == KERF_CURVES) != (o.image != nullptr))
    throw ArgumentError("image: goes with the pattern KERF_CURVES, which needs one");
  if (!o.image) return;
  geo::GrayImage image{.width = static_cast<int>(number_of(o.image_width, 1, widest, "image_width")),
                       .height = static_cast<int>(number_of(o.image_height, 1, widest, "image_height")),
                       .brightness = {}};
  const auto pixels = std::size_t(image.width) * std::size_t(image.height);
  constexpr float white = 255;
  for (std::size_t i = 0; i < pixels; ++i) image.brightness.push_back(float(o.image[i]) / white);
  geo::CutOutOptions cut;
  if (options.pattern.axis) cut.axis = *options.pattern.axis;
  options.pattern.curves = geo::cut_out(image, geo::bounding_box(model), cut).curves;
}

geo::ScoreOptions score_options_of(const kerf_score_options* given, const geo::TriangleMesh& model) {
  kerf_score_options o;
  kerf_score_defaults(&o);
  if (given) o = *given;
  geo::ScoreOptions options;
  number_of(o.pattern, KERF_PLANES, KERF_CURVES, "pattern");
  options.pattern.pattern = static_cast<geo::Pattern>(o.pattern);
  options.pieces = static_cast<int>(number_of(o.pieces, 1, 1000000, "pieces"));
  options.pattern.seed = options.jagged.seed = o.seed;
  if (flag_of(o.has_axis, "has_axis")) options.pattern.axis = point_of(o.axis, "axis");
  if (flag_of(o.has_impact, "has_impact")) options.pattern.impact = point_of(o.impact, "impact");
  options.pattern.cluster = number_of(o.cluster, 1e-6, 10, "cluster");
  options.pattern.grain = number_of(o.grain, 1, 1000, "grain");
  options.jagged.amplitude = number_of(o.jagged, 0, 1, "jagged");
  options.jagged.frequency = number_of(o.frequency, 1e-3, 200, "frequency");
  options.depth = number_of(o.depth, 1e-6, 1, "depth");
  options.attempts = static_cast<int>(number_of(o.attempts, 1, 1000000, "attempts"));
  options.chips.count = static_cast<int>(number_of(o.chips, 0, 100000, "chips"));
  options.chips.size = number_of(o.chip_size, 0.01, 1, "chip_size");
  options.jagged.edge_amplitude = number_of(o.edge_detail, 0, 1, "edge_detail");
  options.jagged.edge_width = number_of(o.edge_width, 1e-3, 1, "edge_width");
  options.pattern.density = density_of(o, model);
  add_image(o, model, options);
  return options;
}

}  // namespace kerf_c

using namespace kerf_c;

kerf_status kerf_complex_create(kerf_mesh mesh, kerf_complex* complex) {
  return call([&] {
    NewHandle out(complex, "complex");
    const Reading<MeshObject> use(mesh);
    out.set(complex_for(use->kept));
  });
}

kerf_status kerf_complex_copy(kerf_complex complex, kerf_complex* copy) {
  return call([&] {
    NewHandle out(copy, "copy");
    const Reading<ComplexObject> use(complex);
    auto made = std::make_shared<ComplexObject>(use->complex, use->model);
    made->numbers = use->numbers;
    out.set(std::move(made));
  });
}

kerf_status kerf_complex_surface(kerf_complex complex, kerf_mesh* surface) {
  return call([&] {
    NewHandle out(surface, "surface");
    const Reading<ComplexObject> use(complex);
    geo::TriangleMesh mesh = use->complex.two_sided();
    geo::transfer_attributes(*use->model, mesh);
    out.set(object_for(std::move(mesh)));
  });
}

kerf_status kerf_complex_count(kerf_complex complex, kerf_complex_counts* counts) {
  return call([&] {
    kerf_complex_counts& to = required(counts, "counts");
    const Reading<ComplexObject> use(complex);
    to = {};
    to.vertices = use->complex.vertex_count();
    to.faces = use->complex.live_face_count();
    to.cracks = use->complex.crack_count();
    to.pieces = geo::find_pieces(use->complex).count;
  });
}

kerf_status kerf_score_defaults(kerf_score_options* options) {
  return call([&] {
    const geo::ScoreOptions from;
    kerf_score_options to{};
    to.pattern = static_cast<std::int32_t>(from.pattern.pattern);
    to.pieces = from.pieces;
    to.seed = from.pattern.seed;
    to.cluster = from.pattern.cluster;
    to.grain = from.pattern.grain;
    to.jagged = from.jagged.amplitude;
    to.frequency = from.jagged.frequency;
    to.depth = from.depth;
    to.attempts = from.attempts;
    to.chips = from.chips.count;
    to.chip_size = from.chips.size;
    to.edge_detail = from.jagged.edge_amplitude;
    to.edge_width = from.jagged.edge_width;
    required(options, "options") = to;
  });
}

kerf_status kerf_score(kerf_complex complex, const kerf_score_options* options, kerf_progress progress, void* user,
                       kerf_mesh* sheet, uint32_t* pieces) {
  return call([&] {
    NewHandle out(sheet, "sheet");
    const Reading<ComplexObject> use(complex);
    const geo::ScoreOptions o = score_options_of(options, *use->model);
    geo::Score score = geo::make_score(use->complex, o, progress_of(progress, user));
    if (pieces) *pieces = score.pieces;
    out.set(object_for(std::move(score.sheet)));
  });
}

kerf_status kerf_complex_insert(kerf_complex complex, kerf_mesh sheet) {
  return call([&] {
    const Reading<MeshObject> from(sheet);
    const Writing<ComplexObject> use(complex);
    insert(*use, from->mesh);
  });
}

kerf_status kerf_complex_cut_plane(kerf_complex complex, const double point[3], const double normal[3]) {
  return call([&] {
    const geo::Vec3 at = point_of(point, "point"), direction = point_of(normal, "normal").stableNormalized();
    if (direction.isZero(0.5)) throw ArgumentError("normal: has no length");
    const Writing<ComplexObject> use(complex);
    insert(*use, sheet_across(at, direction, use->complex.extent()));
  });
}

kerf_status kerf_complex_crack_file(kerf_complex complex, const char* path, kerf_progress progress, void* user) {
  return call([&] { crack(complex, geo::read_fronts(path_of(path, "path")), progress_of(progress, user)); });
}

kerf_status kerf_complex_crack_bytes(kerf_complex complex, const uint8_t* bytes, size_t length, const char* name,
                                     kerf_progress progress, void* user) {
  return call([&] {
    const std::string title = text_of(name, "name"), content = bytes_of(bytes, length, "bytes");
    crack(complex, geo::parse_fronts(content, title), progress_of(progress, user));
  });
}

kerf_status kerf_complex_undo(kerf_complex complex) {
  return call([&] {
    const Writing<ComplexObject> use(complex);
    if (use->changed_whole)
      throw geo::GeometryError("undo: the last edit changed the whole complex; copy it before such an edit");
    use->complex.undo();
    if (const auto front = use->moved.lock()) front->state = use->before;
    forget_front(*use);
  });
}

kerf_status kerf_complex_join_small_pieces(kerf_complex complex, double least) {
  return call([&] {
    number_of(least, 0, 1e200, "least");
    const Writing<ComplexObject> use(complex);
    const geo::Pieces pieces = geo::find_pieces(use->complex);
    const auto group = geo::join_small_pieces(pieces.volume, geo::find_bonds(use->complex, pieces), least);
    ++use->healed;
    forget_front(*use);
    geo::heal(use->complex, pieces, group);
  });
}

// An edit of the whole complex, after which its fronts have ended.
template <class Edit>
static kerf_status edit_all(kerf_complex complex, const Edit& edit) {
  return call([&] {
    const Writing<ComplexObject> use(complex);
    edit(use->complex);
    ++use->healed;
    forget_front(*use);
    use->changed_whole = true;
  });
}

kerf_status kerf_complex_remesh(kerf_complex complex, double angle, kerf_progress progress, void* user) {
  return edit_all(complex, [&](geo::Complex& k) {
    geo::RemeshOptions options;
    options.angle = number_of(angle, 0, 30, "angle");
    std::vector<geo::FaceId> faces;
    for (std::uint32_t f = 0; f < k.face_count(); ++f) faces.emplace_back(f);
    geo::remesh(k, faces, {}, options, nullptr, progress_of(progress, user));
  });
}

kerf_status kerf_complex_roughen(kerf_complex complex, double amplitude, double frequency, uint64_t seed,
                                 kerf_progress progress, void* user) {
  return edit_all(complex, [&](geo::Complex& k) {
    geo::RoughenOptions options;
    options.amplitude = number_of(amplitude, 0, 1, "amplitude");
    options.frequency = number_of(frequency, 0, 1e4, "frequency");
    options.seed = seed;
    geo::roughen(k, {}, options, nullptr, progress_of(progress, user));
  });
}

kerf_status kerf_complex_decimate(kerf_complex complex, double deviation, size_t faces, kerf_progress progress,
                                  void* user) {
  return edit_all(complex, [&](geo::Complex& k) {
    geo::DecimateOptions options;
    options.deviation = number_of(deviation, 0, 1, "deviation");
    options.faces = faces;
    geo::decimate(k, {}, options, nullptr, progress_of(progress, user));
  });
}

kerf_status kerf_front_begin(kerf_complex complex, const double* points, size_t points_length, int32_t closed,
                             kerf_front* front) {
  return call([&] {
    NewHandle out(front, "front");
    const auto line = points_of(points, points_length, "points");
    const bool loop = flag_of(closed, "closed");
    const Writing<ComplexObject> use(complex);
    geo::FrontState state = geo::begin_front(line, loop, use->numbers.next());
    out.set(std::make_shared<FrontObject>(use.shared(), std::move(state)));
  });
}

kerf_status kerf_front_advance(kerf_front front, const double* points, size_t points_length, size_t* new_faces) {
  return call([&] {
    const auto line = points_of(points, points_length, "points");
    const Writing<FrontObject> use(front);
    const Writing<ComplexObject> complex(use->complex);
    if (use->healed != complex->healed)
      throw geo::InputError("the front ended where the whole complex was changed; begin another one");
    geo::FrontState before = use->state;
    const geo::CrackDelta delta = geo::advance(complex->complex, use->state, line);
    complex->before = std::move(before);
    complex->moved = use.shared();
    complex->changed_whole = false;
    if (new_faces) *new_faces = delta.new_crack_faces.size();
  });
}

kerf_status kerf_complex_pieces(kerf_complex complex, kerf_pieces* pieces) {
  return call([&] {
    NewHandle out(pieces, "pieces");
    const Reading<ComplexObject> use(complex);
    out.set(std::make_shared<PiecesObject>(geo::pieces_of(use->complex, *use->model)));
  });
}

kerf_status kerf_fracture(kerf_mesh solid, const kerf_score_options* options, kerf_progress progress, void* user,
                          kerf_pieces* pieces) {
  return call([&] {
    NewHandle out(pieces, "pieces");
    const Reading<MeshObject> use(solid);
    const geo::ScoreOptions o = score_options_of(options, use->mesh);
    out.set(std::make_shared<PiecesObject>(geo::fracture(use->mesh, o, progress_of(progress, user))));
  });
}

namespace {

// Throws ArgumentError where there is no such piece.
const geo::Chunk& piece_at(const PiecesObject& pieces, std::size_t index) {
  if (index >= pieces.set.chunks.size())
    throw ArgumentError("index: there is no piece " + std::to_string(index) + ", but " +
                        std::to_string(pieces.set.chunks.size()) + " from 0 on");
  return pieces.set.chunks[index];
}

}  // namespace

kerf_status kerf_pieces_count(kerf_pieces pieces, size_t* count) {
  return call([&] {
    std::size_t& to = required(count, "count");
    const Reading<PiecesObject> use(pieces);
    to = use->set.chunks.size();
  });
}

kerf_status kerf_pieces_get(kerf_pieces pieces, size_t index, kerf_piece* piece) {
  return call([&] {
    kerf_piece& to = required(piece, "piece");
    const Reading<PiecesObject> use(pieces);
    const geo::Chunk& from = piece_at(*use, index);
    const geo::MassProperties mass = geo::mass_properties(from.mesh);
    to.volume = from.volume;
    copy_point(from.centroid, to.centroid);
    copy_matrix(mass.inertia, to.inertia);
  });
}

kerf_status kerf_pieces_mesh(kerf_pieces pieces, size_t index, kerf_mesh* mesh) {
  return call([&] {
    NewHandle out(mesh, "mesh");
    const Reading<PiecesObject> use(pieces);
    out.set(object_for(piece_at(*use, index).mesh));
  });
}

kerf_status kerf_pieces_bonds(kerf_pieces pieces, const kerf_bond** bonds, size_t* length) {
  return call([&] {
    required(bonds, "bonds");
    required(length, "length");
    const Reading<PiecesObject> use(pieces);
    *bonds = use->bonds.data();
    *length = use->bonds.size();
  });
}
