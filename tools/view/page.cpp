// Content is packed at a budget of triangles, nodes and pairs. If the page is too large, the budget
// is reduced in proportion and the page is made again.
#include "view/page.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <numeric>
#include <optional>

#include <kerf/files.h>
#include "run_materials.h"
#include "version.h"
#include "view/cut_edges.h"
#include "view/fields.h"
#include "view/moving_nodes.h"
#include "view/pack.h"
#include "view/page_paint.h"
#include "view/page_template.h"
#include "view/pieces.h"
#include "view/shrink.h"

namespace view {
namespace {

using json = nlohmann::ordered_json;
using Numbers = std::vector<std::uint32_t>;

// Limits for the content of a page; more is made coarser.
struct Budget {
  double triangles = 5e6, nodes = 2e5, pairs = 4e6;
};

const std::string made = std::string("kerf-view ") + KERF_VERSION;

std::string counted(std::size_t n, const char* what) { return std::to_string(n) + " " + what; }

class Writer {
 public:
  // `paint`: of the surfaces; none: they have colours of their patches.
  Writer(const geo::Box3& box, const Budget& budget, PagePaint* paint) : box_(box), budget_(budget), paint_(paint) {}

  // Adds one frame, or a single surface, with at most `most` triangles. True where its vertices are
  // those of the mesh.
  bool add_surface(const geo::TriangleMesh& mesh, const std::string& label, double most) {
    PieceMap pieces = pieces_of(mesh);
    const bool coarse = double(mesh.triangles.size()) > most;
    geo::TriangleMesh few;
    if (coarse) {
      Numbers kept, piece;
      few = shrink(mesh, pieces.of_row, static_cast<std::size_t>(most), kept);
      for (const auto v : kept) piece.push_back(pieces.of_row[v]);
      pieces.of_row = piece;
      notice("decimated", "Surface decimated for this page: " + std::to_string(few.triangles.size()) + " of " +
                              counted(mesh.triangles.size(), "triangles shown"));
    }
    const geo::TriangleMesh& shown = coarse ? few : mesh;
    Numbers corners, patch(shown.patch.begin(), shown.patch.end());
    for (const auto& t : shown.triangles) corners.insert(corners.end(), t.begin(), t.end());
    const std::string name = "surface" + std::to_string(about_["surfaces"].size()) + "/";
    about_["surfaces"].push_back(
        {{"label", label},
         {"position", name + "position"},
         {"triangles", shared(name, "triangles", corners, shown.vertices.size() < 65536 ? 2 : 4, 3)},
         {"patch", shared(name, "patch", patch, 4, 1)},
         {"piece", shared(name, "piece", pieces.of_row, 4, 1)}});
    if (paint_ && has_paint(mesh)) {
      if (coarse)
        notice("paint", "Decimated surfaces are shown without the model's materials and colours");
      else
        add_paint(paint_->of(mesh), name);
    }
    const std::string last = last_["position"];
    pack_.points(name + "position", shown.vertices, box_,
                 !last.empty() && pack_.length(last) == 3 * shown.vertices.size() ? last : "");
    last_["position"] = name + "position";
    return !coarse;
  }

  // Adds the obstacles: a mesh for each frame, with equal triangles.
  void add_obstacles(const std::vector<geo::TriangleMesh>& frames, double most) {
    if (frames.empty()) return;
    geo::Box3 around;
    for (const auto& mesh : frames) around.add(geo::bounding_box(mesh));
    Numbers kept, corners;
    const geo::TriangleMesh shown =
        double(frames[0].triangles.size()) > most
            ? shrink(frames[0], Numbers(frames[0].vertices.size(), 0), static_cast<std::size_t>(most), kept)
            : frames[0];
    if (!kept.empty())
      notice("obstacles", "Obstacles decimated for this page: " + std::to_string(shown.triangles.size()) + " of " +
                              counted(frames[0].triangles.size(), "triangles shown"));
    if (kept.empty()) {
      kept.resize(shown.vertices.size());
      std::iota(kept.begin(), kept.end(), 0u);
    }
    for (const auto& t : shown.triangles) corners.insert(corners.end(), t.begin(), t.end());
    pack_.whole("obstacles/triangles", corners, 4, 3);
    std::string last;
    for (std::size_t f = 0; f < frames.size(); ++f) {
      std::vector<geo::Vec3> at;
      for (const auto v : kept) at.push_back(frames[f].vertices[v]);
      const std::string name = "obstacles/at" + std::to_string(f);
      pack_.points(name, at, box_, around, last);
      about_["obstacles"].push_back(last = name);
    }
  }

  // Adds nodes with all their data. `rest`: the surface in material coordinates; `whole`: with all
  // of its vertices.
  void add_nodes(const Subject& subject, int rest, bool whole, const geo::Body* before,
                 const MovingNodes& moving = {}) {
    const geo::NodeSet& nodes = subject.nodes;
    const std::size_t n = nodes.size();
    if (n == 0) return;
    const std::size_t step =
        double(n) > budget_.nodes ? static_cast<std::size_t>(std::ceil(double(n) / budget_.nodes)) : 1;
    if (step > 1)
      notice("nodes", "One node in " + std::to_string(step) + " of " + std::to_string(n) + " shown, without the graph");
    json& about = about_["nodes"];
    const auto thinned = [&](const auto& values) {
      std::remove_cvref_t<decltype(values)> kept;
      for (std::size_t i = 0; i < n; i += step) kept.push_back(values[i]);
      return kept;
    };
    about = {{"count", (n + step - 1) / step}, {"step", step},           {"rest", rest},
             {"frame", subject.frame},         {"graph", false},         {"tree", false},
             {"fields", json::array()},        {"frames", json::array()}};
    pack_.points("nodes/rest", thinned(nodes.position), box_);
    double most = 0;
    for (const auto& frame : moving.frames)
      most = std::max(most, *std::max_element(frame.stress.begin(), frame.stress.end()));
    std::string position = "nodes/rest", stress;
    for (std::size_t f = 0; f < moving.frames.size(); ++f) {
      const auto& frame = moving.frames[f];
      const std::string number = std::to_string(f);
      pack_.points("nodes/at" + number, thinned(frame.position), box_, position);
      pack_.scaled("stress/at" + number, thinned(frame.stress), 0, most, stress);
      position = "nodes/at" + number;
      stress = "stress/at" + number;
      about["frames"].push_back({{"count", (frame.count + step - 1) / step},
                                 {"position", position},
                                 {"stress", stress},
                                 {"pieces", frame.piece_of}});
    }
    if (!moving.frames.empty()) {
      about["fields"].push_back("stress");
      about["stress"] = {0, moving.stress_shown};
    }
    const double unit = std::max(0.5 * box_.diagonal(), 1e-300);
    std::vector<double> size;
    for (const double s : nodes.spacing) size.push_back(s / unit);
    pack_.scaled("nodes/size", thinned(size));
    for (const auto& f : node_fields(subject)) {
      pack_.scaled("field/" + f.name, thinned(f.values));
      about["fields"].push_back(f.name);
    }
    if (!subject.body) return;
    pack_.whole("nodes/piece", thinned(pieces_of_nodes(subject, pieces_of(subject.surface))), 4, 1);
    if (step == 1) add_graph(*subject.body, before, about);
    if (step == 1 && whole) add_tree(subject, about);
  }

  void add_fronts(const std::vector<geo::Front>& fronts) {
    for (std::size_t f = 0; f < fronts.size(); ++f) {
      std::vector<geo::Vec3> points;
      json counts = json::array();
      for (const auto& step : fronts[f].steps) {
        points.insert(points.end(), step.begin(), step.end());
        counts.push_back(step.size());
      }
      const std::string name = "front" + std::to_string(f);
      pack_.points(name, points, box_);
      about_["fronts"].push_back(
          {{"name", fronts[f].name}, {"closed", fronts[f].closed}, {"steps", counts}, {"points", name}});
    }
  }

  Page page(const std::string& title, const PageOptions& options) {
    about_["title"] = title;
    about_["rate"] = options.frame_rate;
    about_["y_up"] = options.y_up;
    about_["unit"] = 0.5 * box_.diagonal();
    about_["made"] = made;
    about_["color"] = options.color;
    about_["paint"] = paint_ ? paint_->about() : json(nullptr);
    about_["arrays"] = pack_.manifest();
    if (paint_ && !paint_->complete()) notice("images", images_left_out);
    Page page;
    for (const auto& [key, text] : notice_of_) page.notices.push_back(text);
    about_["notices"] = page.notices;
    std::string text = about_.dump(-1, ' ', true, json::error_handler_t::replace);
    // A file's name may contain </script> or a placeholder.
    for (std::size_t at = 0; (at = text.find_first_of("<@", at)) != std::string::npos;)
      text.replace(at, 1, text[at] == '<' ? "\\u003c" : "\\u0040");
    page.html = page_template();
    const auto put = [&](const std::string& mark, const std::string& what) {
      page.html.replace(page.html.find(mark), mark.size(), what);
    };
    put("@ABOUT@", text);
    put("@DATA@", pack_.text());
    return page;
  }

 private:
  // Materials, places in images and colours of the last surface's triangles.
  void add_paint(const PaintArrays& paint, const std::string& name) {
    about_["surfaces"].back()["paint"] = {{"material", shared(name, "material", paint.material, 4, 1)},
                                          {"u", shared(name, "u", paint.u.steps, 2, 1)},
                                          {"v", shared(name, "v", paint.v.steps, 2, 1)},
                                          {"lo", {paint.u.lo, paint.v.lo}},
                                          {"step", {paint.u.step, paint.v.step}},
                                          {"tint", shared(name, "tint", paint.tint, 1, 3)}};
  }

  void notice(const std::string& key, const std::string& text) { notice_of_.try_emplace(key, text); }

  // An array that often equals that of the frame before.
  std::string shared(const std::string& name, const std::string& kind, const Numbers& values, int width, int columns) {
    std::string& last = last_[kind];
    if (!last.empty() && pack_.holds(last, values)) return last;
    const bool alike = !last.empty() && pack_.length(last) == values.size();
    pack_.whole(name + kind, values, width, columns, alike && kind != "triangles" ? last : "");
    return last = name + kind;
  }

  void add_graph(const geo::Body& body, const geo::Body* before, json& about) {
    Numbers count, to, bits;
    std::vector<double> distance;
    for (std::uint32_t i = 0; i < body.nodes.size(); ++i) {
      const geo::AdjacencyRow row = body.graph.row(geo::NodeId(i));
      std::size_t path = 0, had = to.size();
      for (std::size_t e = 0; e < row.to.size(); ++e) {
        const bool behind = geo::AdjacencyRow::has_path(row.bits[e]);
        const float length = behind ? row.paths[path++] : 0;
        const std::uint32_t j = row.to[e];
        if (geo::VisibilityGraph::is_guide(j) || j < i) continue;
        to.push_back(j);
        bits.push_back(geo::AdjacencyRow::is_edge(row.bits[e]) | geo::AdjacencyRow::is_neighbor(row.bits[e]) << 1 |
                       behind << 2);
        distance.push_back((behind ? double(length) : (body.nodes.position[i] - body.nodes.position[j]).norm()) /
                           std::max(0.5 * box_.diagonal(), 1e-300));
      }
      count.push_back(static_cast<std::uint32_t>(to.size() - had));
    }
    if (double(to.size()) > budget_.pairs)
      return notice("graph",
                    "The graph has " + counted(to.size(), "edges and pairs of neighbours: too many for this page"));
    pack_.whole("graph/count", count, 4, 1);
    pack_.whole("graph/to", to, 4, 1);
    pack_.whole("graph/bits", bits, 1, 1);
    pack_.scaled("graph/distance", distance);
    Numbers pairs;
    for (const auto& [i, j] : cut_edges(body, before)) {
      pairs.push_back(i);
      pairs.push_back(j);
    }
    pack_.whole("graph/cut", pairs, 4, 2);
    if (before) {
      const auto updated = updated_nodes(body, *before);
      pack_.whole("nodes/updated", {updated.begin(), updated.end()}, 1, 1);
    }
    about["updated"] = before != nullptr;
    about["graph"] = true;
  }

  void add_tree(const Subject& subject, json& about) {
    const geo::Binding& binding = subject.body->binding;
    Numbers parent(subject.surface.vertices.size()), node(subject.surface.vertices.size());
    for (std::uint32_t v = 0; v < subject.row_of.size(); ++v) {
      const std::uint32_t row = subject.row_of[v];
      if (row == ~0u) continue;
      const auto up = binding.parent[v];
      parent[row] = up.valid() ? subject.row_of[up.index()] : row;
      node[row] = binding.master_node[v].valid() ? binding.master_node[v].value + 1 : 0;
    }
    pack_.whole("tree/parent", parent, 4, 1);
    pack_.whole("tree/node", node, 4, 1);
    about["tree"] = true;
  }

  geo::Box3 box_;
  Budget budget_;
  PagePaint* paint_;
  Pack pack_;
  json about_ = {
      {"surfaces", json::array()}, {"obstacles", json::array()}, {"fronts", json::array()}, {"nodes", nullptr}};
  std::map<std::string, std::string> notice_of_;
  std::map<std::string, std::string> last_;
};

// Reduces the limits until the page is small enough.
Page fitted(const PageOptions& options, const Budget& needed, const std::function<Page(const Budget&)>& attempt) {
  Budget budget;
  budget = {std::min(budget.triangles, needed.triangles), std::min(budget.nodes, needed.nodes),
            std::min(budget.pairs, needed.pairs)};
  for (;;) {
    Page page = attempt(budget);
    // Below 1000 triangles and nodes, a smaller budget saves nothing. The clamp bounds the number
    // of attempts.
    const double room = options.megabytes * 1e6 / double(page.html.size());
    if (room >= 1 || budget.triangles + budget.nodes < 1000) return page;
    for (double* b : {&budget.triangles, &budget.nodes, &budget.pairs}) *b *= std::clamp(0.9 * room, 0.2, 0.8);
  }
}

Budget needs_of(const Subject& subject) {
  Budget needed{double(subject.surface.triangles.size()), double(subject.nodes.size()), 0};
  if (subject.body)
    for (std::uint32_t i = 0; i < subject.nodes.size(); ++i)
      needed.pairs += double(subject.body->graph.row(geo::NodeId(i)).to.size()) / 2;
  return needed;
}

geo::Box3 box_of_points(const Subject& subject) {
  geo::Box3 box = geo::bounding_box(subject.surface);
  for (const auto& p : subject.nodes.position) box.add(p);
  for (const auto& front : subject.fronts)
    for (const auto& step : front.steps)
      for (const auto& p : step) box.add(p);
  return box;
}

// Images take at most a third of the page, so that the surface keeps the greater part.
std::optional<PagePaint> paint_for(const PageOptions& options) {
  if (options.color != "model") return std::nullopt;
  return PagePaint(static_cast<std::size_t>(options.megabytes * 1e6 / 3));
}

}  // namespace

Page page_of(const Subject& subject, const PageOptions& options, const geo::Progress& progress) {
  const geo::Box3 box = box_of_points(subject);
  auto paint = paint_for(options);
  return fitted(options, needs_of(subject), [&](const Budget& budget) {
    geo::report(progress, "page", 0, 1);
    Writer writer(box, budget, paint ? &*paint : nullptr);
    const bool some = !subject.surface.triangles.empty();
    const bool whole = some && writer.add_surface(subject.surface, subject.title, budget.triangles);
    writer.add_nodes(subject, some ? 0 : -1, whole, options.before);
    writer.add_fronts(subject.fronts);
    return writer.page(subject.title, options);
  });
}

Page page_of(const Run& run, const PageOptions& options, const geo::Progress& progress) {
  const Subject subject = read_checkpoint(run);
  std::vector<geo::TriangleMesh> frames;
  geo::Box3 box = box_of_points(subject);
  Budget needed = needs_of(subject);
  for (const auto& path : run.frames) {
    geo::report(progress, "read", frames.size(), run.frames.size());
    frames.push_back(geo::read_surface(path).mesh);
    tool::add_run_materials(frames.back(), path);
    box.add(geo::bounding_box(frames.back()));
    needed.triangles =
        std::max(needed.triangles, double(run.frames.size() + 1) * double(frames.back().triangles.size()));
  }
  const std::vector<geo::TriangleMesh> obstacles = read_obstacles(run);
  const MovingNodes moving = read_moving_nodes(run, subject, frames, progress);
  auto paint = paint_for(options);
  for (const auto& frame : moving.frames)
    for (const auto& p : frame.position) box.add(p);
  return fitted(options, needed, [&](const Budget& budget) {
    Writer writer(box, budget, paint ? &*paint : nullptr);
    const double most = budget.triangles / double(frames.size() + 1);
    for (std::size_t f = 0; f < frames.size(); ++f) {
      geo::report(progress, "page", f, frames.size());
      writer.add_surface(frames[f], std::filesystem::path(run.frames[f]).stem().string(), most);
    }
    writer.add_obstacles(obstacles, budget.triangles / 10);
    if (subject.body) {
      const bool whole = writer.add_surface(subject.surface, "at rest", most);
      writer.add_nodes(subject, static_cast<int>(frames.size()), whole, options.before, moving);
    }
    return writer.page(run.title, options);
  });
}

}  // namespace view
