// kerf-live: a deforming body in the browser, to be cut by hand.
#include <cstdio>
#include <filesystem>
#include <iostream>

#include <kerf/files.h>
#include "live/bare_model.h"
#include "live/browser.h"
#include "live/loop.h"
#include "live/memory.h"
#include "live/page_text.h"
#include "sim/setup.h"
#include "tool.h"

namespace {

namespace fs = std::filesystem;

struct Command {
  std::string scene, address = "127.0.0.1", record, up = "z";
  std::vector<std::string> settings;
  int port = 0, nodes = 600;
  double rate = 60, linger = 30;
  bool no_browser = false, no_blades = false;
};

sim::Setup read(const Command& command, const tool::Tool& t) {
  const geo::SceneOverrides overrides = sim::parse_overrides(command.settings);
  sim::Setup setup = live::is_scene(command.scene)
                         ? sim::read_setup(command.scene, overrides)
                         : live::bare_model(command.scene, command.nodes, command.up[0], overrides);
  live::adapt_scene(setup.scene, command.rate, !command.no_blades);
  sim::warn_of_large_models(setup, t);
  sim::tell_touching_bodies(setup, "kerf-live", t);
  return setup;
}

void require_options(const Command& command) {
  if (command.port < 0 || command.port > 65535) throw tool::UsageError("--port is from 0 to 65535");
  if (!(command.rate >= 1 && command.rate <= 240)) throw tool::UsageError("--rate is from 1 to 240 frames a second");
  if (command.nodes < 10 || command.nodes > 1000000) throw tool::UsageError("--nodes is from 10 to 1000000");
  if (!(command.linger >= 0)) throw tool::UsageError("--linger is a time in seconds, 0 for ever");
  if (!command.record.empty()) geo::require_writable(command.record);
}

void serve(const Command& command, const tool::Tool& t) {
  live::limit_free_memory();
  require_options(command);
  const sim::Setup setup = read(command, t);
  live::Session session(setup, t.progress());
  sim::warn_of_coarse_models(setup, session.run().body(), t);
  sim::warn_of_empty_grips(setup, session.run().body(), t);
  live::Inbox inbox;
  const std::string name = fs::path(command.scene).stem().string();
  {
    live::Server server({command.address, command.port, live::random_token(), live::page_text(), name}, inbox);
    std::cout << server.url() << std::endl;
    const bool opened = !command.no_browser && live::open_browser(server.url());
    t.say(opened ? "kerf-live: opened in the browser; Ctrl-C ends it"
                 : "kerf-live: open this address in a browser; Ctrl-C ends it");
    live::run_loop(session, inbox, server,
                   {name, command.linger, &tool::Tool::goes_on, !live::is_scene(command.scene)});
  }
  if (command.record.empty()) return;
  const std::string folder = fs::absolute(command.record).parent_path().string();
  geo::write_all(command.record, [&](std::ostream& out) { geo::write_scene(out, session.recording(), folder); });
  t.say("kerf-live: " + tool::counted(static_cast<std::size_t>(session.run().state().frame), "frame") +
        ", recorded in " + command.record);
}

}  // namespace

int main(int argc, char** argv) {
  tool::Tool t("kerf-live",
               "Simulates a scene, or a model on the ground, while hands cut, grab and pin it in a browser. Prints the "
               "address of the page.",
               "  kerf-live samples/scenes/polyp.toml --no-blades\n  kerf-live models/bear.off --up y --record "
               "bear.toml && kerf-sim bear.toml -o out/bear");
  Command command;
  t.patience = 5;  // a frame may take long
  t.argument("SCENE|MODEL", command.scene, "Scene file (TOML), or a model: OBJ, PLY, STL or OFF");
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
  t.flag("--no-browser", command.no_browser, "Open no browser");
  t.flag("--no-blades", command.no_blades, "Leave out the blades of the scene: only hands cut");
  return t.run(argc, argv, [&] { serve(command, t); });
}
