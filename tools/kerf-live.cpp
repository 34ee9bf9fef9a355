// kerf-live: a deforming body in the browser, to be cut by hand.
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>

#include <kerf/body_file.h>
#include <kerf/error.h>
#include <kerf/files.h>
#include <kerf/vectors.h>
#include "live/bare_model.h"
#include "live/browser.h"
#include "live/gallery.h"
#include "live/loop.h"
#include "live/memory.h"
#include "live/page_text.h"
#include "live/server.h"
#include "sim/setup.h"
#include "tool.h"

namespace {

namespace fs = std::filesystem;

struct Command {
  std::optional<std::string> scene;  // none: a body of the gallery
  std::string address = "127.0.0.1", record, up = "z";
  std::vector<std::string> settings;
  int port = 0, nodes = 600;
  double rate = 60, linger = 30;
  bool portable = false, no_browser = false, no_blades = false;
};

// Makes a run of a scene or model, and warns of what may not be as meant.
live::Shown shown(const Command& command, const std::string& path, live::BareModel read, const tool::Tool& t) {
  sim::Setup& setup = read.setup;
  live::adapt_scene(setup.scene, command.rate, !command.no_blades);
  sim::warn_of_large_models(setup, t);
  sim::tell_touching_bodies(setup, t.name(), t);
  live::Shown shown{.name = fs::path(path).stem().string(), .waits = !live::is_scene(path), .notes = read.notes};
  shown.session = std::make_unique<live::Session>(setup, t.progress());
  sim::warn_of_coarse_models(setup, shown.session->run().body(), t);
  sim::warn_of_empty_grips(setup, shown.session->run().body(), t);
  return shown;
}

live::BareModel read_model(const Command& command, const live::ModelFile& file, const tool::Tool& t) {
  const char up = file.up ? file.up : command.up[0];
  live::BareModel model =
      live::bare_model(file.name, file.bytes, command.nodes, up, sim::parse_overrides(command.settings), file.beside);
  for (const std::string& note : model.notes) t.say(t.name() + ": " + note);
  return model;
}

// A model that was dropped on the page.
live::Shown open_dropped(const Command& command, live::ModelFile file, const tool::Tool& t) {
  if (live::is_scene(file.name))
    throw geo::InputError(file.name + ": is a scene, which names other files: start kerf-live with it");
  if (file.up == 0) file.up = live::up_axis(file.name);
  return shown(command, file.name, read_model(command, file, t), t);
}

// The page shows the other bodies of the gallery beside the first one.
live::Shown open_command(const Command& command, const live::OpenModel& open, const tool::Tool& t) {
  if (!command.scene) return live::open_from_page(open, live::gallery_model("apple"));
  const std::string& path = *command.scene;
  if (live::is_scene(path)) {
    sim::Setup setup = sim::read_setup(path, sim::parse_overrides(command.settings));
    return shown(command, path, {std::move(setup), {}}, t);
  }
  const live::ModelFile file{.name = path, .bytes = geo::read_all(path)};
  live::Shown result = shown(command, path, read_model(command, file, t), t);
  result.model = {.name = fs::path(file.name).filename().string(), .bytes = file.bytes};
  return result;
}

void require_options(const Command& command) {
  if (command.port < 0 || command.port > 65535) throw tool::UsageError("--port is from 0 to 65535");
  if (!(command.rate >= 1 && command.rate <= 240)) throw tool::UsageError("--rate is from 1 to 240 frames a second");
  if (command.nodes < 10 || command.nodes > 1000000) throw tool::UsageError("--nodes is from 10 to 1000000");
  if (!(command.linger >= 0)) throw tool::UsageError("--linger is a time in seconds, 0 for ever");
  if (!command.record.empty()) geo::require_writable(command.record);
}

bool has_work(const live::Session& session) {
  const geo::Scene recording = session.recording();
  const geo::Scene& original = session.original();
  return recording.blades.size() > original.blades.size() || recording.pulls.size() > original.pulls.size() ||
         recording.grips.size() > original.grips.size() || recording.blows.size() > original.blows.size();
}

// Where to write what hands did; empty: nowhere. A run that ended without being asked to keeps
// their work, and overwrites no file.
std::string record_path(const Command& command, const live::Shown& shown, live::LoopEnd end) {
  if (!command.record.empty()) return command.record;
  if (end == live::LoopEnd::asked || !has_work(*shown.session)) return {};
  std::string path = shown.name + "-recorded.toml";
  for (int number = 2; fs::exists(path); ++number) path = shown.name + "-recorded-" + std::to_string(number) + ".toml";
  return path;
}

void record(const live::Session& session, const std::string& path, const tool::Tool& t) {
  const std::string folder = fs::absolute(path).parent_path().string();
  geo::write_all(path, [&](std::ostream& out) { geo::write_scene(out, session.recording(), folder); });
  t.say("kerf-live: " + tool::counted(static_cast<std::size_t>(session.run().state().frame), "frame") +
        ", recorded in " + path);
}

void serve(const Command& command, const tool::Tool& t) {
  live::limit_free_memory();
  require_options(command);
  const auto open = [&](const live::ModelFile& file) { return open_dropped(command, file, t); };
  live::Shown shown = open_command(command, open, t);
  live::Inbox inbox;
  live::LoopEnd end;
  {
    live::Server server(
        {.address = command.address, .port = command.port, .token = live::random_token(), .page = live::page_text()},
        inbox);
    const std::string url = server.url() + (command.scene ? "" : "#bodies=true");
    std::cout << url << std::endl;
    const bool opened = !command.no_browser && live::open_browser(url);
    t.say(opened ? "kerf-live: opened in the browser; Ctrl-C ends it"
                 : "kerf-live: open this address in a browser; Ctrl-C ends it");
    end = live::run_loop(shown, inbox, server, {command.linger, &tool::Tool::goes_on, open});
  }
  if (end == live::LoopEnd::deserted)
    t.say("kerf-live: no page for " + tool::rounded(command.linger) + " s (--linger), so it ends");
  if (const std::string path = record_path(command, shown, end); !path.empty()) record(*shown.session, path, t);
}

}  // namespace

int main(int argc, char** argv) {
  tool::Tool t("kerf-live",
               "Simulates a scene, or a model on the ground, while hands cut, grab and pin it in a browser. Prints the "
               "address of the page.",
               R"(  kerf-live
  kerf-live samples/scenes/polyp.toml --no-blades
  kerf-live models/bear.off --up y --record bear.toml && kerf-sim bear.toml -o out/bear)");
  Command command;
  t.patience = 5;  // a frame may take long
  t.argument(
      "SCENE|MODEL", command.scene,
      "Scene file (TOML), or a model: OBJ, PLY, STL, OFF or GLB; without one the page begins with a choice of bodies");
  t.option("--port", command.port, "Port to listen at; 0: a free one");
  t.option("--address", command.address, "Address of the interface to listen at; 0.0.0.0: all, for other devices");
  t.option("--rate", command.rate,
           "Frames per second of the simulation; slow ones get less accuracy and longer time steps, within bounds");
  t.option("--linger", command.linger, "Seconds to wait for a page after the last one was closed; 0: for ever");
  t.output_option("--record", command.record, "Write what hands did as a scene to this file, at the end");
  t.option("--set", command.settings,
           "Override a key of the scene, as KEY=VALUE; entries of lists by number, as blade.0.divide");
  t.option("--nodes", command.nodes, "Nodes of a model that comes without a scene");
  t.choice("--up", command.up, {"y", "z"}, "Vertical axis of a model that comes without a scene");
  t.flag("--portable", command.portable, "Vectors of two numbers, without fused products, as kerf-sim --portable");
  t.flag("--no-browser", command.no_browser, "Open no browser");
  t.flag("--no-blades", command.no_blades, "Leave out the blades of the scene: only hands cut");
  return t.run(argc, argv, [&] {
    if (command.portable) geo::set_vectors(geo::Vectors::portable);
    serve(command, t);
  });
}
