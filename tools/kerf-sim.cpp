// kerf-sim: runs a scene, and writes its frames and checkpoints.
#include <deque>
#include <filesystem>
#include <functional>
#include <memory>
#include <numeric>
#include <optional>
#include <utility>

#include <kerf/body_file.h>
#include <kerf/export.h>
#include <kerf/files.h>
#include <kerf/pieces.h>
#include <kerf/progress.h>
#include <kerf/simulation.h>
#include <kerf/solid.h>
#include <kerf/vectors.h>
#include "model.h"
#include "sim/frame_writer.h"
#include "sim/review.h"
#include "sim/setup.h"
#include "sim/start.h"
#include "sim/whole_run.h"
#include "tool.h"

namespace {

namespace fs = std::filesystem;

struct Command {
  std::string scene;
  std::vector<std::string> settings;
  int frames = 0;
  bool resume = false;
  bool strict = false;
  bool portable = false;
};

// Estimates the remaining time from the seconds of the last frames.
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

// Continues a run from its checkpoint: `run` itself where it is given, so that a run that was
// resumed and one that was not give the same bytes.
geo::Simulation resume(const sim::Setup& setup, const sim::RunFolder& folder, std::optional<geo::Simulation> run = {}) {
  try {
    geo::Checkpoint c = geo::read_checkpoint(geo::KerfFile(geo::Input(folder.checkpoint().string())));
    if (c.scene != setup.fingerprint)
      throw geo::InputError("was begun with another scene, model or setting; give the same ones, or another folder");
    if (geo::vectors() == geo::Vectors::portable && c.vectors != geo::Vectors::portable)
      throw geo::InputError("was begun without --portable; leave it out, or give another folder");
    if (geo::vectors() != c.vectors) geo::set_vectors(c.vectors);
    if (!run) return geo::Simulation(setup.scene, std::move(c.body), std::move(c.state));
    run->restore(std::move(c.body), std::move(c.state));
    return std::move(*run);
  } catch (const geo::InputError& e) {
    throw geo::InputError(folder.path.string() + ": " + e.what());
  }
}

// Positions and von Mises stress of the nodes, for the file of a frame.
geo::FrameNodes nodes_of(const geo::Simulation& run) {
  geo::FrameNodes frame{run.body().nodes, geo::von_mises_stress(run.solid(), run.body().nodes, run.state().motion)};
  const auto moved = geo::material_displacement(run.solid(), run.body().nodes, run.body().graph, run.state().motion);
  for (std::size_t i = 0; i < moved.size(); ++i) frame.nodes.position[i] += moved[i];
  return frame;
}

// A run and the folder that it is written to.
class RecordedRun {
 public:
  RecordedRun(const sim::Setup& setup, const sim::RunFolder& folder, geo::Simulation run, bool json)
      : setup_(setup),
        folder_(folder),
        run_(std::move(run)),
        writer_(folder, folder.read_log(run_.state().frame), json),
        total_(run_.state().total) {}

  const geo::Simulation& run() const { return run_; }
  /// The figures of all frames, those before a resumed run included. Waits until they are written.
  std::vector<sim::FrameFigures> figures() { return sim::read_figures(writer_.log()); }
  /// Statistics of the run, with the seconds since the program started.
  const geo::FrameStats& total() const { return total_; }

  /// Writes frame 0 and the first checkpoint, whose bytes are given.
  void write_start(std::string checkpoint) {
    writer_.add(frame_of({}));
    write_checkpoint([bytes = std::move(checkpoint)](std::ostream& out) { out << bytes; });
  }

  /// Computes and writes all frames up to `last`.
  void advance_to(int last, const geo::Progress& progress) {
    Forecast forecast;
    geo::Stopwatch watch;
    double waited = 0;  // for the files of the frame before
    while (run_.state().frame < last) {
      const int frame = run_.state().frame + 1;
      geo::FrameStats stats = advance_frame(frame, last, forecast, progress);
      geo::Stopwatch writing;
      run_.solid();  // its points follow the last cut here, not while files are written
      stats.mechanics_seconds += writing.lap();
      sim::Frame done = frame_of({.frame = frame,
                                  .time = run_.state().time,
                                  .nodes = run_.body().nodes.size(),
                                  .faces = run_.body().surface.live_face_count(),
                                  .stats = std::move(stats)});
      done.outcome.stats.write_seconds = waited + writing.lap();
      total_ += done.outcome.stats;
      writer_.add(std::move(done));
      if (setup_.scene.has_checkpoint(frame) || frame == last) {
        write_checkpoint(
            [&](std::ostream& out) { geo::write_checkpoint(out, run_.body(), run_.state(), setup_.fingerprint); });
        if (frame < last) run_ = resume(setup_, folder_, std::move(run_));
      }
      waited = writing.lap();
      forecast.add(watch.lap());
    }
    total_.write_seconds += waited;
  }

 private:
  geo::FrameStats advance_frame(int frame, int last, const Forecast& forecast, const geo::Progress& progress) {
    const std::string phase =
        "frame " + std::to_string(frame) + " of " + std::to_string(last) + forecast.left(last - frame + 1);
    return run_.advance_frame([&](std::string_view, std::size_t step, std::size_t steps) {
      return !progress || progress(phase, static_cast<std::size_t>(frame - 1) * steps + step,
                                   static_cast<std::size_t>(last) * steps);
    });
  }
  sim::Frame frame_of(sim::FrameOutcome outcome) const {
    const geo::TriangleMesh& all = setup_.models.all;
    const geo::TriangleMesh* model = setup_.models.bodies.size() == 1 || !all.attributes.empty() ? &all : nullptr;
    return {.outcome = std::move(outcome),
            .surface = run_.surface(model),
            .nodes = nodes_of(run_),
            .obstacles = geo::place_obstacles(setup_.scene, setup_.models, run_.state().time)};
  }
  void write_checkpoint(const std::function<void(std::ostream&)>& write) {
    folder_.write_text(folder_.log(), writer_.log());
    geo::write_all(folder_.checkpoint().string(), write);
  }

  const sim::Setup& setup_;
  const sim::RunFolder& folder_;
  geo::Simulation run_;
  sim::FrameWriter writer_;
  geo::FrameStats total_;
};

// "2 blows made 17 parts, ", or nothing without a blow.
std::string blows_in_words(const geo::FrameStats& total) {
  if (total.blows == 0) return "";
  return tool::counted(total.blows, "blow") + " made " + tool::counted(total.blow_parts, "part") + ", ";
}

// Writes summary.json, and prints the totals of the run.
void summarise(const RecordedRun& recorded, const sim::Setup& setup, const sim::RunFolder& folder, int last,
               const tool::Tool& t) {
  const geo::Simulation& run = recorded.run();
  const std::size_t nodes = run.body().nodes.size(), edges = run.body().graph.edge_count(),
                    pieces = geo::find_pieces(run.body().surface).count;
  const auto field = [](const char* name, std::size_t n) {
    return std::string(",\"") + name + "\":" + std::to_string(n);
  };
  folder.write_text(folder.path / "summary.json", "{\"frames\":" + std::to_string(last) + field("nodes", nodes) +
                                                      field("edges", edges) + field("pieces", pieces) + "," +
                                                      sim::counts(run.state().total) + "}\n");
  if (!setup.scene.blades.empty() && run.state().total.fronts == 0)
    sim::warn_of_missed_blades(setup, run.state().time, t);
  t.say("kerf-sim: " + tool::counted(static_cast<std::size_t>(last), "frame") + ", " + tool::counted(nodes, "node") +
        ", " + tool::counted(edges, "edge") + ", " +
        tool::counted(recorded.total().split.crack.triangles_cut, "triangle") + " cut, " +
        blows_in_words(run.state().total) + tool::counted(pieces, "piece") + sim::seconds_in_words(recorded.total()));
}

// Says what the scene does not ask for. Throws tool::Failure for it where the command is strict.
void review(RecordedRun& recorded, const sim::Setup& setup, bool strict, const tool::Tool& t) {
  const std::vector<double>& spacing = recorded.run().body().nodes.spacing;
  // The elastic energy of a strain of a millionth, which is below any accuracy of a step.
  const double least = 0.5e-12 * setup.scene.material.young * geo::signed_volume(setup.models.all);
  const sim::BodyFigures bodies{
      .spacing = std::accumulate(spacing.begin(), spacing.end(), 0.0) / double(spacing.size()), .least_energy = least};
  std::vector<std::string> faults = sim::faults_of(setup.scene, recorded.figures(), bodies);
  for (std::string& thin : sim::thin_models(setup, recorded.run().body())) faults.push_back(std::move(thin));
  for (const std::string& fault : faults) t.say("kerf-sim: " + fault);
  if (strict && !faults.empty())
    throw tool::Failure("--strict: " + tool::counted(faults.size(), "thing") +
                        " not as asked for; the frames are there");
}

// Creates the folder and the run in it: resumed, or new with its first frame and checkpoint.
std::unique_ptr<RecordedRun> open_run(const sim::Setup& setup, const sim::RunFolder& folder, int last, bool resumed,
                                      const tool::Tool& t) {
  const double frame_bytes = sim::bytes_of_frames(setup.models.all, last);
  if (!resumed) folder.require_space(frame_bytes);
  folder.make(!setup.scene.obstacles.empty());
  if (resumed) return std::make_unique<RecordedRun>(setup, folder, resume(setup, folder), t.json);
  std::string checkpoint;
  std::optional<geo::Simulation> run;
  try {
    checkpoint = sim::first_checkpoint(setup, t.progress());
    run = sim::run_from(setup.scene, checkpoint);
  } catch (...) {
    folder.unmake();
    throw;
  }
  const std::size_t nodes = run->body().nodes.size();
  sim::warn_of_coarse_models(setup, run->body(), t);
  sim::warn_of_empty_grips(setup, run->body(), t);
  auto recorded = std::make_unique<RecordedRun>(setup, folder, std::move(*run), t.json);
  recorded->write_start(std::move(checkpoint));
  folder.require_space(frame_bytes + 28.0 * (last + 1) * double(nodes) +
                       4 * double(fs::file_size(folder.checkpoint())));
  return recorded;
}

void simulate(const Command& command, const tool::Tool& t) {
  if (t.output_path.empty() || t.output_path == "-") throw tool::UsageError("give a folder with -o");
  t.require_ending();
  const sim::RunFolder folder{t.output_path};
  folder.require_room(command.resume);
  const sim::Setup setup = sim::read_setup(command.scene, sim::parse_overrides(command.settings));
  sim::warn_of_large_models(setup, t);
  sim::tell_touching_bodies(setup, "kerf-sim", t);
  const int last = command.frames > 0 ? command.frames : setup.scene.frames;
  std::error_code error;
  const bool resumed = command.resume && fs::exists(folder.checkpoint(), error);
  const auto recorded = open_run(setup, folder, last, resumed, t);
  if (setup.materials.glb) folder.write_text(folder.materials(), *setup.materials.glb);
  const geo::Progress progress = t.progress();
  recorded->advance_to(last, progress);
  geo::report(progress, "done", 1, 1);
  const geo::Vec3 offset = geo::single_precision_offset(geo::bounding_box(setup.models.all));
  if (!offset.isZero(0))
    t.say("kerf-sim: the bodies are far from the origin; the root of run.usda moves them by (" + tool::rounded(offset) +
          ")");
  tool::say_left_out(sim::write_whole_run(folder, last, setup.scene.frame_rate, sim::up_axis(setup.scene.gravity)),
                     folder.path.string() + "/run.usda", "run's materials.glb", t);
  summarise(*recorded, setup, folder, last, t);
  review(*recorded, setup, command.strict, t);
}

}  // namespace

int main(int argc, char** argv) {
  tool::Tool t("kerf-sim",
               "Runs a scene: bodies deform while blades cut them. Writes numbered frames, a ParaView series, a USD "
               "file and checkpoints.",
               R"(  kerf-sim samples/scenes/halve.toml -o out/halve
  kerf-sim halve.toml -o out/soft --set material.young=2e4 --set blade.0.divide=9 --frames 48
  kerf-sim halve.toml -o out/halve --resume)");
  Command command;
  t.patience = 20;  // a time step may take long
  t.argument("SCENE", command.scene, "Scene file (TOML)");
  t.option("--frames", command.frames, "Number of frames; 0: as the scene says");
  t.option("--set", command.settings,
           "Override a key of the scene, as KEY=VALUE; entries of lists by number, as blade.0.divide");
  t.flag("--resume", command.resume, "Continue from the last checkpoint in the output folder; start where it has none");
  t.flag("--portable", command.portable,
         "Vectors of two numbers, without fused products: the bytes of any x86 processor and of the page without a "
         "server; --resume goes on with those that the run began with");
  t.flag("--strict", command.strict,
         "Fail, with exit code 1, where the run is not as asked for: crumbs, crossings, refused steps, thin material, "
         "lag, energy from nothing");
  t.output("Folder of the run", {"a folder"});
  return t.run(argc, argv, [&] {
    if (command.portable) geo::set_vectors(geo::Vectors::portable);
    simulate(command, t);
  });
}
