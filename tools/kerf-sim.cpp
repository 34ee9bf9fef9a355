// kerf-sim: the whole loop, from a scene to frames.
#include <algorithm>
#include <cstdio>
#include <deque>
#include <filesystem>
#include <iostream>

#include "base/stopwatch.h"
#include "contact/crossing.h"
#include "io/checkpoint_file.h"
#include "io/run_files.h"
#include "io/scene_file.h"
#include "io/stream.h"
#include "mechanics/node_fields.h"
#include "model.h"
#include "simulation/simulation.h"
#include "surface/pieces.h"
#include "tool.h"

namespace {

namespace fs = std::filesystem;

std::string seconds(const geo::FrameWork& w) {
  return "{\"front\":" + tool::number(w.front_seconds) + ",\"mesh\":" + tool::number(w.split.crack.seconds()) + ",\"graph\":" + tool::number(w.split.graph_seconds) +
         ",\"resample\":" + tool::number(w.split.resample_seconds) + ",\"binding\":" + tool::number(w.split.binding_seconds) + ",\"fracture\":" + tool::number(w.fracture_seconds) + ",\"mechanics\":" + tool::number(w.mechanics_seconds) +
         ",\"contact\":" + tool::number(w.contact_seconds) + ",\"write\":" + tool::number(w.write_seconds) + "}";
}

std::string counts(const geo::FrameWork& w) {
  const auto of = [](const char* name, std::size_t n) { return std::string("\"") + name + "\":" + std::to_string(n); };
  return of("steps", w.steps) + "," + of("newton", w.newton) + "," + of("cg", w.cg) + "," + of("fronts", w.fronts) + "," + of("cracks_begun", w.fracture.begun + w.fracture.divided) + "," + of("refused", w.refused) + "," +
         of("triangles_cut", w.split.crack.triangles_cut) + "," + of("edges_cut", w.split.edges_cut) + "," + of("nodes_updated", w.split.nodes_updated) + "," +
         of("nodes_added", w.split.nodes_added) + "," + of("touching", w.contact.touching) + "," + of("in_zones", w.contact.in_zones) + "," + of("held", w.contact.held);
}

// What a frame came to, without times: a line of frames.jsonl, the same in every run.
std::string outcome(const geo::Simulation& sim, const geo::FrameWork& w, const geo::TriangleMesh& surface) {
  std::string line = "{\"frame\":" + std::to_string(sim.state().frame) + ",\"time\":" + tool::number(sim.state().time) + ",\"nodes\":" + std::to_string(sim.body().nodes.size()) +
                     ",\"faces\":" + std::to_string(sim.body().surface.live_face_count()) + ","  + counts(w) + ",\"crossings\":" + std::to_string(geo::count_crossings(surface)) + ",\"lag\":" + tool::number(w.contact.lag) + ",\"energy\":" + tool::number(w.energy) + ",\"blade_force\":[";
  for (std::size_t b = 0; b < w.blade_force.size(); ++b) {
    const geo::Vec3& f = w.blade_force[b];
    line += std::string(b ? "," : "") + "[" + tool::number(f.x()) + "," + tool::number(f.y()) + "," + tool::number(f.z()) + "]";
  }
  return line + "]";
}

// Throws OutputError where `bytes` more do not fit beside `folder`, which need not be there.
void require_space(const fs::path& folder, double bytes) {
  std::error_code error;
  fs::path there = fs::absolute(folder);
  while (!fs::exists(there, error) && there.has_parent_path() && there != there.parent_path()) there = there.parent_path();
  const auto space = fs::space(there, error);
  if (error || space.capacity == 0 || double(space.available) >= bytes) return;
  const auto megabytes = [](double b) { return std::to_string(static_cast<long long>(b / 1e6) + 1) + " MB"; };
  throw geo::OutputError(folder.string() + ": the run needs about " + megabytes(bytes) + ", but " + megabytes(double(space.available)) + " are free; ask for fewer frames, or give another folder");
}

// Nodes as a frame has them, in the folder `nodes` beside `frames`.
geo::FrameNodes nodes_of(const geo::Simulation& sim) {
  geo::FrameNodes frame{sim.body().nodes, geo::von_mises_stress(sim.solid(), sim.body().nodes, sim.state().motion)};
  const auto moved = geo::material_displacement(sim.solid(), sim.body().nodes, sim.body().graph, sim.state().motion);
  for (std::size_t i = 0; i < moved.size(); ++i) frame.nodes.position[i] += moved[i];
  return frame;
}

// A frame as PLY and its samples in the USD file, by what there is now and half as much again for cracks.
double bytes_of_frames(const geo::TriangleMesh& mesh, int frames) {
  return 1.5 * double(frames + 1) * (100.0 * double(mesh.vertices.size()) + 60.0 * double(mesh.triangles.size()));
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
    return ", " + (whole >= 60 ? std::to_string(whole / 60) + " min " : std::string()) + std::to_string(whole % 60) + " s left";
  }

 private:
  std::deque<double> last_;
};

// The folder of a run: what is in it, and how it is taken up again.
struct Folder {
  fs::path path;
  fs::path frames() const { return path / "frames"; }
  fs::path nodes() const { return path / "nodes"; }
  fs::path checkpoint() const { return path / "checkpoint.kerf"; }
  fs::path log() const { return path / "frames.jsonl"; }
  static std::string frame_name(int i, const char* what = "frame") {
    char name[32];
    std::snprintf(name, sizeof name, "%s_%04d.ply", what, i);
    return name;
  }
  std::string frame(int i) const { return (frames() / frame_name(i)).string(); }
  std::string nodes(int i) const { return (nodes() / frame_name(i, "nodes")).string(); }

  void make() const {
    std::error_code error;
    fs::create_directories(frames(), error);
    if (!error) fs::create_directories(nodes(), error);
    if (error) throw geo::OutputError(path.string() + ": cannot be made (" + error.message() + ")");
  }
  // Removes what make() made, where nothing came of it.
  void unmake() const {
    std::error_code ignored;
    fs::remove_all(frames(), ignored);
    fs::remove_all(nodes(), ignored);
    fs::remove(path, ignored);
  }
  void write_text(const fs::path& file, const std::string& text) const {
    geo::write_all(file.string(), [&](std::ostream& out) { out << text; });
  }
  // The first `count` lines of the log; it is never behind the checkpoint.
  std::string read_log(int count) const {
    if (count == 0) return "";
    const std::string all = geo::read_all(log().string());
    std::size_t end = 0;
    for (int i = 0; i < count && end != std::string::npos; ++i) end = all.find('\n', end ? end + 1 : 0);
    if (end == std::string::npos) throw geo::InputError(log().string() + ": has fewer lines than there are frames; begin the run anew");
    return all.substr(0, end + 1);
  }
};

struct Plan {
  geo::Scene scene;
  geo::Model model;
  std::uint64_t fingerprint = 0;  ///< of scene and models
};

geo::Simulation take_up(const Plan& plan, const Folder& folder) {
  try {
    geo::Checkpoint c = geo::read_checkpoint(geo::KerfFile(geo::Input(folder.checkpoint().string())));
    if (c.scene != plan.fingerprint) throw geo::InputError("was begun with another scene, model or setting; give the same ones, or another folder");
    return geo::Simulation(plan.scene, std::move(c.body), std::move(c.state));
  } catch (const geo::InputError& e) {
    throw geo::InputError(folder.path.string() + ": " + e.what());
  }
}

Plan read_plan(const std::string& path, const geo::SceneOverrides& overrides) {
  Plan plan{geo::read_scene(path, overrides), {}, 0};
  std::vector<geo::TriangleMesh> meshes;
  std::string hashes = std::to_string(plan.scene.fingerprint);
  for (const geo::SceneBody& body : plan.scene.bodies) {
    const std::string bytes = geo::read_all(body.mesh);
    meshes.push_back(tool::parse_solid(bytes, body.mesh).mesh);
    if (meshes.back().two_sided()) throw geo::InputError(body.mesh + ": is cut already; a scene begins with whole models");
    hashes += " " + std::to_string(geo::fingerprint(bytes));
  }
  plan.fingerprint = geo::fingerprint(hashes);
  plan.model = geo::place_models(plan.scene, std::move(meshes));
  if (plan.model.parts.size() > 1) {
    try {
      geo::require_solid(plan.model.mesh);
    } catch (const geo::InputError& e) {
      throw geo::InputError(path + ": the placed bodies, taken together: " + e.what());
    }
  }
  return plan;
}

geo::SceneOverrides overrides_of(const std::vector<std::string>& settings) {
  geo::SceneOverrides overrides;
  for (const auto& s : settings) {
    const auto equals = s.find('=');
    if (equals == std::string::npos || equals == 0) throw tool::UsageError("--set '" + s + "' is not KEY=VALUE");
    overrides.push_back({s.substr(0, equals), s.substr(equals + 1)});
    // Paths on the command line are relative to where one stands, not to the scene.
    const std::string last = overrides.back().first.substr(overrides.back().first.find_last_of('.') + 1);
    if (last == "mesh" || last == "motion" || last == "file") overrides.back().second = "\"" + fs::absolute(overrides.back().second).string() + "\"";
  }
  return overrides;
}

}  // namespace

int main(int argc, char** argv) {
  tool::Tool t("kerf-sim", "Runs a scene: bodies deform while blades cut them. Writes numbered frames, a ParaView collection, a USD file and checkpoints.",
               "  kerf-sim samples/scenes/halve.toml -o out/halve\n  kerf-sim halve.toml -o out/soft --set material.young=2e4 --set blade.0.thickness=0.01 --frames 48\n  kerf-sim halve.toml -o out/halve --resume");
  std::string path;
  std::vector<std::string> settings;
  int frames = 0;
  t.patience = 20;  // a time step may take long
  bool resume = false;
  t.argument("SCENE", path, "Scene file (TOML)");
  t.option("--frames", frames, "How many frames; 0: as the scene says");
  t.option("--set", settings, "Override a key of the scene, as KEY=VALUE; rows of lists by number, as blade.0.thickness");
  t.flag("--resume", resume, "Go on from the last checkpoint in the output folder, or begin where there is none");
  t.output("Folder of the run");
  return t.run(argc, argv, [&] {
    if (t.output_path.empty() || t.output_path == "-") throw tool::UsageError("give a folder with -o");
    const Plan plan = read_plan(path, overrides_of(settings));
    const int last = frames > 0 ? frames : plan.scene.frames;
    const Folder folder{t.output_path};
    std::error_code error;
    if (!resume && fs::exists(folder.frames(), error)) throw geo::OutputError(folder.path.string() + ": holds a run already; go on with --resume, remove it, or give another folder");
    const bool begun = resume && fs::exists(folder.checkpoint(), error);
    if (!begun) require_space(folder.path, bytes_of_frames(plan.model.mesh, last));
    folder.make();
    const auto progress = t.progress();
    const auto begin = [&] {
      try {
        return geo::Simulation(plan.scene, plan.model, progress);
      } catch (...) {
        folder.unmake();
        throw;
      }
    };
    geo::Simulation sim = begun ? take_up(plan, folder) : begin();
    std::string log = folder.read_log(sim.state().frame);
    const geo::TriangleMesh* carried = plan.model.parts.size() == 1 ? &plan.model.mesh : nullptr;
    const auto write_frame = [&](const geo::TriangleMesh& mesh) {
      geo::write_all(folder.nodes(sim.state().frame), [&](std::ostream& out) { geo::write_frame_nodes(out, nodes_of(sim)); });
      geo::write_all(folder.frame(sim.state().frame), [&](std::ostream& out) { geo::write_ply(out, mesh); });
    };
    // The run goes on from what it wrote, so that one taken up here and one never stopped are the same.
    const auto checkpoint = [&] {
      folder.write_text(folder.log(), log);
      geo::write_all(folder.checkpoint().string(), [&](std::ostream& out) { geo::write_checkpoint(out, sim.body(), sim.state(), plan.fingerprint); });
      sim = take_up(plan, folder);
    };
    if (!begun) {
      write_frame(sim.surface(carried));
      checkpoint();
      require_space(folder.path, bytes_of_frames(plan.model.mesh, last) + 28.0 * (last + 1) * double(sim.body().nodes.size()) + 4 * double(fs::file_size(folder.checkpoint())));
    }
    Forecast forecast;
    geo::FrameWork total = sim.state().total;
    geo::Stopwatch watch;
    while (sim.state().frame < last) {
      const int frame = sim.state().frame + 1;
      const std::string phase = "frame " + std::to_string(frame) + " of " + std::to_string(last) + forecast.left(last - frame + 1);
      geo::FrameWork work = sim.advance_frame([&](std::string_view, std::size_t step, std::size_t steps) {
        return !progress || progress(phase, static_cast<std::size_t>(frame - 1) * steps + step, static_cast<std::size_t>(last) * steps);
      });
      geo::Stopwatch writing;
      const auto mesh = sim.surface(carried);
      const std::string line = outcome(sim, work, mesh);
      log += line + "}\n";
      write_frame(mesh);
      if (frame % plan.scene.checkpoint_every == 0 || frame == last) checkpoint();
      work.write_seconds += writing.lap();
      total += work;
      if (t.json) std::cout << line << ",\"seconds\":" << seconds(work) << "}\n" << std::flush;
      forecast.add(watch.lap());
    }
    geo::report(progress, "done", 1, 1);
    std::vector<std::string> names;
    for (int i = 0; i <= last; ++i) names.push_back("frames/" + Folder::frame_name(i));
    geo::write_all((folder.path / "run.pvd").string(), [&](std::ostream& out) { geo::write_pvd(out, names, plan.scene.frame_rate); });
    geo::write_all((folder.path / "run.usda").string(), [&](std::ostream& out) {
      geo::write_usda(out, names.size(), [&](std::size_t i) { return geo::read_surface((folder.path / names[i]).string()).mesh; }, plan.scene.frame_rate);
    });
    const auto pieces = geo::find_pieces(sim.body().surface).count;
    folder.write_text(folder.path / "summary.json", "{\"frames\":" + std::to_string(last) + ",\"nodes\":" + std::to_string(sim.body().nodes.size()) + ",\"edges\":" +
                                                        std::to_string(sim.body().graph.edge_count()) + ",\"pieces\":" + std::to_string(pieces) + "," + counts(sim.state().total) + "}\n");
    t.say("kerf-sim: " + std::to_string(last) + " frames, " + std::to_string(sim.body().nodes.size()) + " nodes, " + std::to_string(sim.body().graph.edge_count()) + " edges, " +
          std::to_string(total.split.crack.triangles_cut) + " triangles cut, " + std::to_string(pieces) + " pieces; seconds " + seconds(total));
  });
}
