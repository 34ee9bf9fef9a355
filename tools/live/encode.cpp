// Little endian, as all machines that Kerf runs on. Positions are 16 bits of the box of the frame.
#include "live/encode.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

#include "tool.h"

namespace live {
namespace {

static_assert(std::endian::native == std::endian::little);

class Bytes {
 public:
  Bytes(Kind kind, std::uint8_t flags, std::uint32_t sequence, double time) {
    put(static_cast<std::uint8_t>(kind));
    put(flags);
    put(std::uint16_t(1));
    put(sequence);
    put(time);
  }
  template <class T>
  void put(const T& value) {
    append(&value, sizeof value);
  }
  template <class T>
  void put_all(const std::vector<T>& values) {
    append(values.data(), values.size() * sizeof(T));
  }
  void pad() { bytes_.resize((bytes_.size() + 3) / 4 * 4, '\0'); }
  void put_size(std::size_t n) { put(static_cast<std::uint32_t>(n)); }
  // Text, filled with blanks up to a multiple of four.
  static std::string padded(std::string text) {
    text.resize((text.size() + 3) / 4 * 4, ' ');
    return text;
  }
  void put_text(const std::string& text) { append(text.data(), text.size()); }
  std::string take() { return std::move(bytes_); }

 private:
  void append(const void* data, std::size_t size) { bytes_.append(static_cast<const char*>(data), size); }
  std::string bytes_;
};

// 16 bits of a box: position = lo + step · value.
struct Grid {
  geo::Box3 box;
  Eigen::Vector3f lo = Eigen::Vector3f::Zero(), step = Eigen::Vector3f::Zero();
  void fit() {
    if (box.empty()) box.add(geo::Vec3::Zero());
    lo = box.lo.cast<float>();
    step = ((box.hi - box.lo) / 65535).cast<float>() * (1 + 1e-6f);
  }
  void put(Bytes& bytes, const std::vector<geo::Vec3>& points) const {
    std::vector<std::uint16_t> values(3 * points.size());
    for (std::size_t i = 0; i < points.size(); ++i)
      for (int k = 0; k < 3; ++k) {
        const double value = step[k] > 0 ? (points[i][k] - double(lo[k])) / double(step[k]) : 0;
        values[3 * i + static_cast<std::size_t>(k)] = static_cast<std::uint16_t>(std::clamp(value + 0.5, 0.0, 65535.0));
      }
    bytes.put_all(values);
    bytes.pad();
  }
};

constexpr std::uint8_t has_nodes = 1, has_stress = 2, has_rest = 4, has_paint = 8, has_skin_stress = 16;

std::uint8_t flags_of(const Snapshot& s, const Content& c) {
  const bool skin_stress = c.rest && c.stress && !s.skin_stress.empty();
  return static_cast<std::uint8_t>((c.nodes && !s.nodes.empty() ? has_nodes : 0) |
                                   (c.stress && !s.stress.empty() ? has_stress : 0) | (c.rest ? has_rest : 0) |
                                   (c.rest && !s.topology->paint.empty() ? has_paint : 0) |
                                   (skin_stress ? has_skin_stress : 0));
}

void put_rest(Bytes& bytes, const Eigen::Vector3f& p) {
  for (int k = 0; k < 3; ++k) bytes.put(p[k]);
}

// Materials of all, places of all, tints of all.
void put_paint(Bytes& bytes, const std::vector<TrianglePaint>& paint) {
  for (const TrianglePaint& t : paint) bytes.put(t.material);
  bytes.pad();
  for (const TrianglePaint& t : paint)
    for (const Eigen::Vector2f& at : t.at) {
      bytes.put(at.x());
      bytes.put(at.y());
    }
  for (const TrianglePaint& t : paint) bytes.put(t.tint);
}

// The largest value, and all in 65536 steps of it.
void put_values(Bytes& bytes, const std::vector<double>& values) {
  const double most = *std::max_element(values.begin(), values.end());
  bytes.put(static_cast<float>(most));
  std::vector<std::uint16_t> steps;
  for (const double x : values) steps.push_back(static_cast<std::uint16_t>(most > 0 ? 65535 * x / most : 0));
  bytes.put_all(steps);
  bytes.pad();
}

void put_frame(Bytes& bytes, const Snapshot& s, const Content& content) {
  const std::uint8_t flags = flags_of(s, content);
  const std::string statistics = Bytes::padded(s.statistics + ",\"ack_input\":" + std::to_string(content.taken) + "}");
  Grid grid;
  for (const geo::Vec3& p : s.positions) grid.box.add(p);
  if (flags & has_nodes)
    for (const geo::Vec3& p : s.nodes) grid.box.add(p);
  grid.fit();
  bytes.put(s.topology->revision);
  bytes.put_size(s.positions.size());
  bytes.put_size(s.node_count);
  bytes.put_size(statistics.size());
  bytes.put_text(statistics);
  for (int k = 0; k < 3; ++k) bytes.put(grid.lo[k]);
  for (int k = 0; k < 3; ++k) bytes.put(grid.step[k]);
  grid.put(bytes, s.positions);
  if (flags & has_nodes) grid.put(bytes, s.nodes);
  if (flags & has_stress) put_values(bytes, s.stress);
  if (flags & has_skin_stress) put_values(bytes, s.skin_stress);
}

}  // namespace

std::string encode_state(const Snapshot& s, const Content& content) {
  const Topology& t = *s.topology;
  Bytes bytes(Kind::state, flags_of(s, content), content.sequence, s.time);
  const std::string scene = Bytes::padded(*s.scene);
  bytes.put(t.revision);
  bytes.put(t.vertices);
  bytes.put_size(t.triangle.size());
  bytes.put_size(s.node_count);
  bytes.put_size(scene.size());
  bytes.put_text(scene);
  bytes.put_all(t.triangle);
  bytes.put_all(t.patch);
  bytes.pad();
  if (content.rest) {
    for (const Eigen::Vector3f& p : t.rest) put_rest(bytes, p);
    put_paint(bytes, t.paint);
  }
  put_frame(bytes, s, content);
  return bytes.take();
}

std::string encode_frame(const Snapshot& s, const Topology& known, const Content& content) {
  const Topology& t = *s.topology;
  if (known.revision == t.revision) {
    Bytes bytes(Kind::frame, flags_of(s, content), content.sequence, s.time);
    put_frame(bytes, s, content);
    return bytes.take();
  }
  const TopologyChange change = change_between(known, t);
  Bytes bytes(Kind::delta, flags_of(s, content), content.sequence, s.time);
  bytes.put(known.revision);
  bytes.put(t.revision);
  bytes.put(t.vertices);
  bytes.put_size(change.removed.size());
  bytes.put_size(change.added.size());
  bytes.put_all(change.removed);
  std::vector<std::uint8_t> patch;
  for (const auto slot : change.added) {
    bytes.put(slot);
    bytes.put(t.triangle[slot]);
    patch.push_back(t.patch[slot]);
  }
  bytes.put_all(patch);
  bytes.pad();
  if (content.rest) {
    bytes.put_size(change.placed.size());
    bytes.put_all(change.placed);
    for (const auto vertex : change.placed) put_rest(bytes, t.rest[vertex]);
    std::vector<TrianglePaint> paint;
    for (const auto slot : change.added)
      if (!t.paint.empty()) paint.push_back(t.paint[slot]);
    put_paint(bytes, paint);
  }
  put_frame(bytes, s, content);
  return bytes.take();
}

std::string encode_graph(const Snapshot& s, std::uint32_t sequence) {
  Bytes bytes(Kind::graph, 0, sequence, s.time);
  bytes.put_size(s.graph->size());
  for (const auto& [a, b] : *s.graph) {
    bytes.put(a);
    bytes.put(b);
  }
  return bytes.take();
}

std::string encode_look(const Snapshot& s, std::uint32_t sequence) {
  Bytes bytes(Kind::look, 0, sequence, s.time);
  bytes.put_text(*s.look);
  return bytes.take();
}

std::string encode_notice(std::string_view key, std::string_view sentence, std::uint32_t sequence) {
  Bytes bytes(Kind::notice, 0, sequence, 0);
  bytes.put_text(Bytes::padded("{\"" + std::string(key) + "\":" + tool::quoted(std::string(sentence)) + "}"));
  return bytes.take();
}

}  // namespace live
