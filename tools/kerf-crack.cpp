// kerf-crack: cuts a surface by fronts and sheets.
#include <algorithm>
#include <iostream>

#include <kerf/crack.h>
#include <kerf/files.h>
#include <kerf/pieces.h>
#include "model.h"
#include "tool.h"

namespace {

struct Command {
  std::string model, steps, repro;
  std::vector<std::string> fronts, sheets;
  double max_move = 0, remesh = 0, jagged = 0, bumps = 8, decimate = 0, unit = 0;
  std::size_t from = 0, to = ~std::size_t(0);
  bool repair = false;
};

void check(Command& w) {
  if ((w.model == "-") + std::count(w.fronts.begin(), w.fronts.end(), "-") +
          std::count(w.sheets.begin(), w.sheets.end(), "-") >
      1)
    throw tool::UsageError("only one file can come from standard input");
  if (w.fronts.empty() && w.sheets.empty() && !(w.jagged > 0) && !(w.decimate > 0))
    throw tool::UsageError("give at least one --front, --sheet, --jagged or --decimate");
  if (!w.steps.empty()) {
    unsigned long a = 0, b = 0;
    char rest = 0;
    if (std::sscanf(w.steps.c_str(), "%lu:%lu%c", &a, &b, &rest) != 2 || a >= b)
      throw tool::UsageError("--steps '" + w.steps + "' is not A:B with A < B");
    w.from = a;
    w.to = b;
  }
  if (!(w.max_move >= 0)) throw tool::UsageError("--max-move must not be negative");
  if (!(w.remesh >= 0 && w.remesh <= 30)) throw tool::UsageError("--remesh must be an angle between 0 and 30 degrees");
  if (!(w.jagged >= 0 && w.jagged < 1))
    throw tool::UsageError("--jagged must be a fraction of the diagonal, at least 0 and below 1");
  if (!(w.bumps > 0 && w.bumps <= 1e4)) throw tool::UsageError("--bumps must be positive and at most 10000");
  if (!(w.decimate >= 0 && w.decimate < 1))
    throw tool::UsageError("--decimate must be a fraction of the diagonal, at least 0 and below 1");
}

class Cutting {
 public:
  Cutting(const Command& command, const tool::Tool& t)
      : w_(command),
        t_(t),
        file_(tool::read_solid(w_.model, w_.repair, [&](const std::string& line) { t.say("kerf-crack: " + line); })),
        complex_(tool::complex_of(file_, w_.model)),
        states_(file_.fronts) {
    options_.seed = t.seed;
    if (w_.unit > 0) file_.mesh.unit = w_.unit;
  }

  void decimate() {
    if (!(w_.decimate > 0)) return;
    geo::DecimateOptions options;
    options.deviation = w_.decimate;
    geo::DecimateStats work;
    geo::decimate(complex_, held(), options, &work);
    note("\"decimate\":{\"collapses\":" + std::to_string(work.collapses) + ",\"faces\":" +
         std::to_string(complex_.live_face_count()) + ",\"seconds\":" + tool::number(work.seconds) + "}");
  }

  void sweep(const std::vector<geo::Front>& fronts) {
    const auto progress = t_.progress();
    std::size_t done = 0, total = 0;
    for (const auto& f : fronts)
      total += f.is_sheet() ? 1 : std::min(w_.to, f.steps.size() - 1) - std::min(w_.from, f.steps.size() - 1);
    for (const auto& front : fronts) {
      if (front.is_sheet()) {
        geo::report(progress, "crack " + front.name, done++, total);
        if (w_.from == 0)
          insert(front.name, front.steps[0], front.triangles);  // otherwise an earlier run has inserted it
        continue;
      }
      const std::size_t last = std::min(w_.to, front.steps.size() - 1);
      if (w_.from >= last)
        throw geo::InputError("front '" + front.name + "' has only " + std::to_string(front.steps.size()) +
                              " time steps; change --steps");
      const std::size_t row = state_of(front);
      std::size_t made = 0;
      geo::Box3 swept;
      for (std::size_t step = w_.from; step < last; ++step) {
        geo::report(progress, "crack " + front.name, done++, total);
        made += make_step(front, states_[row], step);
        for (std::size_t s : {step, step + 1})
          for (const geo::Vec3& p : front.steps[s]) swept.add(p);
      }
      if (made == 0 && w_.from == 0 && last + 1 == front.steps.size()) say_missed("front '" + front.name + "'", swept);
    }
    geo::report(progress, "done", total, total);
  }

  void insert(const std::string& name, const std::vector<geo::Vec3>& points,
              const std::vector<geo::Triangle>& triangles) {
    geo::TriangleMesh sheet;
    sheet.vertices = points;
    sheet.triangles = triangles;
    geo::CrackStats work;
    geo::CrackDelta delta;
    try {
      delta = geo::insert_sheet(complex_, sheet, next_crack(), options_, &work);
    } catch (const geo::GeometryError& e) {
      throw geo::GeometryError(name + ": " + e.what());
    }
    if (work.new_crack_faces == 0) say_missed("sheet '" + name + "'", geo::bounding_box(sheet));
    note("\"sheet\":" + tool::quoted(name) + "," + figures(work) + remeshed(delta.new_faces));
  }

  void roughen() {
    if (!(w_.jagged > 0)) return;
    geo::RoughenOptions options;
    options.amplitude = w_.jagged;
    options.frequency = w_.bumps;
    options.seed = t_.seed;
    geo::RoughenStats work;
    geo::roughen(complex_, held(), options, &work);
    note("\"jagged\":{\"divisions\":" + std::to_string(work.divisions) + ",\"moves\":" + std::to_string(work.moves) +
         ",\"lowered\":" + std::to_string(work.lowered) + ",\"seconds\":" + tool::number(work.seconds) + "}");
  }

  void write(const std::string& target) const {
    const auto mesh = cut_surface();
    tool::write_surface(mesh, states_, target, t_);
    if (t_.json) (target == "-" ? std::cerr : std::cout) << '[' << json_ << "]\n";
    if (!t_.verbose) return;
    const auto cracks = static_cast<std::size_t>(complex_.crack_count());
    t_.say("kerf-crack: " + tool::counted(geo::find_pieces(complex_).count, "piece") + ", " +
           tool::counted(cracks, "crack") + ", " + tool::counted(mesh.triangles.size(), "triangle"));
  }

 private:
  void say_missed(const std::string& what, const geo::Box3& where) const {
    const geo::Box3 model = complex_.extent();
    t_.say("kerf-crack: " + what + " meets no material; it is within (" + tool::rounded(where.lo) + ") to (" +
           tool::rounded(where.hi) + "), the model within (" + tool::rounded(model.lo) + ") to (" +
           tool::rounded(model.hi) + ")");
  }
  geo::TriangleMesh cut_surface() const {
    geo::TriangleMesh mesh = complex_.two_sided();
    geo::transfer_attributes(file_.mesh, mesh);
    return mesh;
  }
  void note(const std::string& entry) { json_ += (json_.empty() ? "{" : ",{") + entry + "}"; }
  std::vector<geo::FrontState*> held() {
    std::vector<geo::FrontState*> fronts;
    for (auto& s : states_) fronts.push_back(&s);
    return fronts;
  }
  std::int32_t next_crack() const {
    geo::CrackNumbers numbers(complex_);
    for (const auto& other : states_) numbers.note(other.crack);
    return numbers.next();
  }

  // Continues a front of this name, with its contacts, that stopped at the first step of this run.
  std::size_t state_of(const geo::Front& front) {
    auto state = std::find_if(states_.begin(), states_.end(), [&](const geo::FrontState& s) {
      return s.name == front.name && s.step == w_.from && w_.from > 0;
    });
    if (state == states_.end()) {
      states_.push_back(geo::begin_front(front.steps[w_.from], front.closed, next_crack()));
      state = states_.end() - 1;
      state->name = front.name;
    }
    state->step = static_cast<std::uint32_t>(w_.from);
    return static_cast<std::size_t>(state - states_.begin());
  }

  // Returns the number of crack triangles that the step made.
  std::size_t make_step(const geo::Front& front, geo::FrontState& state, std::size_t step) {
    std::vector<geo::Vec3> start;
    for (const auto& p : state.points) start.push_back(p.position);
    const auto end = geo::resample_front(start, front.steps[step + 1], front.closed);
    const int parts = w_.max_move > 0 ? geo::substep_count(start, end, w_.max_move) : 1;
    geo::CrackStats work;
    std::vector<geo::FaceId> made;
    for (int i = 1; i <= parts; ++i) {
      std::vector<geo::Vec3> next = end;
      if (i < parts)
        for (std::size_t p = 0; p < next.size(); ++p) next[p] = start[p] + (end[p] - start[p]) * (double(i) / parts);
      try {
        const auto delta = geo::advance(complex_, state, next, options_, &work);
        made.insert(made.end(), delta.new_faces.begin(), delta.new_faces.end());
      } catch (const geo::GeometryError& e) {
        if (!w_.repro.empty()) {
          geo::write_all(w_.repro + ".ply", [&](std::ostream& out) { geo::write_ply(out, cut_surface(), states_); });
          geo::write_all(w_.repro + ".front", [&](std::ostream& out) {
            geo::write_fronts(out,
                              {{.name = front.name, .closed = front.closed, .steps = {start, next}, .triangles = {}}});
          });
        }
        throw geo::GeometryError(w_.model + ": front '" + front.name + "', " + e.what() + "; " +
                                 (w_.repro.empty() ? "run again with --repro FILE to keep the case"
                                                   : "the case is in " + w_.repro + ".ply and .front"));
      }
    }
    state.step = static_cast<std::uint32_t>(step + 1);
    note("\"front\":" + tool::quoted(front.name) + ",\"step\":" + std::to_string(step + 1) + "," + figures(work) +
         remeshed(made));
    return work.new_crack_faces;
  }

  static std::string figures(const geo::CrackStats& work) {
    return "\"triangles_cut\":" + std::to_string(work.triangles_cut) +
           ",\"crack_faces\":" + std::to_string(work.new_crack_faces) +
           ",\"attempts\":" + std::to_string(work.attempts) + ",\"repairs\":" + std::to_string(work.repairs) +
           ",\"seconds\":{\"near\":" + tool::number(work.near_seconds) +
           ",\"meet\":" + tool::number(work.meet_seconds) + ",\"split\":" + tool::number(work.split_seconds) +
           ",\"keep\":" + tool::number(work.keep_seconds) + ",\"stitch\":" + tool::number(work.stitch_seconds) +
           ",\"guard\":" + tool::number(work.guard_seconds) + ",\"total\":" + tool::number(work.seconds()) + "}";
  }

  std::string remeshed(const std::vector<geo::FaceId>& faces) {
    if (!(w_.remesh > 0)) return {};
    geo::RemeshOptions options;
    options.angle = w_.remesh;
    geo::RemeshStats work;
    geo::remesh(complex_, faces, held(), options, &work);
    return ",\"remesh\":{\"flips\":" + std::to_string(work.flips) + ",\"collapses\":" + std::to_string(work.collapses) +
           ",\"moves\":" + std::to_string(work.moves) + ",\"divisions\":" + std::to_string(work.divisions) +
           ",\"seconds\":" + tool::number(work.seconds) + "}";
  }

  const Command& w_;
  const tool::Tool& t_;
  geo::SurfaceFile file_;
  geo::Complex complex_;
  std::vector<geo::FrontState> states_;
  geo::CrackOptions options_;
  std::string json_;
};

}  // namespace

int main(int argc, char** argv) {
  tool::Tool t("kerf-crack", "Sweeps fronts through a solid and adds the cracks they leave, both sides of each.",
               R"(  kerf-crack bear.off --front halve.front -o cut.ply
  kerf-crack bear.off --front halve.front --steps 0:6 -o half.ply
  kerf-crack half.ply --front halve.front --steps 6:12 -o cut.ply
  kerf-crack cut.ply --front second.front --remesh 15 -o quarters.ply
  kerf-crack bear.off --sheet plane.obj --jagged 0.01 -o broken.ply)");
  Command w;
  t.argument("MESH", w.model, "A closed surface, or the output of an earlier run to go on with");
  t.option("--front", w.fronts, "Front files, each front or sheet a crack of its own");
  t.option("--sheet", w.sheets, "Surfaces, open or closed, each inserted whole as a crack of its own");
  t.option("--steps", w.steps, "Sweep from time step A to B only, as A:B");
  t.option("--max-move", w.max_move, "Divide steps in which a front point moves farther; 0: never");
  t.option("--remesh", w.remesh, "After each step, improve new faces with angles below this, in degrees; 0: never");
  t.option("--jagged", w.jagged,
           "At last, roughen the cracks: height of the bumps as a fraction of the model's diagonal");
  t.option("--bumps", w.bumps, "How many of the largest bumps fit along the diagonal");
  t.option("--decimate", w.decimate, "First, drop vertices whose surface stays within this fraction of the diagonal");
  t.flag("--repair", w.repair, "Repair the model first, as kerf-repair does");
  t.unit_option(w.unit, "Unit of the model's coordinates, which the output states: m, cm, mm, in, ft ...");
  t.output_option("--repro", w.repro, "Where to write model and front when a step fails");
  t.output("The cut surface (PLY with patch and site; .obj on request)", {".ply", ".obj"});
  return t.run(argc, argv, [&] {
    check(w);
    const std::string target = t.target(true);
    std::vector<geo::Front> fronts;
    for (const auto& path : w.fronts) {
      const auto more = geo::read_fronts(path);
      fronts.insert(fronts.end(), more.begin(), more.end());
    }
    Cutting cutting(w, t);
    cutting.decimate();
    cutting.sweep(fronts);
    for (const auto& path : w.sheets) {
      const auto sheet = tool::read_surface(path).mesh;
      cutting.insert(path, sheet.vertices, sheet.triangles);
    }
    cutting.roughen();
    cutting.write(target);
  });
}
