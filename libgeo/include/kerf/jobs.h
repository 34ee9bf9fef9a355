// The main jobs in one call each: break a model, cut it, simulate a scene, save pieces. Repair is
// in kerf/repair.h.
//
// These calls are made of those in the other headers, which give more control: a crack complex that
// grows step by step, nodes, mechanics. Python has the same names (docs/python.md).
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "kerf/crack.h"
#include "kerf/export.h"
#include "kerf/mesh.h"
#include "kerf/progress.h"
#include "kerf/scene.h"
#include "kerf/score.h"
#include "kerf/simulation.h"

namespace geo {

// ---- Pieces

/// Breaks a model along a fracture pattern: make_score(), insert_sheet(), make_chunks().
///
/// \param model  a valid model (require_solid()), which may be cut already
/// \param options  the pattern and the number of pieces; lengths are relative to the diagonal
/// \param progress  receives the patterns that are tried
/// \return the pieces in descending order of volume, with the attributes of `model`, the bonds
///   between them, and their names
/// \throws InputError where the model is not valid, or an option out of range
/// \throws GeometryError where no pattern can be inserted
/// \throws Interrupted where `progress` asks for it
PieceSet fracture(const TriangleMesh& model, const ScoreOptions& options = {}, const Progress& progress = {});

/// As insert_sheet() of kerf/crack.h, where the caller may stop it.
/// \param progress  is called every few milliseconds
/// \throws Interrupted where `progress` asks for it; `complex` is then unchanged
CrackDelta insert_sheet(Complex& complex, const TriangleMesh& sheet, std::int32_t crack, const CrackOptions& options,
                        CrackStats* stats, const Progress& progress);

/// Cuts a model along a sheet: insert_sheet(), make_chunks(). Parts of the sheet outside the model
/// have no effect.
///
/// \param model  a valid model (require_solid()), which may be cut already
/// \param sheet  any triangles, connected or not, crossing each other or not; model units
/// \param options  tolerances, relative to the diagonal
/// \param progress  as insert_sheet()
/// \return as fracture()
/// \throws InputError where the model is not valid, or the sheet cannot be used
/// \throws GeometryError where no attempt passes the guard
/// \throws Interrupted where `progress` asks for it
PieceSet cut(const TriangleMesh& model, const TriangleMesh& sheet, const CrackOptions& options = {},
             const Progress& progress = {});

/// Cuts a model along the way of a front, from its first step to its last: begin_front(),
/// advance(), make_chunks(). The front of a sheet is that sheet.
///
/// \param model  a valid model (require_solid()), which may be cut already
/// \param front  with two steps at least unless it is a sheet; model units
/// \param options  tolerances, relative to the diagonal
/// \param progress  is called before each step
/// \return as fracture()
/// \throws InputError where the model is not valid, or the front has too few points or steps
/// \throws GeometryError where no attempt of a step passes the guard
/// \throws Interrupted where `progress` asks for it
PieceSet cut(const TriangleMesh& model, const Front& front, const CrackOptions& options = {},
             const Progress& progress = {});

/// The pieces of a complex: find_pieces(), make_chunks() with a texture tile of a quarter of the
/// diagonal on inner faces, and find_bonds().
///
/// \param model  the surface that `complex` was made from, for its attributes
/// \return as fracture()
PieceSet pieces_of(const Complex& complex, const TriangleMesh& model);

/// Writes pieces, their bonds and convex hulls to a file for engines.
///
/// \param path  ends with .glb (write_glb(), hulls of at most 64 corners) or .usda
///   (write_usd_pieces())
/// \throws InputError for another ending
/// \throws OutputError where the file cannot be written
void save(const std::string& path, const PieceSet& pieces);

// ---- Runs

/// Receives the run and the statistics of the frame that it has just made. False ends the run.
using FrameSink = std::function<bool(const Simulation& run, const FrameStats& frame)>;

/// Simulates a scene up to its last frame, scene.frames, with the models that its bodies name. The
/// frames are those of kerf-sim.
///
/// \param sink  is called after each frame
/// \param progress  receives the reports of the beginning and of each frame
/// \return the run after its last frame: surface, body, state
/// \throws InputError where a model cannot be read, or does not fit the scene
/// \throws GeometryError as Simulation::advance_frame()
/// \throws Interrupted where `progress` asks for it
Simulation simulate(const Scene& scene, const FrameSink& sink, const Progress& progress = {});
/// The same with these models, one for each body of the scene, in place of the files that it names.
Simulation simulate(const Scene& scene, std::vector<TriangleMesh> models, const FrameSink& sink,
                    const Progress& progress = {});

}  // namespace geo
