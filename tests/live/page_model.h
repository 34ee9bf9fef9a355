// A page without a screen: decodes messages by docs/live-protocol.md alone, and keeps what a page
// would draw.
#pragma once

#include <array>
#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

class PageModel {
 public:
  int kind = 0, flags = 0;
  std::uint32_t sequence = 0, revision = 0, nodes = 0;
  double time = 0;
  nlohmann::json scene, statistics, notice;
  std::vector<std::array<std::uint32_t, 3>> triangles;  // per slot
  std::vector<int> patch;
  std::vector<std::array<double, 3>> positions, node_positions;
  std::vector<double> stress;
  std::vector<std::array<std::uint32_t, 2>> edges;
  std::array<float, 3> step{};
  std::vector<std::array<float, 3>> rest;  // per vertex slot; where the page has asked for it
  // Per slot: material, and for each corner the place in the image and the tint.
  struct Paint {
    std::uint16_t material = 0;
    std::array<std::array<float, 2>, 3> at{};
    std::array<std::uint32_t, 3> tint{};
  };
  std::vector<Paint> paint;
  std::vector<double> skin_stress;  // per vertex slot
  nlohmann::json look;
  std::string images;

  /// Takes a message; throws where it is shorter or longer than it says, or does not follow.
  void take(const std::string& bytes) {
    bytes_ = bytes;
    at_ = 0;
    kind = get<std::uint8_t>();
    flags = get<std::uint8_t>();
    if (get<std::uint16_t>() != 1) throw std::runtime_error("version");
    sequence = get<std::uint32_t>();
    time = get<double>();
    if (kind == 5) {
      notice = nlohmann::json::parse(bytes_.substr(at_));
      return;
    }
    if (kind == 6) {
      look = text(get<std::uint32_t>());
      images = bytes_.substr(at_);
      return;
    }
    if (kind == 4) {
      edges.resize(get<std::uint32_t>());
      for (auto& e : edges) e = {get<std::uint32_t>(), get<std::uint32_t>()};
    }
    if (kind == 1) take_state();
    if (kind == 2) take_delta();
    if (kind <= 3) take_frame();
    if (at_ != bytes_.size()) throw std::runtime_error("the message is longer than it says");
  }

 private:
  template <class T>
  T get() {
    if (at_ + sizeof(T) > bytes_.size()) throw std::runtime_error("the message is too short");
    T value;
    std::memcpy(&value, &bytes_[at_], sizeof value);
    at_ += sizeof value;
    return value;
  }
  nlohmann::json text(std::size_t length) {
    if (length % 4 != 0 || at_ + length > bytes_.size()) throw std::runtime_error("length of text");
    at_ += length;
    return nlohmann::json::parse(bytes_.substr(at_ - length, length));
  }
  void align() {
    while (at_ % 4 != 0)
      if (get<char>() != 0) throw std::runtime_error("padding");
  }
  std::array<std::uint32_t, 3> corners() { return {get<std::uint32_t>(), get<std::uint32_t>(), get<std::uint32_t>()}; }
  std::array<float, 3> place() { return {get<float>(), get<float>(), get<float>()}; }
  void take_paint(const std::vector<std::uint32_t>& slots) {
    for (const auto s : slots) paint[s].material = get<std::uint16_t>();
    align();
    for (const auto s : slots)
      for (auto& at : paint[s].at) at = {get<float>(), get<float>()};
    for (const auto s : slots)
      for (auto& tint : paint[s].tint) tint = get<std::uint32_t>();
  }
  void take_state() {
    revision = get<std::uint32_t>();
    const auto vertices = get<std::uint32_t>(), slots = get<std::uint32_t>();
    get<std::uint32_t>();
    scene = text(get<std::uint32_t>());
    triangles.resize(slots);
    patch.resize(slots);
    for (auto& t : triangles) t = corners();
    for (int& p : patch) p = get<std::uint8_t>();
    align();
    rest.resize(flags & 4 ? vertices : 0);
    for (auto& p : rest) p = place();
    paint.resize(flags & 8 ? slots : 0);
    std::vector<std::uint32_t> all(paint.size());
    for (std::uint32_t i = 0; i < all.size(); ++i) all[i] = i;
    take_paint(all);
  }
  void take_delta() {
    if (get<std::uint32_t>() != revision) throw std::runtime_error("revision");
    revision = get<std::uint32_t>();
    get<std::uint32_t>();
    const auto removed = get<std::uint32_t>(), added = get<std::uint32_t>();
    for (std::uint32_t i = 0; i < removed; ++i) triangles.at(get<std::uint32_t>()) = {0, 0, 0};
    std::vector<std::uint32_t> slots;
    for (std::uint32_t i = 0; i < added; ++i) {
      slots.push_back(get<std::uint32_t>());
      if (slots.back() >= triangles.size()) {
        triangles.resize(slots.back() + 1, {0, 0, 0});
        patch.resize(triangles.size());
      }
      triangles[slots.back()] = corners();
    }
    for (const auto slot : slots) patch[slot] = get<std::uint8_t>();
    align();
    if (flags & 4) {
      std::vector<std::uint32_t> placed(get<std::uint32_t>());
      for (auto& v : placed) v = get<std::uint32_t>();
      for (const auto v : placed) {
        if (v >= rest.size()) rest.resize(v + 1);
        rest[v] = place();
      }
    }
    if (!(flags & 8)) return;
    paint.resize(triangles.size());
    take_paint(slots);
  }
  void take_frame() {
    if (get<std::uint32_t>() != revision) throw std::runtime_error("revision of the frame");
    positions.resize(get<std::uint32_t>());
    nodes = get<std::uint32_t>();
    statistics = text(get<std::uint32_t>());
    std::array<float, 3> lo{get<float>(), get<float>(), get<float>()};
    step = {get<float>(), get<float>(), get<float>()};
    const auto points = [&](auto& list) {
      for (auto& p : list)
        for (std::size_t k = 0; k < 3; ++k) p[k] = double(lo[k]) + double(step[k]) * get<std::uint16_t>();
      align();
    };
    points(positions);
    node_positions.resize(flags & 1 ? nodes : 0);
    stress.resize(flags & 2 ? nodes : 0);
    if (flags & 1) points(node_positions);
    if (flags & 2) {
      const float most = get<float>();
      for (double& s : stress) s = double(most) * get<std::uint16_t>() / 65535;
      align();
    }
    skin_stress.resize(flags & 16 ? positions.size() : 0);
    if (flags & 16) {
      const float most = get<float>();
      for (double& s : skin_stress) s = double(most) * get<std::uint16_t>() / 65535;
      align();
    }
  }

  std::string bytes_;
  std::size_t at_ = 0;
};
