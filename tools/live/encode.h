// Binary messages from the server to a page: docs/live-protocol.md.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "live/snapshot.h"

namespace live {

enum class Kind : std::uint8_t { state = 1, delta = 2, frame = 3, graph = 4, notice = 5, look = 6 };

/// Contents of a frame in addition to the surface, for one page.
struct Content {
  std::uint32_t sequence = 0;
  bool nodes = false, stress = false;
  std::uint64_t taken = 0;  ///< number of the page's last input in the snapshot
  bool rest = false;        ///< places in the material, and colours, of what is new; stress at vertices
};

/// STATE: everything, for a page that knows nothing.
std::string encode_state(const Snapshot& snapshot, const Content& content);
/// FRAME, or DELTA where the page has another topology than the snapshot.
std::string encode_frame(const Snapshot& snapshot, const Topology& known, const Content& content);
/// GRAPH. Precondition: the snapshot has one.
std::string encode_graph(const Snapshot& snapshot, std::uint32_t sequence);
/// LOOK. Precondition: the snapshot has one.
std::string encode_look(const Snapshot& snapshot, std::uint32_t sequence);
/// NOTICE. `key`: "error" or "notice".
std::string encode_notice(std::string_view key, std::string_view sentence, std::uint32_t sequence);

}  // namespace live
