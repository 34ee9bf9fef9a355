// The Python module beside the same calls in C++: arrays to pieces to arrays, in turns, on one
// thread. CPU time; python_fracture.py is the other side.
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <stdexcept>

#include "bench.h"
#include "kerf/check.h"
#include "kerf/crack.h"
#include "kerf/mesh.h"
#include "kerf/parallel.h"
#include "kerf/pieces.h"
#include "kerf/score.h"

namespace bench {
namespace {

constexpr int pieces = 30, runs = 9, imports = 11;

// A Python program that answers each line with a line.
class Interpreter {
 public:
  explicit Interpreter(const std::vector<std::string>& arguments) {
    std::array<int, 2> ends{};
    if (socketpair(AF_UNIX, SOCK_STREAM, 0, ends.data()) != 0) throw std::runtime_error("no socket");
    child_ = fork();
    if (child_ < 0) throw std::runtime_error("no process");
    if (child_ == 0) {
      dup2(ends[1], 0);
      dup2(ends[1], 1);
      close(ends[0]);
      close(ends[1]);
      setenv("PYTHONPATH", KERF_PYTHON_PATH, 1);
      std::vector<char*> words{const_cast<char*>(KERF_PYTHON_EXECUTABLE)};
      for (const auto& word : arguments) words.push_back(const_cast<char*>(word.c_str()));
      words.push_back(nullptr);
      execv(KERF_PYTHON_EXECUTABLE, words.data());
      _exit(127);
    }
    close(ends[1]);
    in_ = fdopen(dup(ends[0]), "w");
    out_ = fdopen(ends[0], "r");
  }
  ~Interpreter() {
    shutdown(fileno(in_), SHUT_WR);
    std::fclose(in_);
    std::fclose(out_);
    waitpid(child_, nullptr, 0);
  }
  Interpreter(const Interpreter&) = delete;
  Interpreter& operator=(const Interpreter&) = delete;

  void tell(const std::string& line) {
    std::fprintf(in_, "%s\n", line.c_str());
    std::fflush(in_);
  }
  /// The numbers of a line.
  std::vector<double> numbers(std::size_t count) {
    std::vector<double> out(count);
    for (double& value : out)
      if (std::fscanf(out_, "%lf", &value) != 1) throw std::runtime_error("kerf-bench: the Python side stopped");
    return out;
  }

 private:
  pid_t child_ = 0;
  std::FILE *in_ = nullptr, *out_ = nullptr;
};

// Arrays as NumPy has them.
struct Arrays {
  std::vector<double> vertices;
  std::vector<std::int64_t> faces;
};

// The sum over what a user reads of the pieces, so that no side leaves work out.
struct Result {
  double volume = 0;
  std::size_t faces = 0, pieces = 0;
};

Result fracture(const Arrays& arrays, double& seconds) {
  geo::TriangleMesh model;
  model.vertices.resize(arrays.vertices.size() / 3);
  model.triangles.resize(arrays.faces.size() / 3);
  for (std::size_t i = 0; i < model.vertices.size(); ++i)
    for (int k = 0; k < 3; ++k) model.vertices[i][k] = arrays.vertices[3 * i + static_cast<std::size_t>(k)];
  for (std::size_t i = 0; i < model.triangles.size(); ++i)
    for (std::size_t k = 0; k < 3; ++k) model.triangles[i][k] = static_cast<std::uint32_t>(arrays.faces[3 * i + k]);
  geo::require_solid(model);
  const double start = cpu_seconds();
  geo::ScoreOptions options;
  options.pattern.pattern = geo::Pattern::voronoi;
  options.pattern.seed = options.jagged.seed = 7;
  options.pieces = pieces;
  options.jagged.amplitude = 0.02;
  const geo::Complex skin = geo::Complex::from_skin(model);
  const geo::Score score = geo::make_score(skin, options);
  geo::Complex complex = skin;
  geo::insert_sheet(complex, score.sheet, 1);
  const geo::Pieces found = geo::find_pieces(complex);
  const auto chunks = geo::make_chunks(complex, found, model, 0.25 * complex.extent().diagonal());
  seconds = cpu_seconds() - start;
  Result result{0, 0, chunks.size()};
  for (const auto& chunk : chunks) {
    result.volume += chunk.volume;
    result.faces += chunk.mesh.triangles.size();
  }
  return result;
}

double import_milliseconds() {
  double least = 1e300;
  for (int run = 0; run < imports; ++run) {
    Interpreter one(
        {"-c", "import time; t = time.perf_counter(); import kerf; print(1e3 * (time.perf_counter() - t))"});
    least = std::min(least, one.numbers(1)[0]);
  }
  return least;
}

}  // namespace

int python(const Options& options) {
  geo::set_threads(1);
  const auto model = geo::make_pumpkin(options.frequencies.front());
  Arrays arrays;
  for (const auto& p : model.vertices) arrays.vertices.insert(arrays.vertices.end(), p.data(), p.data() + 3);
  for (const auto& t : model.triangles) arrays.faces.insert(arrays.faces.end(), t.begin(), t.end());

  Interpreter peer({KERF_PYTHON_SCRIPT, std::to_string(options.frequencies.front()), std::to_string(pieces)});
  double ours = 1e300, theirs = 1e300, ours_fracture = 1e300, theirs_fracture = 1e300;
  for (int run = 0; run < runs; ++run) {
    double seconds = 0;
    const double start = cpu_seconds();
    const Result result = fracture(arrays, seconds);
    ours = std::min(ours, cpu_seconds() - start);
    ours_fracture = std::min(ours_fracture, seconds);
    peer.tell("run");
    const auto told = peer.numbers(5);  // seconds of all, of fracture; volume, faces, pieces
    theirs = std::min(theirs, told[0]);
    theirs_fracture = std::min(theirs_fracture, told[1]);
    if (told[2] != result.volume || told[3] != double(result.faces) || told[4] != double(result.pieces))
      throw std::runtime_error("kerf-bench: Python and C++ made other pieces");
  }
  const Figures figures{{"overhead", theirs / ours - 1},
                        {"fracture_40k_seconds", theirs_fracture},
                        {"fracture_40k_seconds_cpp", ours_fracture},
                        {"seconds_python", theirs},
                        {"seconds_cpp", ours},
                        {"import_ms", import_milliseconds()}};
  print(figures, options.json);
  return 0;
}

}  // namespace bench
