// kerf-view: pictures, animations and an interactive page of surfaces, bodies, nodes, fronts and
// simulation runs.
#include <algorithm>
#include <cstdio>
#include <filesystem>

#include <kerf/body_file.h>
#include <kerf/files.h>
#include "tool.h"
#include "view/animation.h"
#include "view/compose.h"
#include "view/page.h"

namespace {

namespace fs = std::filesystem;

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

enum class Kind { png, webp, mp4, html };
Kind kind_of_output(const std::string& path) {
  if (path.ends_with(".html")) return Kind::html;
  if (path.ends_with(".webp")) return Kind::webp;
  return path.ends_with(".mp4") ? Kind::mp4 : Kind::png;
}

struct Command {
  std::vector<std::string> paths;
  std::string size, camera = "30,22", cutaway, color = "model", up = "auto", skin = "#e0803a", before, steps;
  bool no_ground = false, hollow = false;
  int columns = 4, frames = 0, samples = 3, node = -1;
  double zoom = 1, rate = 24, megabytes = 20;
};

view::Look checked(const Command& w, view::Look look) {
  if (w.samples < 1 || w.samples > 16 || w.frames < 0 || w.columns < 1)
    throw tool::UsageError("--samples and --columns must be positive, --frames not negative");
  if (!(look.opacity >= 0 && look.opacity <= 1) || !(look.explode >= 0) || !(w.zoom > 0))
    throw tool::UsageError("--opacity is from 0 to 1, --explode not negative, --zoom positive");
  if (!(w.rate > 0 && w.rate <= 1000)) throw tool::UsageError("--rate must be positive and at most 1000");
  if (!(w.megabytes >= 1 && w.megabytes <= 500)) throw tool::UsageError("--megabytes is from 1 to 500");
  if (w.node < -1) throw tool::UsageError("--node must not be negative");
  look.coloring = view::coloring_of(w.color);
  try {
    look.skin = view::parse_color(w.skin);
  } catch (const geo::InputError& e) {
    throw tool::UsageError(e.what());
  }
  char rest = 0;
  if (!w.steps.empty() && (std::sscanf(w.steps.c_str(), "%zu:%zu%c", &look.first_step, &look.last_step, &rest) != 2 ||
                           look.first_step > look.last_step))
    throw tool::UsageError("--steps '" + w.steps + "' is not A:B with A up to B");
  if (w.node >= 0) look.node = static_cast<std::uint32_t>(w.node);
  look.section = !w.hollow && !look.inside();
  if (!w.cutaway.empty()) {
    const auto plane = numbers(w.cutaway, 3, 4, "--cut-away '" + w.cutaway + "' is not NX,NY,NZ or NX,NY,NZ,OFFSET");
    look.cutaway = view::RelativePlane{{plane[0], plane[1], plane[2]}, plane.size() == 4 ? plane[3] : 0.0};
    if (!(look.cutaway->normal.norm() > 0)) throw tool::UsageError("--cut-away needs a direction");
  }
  return look;
}

// Indices of `shown` frames, evenly spaced, with the first and the last.
std::vector<std::string> spread(const std::vector<std::string>& files, int shown) {
  const int n = static_cast<int>(files.size());
  std::vector<std::string> some;
  shown = shown > 0 ? std::min(shown, n) : n;
  for (int i = 0; i < shown; ++i)
    some.push_back(files[static_cast<std::size_t>(shown > 1 ? i * (n - 1) / (shown - 1) : 0)]);
  return some;
}

class Drawing {
 public:
  Drawing(const Command& w, const view::Look& look, view::Camera eye, view::RenderOptions options,
          geo::Progress progress)
      : w_(w), look_(look), eye_(std::move(eye)), options_(options), progress_(std::move(progress)) {}

  view::Picture still() {
    const view::Subject subject = view::read_subject(w_.paths);
    view::Stage stage = staged(subject);
    look_at(stage);
    if (look_.node && w_.zoom > 1) {  // close-up: the node in the centre
      const geo::Vec3 away = subject.nodes.position[*look_.node] - eye_.box.center();
      eye_.box = {eye_.box.lo + away, eye_.box.hi + away};
      for (geo::Vec3& p : eye_.points) p += away;
      eye_.on_box = true;
    }
    geo::report(progress_, "render", 0, 1);
    return view::render(stage, eye_, options_);
  }
  view::Picture sheet(const std::vector<std::string>& files) {
    std::vector<view::Picture> pictures;
    std::vector<std::string> labels;
    look_around(files);
    for (const auto& file : files) {
      pictures.push_back(frame(file, pictures.size(), files.size()));
      labels.push_back(fs::path(file).stem().string());
    }
    return view::contact_sheet(pictures, labels, w_.columns);
  }
  // The frames of a run, or a turn around anything else.
  void animate(const std::string& target, const std::vector<std::string>& files) {
    const bool run = !files.empty();
    const int count = run ? static_cast<int>(files.size()) : w_.frames > 0 ? w_.frames : 72;
    view::Stage stage;
    if (run)
      look_around(files);
    else {
      stage = staged(view::read_subject(w_.paths));
      look_at(stage);
      eye_.all_round = true;
    }
    const view::Sequence picture = [&](int i) {
      if (run) return frame(files[static_cast<std::size_t>(i)], static_cast<std::size_t>(i), files.size());
      geo::report(progress_, "render", static_cast<std::size_t>(i), static_cast<std::size_t>(count));
      view::Camera eye = eye_;
      eye.azimuth += 360.0 * i / count;
      return view::render(stage, eye, options_);
    };
    if (kind_of_output(target) == Kind::mp4) return view::write_mp4(target, count, w_.rate, picture);
    geo::write_all(target, [&](std::ostream& out) { view::write_webp(out, count, w_.rate, picture); });
  }
  // Whether no image of a material was left out.
  bool complete() const { return complete_; }

 private:
  view::Stage staged(const view::Subject& subject) {
    view::Stage stage = view::stage_of(subject, look_);
    stage.ground = !w_.no_ground;
    complete_ = complete_ && stage.paint.complete;
    return stage;
  }
  // Extends the view to another stage.
  void look_at(const view::Stage& stage) {
    const geo::Box3 frame = view::frame_of(stage);
    if (frame.empty()) return;
    eye_.box.add(frame);
    view::add_outermost(stage, eye_.box, eye_.points);
  }
  // One camera and one floor for all frames.
  void look_around(const std::vector<std::string>& files) {
    for (const auto& file : files) {
      const view::Stage stage = staged(view::read_subject({file}));
      look_at(stage);
      all_.add(view::box_of(stage));
    }
  }
  view::Picture frame(const std::string& file, std::size_t i, std::size_t count) {
    geo::report(progress_, "render", i, count);
    view::Stage stage = staged(view::read_subject({file}));
    stage.ground_level = all_.lo[eye_.y_up ? 1 : 2] - 1e-4 * all_.diagonal();
    return view::render(stage, eye_, options_);
  }

  const Command& w_;
  const view::Look& look_;
  view::Camera eye_;
  geo::Box3 all_;  // of all frames
  bool complete_ = true;
  view::RenderOptions options_;
  geo::Progress progress_;
};

}  // namespace

int main(int argc, char** argv) {
  tool::Tool t(
      "kerf-view",
      "Draws files, or a run's frames: a picture (.png), an animation (.webp, .mp4) or a page for the browser (.html).",
      R"(  kerf-view cut.kerf -o cut.html
  kerf-view out/halve -o halve.html
  kerf-view cut.ply --explode 0.4 -o cut.png
  kerf-view cut.kerf --nodes --opacity 0.25 -o nodes.png
  kerf-view bear.kerf --nodes --edges --cut-away 0,-1,0 -o inside.png
  kerf-view cut.kerf --node 100 --before bear.kerf --cut-edges --opacity 0.2 -o near.png
  kerf-view cut.ply halve.front -o both.png
  kerf-view out/halve -o sheet.png
  kerf-view out/halve -o halve.webp)");
  Command w;
  view::Look look;
  t.argument("FILE", w.paths,
             "Surface, body, node and front files, together in one picture; or the folder of a kerf-sim run");
  t.option("--size", w.size, "Width x height in pixels (960x720; 480x360 on a sheet and animated)");
  t.option("--camera", w.camera, "Azimuth, elevation in degrees");
  t.option("--zoom", w.zoom, "1 shows everything; above it the node of --node is in the middle");
  t.choice("--up", w.up, {"auto", "z", "y"},
           "Which axis of the model is up, y in most OBJ and glTF files; auto: of a run what gravity says, else z");
  t.option("--cut-away", w.cutaway, "Remove what lies beyond the plane NX,NY,NZ[,OFFSET] (offset in half diagonals)");
  t.flag("--hollow", w.hollow, "Look into the cut-away body instead of at a filled section");
  t.choice("--color", w.color, {"model", "patch", "piece", "plain"},
           "Colours: the model's materials and colours, where it has them; skin and the two sheets of cracks; pieces; "
           "or one");
  t.option("--skin", w.skin, "Colour of the skin, #rrggbb, where the model brings none");
  t.flag("--nodes", look.nodes, "Draw a body's nodes, coloured by --field");
  t.option("--field", look.field,
           "radius, spacing, volume, neighbors, component or debris; of a run strain, displacement, speed");
  t.flag("--edges", look.edges, "Draw a body's visibility edges");
  t.flag("--cut-edges", look.cut_edges, "Draw the edges that cracks have cut, in red");
  t.option("--before", w.before,
           "The body before it was cut: cut edges are those it had, nodes whose neighbours changed are red");
  t.option("--node", w.node, "Draw the neighbourhood of this node, from 0: blue sees it, orange is behind a face");
  t.flag("--trees", look.trees,
         "Draw masters (their nodes' links red) and trees of slaves; with --node those of one node");
  t.flag("--seams", look.seams, "Draw where cracks meet the skin, green, and where they end, red");
  t.option("--steps", w.steps, "Draw fronts from time step A to B, as A:B");
  t.flag("--wire", look.wire, "Draw the triangles' edges");
  t.option("--opacity", look.opacity, "Of the surface, 0 to 1");
  t.flag("--sheets", look.sheets, "With --opacity: the skin is see-through, cracks are not");
  t.option("--explode", look.explode, "Move pieces apart by this fraction");
  t.flag("--no-ground", w.no_ground, "No floor");
  t.option("--frames", w.frames, "Frames on a sheet (12), in an animation (a run: all, else 72 once around)");
  t.option("--columns", w.columns, "Columns of a sheet");
  t.option("--rate", w.rate, "Frames a second, of animations and pages");
  t.option("--samples", w.samples, "Rays a pixel and direction");
  t.option("--megabytes", w.megabytes, "A page stays below; what is too large for it is made coarser");
  t.output("PNG, WebP, MP4 or HTML file, told by the name's end", {".png", ".webp", ".mp4", ".html"});
  return t.run(argc, argv, [&] {
    if (w.paths.empty()) throw tool::UsageError("give a file, or the folder of a run");
    look = checked(w, look);
    const bool folder = fs::is_directory(w.paths[0]);
    if (folder && w.paths.size() > 1) throw tool::UsageError("give one folder, or files");
    const Kind kind = kind_of_output(t.output_path);
    view::RenderOptions options;
    const bool small = folder || kind == Kind::webp || kind == Kind::mp4;
    options.width = small ? 480 : 960;
    options.height = small ? 360 : 720;
    options.samples = w.samples;
    char rest = 0;
    if (!w.size.empty() &&
        (std::sscanf(w.size.c_str(), "%dx%d%c", &options.width, &options.height, &rest) != 2 ||
         std::min(options.width, options.height) < 8 || std::max(options.width, options.height) > 16384))
      throw tool::UsageError("--size '" + w.size + "' is not WIDTHxHEIGHT");
    view::Camera eye;
    const auto angles = numbers(w.camera, 2, 2, "--camera '" + w.camera + "' is not AZIMUTH,ELEVATION");
    eye.azimuth = angles[0];
    eye.elevation = angles[1];
    eye.zoom = w.zoom;
    eye.y_up = w.up == "y" || (w.up == "auto" && folder && view::find_run(w.paths[0]).y_up);
    const std::string target = t.target(true);
    const auto progress = t.progress();
    std::optional<geo::Body> before;
    if (!w.before.empty()) {
      before = geo::read_body(w.before);
      look.before = &*before;
    }

    if (kind == Kind::html) {
      const view::PageOptions page_options{
          .megabytes = w.megabytes, .before = look.before, .frame_rate = w.rate, .y_up = eye.y_up, .color = w.color};
      const view::Page page = folder ? view::page_of(view::find_run(w.paths[0]), page_options, progress)
                                     : view::page_of(view::read_subject(w.paths), page_options, progress);
      geo::report(progress, "done", 1, 1);
      geo::write_all(target, [&](std::ostream& out) { out << page.html; });
      for (const auto& notice : page.notices) t.say("kerf-view: " + notice);
      return;
    }
    Drawing drawing(w, look, eye, options, progress);
    std::vector<std::string> files;
    if (folder) files = spread(view::find_run(w.paths[0]).frames, w.frames > 0 || kind != Kind::png ? w.frames : 12);
    if (kind == Kind::png) {
      const view::Picture picture = folder ? drawing.sheet(files) : drawing.still();
      geo::report(progress, "done", 1, 1);
      geo::write_all(target, [&](std::ostream& out) { view::write_png(out, picture); });
    } else {
      drawing.animate(target, files);
    }
    if (!drawing.complete()) t.say(std::string("kerf-view: ") + view::images_left_out);
  });
}
