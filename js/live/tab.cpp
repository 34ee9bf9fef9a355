// kerf-live in a browser's tab: the loop of tools/live in a worker, turn by turn, with one page.
#include <emscripten/bind.h>
#include <emscripten/val.h>

#include <chrono>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <kerf/error.h>
#include <kerf/parallel.h>
#include "live/bare_model.h"
#include "live/inbox.h"
#include "live/loop.h"
#include "live/page_view.h"
#include "live/save.h"

namespace {

using emscripten::val;
using Clock = std::chrono::steady_clock;

constexpr live::ClientId the_page = 1;

// The defaults of kerf-live's --nodes and --rate.
constexpr int default_nodes = 600;
constexpr double default_rate = 60;

val bytes_of(const std::string& bytes) {
  return val(emscripten::typed_memory_view(bytes.size(), reinterpret_cast<const std::uint8_t*>(bytes.data())))
      .call<val>("slice");
}

std::string text_from(const val& bytes) {
  std::string text(bytes["length"].as<std::size_t>(), '\0');
  val(emscripten::typed_memory_view(text.size(), reinterpret_cast<std::uint8_t*>(text.data())))
      .call<void>("set", bytes);
  return text;
}

// The one page, as the loop sees it.
class TabPage : public live::Pages {
 public:
  void publish(std::shared_ptr<const live::Snapshot> snapshot) override { latest_ = std::move(snapshot); }
  void tell(live::ClientId, const std::string& key, const std::string& sentence) override { view_.tell(key, sentence); }
  bool wants_nodes() const override { return view_.nodes; }
  bool wants_stress() const override { return view_.stress; }
  std::uint64_t graphs_wanted() const override { return graphs_; }

  std::optional<std::string> next() { return view_.next(latest_); }
  // Obeys what concerns the page alone, and passes on all else.
  void read(const std::string& text, live::Inbox& inbox) {
    try {
      live::Command command = live::read_command(text);
      if (const auto* ack = std::get_if<live::Acknowledge>(&command)) return view_.acknowledged(ack->sequence);
      if (const auto* want = std::get_if<live::Want>(&command)) {
        view_.nodes = want->nodes.value_or(view_.nodes);
        view_.stress = want->stress.value_or(view_.stress);
        if (want->rest) view_.want_rest(*want->rest);
        if (want->graph) view_.ask_graph(++graphs_);
      }
      if (!inbox.put({the_page, std::move(command)}))
        view_.tell("error", "the simulation is busy; the message is left out");
    } catch (const live::BadMessage& e) {
      view_.tell("error", e.what());
    }
  }

 private:
  live::PageView view_{the_page};
  std::shared_ptr<const live::Snapshot> latest_;
  std::uint64_t graphs_ = 0;
};

struct Tab {
  live::Shown shown;
  live::Inbox inbox;
  TabPage page;
  live::LoopOptions options;
  std::unique_ptr<live::Turns> turns;
};
Tab tab;

// A scene names files that a tab does not have.
live::Shown shown_model(const live::ModelFile& file, char up, int nodes) {
  const std::string& name = file.name;
  if (live::is_scene(name)) throw geo::InputError(name + ": is a scene, which names other files: drop a model");
  live::BareModel read = live::bare_model(name, file.bytes, nodes, up, {}, file.beside);
  live::adapt_scene(read.setup.scene, default_rate, true);
  live::Shown shown{.name = std::filesystem::path(name).stem().string(), .waits = true, .notes = read.notes};
  shown.session = std::make_unique<live::Session>(read.setup, geo::Progress());
  return shown;
}

char up_axis(const live::ModelFile& file, const std::string& wanted) {
  if (file.up) return file.up;
  if (wanted == "y" || wanted == "z") return wanted[0];
  return live::up_axis(file.name) == 'y' ? 'y' : 'z';
}

// Files that came with a model: a list of {name, bytes}.
std::vector<live::BesideFile> beside_of(const val& files) {
  std::vector<live::BesideFile> beside;
  const auto count = files["length"].as<unsigned>();
  for (unsigned i = 0; i < count; ++i)
    beside.push_back({files[i]["name"].as<std::string>(), text_from(files[i]["bytes"])});
  return beside;
}

// Opens a model in place of the one that is shown; the reason where it cannot be opened.
std::string open_model(const std::string& name, const val& bytes, const val& beside, const std::string& up, int nodes) {
  const int wanted = nodes > 0 ? nodes : default_nodes;
  tab.options.open = [=](const live::ModelFile& file) { return shown_model(file, up_axis(file, up), wanted); };
  live::ModelFile file{.name = name, .bytes = text_from(bytes), .beside = beside_of(beside)};
  if (!tab.turns) {
    try {
      geo::set_threads(1);
      tab.shown = live::open_from_page(tab.options.open, std::move(file));
      tab.options.linger = 0;
      tab.turns = std::make_unique<live::Turns>(tab.shown, tab.inbox, tab.page, tab.options);
      tab.inbox.put({the_page, live::Join{}});
      tab.turns->take();
      return {};
    } catch (const std::exception& e) {
      return e.what();
    }
  }
  std::string reason;
  tab.inbox.put({0, live::Open{std::move(file), [&](live::Answer answer) { reason = std::move(answer.error); }}});
  tab.turns->take();
  return reason;
}

// The file as {bytes, name}, or {error}.
val save(const std::string& format) {
  val result = val::object();
  if (!live::is_save_format(format)) {
    result.set("error", std::string(live::save_formats));
    return result;
  }
  tab.inbox.put({0, live::Save{format, [&](live::Answer answer) {
                                 if (!answer.error.empty()) return result.set("error", answer.error);
                                 result.set("bytes", bytes_of(answer.bytes));
                                 result.set("name", answer.name);
                               }}});
  tab.turns->take();
  return result;
}

void message(const std::string& text) {
  if (tab.turns) tab.page.read(text, tab.inbox);
}

// The next message for the page; undefined: there is none now.
val next_message() {
  const auto next = tab.page.next();
  return next ? bytes_of(*next) : val::undefined();
}

// Takes what the page has said, computes a frame where one is due.
std::string take_turn() {
  try {
    if (tab.turns) tab.turns->take();
    return {};
  } catch (const std::exception& e) {
    return e.what();
  }
}

// Milliseconds until a frame is due; below 0: the run stands still up to the next message.
double wait_time() {
  const auto due = tab.turns ? tab.turns->due() : std::nullopt;
  if (!due) return -1;
  return std::max(0.0, std::chrono::duration<double, std::milli>(*due - Clock::now()).count());
}

}  // namespace

EMSCRIPTEN_BINDINGS(kerf_tab) {
  emscripten::function("openModel", &open_model);
  emscripten::function("save", &save);
  emscripten::function("message", &message);
  emscripten::function("nextMessage", &next_message);
  emscripten::function("takeTurn", &take_turn);
  emscripten::function("waitTime", &wait_time);
}
