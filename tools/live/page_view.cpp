// Notices go first, then the graph, then the newest state.
#include "live/page_view.h"

#include <utility>

#include "live/encode.h"

namespace live {
namespace {

constexpr std::size_t max_notices = 16;  // that wait for a page

}  // namespace

void PageView::tell(std::string_view key, std::string_view sentence) {
  if (notices_.size() < max_notices) notices_.push_back(encode_notice(key, sentence, 0));
}

std::optional<std::string> PageView::next(const std::shared_ptr<const Snapshot>& latest) {
  if (!notices_.empty()) {
    std::string notice = std::move(notices_.front());
    notices_.pop_front();
    return notice;
  }
  if (awaited_ || !latest) return {};
  const Snapshot& s = *latest;
  if (s.graph && graph_asked_ && s.graph_number >= *graph_asked_) {
    graph_asked_.reset();
    awaited_ = ++sequence_;
    return encode_graph(s, sequence_);
  }
  if (rest_ && s.look && s.look != look_) {
    look_ = s.look;
    awaited_ = ++sequence_;
    return encode_look(s, sequence_);
  }
  if (s.number == sent_ && known_) return {};
  const auto taken = s.taken.find(id_);
  const Content content{.sequence = ++sequence_,
                        .nodes = nodes,
                        .stress = stress,
                        .taken = taken == s.taken.end() ? 0 : taken->second,
                        .rest = rest_};
  const bool knows = known_ && scene_ == s.scene;  // another scene where another model was opened
  std::string message = knows ? encode_frame(s, *known_, content) : encode_state(s, content);
  known_ = s.topology;
  scene_ = s.scene;
  sent_ = s.number;
  awaited_ = sequence_;
  return message;
}

void PageView::acknowledged(std::uint32_t sequence) {
  if (awaited_ == sequence) awaited_.reset();
}

}  // namespace live
