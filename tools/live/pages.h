// The pages that show a run, as the simulation sees them: WebSockets of a server, or the page
// around a worker.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "live/snapshot.h"

namespace live {

class Pages {
 public:
  virtual ~Pages() = default;
  /// Shows a state to all pages, each as soon as it has confirmed what it got before.
  virtual void publish(std::shared_ptr<const Snapshot> snapshot) = 0;
  /// Tells a page a sentence. `key`: "error" or "notice".
  virtual void tell(ClientId page, const std::string& key, const std::string& sentence) = 0;
  /// Whether a page wants nodes.
  virtual bool wants_nodes() const = 0;
  /// Whether a page wants stress.
  virtual bool wants_stress() const = 0;
  /// The number of requests of the graph so far.
  virtual std::uint64_t graphs_wanted() const = 0;
};

}  // namespace live
