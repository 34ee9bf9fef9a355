// make_score() of kerf/score.h.
//
// Search over the number of cells of a pattern: pieces are counted by cutting a copy of the model.
// The next number follows from the pieces missing or the ratio of surplus, bracketed by bisection;
// a new seed starts the search again. A small surplus of pieces is joined, while walls are flat
// where it is found there.
#include "kerf/score.h"

#include <algorithm>
#include <cmath>

#include "crack/insert.h"
#include "kerf/crack.h"
#include "kerf/error.h"
#include "kerf/pieces.h"
#include "score/chips.h"
#include "score/jagged.h"
#include "score/join.h"
#include "score/partial.h"
#include "score/patterns.h"
#include "surface/skin.h"

namespace geo {
namespace {

class Scoring {
 public:
  Scoring(const Complex& model, const ScoreOptions& options, const Progress& progress)
      : model_(model),
        o_(options),
        progress_(progress),
        skin_(corners_of(skin_of(model))),
        density_(relative_density(skin_, options.pattern.density)) {}

  Score run() {
    Try now{o_.pieces, o_.pattern.seed};
    std::uint64_t variants = 0;
    int low = 0, high = 2 * o_.pieces + 2;  // bisection: numbers of cells with too few and too many pieces
    while (best_.attempts < o_.attempts && best_.pieces != wanted()) {
      const bool done = attempt(now);
      if (is_given()) break;
      if (done && now.pieces < wanted()) {
        low = now.cells;
        now.cells += o_.pieces - int(now.pieces);
      } else if (done) {
        high = now.cells;
        now.cells = int(double(now.cells) * o_.pieces / now.pieces);
      }
      if (now.cells <= low || now.cells >= high) now.cells = (low + high) / 2;
      if (!done || high - low < 2) {
        now = {o_.pieces, o_.pattern.seed + 0x9e3779b97f4a7c15ull * ++variants};
        low = 0;
        high = 2 * o_.pieces + 2;
      }
    }
    if (best_.pieces == 0 && nearest_.pieces > 0) finish(walls_of(nearest_), false);
    if (best_.pieces == 0) throw GeometryError("no such pattern can be inserted" + reason_);
    if (o_.depth < 1) {
      if (!is_jagged()) refine_walls(best_.sheet, skin_, edge(), edge(), [this] { pause(); });
      keep_shallow(best_.sheet, skin_, o_.depth);
    } else {
      best_.chips = add_chips(best_.sheet, model_, best_cut_, skin_, o_.chips, o_.pattern.seed, [this] { pause(); });
    }
    return std::move(best_);
  }

  // The model cut along the sheet of the score, which run() returned.
  Complex cut_along(const TriangleMesh& sheet) { return o_.depth < 1 ? cut_by(sheet) : std::move(best_cut_); }

 private:
  std::uint32_t wanted() const { return static_cast<std::uint32_t>(o_.pieces); }
  bool is_jagged() const { return o_.jagged.amplitude > 0 || o_.jagged.edge_amplitude > 0; }
  double edge() const { return skin_.box().diagonal() / (8 * o_.jagged.frequency); }

  bool is_given() const { return o_.pattern.pattern == Pattern::curves || o_.pattern.pattern == Pattern::sheets; }

  struct Try {
    int cells;
    std::uint64_t seed;
    std::uint32_t pieces = 0;
  };
  TriangleMesh walls_of(const Try& t) const {
    PatternOptions pattern = o_.pattern;
    pattern.seed = t.seed;
    pattern.density = density_;
    return pattern_walls(skin_, t.cells, pattern, [this] { pause(); });
  }
  double distance_from_wanted(std::uint32_t pieces) const {
    return pieces == 0 ? 1e300 : std::abs(double(pieces) - o_.pieces);
  }

  // Counts the pieces that a pattern makes, and finishes it where they are as many as wanted, or
  // few enough more to be joined. False when the pattern cannot be inserted.
  bool attempt(Try& t) {
    ++best_.attempts;
    pause();
    try {
      TriangleMesh walls = walls_of(t);
      t.pieces = 1;
      if (!is_given()) {
        const Complex cut = roughly_cut_by(walls);
        const Pieces pieces = find_pieces(cut);
        t.pieces = pieces.count;
        if (distance_from_wanted(t.pieces) < distance_from_wanted(nearest_.pieces)) nearest_ = t;
        if (t.pieces < wanted() || t.pieces > wanted() + wanted() / 4 + 1) return true;
        if (t.pieces > wanted()) {
          TriangleMesh joined = walls;
          join_small_pieces(joined, cut, new_crack(), pieces, wanted());
          if (const std::uint32_t count = finish(std::move(joined), true)) {
            t.pieces = count;
            return true;
          }
        }
      }
      t.pieces = finish(std::move(walls), false);
      return true;
    } catch (const GeometryError& e) {
      reason_ = std::string(": ") + e.what();
      return false;
    }
  }

  // Roughens walls, joins surplus pieces, and keeps the result if it is the best one. Returns the
  // number of pieces before joining. Walls that were joined while flat may reach into pieces once
  // they are rough; the result is then 0, and nothing is kept.
  std::uint32_t finish(TriangleMesh walls, bool joined) {
    if (is_jagged()) roughen_walls(walls, skin_, o_.jagged, [this] { pause(); });
    Complex cut = cut_by(walls);
    const Pieces pieces = find_pieces(cut);
    if (joined && has_wall_inside(cut, pieces)) return 0;
    std::uint32_t count = pieces.count;
    if (count > wanted() && !is_given()) {
      join_small_pieces(walls, cut, new_crack(), pieces, wanted());
      cut = cut_by(walls);
      count = find_pieces(cut).count;
    }
    if (distance_from_wanted(count) < distance_from_wanted(best_.pieces)) {
      best_.sheet = std::move(walls);
      best_cut_ = std::move(cut);
      best_.pieces = count;
    }
    return pieces.count;
  }

  std::int32_t new_crack() const { return CrackNumbers(model_).next(); }

  // Whether a piece has both sides of a new wall.
  bool has_wall_inside(const Complex& cut, const Pieces& pieces) const {
    for (std::uint32_t f = 0; f < cut.face_count(); ++f)
      if (cut.alive(FaceId(f)) && cut.face(FaceId(f)).crack == new_crack() &&
          pieces.of_side[2 * f] == pieces.of_side[2 * f + 1])
        return true;
    return false;
  }

  // Reports the attempts before this one; throws Interrupted where the caller stops the search.
  void pause() const {
    const auto done = static_cast<std::size_t>(std::max(best_.attempts - 1, 0));
    report(progress_, "score", done, static_cast<std::size_t>(o_.attempts));
  }
  Complex cut_by(const TriangleMesh& walls) const {
    pause();
    Complex cut = model_;
    crack::insert_sheet_with_pauses(cut, walls, new_crack(), {}, nullptr, [this] { pause(); });
    return cut;
  }

  // The same for counting pieces; faces may cross each other within rounding.
  Complex roughly_cut_by(const TriangleMesh& walls) const {
    pause();
    Complex cut = model_;
    crack::insert_unguarded(cut, walls, new_crack(), [this] { pause(); });
    return cut;
  }

  const Complex& model_;
  const ScoreOptions& o_;
  const Progress& progress_;
  const TriangleBvh skin_;
  const Density density_;  // at most 1; empty: none is given
  Score best_;
  Complex best_cut_;  // by the sheet of best_
  Try nearest_{};
  std::string reason_;
};

}  // namespace

Score make_score(const Complex& model, const ScoreOptions& options, const Progress& progress, Complex* cut) {
  if (options.pieces < 1 || options.pieces > 1000000)
    throw InputError("the number of pieces must be between 1 and 1000000");
  if (!(options.depth > 0 && options.depth <= 1)) throw InputError("the depth must be above 0 and at most 100 percent");
  if (options.attempts < 1) throw InputError("at least one attempt is needed");
  const auto& chips = options.chips;
  if (chips.count < 0 || chips.count > 100000 || !(chips.size >= 0.01 && chips.size <= 1) ||
      !(chips.least >= 0 && chips.least <= 1))
    throw InputError("chips must be at most 100000, their size from 0.01 to 1, the least one from 0 to 1");
  if (chips.count > 0 && options.depth < 1)
    throw InputError("a partial score has no chips: none would break off; give a depth of 100 percent, or no chips");
  const auto& p = options.pattern;
  if (!(p.cluster > 0 && p.cluster <= 10))
    throw InputError("the cluster's size must be above 0 and at most 10 diagonals");
  if (!(p.grain >= 1 && p.grain <= 1000)) throw InputError("the grain must be between 1 and 1000");
  Scoring scoring(model, options, progress);
  Score score = scoring.run();
  if (cut) *cut = scoring.cut_along(score.sheet);
  return score;
}

}  // namespace geo
