// Fronts that cut step by step, edits of a whole complex, and undo.
#include <algorithm>
#include <limits>

#include <kerf/hierarchy.h>
#include <kerf/pieces.h>
#include "bind.h"

namespace kerf_js {

// The front of a complex, which lives as long as either.
struct Front {
  ComplexHandle owner;
  geo::FrontState state;
  std::uint64_t changed;  // of the complex, when the front began
};
using FrontHandle = std::shared_ptr<Front>;

val changes(const geo::CrackDelta& delta) {
  const auto ids = [](const std::vector<geo::FaceId>& faces) {
    std::vector<std::uint32_t> values;
    for (const geo::FaceId f : faces) values.push_back(f.value);
    return array_of(values);
  };
  val result = val::object();
  result.set("removedFaces", ids(delta.removed_faces));
  result.set("newFaces", ids(delta.new_faces));
  result.set("newCrackFaces", ids(delta.new_crack_faces));
  return result;
}

namespace {

// ---- Fronts

val begin_front(const ComplexHandle& complex, const val& points, bool closed, int crack) {
  return guarded([&] {
    const auto line = points_from(points, "points");
    const std::int32_t number = std::max(crack, complex->complex.crack_count() + 1);
    return std::make_shared<Front>(Front{complex, geo::begin_front(line, closed, number), complex->changed});
  });
}

val advance(const FrontHandle& front, const val& points, const val& options) {
  return guarded([&] {
    Complex& complex = *front->owner;
    if (front->changed != complex.changed)
      throw geo::InputError("the front ended where the whole complex was changed; begin another one");
    std::vector<geo::Vec3> present;
    for (const auto& p : front->state.points) present.push_back(p.position);
    const auto next = geo::resample_front(present, points_from(points, "points"), front->state.closed);
    geo::FrontState before = front->state;
    const geo::CrackDelta delta = geo::advance(complex.complex, front->state, next, crack_options(options));
    complex.before = std::move(before);
    complex.moved = front;
    complex.changed_whole = false;
    return changes(delta);
  });
}

int front_crack(const FrontHandle& front) { return front->state.crack; }

// The front that made the last edit goes back with it.
val undo(const ComplexHandle& complex) {
  return guarded([&] {
    if (complex->changed_whole)
      throw geo::GeometryError("undo: the last edit changed the whole complex; copy it before such an edit");
    complex->complex.undo();
    if (const auto front = complex->moved.lock()) front->state = complex->before;
    complex->forget_front();
  });
}

// ---- Edits of the whole complex, after which its fronts have ended

void ended_fronts(Complex& complex, bool undone) {
  ++complex.changed;
  complex.forget_front();
  complex.changed_whole = !undone;
}

val join_small_pieces(const ComplexHandle& complex, const val& least) {
  return guarded([&] {
    val given = val::object();
    given.set("least", least);
    double volume = 0;
    take(given, "least", volume, 0, 1e200);
    const geo::Pieces pieces = geo::find_pieces(complex->complex);
    const auto group = geo::join_small_pieces(pieces.volume, geo::find_bonds(complex->complex, pieces), volume);
    ended_fronts(*complex, true);
    geo::heal(complex->complex, pieces, group);
  });
}

val remesh(const ComplexHandle& complex, const val& options, const val& progress) {
  return guarded([&] {
    geo::RemeshOptions o;
    take(options, "angle", o.angle, 0, 30);
    take(options, "deviation", o.deviation, 0, 1);
    std::vector<geo::FaceId> faces;
    for (std::uint32_t f = 0; f < complex->complex.face_count(); ++f) faces.emplace_back(f);
    const val made = changes(geo::remesh(complex->complex, faces, {}, o, nullptr, progress_to(progress)));
    ended_fronts(*complex, false);
    return made;
  });
}

val roughen(const ComplexHandle& complex, const val& options, const val& progress) {
  return guarded([&] {
    geo::RoughenOptions o;
    take(options, "amplitude", o.amplitude, 0, 1);
    take(options, "frequency", o.frequency, 0, 1e4);
    take(options, "octaves", o.octaves, 1, 16);
    take_seed(options, "seed", o.seed);
    const val made = changes(geo::roughen(complex->complex, {}, o, nullptr, progress_to(progress)));
    ended_fronts(*complex, false);
    return made;
  });
}

val decimate(const ComplexHandle& complex, const val& options, const val& progress) {
  return guarded([&] {
    geo::DecimateOptions o;
    int faces = 0;
    take(options, "deviation", o.deviation, 0, 1);
    take(options, "faces", faces, 0, std::numeric_limits<int>::max());
    o.faces = static_cast<std::size_t>(faces);
    const val made = changes(geo::decimate(complex->complex, {}, o, nullptr, progress_to(progress)));
    ended_fronts(*complex, false);
    return made;
  });
}

}  // namespace

EMSCRIPTEN_BINDINGS(kerf_edits) {
  emscripten::class_<Front>("FrontHandle").smart_ptr<FrontHandle>("FrontHandle");
  emscripten::function("beginFront", &begin_front);
  emscripten::function("advance", &advance);
  emscripten::function("frontCrack", &front_crack);
  emscripten::function("undo", &undo);
  emscripten::function("joinSmallPieces", &join_small_pieces);
  emscripten::function("remesh", &remesh);
  emscripten::function("roughen", &roughen);
  emscripten::function("decimate", &decimate);
}

}  // namespace kerf_js
