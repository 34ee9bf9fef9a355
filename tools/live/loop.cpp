// Input is taken right before a frame is computed. Without a page, paused, or while it waits for a
// touch, nothing is computed.
#include "live/loop.h"

#include <algorithm>
#include <filesystem>
#include <set>
#include <thread>
#include <utility>

#include <kerf/error.h>

#include "live/gallery.h"
#include "live/memory.h"
#include "live/pace.h"
#include "live/save.h"
#include "live/scene_text.h"

namespace live {

using Clock = Pacer::Clock;

namespace {

// Seconds by which input may be late. A stroke whose begin waited longer is left out. A stroke ends
// this long after its pointer was released, in the time of the simulation.
constexpr double latest_begin = 1, latest_end = 2;

}  // namespace

Shown open_from_page(const OpenModel& open, ModelFile model) {
  Shown opened = open(model);
  if (model.tension > 1) opened.session->tighten(model.tension);
  opened.model = {.name = std::move(model.name), .bytes = std::move(model.bytes), .from_gallery = model.from_gallery};
  opened.from_page = true;
  return opened;
}

struct Turns::Impl {
  Impl(Shown& shown, Inbox& inbox, Pages& pages, const LoopOptions& options)
      : shown_(shown), inbox_(inbox), shows_(pages), options_(options), pacer_(pacer_of(*shown.session)) {
    begin();
    publish();
  }

  bool moves() const { return !pages_.empty() && !waits_ && (!paused_ || steps_ > 0); }
  Clock::time_point due() const { return pacer_.due(); }
  bool is_deserted() const {
    return options_.linger > 0 && came_ && pages_.empty() &&
           Clock::now() - gone_ > std::chrono::duration<double>(options_.linger);
  }
  void turn() {
    const bool was_moving = moves();
    bool changed = false;
    for (Request& request : inbox_.take()) changed |= take(std::move(request));
    release();
    if (!was_moving || waits_) {  // a reset may be among the requests
      pacer_.restart();
      if (changed) publish();
      return;
    }
    compute();
    publish();
  }

 private:
  static Pacer pacer_of(const Session& session) {
    return {1 / session.original().frame_rate, session.effort(), session.least_effort()};
  }
  Session& session() const { return *shown_.session; }

  // Shows a run from its beginning.
  void begin() {
    pacer_ = pacer_of(session());
    scene_ = std::make_shared<std::string>(scene_text(session(), shown_.name, ++runs_, shown_.model.from_gallery));
    effort_ = session().effort();
    paused_ = false;
    steps_ = 0;
    graph_ = nullptr;
    wait();
  }
  // A model without a scene waits for a hand, without weight.
  void wait() {
    waits_ = shown_.waits;
    if (waits_) session().withhold_weight();
  }

  void compute() {
    const auto begin = Clock::now();
    if (const std::string reason = session().advance(paused_); !reason.empty()) say("went back: " + reason);
    if (const std::size_t refused = session().stats().refused; refused > 0)
      say("a bit of the cut would make surfaces cross and is left out; it goes on where it can");
    const auto end = Clock::now();
    pacer_.add(begin, end);
    if (session().end_late_strokes(1 / session().original().frame_rate, latest_end) > 0)
      say("the edge is far behind the pointer: a stroke ends where it is");
    steps_ = std::max(0, steps_ - 1);
    if (const Effort effort = pacer_.effort(); effort != effort_) {
      session().set_effort(effort);
      effort_ = effort;
    }
  }

  // Gives freed memory back to the system from time to time.
  void release() {
    constexpr std::chrono::seconds interval(10);
    if (const auto now = Clock::now(); now - released_ > interval) {
      release_free_memory();
      released_ = now;
    }
  }

  // Whether pages are to be shown a new state.
  bool take(Request request) {
    const ClientId page = request.page;
    try {
      if (is_late_stroke(request, Clock::now(), latest_begin))
        throw BadMessage("frames take longer than a second: a stroke that began meanwhile is left out");
      return std::visit([&](auto& what) { return obey(page, what); }, request.what);
    } catch (const BadMessage& e) {
      shows_.tell(page, "error", e.what());
      return false;
    }
  }
  bool obey(ClientId page, Join&) {
    pages_.insert(page);
    came_ = true;
    for (const std::string& note : shown_.notes) shows_.tell(page, "notice", note);
    return true;
  }
  bool obey(ClientId page, Leave&) {
    pages_.erase(page);
    gone_ = Clock::now();
    session().leave(page);
    return true;
  }
  bool obey(ClientId, Save& save) {
    try {
      if (save.format == "model") {
        if (shown_.model.bytes.empty()) throw BadMessage("a scene names its models, which are files of their own");
        save.answer({.bytes = shown_.model.bytes, .name = shown_.model.name});
      } else {
        const std::string folder = shown_.from_page ? std::filesystem::current_path().string() : "";
        // No file has the name of the model, which the recording names.
        const std::string kind = save.format == "toml" ? "" : "-saved";
        save.answer(
            {.bytes = saved_file(session(), save.format, folder), .name = shown_.name + kind + "." + save.format});
      }
    } catch (const std::exception& e) {
      save.answer({.error = e.what()});
    }
    return false;
  }
  bool obey(ClientId, Open& open) {
    try {
      show(std::move(open.model));
      open.answer({});
    } catch (const std::exception& e) {
      open.answer({.error = e.what()});
    }
    return true;
  }
  // Shows a model in place of the present one. Throws geo::InputError, BadMessage.
  void show(ModelFile model) {
    if (!options_.open) throw BadMessage("no model can be opened here");
    shown_ = open_from_page(options_.open, std::move(model));
    release_free_memory();
    begin();
    for (const ClientId page : pages_)
      for (const std::string& note : shown_.notes) shows_.tell(page, "notice", note);
  }
  bool obey(ClientId page, Command& command) {
    if (is_touch(command)) waits_ = false;
    return std::visit([&](const auto& c) { return obey_command(page, c); }, command);
  }
  static bool is_touch(const Command& command) {
    const auto* stroke = std::get_if<Stroke>(&command);
    const auto* grab = std::get_if<Grab>(&command);
    return (stroke && stroke->phase == Phase::begin) || (grab && grab->phase == Phase::begin) ||
           std::holds_alternative<Pin>(command) || std::holds_alternative<Blow>(command) ||
           std::holds_alternative<Set>(command) || std::holds_alternative<Step>(command);
  }
  bool obey_command(ClientId, const Acknowledge&) { return false; }
  bool obey_command(ClientId, const Want&) { return true; }
  // A run that stands still shows that a stroke waits.
  bool obey_command(ClientId page, const Stroke& c) {
    session().obey(page, c);
    return paused_ && c.phase != Phase::move;
  }
  bool obey_command(ClientId page, const Grab& c) {
    session().obey(page, c);
    return paused_ && c.phase != Phase::move;
  }
  bool obey_command(ClientId, const Pin& c) {
    session().obey(c);
    return true;
  }
  bool obey_command(ClientId, const Set& c) {
    session().obey(c);
    if (c.tension) {
      restart();
      wait();
    }
    return true;
  }
  bool obey_command(ClientId, const Blow& c) {
    session().obey(c);
    restart();
    return true;
  }
  bool obey_command(ClientId, const Show& c) {
    try {
      show(gallery_model(c.name));
    } catch (const geo::InputError& e) {
      throw BadMessage(e.what());
    }
    return true;
  }
  bool obey_command(ClientId, const Undo&) {
    session().undo();
    restart();
    waits_ = shown_.waits && session().is_weightless();
    return true;
  }
  bool obey_command(ClientId, const Redo&) {
    session().redo();
    restart();
    waits_ = false;
    return true;
  }
  bool obey_command(ClientId, const Reset&) {
    session().reset();
    restart();
    wait();
    return true;
  }
  bool obey_command(ClientId, const Pause& c) {
    paused_ = c.on;
    return true;
  }
  bool obey_command(ClientId, const Step&) {
    paused_ = true;
    ++steps_;
    return false;
  }

  // After going back, the effort is what the recording says.
  void restart() {
    effort_ = session().effort();
    pacer_.restart();
  }

  void say(const std::string& sentence) {
    message_ = sentence;
    said_ = Clock::now();
  }

  void publish() {
    auto s = std::make_shared<Snapshot>();
    s->number = ++number_;
    session().show(*s, shows_.wants_stress());
    const geo::Simulation& run = session().run();
    if (shows_.wants_nodes()) {
      s->nodes = run.body().nodes.position;
      for (std::size_t i = 0; i < s->nodes.size(); ++i) s->nodes[i] += run.state().motion.displacement[i];
    }
    if (const auto asked = shows_.graphs_wanted(); asked != graphs_) {
      graphs_ = asked;
      graph_ = edges();
    }
    s->graph = graph_;
    s->graph_number = graphs_;
    s->scene = scene_;
    s->statistics = statistics_text(session(), pace());
    shows_.publish(std::move(s));
  }
  Pace pace() {
    if (Clock::now() - said_ > std::chrono::seconds(4)) message_.clear();
    std::string message = message_;
    if (message.empty() && pacer_.slow())
      message = "slower than real time: " + std::to_string(static_cast<int>(100 * pacer_.rate() + 0.5)) + " %";
    return {.fps = pacer_.fps(),
            .rate = pacer_.rate(),
            .step = pacer_.step(),
            .effort = session().effort(),
            .paused = paused_,
            .message = message};
  }
  std::shared_ptr<const std::vector<std::pair<std::uint32_t, std::uint32_t>>> edges() const {
    auto list = std::make_shared<std::vector<std::pair<std::uint32_t, std::uint32_t>>>();
    const geo::Body& body = session().run().body();
    for (std::uint32_t i = 0; i < body.nodes.size(); ++i)
      for (const geo::NodeId j : body.graph.edges(geo::NodeId(i)))
        if (j.value > i && j.value < body.nodes.size()) list->push_back({i, j.value});
    return list;
  }

  Shown& shown_;
  Inbox& inbox_;
  Pages& shows_;
  const LoopOptions& options_;
  Pacer pacer_;
  std::shared_ptr<const std::string> scene_;
  std::set<ClientId> pages_;
  bool came_ = false, paused_ = false;
  int steps_ = 0;       // to be made while paused
  Effort effort_;       // in force, unless the scene changes it
  bool waits_ = false;  // for the first touch
  Clock::time_point gone_ = Clock::now(), said_ = Clock::now(), released_ = Clock::now();
  std::string message_;
  std::uint64_t number_ = 0, graphs_ = 0, runs_ = 0;
  std::shared_ptr<const std::vector<std::pair<std::uint32_t, std::uint32_t>>> graph_;
};

Turns::Turns(Shown& shown, Inbox& inbox, Pages& pages, const LoopOptions& options)
    : impl_(std::make_unique<Impl>(shown, inbox, pages, options)) {}
Turns::~Turns() = default;

std::optional<Clock::time_point> Turns::due() const {
  if (!impl_->moves()) return {};
  return impl_->due();
}
bool Turns::is_deserted() const { return impl_->is_deserted(); }
void Turns::take() { impl_->turn(); }

LoopEnd run_loop(Shown& shown, Inbox& inbox, Pages& pages, const LoopOptions& options) {
  Turns turns(shown, inbox, pages, options);
  while (options.keep_on()) {
    if (turns.is_deserted()) return LoopEnd::deserted;
    const auto soon = Clock::now() + std::chrono::milliseconds(100);
    // Until a frame is due, requests wait for it: so the input is the latest.
    if (const auto due = turns.due())
      while (Clock::now() < *due) std::this_thread::sleep_until(std::min(*due, soon));
    else
      inbox.wait_until(soon);
    turns.take();
  }
  return LoopEnd::asked;
}

}  // namespace live
