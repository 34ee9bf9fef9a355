// kerf-view: pictures of surfaces, bodies, nodes, fronts and simulation runs, without a display.
#include <algorithm>
#include <cstdio>
#include <filesystem>

#include "io/body_file.h"
#include "io/front_file.h"
#include "io/node_file.h"
#include "io/stream.h"
#include "io/surface_file.h"
#include "kind.h"
#include "tool.h"
#include "view/compose.h"

namespace {

view::Stage load(const std::string& path, const view::Look& look) {
  const std::string bytes = geo::read_all(path);
  switch (tool::kind_of(bytes, path)) {
    case tool::Kind::body: return view::stage_of(geo::parse_body(bytes, path), look);
    case tool::Kind::nodes: return view::stage_of(geo::parse_nodes(bytes, path), look);
    case tool::Kind::fronts: return view::stage_of(geo::parse_fronts(bytes, path), look);
    case tool::Kind::surface: break;
  }
  return view::stage_of(geo::parse_surface(bytes, path).mesh, look);
}

std::vector<double> numbers(const std::string& text, std::size_t least, std::size_t most, const std::string& what) {
  std::vector<double> values;
  const char* at = text.c_str();
  while (*at) {
    char* end = nullptr;
    values.push_back(std::strtod(at, &end));
    if (end == at) break;
    at = *end == ',' ? end + 1 : end;
    if (*end && *end != ',') break;
  }
  if (*at || values.size() < least || values.size() > most) throw tool::UsageError(what);
  return values;
}

}  // namespace

int main(int argc, char** argv) {
  tool::Tool t("kerf-view", "Draws a file, or a run's frames on one sheet, as PNG by ray tracing.",
               "  kerf-view cut.ply --explode 0.4 -o cut.png\n  kerf-view cut.kerf --nodes --opacity 0.25 -o nodes.png\n  kerf-view bear.kerf --nodes --edges --cut-away 0,-1,0 -o inside.png\n  kerf-view out/halve -o sheet.png");
  std::string path, size, camera = "30,22", cutaway, color = "patch", skin = "#e0803a";
  view::Look look;
  bool no_ground = false, hollow = false;
  double zoom = 1;
  int columns = 4, frames = 12, samples = 3;
  t.argument("FILE", path, "Surface, body, nodes or front file, or the folder of a kerf-sim run");
  t.option("--size", size, "Width x height in pixels (960x720; 480x360 on a sheet)");
  t.option("--camera", camera, "Azimuth, elevation in degrees");
  t.option("--zoom", zoom, "1 shows everything");
  t.option("--cut-away", cutaway, "Remove what lies beyond the plane NX,NY,NZ[,OFFSET] (offset in half diagonals)");
  t.flag("--hollow", hollow, "Look into the cut-away body instead of at a filled section");
  t.option("--color", color, "patch (skin and the two sheets of cracks), piece, or plain");
  t.option("--skin", skin, "Colour of the skin, #rrggbb");
  t.flag("--nodes", look.nodes, "Draw a body's nodes, coloured by support radius");
  t.flag("--edges", look.edges, "Draw a body's visibility edges");
  t.flag("--wire", look.wire, "Draw the triangles' edges");
  t.option("--opacity", look.opacity, "Of the surface, 0 to 1");
  t.flag("--sheets", look.sheets, "With --opacity: the skin is see-through, cracks are not");
  t.option("--explode", look.explode, "Move pieces apart by this fraction");
  t.flag("--no-ground", no_ground, "No floor");
  t.option("--frames", frames, "Frames on a sheet");
  t.option("--columns", columns, "Columns of a sheet");
  t.option("--samples", samples, "Rays a pixel and direction");
  t.output("PNG file");
  return t.run(argc, argv, [&] {
    namespace fs = std::filesystem;
    const bool sheet = fs::is_directory(path);
    int width = sheet ? 480 : 960, height = sheet ? 360 : 720;
    char rest = 0;
    if (!size.empty() && (std::sscanf(size.c_str(), "%dx%d%c", &width, &height, &rest) != 2 || width < 8 || height < 8 || width > 16384 || height > 16384)) throw tool::UsageError("--size '" + size + "' is not WIDTHxHEIGHT");
    if (samples < 1 || samples > 16 || frames < 1 || columns < 1) throw tool::UsageError("--samples, --frames and --columns must be positive");
    if (!(look.opacity >= 0 && look.opacity <= 1) || !(look.explode >= 0) || !(zoom > 0)) throw tool::UsageError("--opacity is from 0 to 1, --explode not negative, --zoom positive");
    if (color == "piece") look.coloring = view::Coloring::piece;
    else if (color == "plain") look.coloring = view::Coloring::plain;
    else if (color != "patch") throw tool::UsageError("--color must be patch, piece or plain");
    try {
      look.skin = view::parse_color(skin);
    } catch (const geo::InputError& e) {
      throw tool::UsageError(e.what());
    }
    look.section = !hollow && !look.nodes && !look.edges;
    view::Camera eye;
    const auto angles = numbers(camera, 2, 2, "--camera '" + camera + "' is not AZIMUTH,ELEVATION");
    eye.azimuth = angles[0], eye.elevation = angles[1], eye.zoom = zoom;
    if (!cutaway.empty()) {
      const auto plane = numbers(cutaway, 3, 4, "--cut-away '" + cutaway + "' is not NX,NY,NZ or NX,NY,NZ,OFFSET");
      look.cutaway = view::RelativePlane{{plane[0], plane[1], plane[2]}, plane.size() == 4 ? plane[3] : 0.0};
      if (!(look.cutaway->normal.norm() > 0)) throw tool::UsageError("--cut-away needs a direction");
    }
    view::RenderOptions options;
    options.width = width, options.height = height, options.samples = samples;
    const std::string target = t.target(true);
    const auto progress = t.progress();
    view::Picture picture;
    if (!sheet) {
      view::Stage stage = load(path, look);
      stage.ground = !no_ground;
      eye.box = view::box_of(stage);
      geo::report(progress, "render", 0, 1);
      picture = view::render(stage, eye, options);
    } else {
      std::vector<std::string> files;
      const fs::path folder = fs::is_directory(fs::path(path) / "frames") ? fs::path(path) / "frames" : fs::path(path);
      for (const auto& entry : fs::directory_iterator(folder))
        if (entry.path().extension() == ".ply") files.push_back(entry.path().string());
      std::sort(files.begin(), files.end());
      if (files.empty()) throw geo::InputError(path + ": holds no frames");
      std::vector<view::Stage> stages;
      std::vector<std::string> labels;
      const int n = static_cast<int>(files.size()), shown = std::min(frames, n);
      for (int i = 0; i < shown; ++i) {
        const auto& file = files[static_cast<std::size_t>(shown > 1 ? i * (n - 1) / (shown - 1) : 0)];
        stages.push_back(load(file, look));
        stages.back().ground = !no_ground;
        labels.push_back(fs::path(file).stem().string());
        eye.box.add(view::box_of(stages.back()));
      }
      std::vector<view::Picture> pictures;
      for (int i = 0; i < shown; ++i) {
        geo::report(progress, "render", static_cast<std::size_t>(i), static_cast<std::size_t>(shown));
        stages[static_cast<std::size_t>(i)].ground_level = eye.box.lo.z() - 1e-4 * eye.box.diagonal();
        pictures.push_back(view::render(stages[static_cast<std::size_t>(i)], eye, options));
      }
      picture = view::contact_sheet(pictures, labels, columns);
    }
    geo::report(progress, "done", 1, 1);
    geo::write_all(target, [&](std::ostream& out) { view::write_png(out, picture); });
  });
}
