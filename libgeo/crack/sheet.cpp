// insert_sheet() of kerf/crack.h. As advance(): attempt 0 with the sheet as given, later ones with
// each vertex displaced at random by up to the attempt's jitter. The sheet is a strip without a
// front: no contacts are kept.
#include "kerf/crack.h"

#include "base/random.h"
#include "crack/insert.h"
#include "kerf/error.h"
#include "kerf/progress.h"

namespace geo {

namespace {

// Throws InputError for a sheet that cannot be inserted whatever the complex is.
void check(const TriangleMesh& sheet, std::int32_t crack) {
  if (crack < 1) throw InputError("cracks are numbered from 1");
  for (const Vec3& p : sheet.vertices)
    if (!p.allFinite()) throw InputError("the sheet has a coordinate that is not a finite number");
  for (std::size_t t = 0; t < sheet.triangles.size(); ++t)
    for (const auto v : sheet.triangles[t])
      if (v >= sheet.vertices.size())
        throw InputError("triangle " + std::to_string(t) + " of the sheet names a vertex that is not there");
}

}  // namespace

void crack::insert_unguarded(Complex& complex, const TriangleMesh& sheet, std::int32_t crack, const Pause& pause) {
  check(sheet, crack);
  const CrackOptions options;
  Strip strip = strip_of(sheet.vertices, sheet.triangles);
  snap_to_vertices(strip, complex, options.snap * complex.extent().diagonal());
  Arrangement arrangement(complex, strip, pause);
  std::vector<VertexId> vertex;
  CrackStats stats;
  insert_strip(complex, strip, arrangement, crack, vertex, {}, stats);
}

CrackDelta crack::insert_sheet_with_pauses(Complex& complex, const TriangleMesh& sheet, std::int32_t crack,
                                           const CrackOptions& options, CrackStats* stats, const crack::Pause& pause) {
  check(sheet, crack);
  const double size = complex.extent().diagonal();
  // 2⁶⁴ / golden ratio spreads consecutive seeds.
  Random random(options.seed * 0x9e3779b97f4a7c15ull);
  CrackStats done;
  std::string reason;
  for (int attempt = 0; attempt <= options.attempts; ++attempt) {
    const auto [jitter, clearance] = crack::attempt_at(attempt, options, size);
    ++done.attempts;
    Stopwatch watch;
    std::vector<Vec3> points = sheet.vertices;
    if (attempt > 0)
      for (Vec3& p : points) {
        const Vec3 direction = random.direction();
        p += random.uniform(0.2, 1.0) * jitter * direction;
      }
    Strip strip = strip_of(points, sheet.triangles);
    done.snapped += snap_to_vertices(strip, complex, options.snap * size);
    done.near_seconds += watch.lap();
    try {
      crack::Arrangement arrangement(complex, strip, pause);
      std::vector<VertexId> vertex;
      CrackDelta delta = crack::insert_strip(complex, strip, arrangement, crack, vertex, clearance, done);
      if (stats) *stats += done;
      return delta;
    } catch (const GeometryError& e) {
      reason = e.what();
    }
  }
  if (stats) *stats += done;
  throw GeometryError("the sheet cannot be inserted: " + reason);
}

CrackDelta insert_sheet(Complex& complex, const TriangleMesh& sheet, std::int32_t crack, const CrackOptions& options,
                        CrackStats* stats) {
  return crack::insert_sheet_with_pauses(complex, sheet, crack, options, stats, {});
}

}  // namespace geo
