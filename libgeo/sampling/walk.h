// Traversal of a solid from coarse cells to fine ones on all threads, with results in Morton order.
#pragma once

#include <utility>
#include <vector>

#include "kerf/parallel.h"
#include "kerf/progress.h"
#include "sampling/region.h"

namespace geo {

/// Calls visit(region, found) for the region of `root`. If visit() returns true, the parts of the
/// region that hold material are visited, too. Calls come from any thread. Returns lists of what
/// was found; concatenated, they have the order of a serial depth-first traversal.
template <class Found, class Visit>
std::vector<std::vector<Found>> walk(const RegionTree& tree, const Lattice& lattice, const Cell& root,
                                     const char* phase, const Progress& progress, const Visit& visit) {
  constexpr std::size_t enough = 1024;  // tasks: for a smooth progress bar and balanced threads
  struct Task {
    Region region;
    std::vector<Found> found;
    std::vector<Region> parts;
    bool open = true;
  };
  std::vector<Task> tasks(1);
  tasks[0].region = tree.root(lattice, root);
  report(progress, phase, 0, enough);
  for (std::size_t open = 1; open > 0 && open < enough;) {
    parallel_for(tasks.size(), 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        Task& task = tasks[i];
        if (std::exchange(task.open, false) && visit(std::as_const(task.region), task.found))
          tree.divide(lattice, task.region, [&](Region&& part) { task.parts.push_back(std::move(part)); });
      }
    });
    std::vector<Task> next;
    open = 0;
    for (Task& task : tasks) {
      if (!task.found.empty())
        next.push_back({.region = {}, .found = std::move(task.found), .parts = {}, .open = false});
      for (Region& part : task.parts) {
        next.push_back({.region = std::move(part), .found = {}, .parts = {}, .open = true});
        ++open;
      }
    }
    tasks = std::move(next);
  }
  const std::size_t share = std::max<std::size_t>(1, tasks.size() / 64);
  for (std::size_t first = 0; first < tasks.size(); first += share) {
    report(progress, phase, first, tasks.size());
    parallel_for(std::min(share, tasks.size() - first), 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = first + begin; i < first + end; ++i) {
        Task& task = tasks[i];
        if (!task.open) continue;
        const auto descend = [&](const auto& self, const Region& region) -> void {
          if (visit(region, task.found)) tree.divide(lattice, region, [&](Region&& part) { self(self, part); });
        };
        descend(descend, std::as_const(task.region));
        task.region = {};
      }
    });
  }
  std::vector<std::vector<Found>> found;
  for (Task& task : tasks)
    if (!task.found.empty()) found.push_back(std::move(task.found));
  return found;
}

}  // namespace geo
