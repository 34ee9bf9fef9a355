// Procedural models at any resolution: closed, oriented outwards, free of self-intersection.
// Samples and tests use them.
#pragma once

#include <functional>

#include "kerf/mesh.h"

namespace geo {

/// A geodesic sphere of 20·frequency² triangles whose point in unit direction d is radius(d)·d;
/// frequency ≥ 1. Star-shaped, hence free of self-intersection, for any positive continuous radius.
/// Throws InputError for frequency < 1.
TriangleMesh make_star(int frequency, const std::function<double(const Vec3&)>& radius);

/// A unit sphere of 20·frequency² triangles.
TriangleMesh make_sphere(int frequency);
/// A pumpkin with nine lobes, flattened poles and a dimple at each, about 2 units across;
/// 20·frequency² triangles.
TriangleMesh make_pumpkin(int frequency);
/// An apple with a deep dimple at the stem and a shallow one below, about 2 units across;
/// 20·frequency² triangles.
TriangleMesh make_apple(int frequency);
/// A polyp: a bulb on a thin stalk that widens into its base; z upwards, about 2 units tall;
/// 20·frequency² triangles.
TriangleMesh make_polyp(int frequency);

/// An axis-aligned block [0, size] with faces divided so that no edge along an axis is longer than
/// `edge`. Throws InputError unless size and edge are positive.
TriangleMesh make_block(const Vec3& size, double edge);

/// A capital letter A–Z of height 1, drawn with a pen of width 0.2 and extruded to `depth` along z.
/// `resolution` is the number of cells per unit of height, at least 12. Throws InputError for a
/// character that is not in the alphabet.
TriangleMesh make_letter(char letter, double depth, int resolution);

}  // namespace geo
