// kerf-model: writes the procedural models of the samples, and fronts that halve a model.
#include <algorithm>
#include <cmath>
#include <numbers>

#include <kerf/error.h>
#include <kerf/files.h>
#include <kerf/mesh.h>
#include "tool.h"

namespace {

// A hemisphere of radius 1 with a wall of 0.15, open at its top: its profile turned about z.
geo::TriangleMesh make_bowl(int frequency) {
  const int around = 8 * frequency, along = 2 * frequency;
  geo::TriangleMesh mesh;
  const auto add_pole = [&](double radius) {
    mesh.vertices.push_back({0, 0, -radius});
    return static_cast<std::uint32_t>(mesh.vertices.size() - 1);
  };
  // Rings from the pole upwards; the last one is the rim.
  const auto add_rings = [&](double radius) {
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    for (int i = 1; i <= along; ++i)
      for (int k = 0; k < around; ++k) {
        const double polar = 0.5 * std::numbers::pi * i / along, turn = 2 * std::numbers::pi * k / around;
        mesh.vertices.push_back(
            radius * geo::Vec3(std::sin(polar) * std::cos(turn), std::sin(polar) * std::sin(turn), -std::cos(polar)));
      }
    return first;
  };
  const auto outer_pole = add_pole(1), outer = add_rings(1), inner_pole = add_pole(0.85), inner = add_rings(0.85);
  const auto n = static_cast<std::uint32_t>(around), rim = n * static_cast<std::uint32_t>(along - 1);
  const auto add = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) { mesh.triangles.push_back({a, b, c}); };
  for (std::uint32_t k = 0; k < n; ++k) {
    const std::uint32_t l = (k + 1) % n;
    add(outer_pole, outer + l, outer + k);
    add(inner_pole, inner + k, inner + l);
    for (std::uint32_t r = 0; r < rim; r += n) {
      add(outer + r + k, outer + r + l, outer + r + n + l);
      add(outer + r + k, outer + r + n + l, outer + r + n + k);
      add(inner + r + k, inner + r + n + l, inner + r + l);
      add(inner + r + k, inner + r + n + k, inner + r + n + l);
    }
    add(outer + rim + k, outer + rim + l, inner + rim + l);
    add(outer + rim + k, inner + rim + l, inner + rim + k);
  }
  return mesh;
}

}  // namespace

int main(int argc, char** argv) {
  tool::Tool t("kerf-model", "Makes a sample model, or a front that sweeps through the middle of a model.",
               R"(  kerf-model pumpkin --frequency 22 -o pumpkin.ply
  kerf-model letter --text K -o k.ply
  kerf-model front --around bear.off --steps 12 -o halve.front)");
  std::string kind, text = "K", around, size = "2,1,1";
  int frequency = 22, resolution = 24, steps = 12, points = 24;
  double edge = 0.1, depth = 0.25, bend = 0.06, tilt = 7;
  t.argument("KIND", kind, "pumpkin, apple, polyp, sphere, bowl, block, plate, letter, or front");
  t.option("--frequency", frequency, "Of pumpkin, apple, polyp, sphere: 20 f^2 triangles; of a bowl: 64 f^2");
  t.option("--size", size, "Of a block: X,Y,Z");
  t.option("--edge", edge, "Of a block or plate (2 x 1 x 0.12): longest edge along an axis");
  t.option("--text", text, "Of a letter: A to Z");
  t.option("--depth", depth, "Of a letter");
  t.option("--resolution", resolution, "Of a letter: cells per unit of height");
  t.option("--around", around, "Of a front: the model");
  t.option("--steps", steps, "Of a front: time steps swept");
  t.option("--points", points, "Of a front");
  t.option("--bend", bend, "Of a front: how far the sheet bends, as a fraction of the diagonal");
  t.option("--tilt", tilt, "Of a front: degrees about the model's longest axis");
  t.output("PLY or front file", {".ply", ".front", ".vdb"});
  return t.run(argc, argv, [&] {
    const std::string target = t.target(kind != "front");
    if (kind == "front") {
      if (around.empty() || steps < 1 || points < 2)
        throw tool::UsageError("a front needs --around MODEL, --steps of 1 and --points of 2 at least");
      const auto mesh = geo::read_surface(around).mesh;
      const geo::Box3 box = geo::bounding_box(mesh);
      // Across the longest axis, downwards along the next, tilted and bent to avoid degenerate
      // cases.
      int axis[3] = {0, 1, 2};
      const geo::Vec3 size = box.hi - box.lo;
      std::sort(axis, axis + 3, [&](int a, int b) { return size[a] > size[b]; });
      const double d = box.diagonal(), angle = tilt * 3.14159265358979 / 180;
      geo::Vec3 normal = geo::Vec3::Zero(), down = geo::Vec3::Zero(), along = geo::Vec3::Zero();
      normal[axis[0]] = 1;
      down[axis[1]] = -1;
      along[axis[2]] = 1;
      const geo::Vec3 n = std::cos(angle) * normal + std::sin(angle) * along,
                      a = std::cos(angle) * along - std::sin(angle) * normal;
      geo::Front front{"halve", false, {}};
      for (int s = 0; s <= steps; ++s) {
        front.steps.emplace_back();
        for (int i = 0; i < points; ++i) {
          const double u = double(s) / steps - 0.5, v = double(i) / (points - 1) - 0.5;
          front.steps.back().push_back(box.center() + 1.13 * d * (u * down + v * a) +
                                       d * (0.0031 + bend * std::sin(4 * u + 1) * std::cos(5 * v + 0.4)) * n);
        }
      }
      geo::write_all(target, [&](std::ostream& out) { geo::write_fronts(out, {front}); });
      return;
    }
    geo::TriangleMesh mesh;
    if (kind == "pumpkin")
      mesh = geo::make_pumpkin(frequency);
    else if (kind == "apple")
      mesh = geo::make_apple(frequency);
    else if (kind == "polyp")
      mesh = geo::make_polyp(frequency);
    else if (kind == "sphere")
      mesh = geo::make_sphere(frequency);
    else if (kind == "bowl")
      mesh = make_bowl(std::max(1, frequency));
    else if (kind == "block")
      mesh = geo::make_block(tool::parse_vector("--size", size), edge);
    else if (kind == "plate")
      mesh = geo::make_block({2, 1, 0.12}, edge);
    else if (kind == "letter" && text.size() == 1)
      mesh = geo::make_letter(text[0], depth, resolution);
    else if (kind == "letter")
      throw tool::UsageError("--text '" + text + "' is no letter from A to Z");
    else
      throw tool::UsageError("'" + kind + "' is none of its models" +
                             geo::did_you_mean(kind, {"pumpkin", "apple", "polyp", "sphere", "bowl", "block", "plate",
                                                      "letter", "front"}));
    if (target.ends_with(".vdb")) return geo::write_level_set(target, mesh, 0.02 * geo::bounding_box(mesh).diagonal());
    geo::write_all(target, [&](std::ostream& out) { geo::write_ply(out, mesh, {}, "kerf-model " + kind); });
  });
}
