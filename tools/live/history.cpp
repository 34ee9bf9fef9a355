// Copies are found by a rolling hash of blocks (A. Tridgell and P. Mackerras, The rsync algorithm,
// 1996): arrays of a checkpoint mostly keep their begin and grow, and shift those behind them.
#include "live/history.h"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>
#include <utility>

namespace live {
namespace {

// Shorter blocks find more copies. Half of a block is what an entry of a copy takes.
constexpr std::size_t block = 48;

// A hash of `block` bytes that moves on by one byte: the bytes are digits of a number to an odd
// base, modulo 2⁶⁴.
class RollingHash {
 public:
  explicit RollingHash(const char* bytes) {
    for (std::size_t i = 0; i < block; ++i) value_ = value_ * base + byte(bytes[i]);
  }
  void move_on(char leaves, char enters) { value_ = (value_ - byte(leaves) * weight()) * base + byte(enters); }
  // The upper bits depend on all bytes.
  std::size_t slot(int bits) const { return static_cast<std::size_t>((value_ * mixer) >> (64 - bits)); }

 private:
  static constexpr std::uint64_t base = 0x9e3779b97f4a7c15, mixer = 0xd6e8feb86659fd93;
  static std::uint64_t byte(char c) { return static_cast<unsigned char>(c) + 1u; }
  static constexpr std::uint64_t weight() {
    std::uint64_t w = 1;
    for (std::size_t i = 1; i < block; ++i) w *= base;
    return w;
  }
  std::uint64_t value_ = 0;
};

// Where the blocks of some bytes are, by their hashes. The first one of equal hashes is kept.
class Blocks {
 public:
  explicit Blocks(std::string_view bytes)
      : bytes_(bytes), bits_(std::max(4, static_cast<int>(std::bit_width(2 * bytes.size() / block)))) {
    at_.assign(std::size_t(1) << bits_, none);
    for (std::size_t i = 0; i + block <= bytes.size(); i += block) {
      std::size_t& at = at_[RollingHash(bytes.data() + i).slot(bits_)];
      if (at == none) at = i;
    }
  }
  // The place of a block with these bytes; `none` where no block is found.
  std::size_t find(const RollingHash& hash, const char* bytes) const {
    const std::size_t at = at_[hash.slot(bits_)];
    return at != none && std::memcmp(bytes_.data() + at, bytes, block) == 0 ? at : none;
  }
  static constexpr std::size_t none = ~std::size_t(0);

 private:
  std::string_view bytes_;
  int bits_;
  std::vector<std::size_t> at_;
};

// An entry of a difference: new bytes, which follow it, and then a copy.
struct Entry {
  std::uint64_t fresh = 0, from = 0, copied = 0;
};

void append(std::string& difference, std::string_view fresh, std::size_t from, std::size_t copied) {
  const Entry entry{fresh.size(), from, copied};
  difference.append(reinterpret_cast<const char*>(&entry), sizeof entry);
  difference += fresh;
}

}  // namespace

std::string difference(std::string_view from, std::string_view to) {
  std::string result;
  const Blocks blocks(from);
  std::size_t done = 0, i = 0;
  while (i + block <= to.size()) {
    RollingHash hash(to.data() + i);
    std::size_t at = blocks.find(hash, to.data() + i);
    while (at == Blocks::none && i + block < to.size()) {
      hash.move_on(to[i], to[i + block]);
      ++i;
      at = blocks.find(hash, to.data() + i);
    }
    if (at == Blocks::none) break;
    std::size_t end = i + block, source = at + block;
    while (end < to.size() && source < from.size() && to[end] == from[source]) {
      ++end;
      ++source;
    }
    while (i > done && at > 0 && to[i - 1] == from[at - 1]) {
      --i;
      --at;
    }
    append(result, to.substr(done, i - done), at, end - i);
    done = i = end;
  }
  append(result, to.substr(done), 0, 0);
  result.shrink_to_fit();
  return result;
}

std::string follow_difference(std::string_view from, std::string_view difference) {
  std::string result;
  while (!difference.empty()) {
    Entry entry;
    std::memcpy(&entry, difference.data(), sizeof entry);
    result += difference.substr(sizeof entry, entry.fresh);
    result += from.substr(entry.from, entry.copied);
    difference.remove_prefix(sizeof entry + entry.fresh);
  }
  return result;
}

void StateStack::put(std::size_t index, std::string bytes) {
  bytes_ -= states_[index].size();
  bytes_ += bytes.size();
  states_[index] = std::move(bytes);
}

void StateStack::push(std::string state) {
  if (!states_.empty()) put(states_.size() - 1, difference(state, states_.back()));
  bytes_ += state.size();
  states_.push_back(std::move(state));
}

std::string StateStack::pop() {
  std::string top = std::move(states_.back());
  states_.pop_back();
  bytes_ -= top.size();
  if (!states_.empty()) put(states_.size() - 1, follow_difference(top, states_.back()));
  return top;
}

void StateStack::erase(std::size_t index) {
  if (index + 1 == states_.size()) {
    pop();
    return;
  }
  if (index > 0) {
    std::string next = states_.back();
    for (std::size_t i = states_.size() - 1; i-- > index + 1;) next = follow_difference(next, states_[i]);
    const std::string gone = follow_difference(next, states_[index]);
    put(index - 1, difference(next, follow_difference(gone, states_[index - 1])));
  }
  bytes_ -= states_[index].size();
  states_.erase(states_.begin() + static_cast<std::ptrdiff_t>(index));
}

void StateStack::clear() {
  states_.clear();
  bytes_ = 0;
}

}  // namespace live
