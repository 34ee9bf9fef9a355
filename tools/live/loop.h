// The simulation loop of a live run: sample the input, compute a frame, show it, keep real time.
#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "live/inbox.h"
#include "live/model_file.h"
#include "live/pages.h"
#include "live/session.h"

namespace live {

/// A run, and how it is shown.
struct Shown {
  std::unique_ptr<Session> session = {};
  std::string name = {};  ///< of the scene or model
  /// Time stands still, and nothing weighs, until a hand touches the body; after a reset, too.
  bool waits = false;
  std::vector<std::string> notes = {};  ///< sentences for each page that comes
  ModelFile model = {};                 ///< as it was opened, without files beside it; empty: a scene
  bool from_page = false;               ///< the model is no file here: a recording names it without a folder
};

/// Makes a run of a model. Throws geo::InputError.
using OpenModel = std::function<Shown(const ModelFile& model)>;

/// A run of a model that a page has sent or chosen, with a tight skin where the model asks for one.
/// Throws as `open` does.
Shown open_from_page(const OpenModel& open, ModelFile model);

struct LoopOptions {
  double linger = 30;                  ///< s without a page before the loop ends; 0: never
  std::function<bool()> keep_on = {};  ///< asked several times a second; false ends the loop
  OpenModel open = {};                 ///< what pages may open; empty: nothing
};

enum class LoopEnd {
  asked,    ///< keep_on() was false
  deserted  ///< no page was there for a while
};

/// Runs until keep_on() is false, or no page is there for `linger` seconds after the last one went.
/// `shown` changes where a page opens another model.
LoopEnd run_loop(Shown& shown, Inbox& inbox, Pages& pages, const LoopOptions& options);

/// The loop turn by turn, for a program that waits by itself.
class Turns {
 public:
  /// Shows the run's first state. All must outlive the turns.
  Turns(Shown& shown, Inbox& inbox, Pages& pages, const LoopOptions& options);
  ~Turns();
  Turns(const Turns&) = delete;
  Turns& operator=(const Turns&) = delete;

  /// When the next frame is due; nothing while the run stands still, up to the next request.
  std::optional<std::chrono::steady_clock::time_point> due() const;
  /// Whether no page was there for `linger` seconds.
  bool is_deserted() const;
  /// Takes all requests, and computes and shows a frame unless the run stands still.
  void take();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace live
