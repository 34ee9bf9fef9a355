// Motions lose their keys after the mark. Parts of the original scene stay as they are.
#include "live/scene_mark.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace live {
namespace {

// The motion up to a time, where it ends then.
void cut_motion(geo::Motion& motion, double time) {
  if (motion.keys.empty() || motion.keys.back().time <= time) return;
  const geo::Vec3 position = motion.at(time).position;
  std::erase_if(motion.keys, [&](const geo::Motion::Key& key) { return key.time > time; });
  if (motion.keys.empty() || motion.keys.back().time == time) return;
  motion.keys.push_back(motion.keys.back());
  motion.keys.back().time = time;
  motion.keys.back().position = position;
}

bool goes_on(const geo::Motion& motion, double time) { return !motion.keys.empty() && motion.keys.back().time > time; }

bool ends_after(const geo::Grip& grip, double time) { return std::isfinite(grip.until) && grip.until > time; }

template <class Part>
std::vector<Part> first(const std::vector<Part>& parts, std::size_t count) {
  return {parts.begin(), parts.begin() + static_cast<std::ptrdiff_t>(count)};
}

template <class Part>
void put_back(std::vector<Part>& parts, const std::map<std::size_t, Part>& rest) {
  for (const auto& [index, part] : rest) {
    if (index >= parts.size()) parts.resize(index + 1);
    parts[index] = part;
  }
}

}  // namespace

SceneMark HandMadeScene::mark(const geo::RunState& state) const {
  return {.time = state.time,
          .frame = state.frame,
          .blades = now_.blades.size(),
          .grips = now_.grips.size(),
          .pulls = now_.pulls.size(),
          .changes = changes_.size()};
}

geo::Scene HandMadeScene::at(const SceneMark& mark) const {
  geo::Scene scene = original_;
  scene.blades = first(now_.blades, mark.blades);
  scene.grips = first(now_.grips, mark.grips);
  scene.pulls = first(now_.pulls, mark.pulls);
  for (std::size_t b = original_.blades.size(); b < mark.blades; ++b) cut_motion(scene.blades[b].motion, mark.time);
  for (std::size_t p = original_.pulls.size(); p < mark.pulls; ++p) cut_motion(scene.pulls[p].motion, mark.time);
  for (std::size_t g = original_.grips.size(); g < mark.grips; ++g)
    if (ends_after(scene.grips[g], mark.time)) scene.grips[g].until = std::numeric_limits<double>::infinity();
  for (std::size_t c = 0; c < mark.changes; ++c) scene.add_change(changes_[c]);
  return scene;
}

SceneRest HandMadeScene::after(const SceneMark& mark) const {
  SceneRest rest;
  for (std::size_t b = original_.blades.size(); b < now_.blades.size(); ++b)
    if (b >= mark.blades || goes_on(now_.blades[b].motion, mark.time)) rest.blades[b] = now_.blades[b];
  for (std::size_t p = original_.pulls.size(); p < now_.pulls.size(); ++p)
    if (p >= mark.pulls || goes_on(now_.pulls[p].motion, mark.time)) rest.pulls[p] = now_.pulls[p];
  for (std::size_t g = original_.grips.size(); g < now_.grips.size(); ++g)
    if (g >= mark.grips || ends_after(now_.grips[g], mark.time)) rest.grips[g] = now_.grips[g];
  rest.changes.assign(changes_.begin() + static_cast<std::ptrdiff_t>(mark.changes), changes_.end());
  return rest;
}

geo::Scene HandMadeScene::at(const SceneMark& mark, const SceneRest& rest) const {
  geo::Scene scene = at(mark);
  put_back(scene.blades, rest.blades);
  put_back(scene.grips, rest.grips);
  put_back(scene.pulls, rest.pulls);
  for (const geo::SceneChange& change : rest.changes) scene.add_change(change);
  return scene;
}

}  // namespace live
