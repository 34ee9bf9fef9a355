// The messages to a page, by what it has been sent and has shown: docs/live-protocol.md.
#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "live/snapshot.h"

namespace live {

/// A page has at most one message that it has not confirmed, notices not counted.
class PageView {
 public:
  explicit PageView(ClientId id) : id_(id) {}

  /// A sentence to be sent. Where too many wait, it is left out.
  void tell(std::string_view key, std::string_view sentence);
  /// The next message, if the page is ready for one and there is news in `latest`, which may be
  /// null.
  std::optional<std::string> next(const std::shared_ptr<const Snapshot>& latest);
  /// The page has shown the message of this number.
  void acknowledged(std::uint32_t sequence);
  /// The page has asked for the graph, by this number.
  void ask_graph(std::uint64_t number) { graph_asked_ = number; }

  bool nodes = false, stress = false;  ///< whether frames have these
  /// Whether the page receives places in the material, and colours. All is then sent anew.
  void want_rest(bool on) {
    if (std::exchange(rest_, on) != on) known_ = nullptr;
  }

 private:
  ClientId id_;
  std::deque<std::string> notices_;
  std::uint32_t sequence_ = 0;
  std::optional<std::uint32_t> awaited_;  // number of the message that is not confirmed
  std::shared_ptr<const Topology> known_;
  std::shared_ptr<const std::string> scene_;
  std::uint64_t sent_ = 0;
  bool rest_ = false;
  std::shared_ptr<const std::string> look_;   // that the page has
  std::optional<std::uint64_t> graph_asked_;  // number of the request that is not answered
};

}  // namespace live
