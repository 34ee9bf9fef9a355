// The copy by node is made by a parallel counting sort of the copy by stencil. At a node, stencils
// are in ascending order for any number of threads.
#include "mechanics/terms/stencil_matrix.h"

#include <algorithm>
#include <utility>

#include "kerf/parallel.h"

namespace geo {

StencilMatrix::StencilMatrix(std::span<const std::uint32_t> selected, const std::vector<Stencil>& stencils,
                             std::size_t nodes)
    : selected_(selected.begin(), selected.end()), stencil_begin_(1, 0), node_begin_(nodes + 1, 0) {
  stencil_begin_.reserve(selected_.size() + 1);
  for (const auto s : selected_) stencil_begin_.push_back(stencil_begin_.back() + stencils[s].size());
  // Parallel counting sort: each chunk of stencils counts its entries per node; prefix sums then
  // give each chunk its own place among a node's entries.
  constexpr std::size_t max_chunks = 8, stencils_per_chunk = 256;
  const std::size_t chunks = std::clamp<std::size_t>(selected_.size() / stencils_per_chunk, 1, max_chunks);
  const auto begin_of = [&](std::size_t chunk) { return selected_.size() * chunk / chunks; };
  std::vector<std::vector<std::uint32_t>> next(chunks);  // per chunk and node: a count, then an offset
  by_stencil_ = UninitializedArray<Entry>(stencil_begin_.back());
  parallel_for(chunks, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t chunk = begin; chunk < end; ++chunk) {
      next[chunk].assign(nodes, 0);
      for (std::size_t k = begin_of(chunk); k < begin_of(chunk + 1); ++k) {
        Entry* to = by_stencil_.data() + stencil_begin_[k];
        for (const auto& e : stencils[selected_[k]]) {
          *to++ = {e.node, static_cast<float>(e.weight)};
          ++next[chunk][e.node];
        }
      }
    }
  });
  std::uint32_t total = 0;
  for (std::size_t n = 0; n < nodes; ++n) {
    node_begin_[n] = total;
    for (auto& of_chunk : next) total += std::exchange(of_chunk[n], total);
  }
  node_begin_[nodes] = total;
  by_node_ = UninitializedArray<Entry>(total);
  weights_ = UninitializedArray<double>(total);
  parallel_for(chunks, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t chunk = begin; chunk < end; ++chunk)
      for (std::size_t k = begin_of(chunk); k < begin_of(chunk + 1); ++k)
        for (const auto& e : stencils[selected_[k]]) {
          const auto to = next[chunk][e.node]++;
          by_node_[to] = {selected_[k], static_cast<float>(e.weight)};
          weights_[to] = e.weight;
        }
  });
}

}  // namespace geo
