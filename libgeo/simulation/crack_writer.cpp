// Nodes follow first, then the surface on them. Weights of the surface, points of the solid and
// loads follow when they are needed.
#include "simulation/crack_writer.h"

#include <utility>

#include "kerf/error.h"
#include "simulation/timed.h"

namespace geo {

CrackWriter::CrackWriter(Body& body, std::vector<std::uint32_t>& body_index, const CrackOptions& options,
                         std::optional<CrackFollowers> followers)
    : body_(body), body_index_(body_index), options_(options), followers_(followers) {}

std::optional<BegunCrack> CrackWriter::begin(const FrontState& front, std::span<const Vec3> next, FrameStats& stats) {
  FrontState after = front;
  std::optional<BegunCrack> begun = begin(advance_of(after, next, options_), stats);
  if (begun) begun->front = std::move(after);
  return begun;
}

std::optional<BegunCrack> CrackWriter::begin(const CrackEdit& edit, FrameStats& stats) {
  try {
    return BegunCrack{CrackTransaction(body_, edit, &stats.split)};
  } catch (const GeometryError&) {
    ++stats.refused;
    return {};
  }
}

std::optional<WrittenCrack> CrackWriter::commit(BegunCrack begun, FrameStats& stats) {
  std::optional<EmbeddingPlan> plan;
  StepVeto veto;
  if (followers_)
    veto = followers_->collisions.embedding_check(body_, followers_->solid.nodes(), followers_->motion, plan,
                                                  stats.contact_seconds);
  BodyDelta delta;
  try {
    delta = begun.step.commit(veto);
  } catch (const GeometryError&) {
    ++stats.refused;
    return {};
  }
  if (!delta.crack.empty()) hand_on(delta, std::move(plan), stats);
  return WrittenCrack{std::move(begun.front), std::move(delta.crack.new_crack_faces)};
}

std::optional<WrittenCrack> CrackWriter::write(const FrontState& front, std::span<const Vec3> next, FrameStats& stats) {
  std::optional<BegunCrack> begun = begin(front, next, stats);
  return begun ? commit(std::move(*begun), stats) : std::nullopt;
}

std::optional<WrittenCrack> CrackWriter::write(const CrackEdit& edit, FrameStats& stats) {
  std::optional<BegunCrack> begun = begin(edit, stats);
  return begun ? commit(std::move(*begun), stats) : std::nullopt;
}

// `plan`: of the surface, empty without self-contact.
void CrackWriter::hand_on(const BodyDelta& delta, std::optional<EmbeddingPlan> plan, FrameStats& stats) {
  for (const NodeId donor : delta.donors) body_index_.push_back(std::uint32_t(body_index_[donor.index()]));
  if (!delta.detached.empty()) crumbs_.reset();
  if (!followers_) return;
  {
    const Timed timed(stats.mechanics_seconds);
    followers_->solid.follow(delta);
    followers_->way.add_nodes(delta.donors);
    followers_->loads.follow_crack();
    followers_->sleep.wake(delta.updated_nodes);
  }
  const Timed timed(stats.contact_seconds);
  followers_->collisions.commit(std::move(plan), body_, delta);
}

std::size_t CrackWriter::crumbs() {
  if (!crumbs_) crumbs_ = count_crumbs(body_);
  return *crumbs_;
}

}  // namespace geo
