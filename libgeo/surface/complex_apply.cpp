// Complex::apply() and undo() of kerf/complex.h. Phases of a commit: check the edit; plan the
// radial cycle of each touched edge (children replace parents, given orders replace the plan);
// overwrite; rebuild the fans at touched vertices. Each overwritten value is logged for undo().
#include <algorithm>
#include <string>

#include "kerf/error.h"
#include "surface/complex_impl.h"
#include "surface/edit_group.h"
#include "surface/radial_edge.h"

namespace geo {

/// The phases of apply(): check and plan, where anything may throw; then commit, where nothing
/// does.
class Complex::Commit {
 public:
  Commit(Complex& complex, const ComplexEdit& edit)
      : k_(complex),
        edit_(edit),
        old_faces_(complex.face_count()),
        old_vertices_(complex.vertex_count()),
        removed_(edit.removed_faces) {}

  CrackDelta run() {
    check_removed_faces();
    check_new_faces();
    plan_radial_cycles();

    begin_undo_log();
    add_vertices();
    remove_faces();
    add_faces();
    link_radial_cycles();
    rebuild_fans();
    return std::move(delta_);
  }

  // The state that run() overwrote.
  Impl::UndoLog log() { return std::move(log_); }

 private:
  // An edge that gains a face, or loses one (then the face is invalid).
  struct Change {
    std::uint64_t edge;
    FaceId face;
  };
  struct PlannedCycle {
    std::uint64_t edge;
    std::uint32_t begin, end;  // cycle_faces_[begin..end)
  };
  static VertexId low_end(std::uint64_t edge) { return VertexId(static_cast<std::uint32_t>(edge >> 32)); }
  static VertexId high_end(std::uint64_t edge) { return VertexId(static_cast<std::uint32_t>(edge)); }
  const ComplexEdit::NewFace& new_face(FaceId f) const { return edit_.new_faces[f.value - old_faces_]; }
  bool is_removed(FaceId f) const { return std::binary_search(removed_.begin(), removed_.end(), f); }
  // A face of K or of the edit.
  Face face_after(FaceId f) const {
    if (f.value < old_faces_) return k_.face(f);
    return {.v = new_face(f).v, .crack = new_face(f).crack, .alive = true, .source = ~0u};
  }

  void check_removed_faces() {
    std::sort(removed_.begin(), removed_.end());
    if (std::adjacent_find(removed_.begin(), removed_.end()) != removed_.end())
      throw GeometryError("a face is removed twice");
    for (const FaceId f : removed_)
      if (f.value >= old_faces_ || !k_.alive(f))
        throw GeometryError("face " + std::to_string(f.value) + " is not there to be removed");
  }

  void check_new_faces() const {
    const auto vertex_total = old_vertices_ + edit_.new_vertices.size();
    for (const auto& n : edit_.new_faces) {
      for (const VertexId v : n.v)
        if (v.value >= vertex_total)
          throw GeometryError("a new face names vertex " + std::to_string(v.value) + ", which is not there");
      if (n.v[0] == n.v[1] || n.v[1] == n.v[2] || n.v[2] == n.v[0])
        throw GeometryError("a new face has a vertex twice");
      if (n.crack < 0) throw GeometryError("a crack's number is negative");
    }
  }

  // By edge, then by face.
  std::vector<Change> edge_changes() const {
    std::vector<Change> changes;
    changes.reserve(3 * (removed_.size() + edit_.new_faces.size()));
    for (const FaceId f : removed_)
      for (int k = 0; k < 3; ++k) changes.push_back({edge_key(k_.face(f).v[k], k_.face(f).v[(k + 1) % 3]), FaceId()});
    for (std::uint32_t i = 0; i < edit_.new_faces.size(); ++i)
      for (int k = 0; k < 3; ++k)
        changes.push_back(
            {edge_key(edit_.new_faces[i].v[k], edit_.new_faces[i].v[(k + 1) % 3]), FaceId(old_faces_ + i)});
    std::sort(changes.begin(), changes.end(),
              [](const Change& x, const Change& y) { return x.edge != y.edge ? x.edge < y.edge : x.face < y.face; });
    return changes;
  }

  // The faces that an edge keeps, with the children of divided faces in their parents' places, then
  // the faces it gains. Faces that replace a parent are erased from `gained`.
  void inherit_cycle(VertexId lo, VertexId hi, std::vector<FaceId>& gained, std::vector<FaceId>& cycle) const {
    cycle.clear();
    if (hi.value < old_vertices_)
      for (const FaceId f : k_.faces_around(lo, hi)) {
        if (!is_removed(f)) {
          cycle.push_back(f);
          continue;
        }
        const auto child =
            std::find_if(gained.begin(), gained.end(), [&](FaceId n) { return new_face(n).parent == f; });
        if (child == gained.end()) continue;
        cycle.push_back(*child);
        gained.erase(child);
      }
    cycle.insert(cycle.end(), gained.begin(), gained.end());
  }

  // Replaces a cycle by the order that the edit gives for it. Throws GeometryError unless that
  // lists the same faces.
  void use_given_order(const ComplexEdit::RadialOrder& order, std::vector<FaceId>& cycle) {
    given_ = order.faces;
    if (order.a > order.b) std::reverse(given_.begin(), given_.end());
    sorted_ = given_;
    std::sort(sorted_.begin(), sorted_.end());
    std::sort(cycle.begin(), cycle.end());
    if (sorted_ != cycle)
      throw GeometryError("the order given for edge " +
                          edge_name(std::min(order.a, order.b), std::max(order.a, order.b)) +
                          " does not list its faces");
    cycle = given_;
  }

  // The radial cycle that each touched edge will have.
  void plan_radial_cycles() {
    const std::vector<Change> changes = edge_changes();
    std::vector<std::pair<std::uint64_t, const ComplexEdit::RadialOrder*>> orders;
    for (const auto& order : edit_.radial_orders) orders.push_back({edge_key(order.a, order.b), &order});
    std::sort(orders.begin(), orders.end(), [](const auto& x, const auto& y) { return x.first < y.first; });
    cycles_.reserve(changes.size());
    cycle_faces_.reserve(2 * changes.size());
    const auto face_of = [&](FaceId f) { return face_after(f); };
    std::vector<FaceId> gained, cycle;
    auto order = orders.begin();
    for (std::size_t at = 0; at < changes.size();) {
      const std::uint64_t edge = changes[at].edge;
      const VertexId lo = low_end(edge), hi = high_end(edge);
      gained.clear();
      for (; at < changes.size() && changes[at].edge == edge; ++at)
        if (changes[at].face.valid()) gained.push_back(changes[at].face);
      inherit_cycle(lo, hi, gained, cycle);
      while (order != orders.end() && order->first < edge) ++order;  // no change there: the order is known
      if (order != orders.end() && order->first == edge) {
        use_given_order(*order->second, cycle);
      } else if (!gained.empty() && cycle.size() >= 3) {
        throw GeometryError("no order is given for edge " + edge_name(lo, hi) + ", which has " +
                            std::to_string(cycle.size()) + " faces");
      }
      check_wedges(cycle, lo, hi, face_of);
      const auto begin = static_cast<std::uint32_t>(cycle_faces_.size());
      cycle_faces_.insert(cycle_faces_.end(), cycle.begin(), cycle.end());
      cycles_.push_back({edge, begin, static_cast<std::uint32_t>(cycle_faces_.size())});
    }
  }

  void begin_undo_log() {
    log_ = {.vertices = old_vertices_,
            .faces = old_faces_,
            .surface_vertices = k_.surface_vertex_count(),
            .cracks = k_.crack_count_,
            .removed = removed_,
            .radial = {},
            .corners = {},
            .fans = {}};
    delta_.removed_faces = removed_;
  }

  void add_vertices() {
    k_.points_.insert(k_.points_.end(), edit_.new_vertices.begin(), edit_.new_vertices.end());
    k_.first_corner_.resize(k_.points_.size(), no_corner);
    for (std::uint32_t i = 0; i < edit_.new_vertices.size(); ++i)
      delta_.new_vertices.push_back(VertexId(old_vertices_ + i));
    ++k_.impl_->epoch;
    k_.impl_->marks.resize(k_.points_.size(), 0);
  }

  void touch(VertexId v) {
    auto& mark = k_.impl_->marks[v.index()];
    if (mark != k_.impl_->epoch) {
      mark = k_.impl_->epoch;
      touched_.push_back(v);
    }
  }

  void remove_faces() {
    for (const FaceId f : removed_) {
      const Face& face = k_.face(f);
      for (int k = 0; k < 3; ++k) {
        touch(face.v[k]);
        for (int which = 0; which < side_count(face); ++which)
          old_ids_.push_back({face.v[k], k_.corner_vertex_[f.index() * 6 + which * 3 + k]});
      }
      k_.impl_->index.erase(f.value);
      k_.faces_[f.index()].alive = false;
      k_.unlink_corners(f);
      --k_.live_faces_;
    }
  }

  // A child keeps its parent's surface vertices where it keeps the parent's corners.
  void inherit_corner(FaceId child, int k, FaceId parent) {
    const int pk = corner_at(k_.face(parent), k_.face(child).v[k]);
    if (pk < 0) return;
    for (int which = 0; which < 2; ++which)
      k_.corner_vertex_[child.index() * 6 + which * 3 + k] = k_.corner_vertex_[parent.index() * 6 + which * 3 + pk];
  }

  void add_faces() {
    const std::size_t total = old_faces_ + edit_.new_faces.size();
    k_.faces_.reserve(std::max(total, k_.faces_.capacity() < total ? 2 * k_.faces_.size() : total));
    k_.radial_.resize(3 * total);
    k_.next_corner_.resize(3 * total, no_corner);
    k_.corner_vertex_.resize(6 * total);
    for (std::uint32_t i = 0; i < edit_.new_faces.size(); ++i) {
      const auto& n = edit_.new_faces[i];
      const FaceId f(old_faces_ + i);
      const bool has_parent = n.parent.valid() && n.parent.value < old_faces_;
      k_.faces_.push_back(
          {.v = n.v, .crack = n.crack, .alive = true, .source = has_parent ? k_.face(n.parent).source : ~0u});
      k_.link_corners(f);
      for (int k = 0; k < 3; ++k) {
        touch(n.v[k]);
        if (has_parent) inherit_corner(f, k, n.parent);
      }
      const auto c = k_.corners(f);
      k_.impl_->index.insert(f.value, box_of(c[0], c[1], c[2]));
      k_.crack_count_ = std::max(k_.crack_count_, n.crack);
      delta_.new_faces.push_back(f);
      if (n.crack > 0 && !n.parent.valid()) delta_.new_crack_faces.push_back(f);
      ++k_.live_faces_;
    }
  }

  void link_radial_cycles() {
    for (const PlannedCycle& cycle : cycles_) {
      const VertexId lo = low_end(cycle.edge), hi = high_end(cycle.edge);
      for (auto i = cycle.begin; i < cycle.end; ++i)
        if (const FaceId f = cycle_faces_[i]; f.value < old_faces_) {
          const auto at = f.index() * 3 + static_cast<std::size_t>(edge_in(k_.face(f), lo, hi));
          log_.radial.push_back({at, k_.radial_[at]});
        }
      k_.link_radial_cycle(lo, hi, cycle_faces_.data() + cycle.begin, cycle.end - cycle.begin);
    }
  }

  // Logs the fans at v, and the surface vertices whose corners there are gone.
  void log_fans_at(VertexId v, const std::vector<SurfaceVertexId>& gone) {
    const auto log_fan = [&](SurfaceVertexId id) {
      if (log_.fans.empty() || log_.fans.back().v != id)
        log_.fans.push_back(
            {.v = id, .site = k_.site(id), .side = k_.fan_side_[id.index()], .corner = k_.fan_corner_[id.index()]});
    };
    for (const FaceId f : k_.faces_at(v)) {
      if (f.value >= old_faces_) break;
      for (int which = 0; which < side_count(k_.face(f)); ++which) {
        const auto at = f.index() * 6 + static_cast<std::size_t>(which * 3 + corner_at(k_.face(f), v));
        log_.corners.push_back({at, k_.corner_vertex_[at]});
        log_fan(k_.corner_vertex_[at]);
      }
    }
    for (const auto id : gone) log_fan(id);
  }

  void rebuild_fans() {
    std::sort(touched_.begin(), touched_.end());
    std::sort(old_ids_.begin(), old_ids_.end());
    std::size_t at = 0;
    std::vector<SurfaceVertexId> here;
    FanBuilder fans(k_);
    for (const VertexId v : touched_) {
      here.clear();
      for (; at < old_ids_.size() && old_ids_[at].first == v; ++at) here.push_back(old_ids_[at].second);
      log_fans_at(v, here);
      fans.rebuild(v, here, &delta_);
    }
    std::sort(delta_.touched_surface_vertices.begin(), delta_.touched_surface_vertices.end());
    std::sort(delta_.removed_surface_vertices.begin(), delta_.removed_surface_vertices.end());
  }

  Complex& k_;
  const ComplexEdit& edit_;
  Impl::UndoLog log_;
  const std::uint32_t old_faces_, old_vertices_;
  std::vector<FaceId> removed_;  // ascending
  std::vector<PlannedCycle> cycles_;
  std::vector<FaceId> cycle_faces_, given_, sorted_;
  std::vector<VertexId> touched_;
  std::vector<std::pair<VertexId, SurfaceVertexId>> old_ids_;  // at corners of removed faces
  CrackDelta delta_;
};

CrackDelta Complex::apply(const ComplexEdit& edit) {
  Commit commit(*this, edit);
  CrackDelta delta = commit.run();
  if (impl_->next != Impl::Next::further_of_group) impl_->logs.clear();
  if (impl_->next == Impl::Next::first_of_group) impl_->next = Impl::Next::further_of_group;
  impl_->logs.push_back(commit.log());
  return delta;
}

void Complex::undo() {
  if (impl_->logs.empty()) throw GeometryError("there is no edit to undo");
  for (auto log = impl_->logs.rbegin(); log != impl_->logs.rend(); ++log) {
    for (std::uint32_t f = log->faces; f < faces_.size(); ++f) {
      impl_->index.erase(f);
      unlink_corners(FaceId(f));
      --live_faces_;
    }
    points_.resize(log->vertices);
    first_corner_.resize(log->vertices);
    impl_->marks.resize(log->vertices);
    faces_.resize(log->faces);
    radial_.resize(std::size_t(3) * log->faces);
    next_corner_.resize(std::size_t(3) * log->faces);
    corner_vertex_.resize(std::size_t(6) * log->faces);
    site_.resize(log->surface_vertices);
    fan_side_.resize(log->surface_vertices);
    fan_corner_.resize(log->surface_vertices);
    for (const FaceId f : log->removed) {
      faces_[f.index()].alive = true;
      link_corners(f);
      const auto c = corners(f);
      impl_->index.insert(f.value, box_of(c[0], c[1], c[2]));
      ++live_faces_;
    }
    for (const auto& [at, next] : log->radial) radial_[at] = next;
    for (const auto& [at, id] : log->corners) corner_vertex_[at] = id;
    for (const auto& fan : log->fans) {
      site_[fan.v.index()] = fan.site;
      fan_side_[fan.v.index()] = fan.side;
      fan_corner_[fan.v.index()] = fan.corner;
    }
    crack_count_ = log->cracks;
  }
  impl_->logs.clear();
}

Complex::EditGroup::EditGroup(Complex& complex) : complex_(complex) {
  complex_.impl_->next = Impl::Next::first_of_group;
}

Complex::EditGroup::~EditGroup() {
  const bool is_changed = complex_.impl_->next == Impl::Next::further_of_group;
  complex_.impl_->next = Impl::Next::single;
  if (is_changed && !is_kept_) complex_.undo();
}

}  // namespace geo
