// kerf-sim: the whole loop, from a scene to frames.
#include <cstdio>
#include <filesystem>
#include <iostream>

#include "io/body_file.h"
#include "io/run_files.h"
#include "io/scene_file.h"
#include "io/stream.h"
#include "model.h"
#include "simulation/simulation.h"
#include "surface/pieces.h"
#include "tool.h"

namespace {

std::string phases(const geo::FrameWork& w) {
  const auto& c = w.split.crack;
  return "{\"front\":" + tool::number(w.front_seconds) + ",\"crack\":" + tool::number(c.seconds()) + ",\"resample\":" + tool::number(w.split.resample_seconds) +
         ",\"graph\":" + tool::number(w.split.graph_seconds) + ",\"binding\":" + tool::number(w.split.binding_seconds) + ",\"fracture\":" + tool::number(w.fracture_seconds) + ",\"mechanics\":" + tool::number(w.mechanics_seconds) +
         ",\"surface\":" + tool::number(w.surface_seconds) + "}";
}

std::string counts(const geo::FrameWork& w) {
  return "\"triangles_cut\":" + std::to_string(w.split.crack.triangles_cut) + ",\"edges_cut\":" + std::to_string(w.split.edges_cut) +
         ",\"nodes_updated\":" + std::to_string(w.split.nodes_updated) + ",\"nodes_added\":" + std::to_string(w.split.nodes_added) +
         ",\"cracks_begun\":" + std::to_string(w.fracture.begun + w.fracture.divided) + ",\"refused\":" + std::to_string(w.refused) + ",\"newton\":" + std::to_string(w.newton) + ",\"cg\":" + std::to_string(w.cg);
}

}  // namespace

int main(int argc, char** argv) {
  tool::Tool t("kerf-sim", "Runs a scene: a body deforms while blades cut it. Writes numbered frames, a ParaView collection, a USD file and checkpoints.",
               "  kerf-sim samples/scenes/halve.toml -o out/halve\n  kerf-sim halve.toml -o out/soft --set material.young=2e4 --frames 48\n  kerf-sim halve.toml -o out/halve --resume");
  std::string path;
  std::vector<std::string> settings;
  int frames = 0;
  t.patience = 20;  // a frame may take long, and ends what is being written
  bool resume = false;
  t.argument("SCENE", path, "Scene file (TOML)");
  t.option("--frames", frames, "How many frames; 0: as the scene says");
  t.option("--set", settings, "Override a key of the scene, as KEY=VALUE");
  t.flag("--resume", resume, "Go on from the last checkpoint in the output folder");
  t.output("Folder of the run");
  return t.run(argc, argv, [&] {
    namespace fs = std::filesystem;
    if (t.output_path.empty() || t.output_path == "-") throw tool::UsageError("give a folder with -o");
    std::vector<std::pair<std::string, std::string>> overrides;
    for (const auto& s : settings) {
      const auto equals = s.find('=');
      if (equals == std::string::npos || equals == 0) throw tool::UsageError("--set '" + s + "' is not KEY=VALUE");
      overrides.push_back({s.substr(0, equals), s.substr(equals + 1)});
      // Paths on the command line are relative to where one stands, not to the scene.
      if (overrides.back().first == "body.mesh") overrides.back().second = "\"" + fs::absolute(overrides.back().second).string() + "\"";
    }
    const geo::Scene scene = geo::read_scene(path, overrides);
    const int last = frames > 0 ? frames : scene.frames;
    const fs::path folder = t.output_path, frame_folder = folder / "frames", body_file = folder / "checkpoint.kerf", state_file = folder / "checkpoint.state";
    std::error_code error;
    if (!resume && fs::exists(frame_folder, error)) throw geo::OutputError(folder.string() + ": holds a run already; go on with --resume, remove it, or give another folder");
    if (resume && !fs::exists(state_file, error)) throw geo::MissingInputError(state_file.string() + ": no checkpoint to go on from; run without --resume");
    const geo::SurfaceFile model = resume ? geo::read_surface(scene.mesh) : tool::read_solid(scene.mesh);
    if (model.mesh.two_sided()) throw geo::InputError(scene.mesh + ": is cut already; a scene begins with a whole model");
    fs::create_directories(frame_folder, error);
    if (error) throw geo::OutputError(folder.string() + ": cannot be made (" + error.message() + ")");
    const auto progress = t.progress();
    const auto load = [&] {
      try {
        return geo::Simulation(scene, geo::read_body(body_file.string()), geo::read_run_state(state_file.string()));
      } catch (const geo::InputError& e) {
        throw geo::InputError(folder.string() + ": " + e.what());
      }
    };
    geo::Simulation sim = resume ? load() : geo::Simulation(scene, model.mesh, progress);
    const auto frame_name = [](int i) {
      char name[32];
      std::snprintf(name, sizeof name, "frame_%04d.ply", i);
      return std::string(name);
    };
    const auto write_frame = [&] {
      const auto mesh = sim.surface(&model.mesh);
      geo::write_all((frame_folder / frame_name(sim.state().frame)).string(), [&](std::ostream& out) { geo::write_ply(out, mesh); });
    };
    const auto checkpoint = [&] {
      // The state first, aside, so that the pair is exchanged in two renames; then the run goes on from what it wrote,
      // so that one taken up here and one never stopped are the same.
      geo::write_all(body_file.string() + ".next", [&](std::ostream& out) { geo::write_body(out, sim.body()); });
      geo::write_all(state_file.string() + ".next", [&](std::ostream& out) { geo::write_run_state(out, sim.state()); });
      fs::rename(body_file.string() + ".next", body_file);
      fs::rename(state_file.string() + ".next", state_file);
      sim = load();
    };
    if (!resume) {
      write_frame();
      checkpoint();
    }
    geo::FrameWork total;
    while (sim.state().frame < last) {
      geo::report(progress, "frame " + std::to_string(sim.state().frame + 1) + " of " + std::to_string(last), static_cast<std::size_t>(sim.state().frame), static_cast<std::size_t>(last));
      const geo::FrameWork work = sim.advance_frame();
      write_frame();
      total += work;
      if (t.json)
        std::cout << "{\"frame\":" << sim.state().frame << ",\"nodes\":" << sim.body().nodes.size() << "," << counts(work) << ",\"seconds\":" << phases(work) << "}\n" << std::flush;
      if (sim.state().frame % scene.checkpoint_every == 0 || sim.state().frame == last) checkpoint();
    }
    geo::report(progress, "done", 1, 1);
    std::vector<std::string> names;
    std::vector<geo::TriangleMesh> meshes;
    for (int i = 0; i <= last; ++i) {
      names.push_back("frames/" + frame_name(i));
      meshes.push_back(geo::read_surface((folder / names.back()).string()).mesh);
    }
    geo::write_all((folder / "run.pvd").string(), [&](std::ostream& out) { geo::write_pvd(out, names, scene.frame_rate); });
    geo::write_all((folder / "run.usda").string(), [&](std::ostream& out) { geo::write_usda(out, meshes, scene.frame_rate); });
    const auto pieces = geo::find_pieces(sim.body().surface).count;
    const std::string summary = "{\"frames\":" + std::to_string(last) + ",\"nodes\":" + std::to_string(sim.body().nodes.size()) + ",\"edges\":" + std::to_string(sim.body().graph.edge_count()) +
                                ",\"pieces\":" + std::to_string(pieces) + "," + counts(total) + ",\"seconds\":" + phases(total) + "}\n";
    geo::write_all((folder / "summary.json").string(), [&](std::ostream& out) { out << summary; });
    if (!t.quiet)
      t.say("kerf-sim: " + std::to_string(last) + " frames, " + std::to_string(sim.body().nodes.size()) + " nodes, " + std::to_string(sim.body().graph.edge_count()) + " edges, " +
            std::to_string(total.split.crack.triangles_cut) + " triangles cut, " + std::to_string(pieces) + " pieces; seconds " + phases(total));
  });
}
