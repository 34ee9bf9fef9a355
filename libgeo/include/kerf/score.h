// A score: the walls of a fracture pattern as one sheet that parts a model into as many pieces as wanted (§ 7, Fig. 7).
#pragma once

#include "kerf/complex.h"
#include "kerf/progress.h"
#include "score/jagged.h"
#include "score/patterns.h"

namespace geo {

struct ScoreOptions {
  PatternOptions pattern;
  int pieces = 20;       ///< of material, wanted; sheets and curves: as they come
  JaggedOptions jagged;  ///< amplitude 0: walls as they are
  double depth = 1;      ///< below 1: a partial score, see keep_shallow()
  int attempts = 60;     ///< how many patterns are tried for the wanted number of pieces
};

struct Score {
  TriangleMesh sheet;        ///< for insert_sheet(): where walls meet they share rows
  std::uint32_t pieces = 0;  ///< that a score of full depth parts the model into
  int attempts = 0;          ///< patterns tried
};

/// Tries patterns, coarser and finer ones and those of other seeds, until one parts the model into as many pieces as
/// wanted; else returns the one that comes nearest. Throws InputError for options out of range, Interrupted when asked
/// to stop.
Score make_score(const Complex& model, const ScoreOptions& options, const Progress& progress = {});

}  // namespace geo
