// kerf-live with a client over the loopback interface, which cuts all the time: frames shown, time
// from a pointer event to the frame that shows it, cost of a step that cuts, bytes.
#include <algorithm>
#include <atomic>
#include <chrono>
#include <functional>
#include <memory>
#include <random>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "bench.h"
#include "client.h"
#include "cut_times.h"
#include "kerf/mesh.h"
#include "live/loop.h"
#include "live/server.h"
#include "live_heap.h"
#include "sample_scenes.h"

namespace bench {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

// A scene of samples/scenes without its blades.
sim::Setup scene(const std::string& name, double rate) {
  sim::Setup s;
  s.scene = sample_scene(name);
  s.models = geo::place_models(s.scene, sample_models(name));
  live::adapt_scene(s.scene, rate, false);
  return s;
}

// A stroke across the bodies every two seconds, 0.8 s long: through the polyp's stalk, at three
// heights through the apple, down through the letters. Then a new beginning.
class Strokes {
 public:
  Strokes(const std::string& name, const geo::Box3& box)
      : box_(box), kinds_(name == "apple" ? 3 : 1), is_down_(name == "letters") {}

  // The pose at a time; Phase::end between strokes.
  live::Stroke pose(double time) const {
    constexpr double every = 2, length = 0.8;
    const double phase = std::fmod(time, every) / length;
    const auto k = static_cast<int>(time / every);
    const geo::Vec3 size = box_.hi - box_.lo;
    const double way = std::clamp(phase, 0.0, 1.0) * 1.2 - 0.1, level = 0.51 + 0.1 * (k % kinds_);
    live::Stroke s;
    s.id = static_cast<std::uint64_t>(k);
    s.origin = box_.lo + (is_down_ ? geo::Vec3(way * size.x(), level * size.y(), 1.3 * size.z())
                                   : geo::Vec3(way * size.x(), -0.3 * size.y(), level * size.z()));
    s.direction = (is_down_ ? geo::Vec3(0.02, 0.03, -1) : geo::Vec3(0.03, 1, 0.02 * way)).normalized();
    s.depth = 1.6 * (is_down_ ? size.z() : size.y());
    s.phase = phase < 1 ? live::Phase::move : live::Phase::end;
    return s;
  }
  // Whether a new beginning follows a stroke.
  bool is_last(std::uint64_t id) const { return static_cast<int>(id) % kinds_ == kinds_ - 1; }
  std::string message(double time, std::uint64_t input) {
    live::Stroke s = pose(time);
    if (s.phase == live::Phase::end && !holds_) return undone(s.id);
    const bool begins = !holds_ || id_ != s.id;
    holds_ = s.phase != live::Phase::end;
    id_ = s.id;
    const auto row = [](const geo::Vec3& p) {
      return "[" + std::to_string(p.x()) + "," + std::to_string(p.y()) + "," + std::to_string(p.z()) + "]";
    };
    const std::string phase = !holds_ ? "end" : begins ? "begin" : "move";
    return "{\"knife\":{\"id\":" + std::to_string(s.id) + ",\"phase\":\"" + phase +
           "\",\"input\":" + std::to_string(input) + ",\"eye\":" + row(s.origin) + ",\"ray\":" + row(s.direction) +
           ",\"depth\":" + std::to_string(s.depth) + ",\"from\":0}}";
  }

 private:
  std::string undone(std::uint64_t id) {
    if (id == undone_ || !is_last(id)) return {};
    undone_ = id;
    return "{\"reset\":true}";
  }
  geo::Box3 box_;
  int kinds_;
  bool is_down_;
  bool holds_ = false;
  std::uint64_t id_ = ~std::uint64_t(0), undone_ = ~std::uint64_t(0);
};

// A run with its server, as kerf-live has it.
class Running {
 public:
  explicit Running(const sim::Setup& s)
      : shown_{.session = std::make_unique<live::Session>(s, nullptr), .name = "bench"},
        server_({"127.0.0.1", 0, "token", ""}, inbox_),
        loop_([this] {
          live::run_loop(shown_, inbox_, server_, {.linger = 0, .keep_on = [this] { return !stops_.load(); }});
        }) {}
  ~Running() {
    stops_ = true;
    loop_.join();
  }
  std::string url() const { return server_.url(); }

 private:
  live::Shown shown_;
  live::Inbox inbox_;
  live::Server server_;
  std::atomic<bool> stops_{false};
  std::thread loop_;
};

struct Shown {
  double fps = 0, bytes = 0, latency = 0, delta_bytes = 0;  // a second; of a frame; 95 of 100 events, s; of a cut
  double pace = 0;                                          // frames computed per second, as the server says
};

// A client that confirms each message, and moves the knife at random times.
Shown show(const std::string& name, double rate, double seconds) {
  const sim::Setup s = scene(name, rate);
  const Running running(s);
  Client client(running.url());
  Strokes strokes(name, geo::bounding_box(s.models.all));
  std::mt19937_64 random(1);
  std::vector<double> latency;
  Shown result;
  double frames = 0, bytes = 0, plain = 0, deltas = 0, delta_bytes = 0;
  std::uint64_t input = 0, waited = 0;
  const double warm = 1;
  const auto start = Clock::now();
  Clock::time_point sent = start;
  for (double now = 0; now < warm + seconds; now = seconds_since(start)) {
    client.next();
    if (client.page.kind == 5) continue;
    now = seconds_since(start);
    if (waited != 0 && client.page.statistics["ack_input"] >= waited) {
      if (now > warm) latency.push_back(seconds_since(sent));
      waited = 0;
    }
    if (now > warm) {
      ++frames;
      if (client.page.kind == 3) {
        ++plain;
        bytes += double(client.bytes);
      }
      if (client.page.kind == 2) {
        ++deltas;
        delta_bytes += double(client.bytes);
      }
      result.pace = client.page.statistics["fps"];
    }
    client.acknowledge();
    if (waited != 0) continue;
    std::this_thread::sleep_for(std::chrono::microseconds(random() % 5000));  // not in step with the frames
    if (const std::string text = strokes.message(seconds_since(start), input + 1); !text.empty()) {
      sent = Clock::now();
      client.send(text);
      if (text.starts_with("{\"knife")) waited = ++input;
    }
  }
  result.fps = frames / seconds;
  result.bytes = bytes / std::max(1.0, plain);
  result.delta_bytes = delta_bytes / std::max(1.0, deltas);
  std::sort(latency.begin(), latency.end());
  if (!latency.empty()) result.latency = latency[latency.size() * 95 / 100];
  return result;
}

// Frames computed per second beside a client that confirms every half second.
double throttled_pace(const sim::Setup& s, double seconds) {
  const Running running(s);
  Client client(running.url());
  double first = 0, passed = 0;
  auto start = Clock::now();
  for (int k = 0; k == 0 || seconds_since(start) < seconds; ++k) {
    client.next();
    if (k == 1) {
      first = client.page.time;
      start = Clock::now();
    }
    if (k > 1) passed = (client.page.time - first) * s.scene.frame_rate / seconds_since(start);
    client.acknowledge();
    std::this_thread::sleep_for(std::chrono::milliseconds(500));
  }
  return passed;
}

// Mean time of a frame that cuts over that of one that does not, in the same run.
double cut_ratio(const std::string& name, double seconds) {
  const sim::Setup s = scene(name, 60);
  live::Session session(s, {});
  const Strokes strokes(name, geo::bounding_box(s.models.all));
  CutTimes times;
  std::uint64_t last = ~std::uint64_t(0);
  live::Snapshot shown;
  session.show(shown);
  const double rate = s.scene.frame_rate;
  bool holds = false;
  for (int frame = 0; frame < seconds * rate; ++frame) {
    live::Stroke stroke = strokes.pose(frame / rate);
    if (stroke.phase != live::Phase::end && stroke.id != last) {
      stroke.phase = live::Phase::begin;
      last = stroke.id;
      holds = true;
      if (stroke.id > 0 && strokes.is_last(stroke.id - 1)) {
        session.reset();
        session.advance();
      }
      session.obey(1, stroke);
    } else if (holds) {
      holds = stroke.phase != live::Phase::end;
      session.obey(1, stroke);
    }
    times.advance(session);
  }
  return times.cut() / times.plain();
}

}  // namespace

int live(const Options& options) {
  Figures figures;
  for (const std::string& model : options.models) heap(model, figures);
  if (!options.models.empty()) {
    print(figures, options.json);
    return 0;
  }
  const double seconds = 12;
  const auto add = [&](const std::string& name, double rate) {
    const Shown shown = show(name, rate, seconds);
    figures[name + "_fps"] = shown.fps;
    figures[name + "_frame_bytes"] = shown.bytes;
    figures[name + "_delta_bytes"] = shown.delta_bytes;
    figures[name + "_latency_p95_ms"] = 1e3 * shown.latency;
  };
  add("polyp", 120);
  add("apple", 60);
  add("letters", 60);
  figures["latency_p95_ms"] = 1e3 * show("polyp", 60, seconds).latency;
  figures["polyp_cut_step_ratio"] = cut_ratio("polyp", seconds);
  figures["apple_cut_step_ratio"] = cut_ratio("apple", seconds);
  figures["cut_step_ratio"] = std::max(figures["polyp_cut_step_ratio"], figures["apple_cut_step_ratio"]);
  figures["throttled_pace"] = throttled_pace(scene("polyp", 60), 6) / 60;
  print(figures, options.json);
  return 0;
}

}  // namespace bench
