// kerf-sim: the whole loop, from a scene to frames.
#include <algorithm>
#include <deque>
#include <filesystem>
#include <functional>
#include <optional>
#include <sstream>
#include <utility>

#include <kerf/pieces.h>
#include <kerf/progress.h>
#include <kerf/run_files.h>
#include <kerf/scene_file.h>
#include <kerf/simulation.h>
#include <kerf/solid.h>
#include <kerf/stream.h>
#include "model.h"
#include "sim/frame_writer.h"
#include "sim/whole_run.h"
#include "tool.h"

namespace {

namespace fs = std::filesystem;

// Nodes as a frame has them, in the folder `nodes` beside `frames`.
geo::FrameNodes nodes_of(const geo::Simulation& run) {
  geo::FrameNodes frame{run.body().nodes, geo::von_mises_stress(run.solid(), run.body().nodes, run.state().motion)};
  const auto moved = geo::material_displacement(run.solid(), run.body().nodes, run.body().graph, run.state().motion);
  for (std::size_t i = 0; i < moved.size(); ++i) frame.nodes.position[i] += moved[i];
  return frame;
}

// How long the frames that are left will take, as the last ones did.
class Forecast {
 public:
  void add(double seconds) {
    last_.push_back(seconds);
    if (last_.size() > 8) last_.pop_front();
  }
  std::string left(int frames) const {
    if (last_.empty()) return "";
    double sum = 0;
    for (const double s : last_) sum += s;
    const auto whole = static_cast<long long>(sum / double(last_.size()) * frames + 0.5);
    return ", " + (whole >= 60 ? std::to_string(whole / 60) + " min " : std::string()) + std::to_string(whole % 60) +
           " s left";
  }

 private:
  std::deque<double> last_;
};

struct Plan {
  geo::Scene scene;
  geo::PlacedModels models;
  std::uint64_t fingerprint = 0;  ///< of scene and models
};

// A run goes on from what it wrote, so that one taken up there and one never stopped are the same.
geo::Simulation take_up(const Plan& plan, const sim::RunFolder& folder, std::optional<geo::Simulation> run = {}) {
  try {
    geo::Checkpoint c = geo::read_checkpoint(geo::KerfFile(geo::Input(folder.checkpoint().string())));
    if (c.scene != plan.fingerprint)
      throw geo::InputError("was begun with another scene, model or setting; give the same ones, or another folder");
    if (!run) return geo::Simulation(plan.scene, std::move(c.body), std::move(c.state));
    run->restore(std::move(c.body), std::move(c.state));
    return std::move(*run);
  } catch (const geo::InputError& e) {
    throw geo::InputError(folder.path.string() + ": " + e.what());
  }
}

// A run from what will be its first checkpoint, which is left in `bytes`.
geo::Simulation begin(const Plan& plan, std::string& bytes, const geo::Progress& progress) {
  std::ostringstream out;
  {
    const geo::RunStart fresh = geo::begin_run(plan.scene, plan.models, progress);
    geo::write_checkpoint(out, fresh.body, fresh.state, plan.fingerprint);
  }
  bytes = std::move(out).str();
  geo::Checkpoint c = geo::read_checkpoint(geo::KerfFile(geo::Input(bytes, "checkpoint")));
  return geo::Simulation(plan.scene, std::move(c.body), std::move(c.state));
}

Plan read_plan(const std::string& path, const geo::SceneOverrides& overrides) {
  Plan plan{geo::read_scene(path, overrides), {}, 0};
  std::vector<geo::TriangleMesh> meshes;
  std::string hashes = std::to_string(plan.scene.fingerprint);
  for (const geo::SceneBody& body : plan.scene.bodies) {
    const std::string bytes = geo::read_all(body.mesh);
    meshes.push_back(tool::parse_solid(bytes, body.mesh).mesh);
    tool::require_whole(meshes.back(), body.mesh, "a scene begins with whole models");
    hashes += " " + std::to_string(geo::fingerprint(bytes));
  }
  plan.fingerprint = geo::fingerprint(hashes);
  plan.models = geo::place_models(plan.scene, std::move(meshes));
  if (plan.models.bodies.size() > 1) {
    try {
      geo::require_solid(plan.models.all);
    } catch (const geo::InputError& e) {
      throw geo::InputError(path + ": the placed bodies, taken together: " + e.what());
    }
  }
  return plan;
}

// When blades are there, and where, for one who wonders why they cut nothing.
std::string way_of(const std::vector<geo::Blade>& blades) {
  double from = blades[0].motion.keys.front().time, to = blades[0].motion.keys.back().time;
  geo::Box3 box;
  for (const geo::Blade& blade : blades) {
    from = std::min(from, blade.motion.keys.front().time), to = std::max(to, blade.motion.keys.back().time);
    for (const auto& key : blade.motion.keys)
      for (const geo::Vec3& p : blade.at(key.time)) box.add(p);
  }
  return "by their keys, blades are there from " + tool::rounded(from) + " to " + tool::rounded(to) + " s, within (" +
         tool::rounded(box.lo) + ") to (" + tool::rounded(box.hi) + ")";
}

// Models in millimetres are mountains in metres.
void say_large(const Plan& plan, const tool::Tool& t) {
  const double across = geo::bounding_box(plan.models.all).diagonal();
  const bool as_it_is = std::all_of(plan.scene.bodies.begin(), plan.scene.bodies.end(),
                                    [](const geo::SceneBody& b) { return b.scale == 1; });
  if (across >= 100 && as_it_is)
    t.say("kerf-sim: the bodies are " + tool::rounded(across) +
          " m across, as units are metres; give them scale = 0.001 if they are in mm");
}

// Models from CAD have a few large triangles, which neither bend nor touch but at their corners.
void say_coarse(const Plan& plan, const geo::Body& body, const tool::Tool& t) {
  const double coarsest = *std::max_element(body.nodes.spacing.begin(), body.nodes.spacing.end());
  for (std::size_t b = 0; b < plan.models.bodies.size(); ++b) {
    double longest = 0;
    for (const auto& [p, q, r] : geo::corners_of(plan.models.bodies[b]))
      longest = std::max({longest, (q - p).norm(), (r - q).norm(), (p - r).norm()});
    if (longest <= 4 * coarsest) continue;
    char share[16];
    std::snprintf(share, sizeof share, "%.1g", coarsest / geo::bounding_box(plan.models.bodies[b]).diagonal());
    t.say("kerf-sim: " + fs::path(plan.scene.bodies[b].mesh).filename().string() + " has edges of up to " +
          tool::rounded(longest) + ", nodes are at most " + tool::rounded(coarsest) +
          " apart; a surface bends and touches at its vertices: kerf-repair --edge " + share + " gives it more");
  }
}

std::string in_words(const geo::Vec3& p) {
  return tool::number(p.x()) + ", " + tool::number(p.y()) + ", " + tool::number(p.z());
}

geo::SceneOverrides overrides_of(const std::vector<std::string>& settings) {
  geo::SceneOverrides overrides;
  for (const auto& s : settings) {
    const auto equals = s.find('=');
    if (equals == std::string::npos || equals == 0) throw tool::UsageError("--set '" + s + "' is not KEY=VALUE");
    overrides.push_back({s.substr(0, equals), s.substr(equals + 1)});
    // Paths on the command line are relative to where one stands, not to the scene.
    const std::string last = overrides.back().first.substr(overrides.back().first.find_last_of('.') + 1);
    if (last == "mesh" || last == "motion" || last == "file")
      overrides.back().second = "\"" + fs::absolute(overrides.back().second).string() + "\"";
  }
  return overrides;
}

}  // namespace

int main(int argc, char** argv) {
  tool::Tool t("kerf-sim",
               "Runs a scene: bodies deform while blades cut them. Writes numbered frames, a ParaView series, a USD "
               "file and checkpoints.",
               "  kerf-sim samples/scenes/halve.toml -o out/halve\n  kerf-sim halve.toml -o out/soft --set "
               "material.young=2e4 --set blade.0.divide=9 --frames 48\n  kerf-sim halve.toml -o out/halve --resume");
  std::string path;
  std::vector<std::string> settings;
  int frames = 0;
  t.patience = 20;  // a time step may take long
  bool resume = false;
  t.argument("SCENE", path, "Scene file (TOML)");
  t.option("--frames", frames, "How many frames; 0: as the scene says");
  t.option("--set", settings, "Override a key of the scene, as KEY=VALUE; rows of lists by number, as blade.0.divide");
  t.flag("--resume", resume, "Go on from the last checkpoint in the output folder, or begin where there is none");
  t.output("Folder of the run", {"a folder"});
  return t.run(argc, argv, [&] {
    if (t.output_path.empty() || t.output_path == "-") throw tool::UsageError("give a folder with -o");
    t.require_ending();
    const sim::RunFolder folder{t.output_path};
    folder.require_room(resume);
    const Plan plan = read_plan(path, overrides_of(settings));
    say_large(plan, t);
    const int last = frames > 0 ? frames : plan.scene.frames;
    std::error_code error;
    const bool begun = resume && fs::exists(folder.checkpoint(), error);
    const double frame_bytes = sim::bytes_of_frames(plan.models.all, last);
    if (!begun) folder.require_space(frame_bytes);
    folder.make(!plan.scene.obstacles.empty());
    const auto progress = t.progress();
    std::string first;  // checkpoint of a run that begins
    const auto fresh = [&] {
      try {
        return begin(plan, first, progress);
      } catch (...) {
        folder.unmake();
        throw;
      }
    };
    geo::Simulation run = begun ? take_up(plan, folder) : fresh();
    if (!begun) say_coarse(plan, run.body(), t);
    const auto& positions = run.body().nodes.position;
    for (const geo::Grip& g : plan.scene.grips)
      if (!begun && std::none_of(positions.begin(), positions.end(), [&](const geo::Vec3& p) {
            return (p.array() >= g.lo.array() && p.array() <= g.hi.array()).all();
          }))
        t.say("kerf-sim: no node is in the box from (" + in_words(g.lo) + ") to (" + in_words(g.hi) +
              "), which is to hold some; bodies are where their scale, rotation and position put them");
    const geo::TriangleMesh* carried = plan.models.bodies.size() == 1 ? &plan.models.all : nullptr;
    sim::FrameWriter writer(folder, folder.read_log(run.state().frame), t.json);
    const auto checkpoint = [&](const std::function<void(std::ostream&)>& write) {
      folder.write_text(folder.log(), writer.log());
      geo::write_all(folder.checkpoint().string(), write);
    };
    if (!begun) {
      writer.add(
          {{}, run.surface(carried), nodes_of(run), geo::place_obstacles(plan.scene, plan.models, run.state().time)});
      checkpoint([bytes = std::exchange(first, {})](std::ostream& out) { out << bytes; });
      folder.require_space(frame_bytes + 28.0 * (last + 1) * double(run.body().nodes.size()) +
                           4 * double(fs::file_size(folder.checkpoint())));
    }
    Forecast forecast;
    geo::FrameStats total = run.state().total;
    geo::Stopwatch watch;
    double waited = 0;  // for files of the frame before
    while (run.state().frame < last) {
      const int frame = run.state().frame + 1;
      const std::string phase =
          "frame " + std::to_string(frame) + " of " + std::to_string(last) + forecast.left(last - frame + 1);
      geo::FrameStats work = run.advance_frame([&](std::string_view, std::size_t step, std::size_t steps) {
        return !progress || progress(phase, static_cast<std::size_t>(frame - 1) * steps + step,
                                     static_cast<std::size_t>(last) * steps);
      });
      geo::Stopwatch writing;
      sim::Frame done{
          {frame, run.state().time, run.body().nodes.size(), run.body().surface.live_face_count(), std::move(work)},
          run.surface(carried),
          nodes_of(run),
          geo::place_obstacles(plan.scene, plan.models, run.state().time)};
      done.outcome.work.write_seconds = waited + writing.lap();
      total += done.outcome.work;
      writer.add(std::move(done));
      if (frame % plan.scene.checkpoint_every == 0 || frame == last) {
        checkpoint([&](std::ostream& out) { geo::write_checkpoint(out, run.body(), run.state(), plan.fingerprint); });
        if (frame < last) run = take_up(plan, folder, std::move(run));
      }
      waited = writing.lap();
      forecast.add(watch.lap());
    }
    total.write_seconds += waited;
    geo::report(progress, "done", 1, 1);
    sim::write_whole_run(folder, last, plan.scene.frame_rate, sim::up_axis(plan.scene.gravity));
    const std::size_t nodes = run.body().nodes.size(), edges = run.body().graph.edge_count(),
                      pieces = geo::find_pieces(run.body().surface).count;
    const auto of = [](const char* name, std::size_t n) {
      return std::string(",\"") + name + "\":" + std::to_string(n);
    };
    folder.write_text(folder.path / "summary.json", "{\"frames\":" + std::to_string(last) + of("nodes", nodes) +
                                                        of("edges", edges) + of("pieces", pieces) + "," +
                                                        sim::counts(run.state().total) + "}\n");
    if (!plan.scene.blades.empty() && run.state().total.fronts == 0)
      t.say("kerf-sim: no blade met the material in " + tool::rounded(run.state().time) + " s; " +
            way_of(plan.scene.blades));
    t.say("kerf-sim: " + tool::counted(static_cast<std::size_t>(last), "frame") + ", " + tool::counted(nodes, "node") +
          ", " + tool::counted(edges, "edge") + ", " + tool::counted(total.split.crack.triangles_cut, "triangle") +
          " cut, " + tool::counted(pieces, "piece") + sim::seconds_in_words(total));
  });
}
