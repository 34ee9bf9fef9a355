// Hulls of the pieces of scores, whose corners are limited: how far pieces stick out of them, for
// thirty models with thirty pieces each.
//   KERF_CASES=10 KERF_TELL=1 test_score '[hulls]': all of them, with figures.
#include <algorithm>
#include <catch2/catch.hpp>
#include <chrono>
#include <cmath>
#include <iostream>

#include "cases.h"
#include "kerf/crack.h"
#include "kerf/pieces.h"
#include "kerf/score.h"
#include "score/models.h"

using namespace geo;

namespace {

std::vector<TriangleMesh> pieces_of(const TriangleMesh& model, std::uint64_t seed) {
  Complex cut = Complex::from_skin(model);
  ScoreOptions options;
  options.pieces = 30;
  options.pattern.seed = options.jagged.seed = seed;
  options.jagged.amplitude = 0.02;
  insert_sheet(cut, make_score(cut, options).sheet, 1);
  const Pieces pieces = find_pieces(cut);
  std::vector<TriangleMesh> meshes;
  for (std::uint32_t p = 0; p < pieces.count; ++p) meshes.push_back(piece_mesh(cut, pieces, p));
  return meshes;
}

// How far vertices of one mesh are in front of a face of another, a convex one.
double stick_out(const TriangleMesh& mesh, const TriangleMesh& hull) {
  double farthest = 0;
  for (const auto& [a, b, c] : corners_of(hull)) {
    const Vec3 normal = face_normal(a, b, c);
    for (const Vec3& p : mesh.vertices) farthest = std::max(farthest, normal.dot(p - a));
  }
  return farthest;
}

// Figures of all hulls with one number of corners.
class Figures {
 public:
  Figures(std::size_t corners, double most) : corners_(corners), most_(most) {}

  void add(const TriangleMesh& piece) {
    const auto start = std::chrono::steady_clock::now();
    const auto hulls = convex_decomposition(piece, 1, corners_);
    seconds_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    REQUIRE(hulls.size() == 1);
    const TriangleMesh whole = convex_decomposition(piece, 1, ~std::size_t(0)).at(0);
    const double diagonal = bounding_box(piece).diagonal();
    out_.push_back(stick_out(piece, hulls[0]) / diagonal);
    CHECK(hulls[0].vertices.size() <= corners_);
    CHECK(out_.back() <= most_);
    // The other way round: hulls are not simply larger.
    beyond_.push_back(stick_out(hulls[0], whole) / diagonal);
    CHECK(beyond_.back() <= most_);
  }

  void tell() {
    const auto percent = [](std::vector<double>& shares, double of) {
      std::sort(shares.begin(), shares.end());
      return 100 * shares[std::size_t(std::ceil(of * double(shares.size())) - 1)];
    };
    std::cout << corners_ << " corners, " << out_.size() << " pieces: out of the hull " << percent(out_, 1)
              << " % at most, 99 of 100 " << percent(out_, 0.99) << " %, half " << percent(out_, 0.5)
              << " %; beyond the piece's " << percent(beyond_, 1) << ", " << percent(beyond_, 0.99) << ", "
              << percent(beyond_, 0.5) << " %; " << seconds_ << " s" << std::endl;
  }

 private:
  std::size_t corners_;
  double most_;
  double seconds_ = 0;
  std::vector<double> out_, beyond_;
};

}  // namespace

TEST_CASE("pieces stick out of limited hulls by little, and hulls out of pieces", "[hulls]") {
  std::vector<std::string> names = score_models::names;
  for (const char* name :
       {"ball", "cube", "letter A", "letter E", "letter G", "letter M", "letter Q", "letter S", "letter W", "letter X"})
    names.emplace_back(name);
  REQUIRE(names.size() == 30);
  Figures many(64, 0.01), few(32, 0.03);
  const auto count = std::min(names.size(), static_cast<std::size_t>(cases(3)));
  for (std::size_t i = 0; i < count; ++i) {
    INFO("model " << names[i]);
    for (const TriangleMesh& piece : pieces_of(score_models::model_of(names[i]), i + 1)) {
      many.add(piece);
      few.add(piece);
    }
  }
  if (!std::getenv("KERF_TELL")) return;
  many.tell();
  few.tell();
}
