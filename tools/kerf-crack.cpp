// kerf-crack: progressive crack surfaces from fronts.
#include <algorithm>
#include <iostream>

#include "crack/advance.h"
#include "io/front_file.h"
#include "io/stream.h"
#include "model.h"
#include "tool.h"

int main(int argc, char** argv) {
  tool::Tool t("kerf-crack", "Sweeps fronts through a solid and adds the cracks they leave, both sides of each.",
               "  kerf-crack bear.off --front halve.front -o cut.ply\n  kerf-crack bear.off --front halve.front --steps 0:6 -o half.ply\n  kerf-crack half.ply --front halve.front --steps 6:12 -o cut.ply\n  kerf-crack cut.ply --front second.front -o quarters.ply");
  std::string model, steps, repro;
  std::vector<std::string> front_paths;
  double max_move = 0;
  t.argument("MESH", model, "A closed surface, or the output of an earlier run to go on with");
  t.option("--front", front_paths, "Front files, each front a crack of its own");
  t.option("--steps", steps, "Sweep from time step A to B only, as A:B");
  t.option("--max-move", max_move, "Divide steps in which a front point moves farther; 0: never");
  t.option("--repro", repro, "Where to write model and front when a step fails");
  t.output("The cut surface (PLY with patch and site; .obj on request)");
  return t.run(argc, argv, [&] {
    if (front_paths.empty()) throw tool::UsageError("give at least one --front");
    std::size_t from = 0, to = ~std::size_t(0);
    if (!steps.empty()) {
      unsigned long a = 0, b = 0;
      char rest = 0;
      if (std::sscanf(steps.c_str(), "%lu:%lu%c", &a, &b, &rest) != 2 || a >= b) throw tool::UsageError("--steps '" + steps + "' is not A:B with A < B");
      from = a, to = b;
    }
    if (max_move < 0) throw tool::UsageError("--max-move must not be negative");
    const std::string target = t.target(true);
    std::vector<geo::Front> fronts;
    for (const auto& path : front_paths) {
      const auto more = geo::read_fronts(path);
      fronts.insert(fronts.end(), more.begin(), more.end());
    }
    const auto file = tool::read_solid(model);
    geo::Complex complex = tool::complex_of(file, model);
    std::vector<geo::FrontState> states = file.fronts;
    const auto cut_surface = [&] {
      geo::TriangleMesh mesh = complex.two_sided();
      geo::carry(file.mesh, mesh);
      return mesh;
    };
    const auto progress = t.progress();
    geo::CrackOptions options;
    options.seed = t.seed;
    std::string json = "[";
    std::size_t done = 0, total = 0;
    for (const auto& f : fronts) total += std::min(to, f.steps.size() - 1) - std::min(from, f.steps.size() - 1);
    for (const auto& front : fronts) {
      const std::size_t last = std::min(to, front.steps.size() - 1);
      if (from >= last) throw geo::InputError("front '" + front.name + "' has only " + std::to_string(front.steps.size()) + " time steps; change --steps");
      // A front of this name that stopped where we begin is taken up again, contacts and all.
      auto state = std::find_if(states.begin(), states.end(), [&](const geo::FrontState& s) { return s.name == front.name && s.step == from && from > 0; });
      if (state == states.end()) {
        std::int32_t crack = complex.crack_count();  // fronts that have met nothing yet have their numbers already
        for (const auto& other : states) crack = std::max(crack, other.crack);
        states.push_back(geo::begin_front(front.steps[from], front.closed, crack + 1));
        state = states.end() - 1;
        state->name = front.name;
      }
      state->step = static_cast<std::uint32_t>(from);
      for (std::size_t step = from; step < last; ++step) {
        geo::report(progress, "crack " + front.name, done++, total);
        std::vector<geo::Vec3> start;
        for (const auto& p : state->points) start.push_back(p.position);
        const auto end = geo::correspond(start, front.steps[step + 1], front.closed);
        const int parts = max_move > 0 ? geo::substeps(start, end, max_move) : 1;
        geo::CrackWork work;
        for (int i = 1; i <= parts; ++i) {
          std::vector<geo::Vec3> next = end;
          if (i < parts)
            for (std::size_t p = 0; p < next.size(); ++p) next[p] = start[p] + (end[p] - start[p]) * (double(i) / parts);
          try {
            geo::advance(complex, *state, next, options, &work);
          } catch (const geo::GeometryError& e) {
            if (!repro.empty()) {
              geo::write_all(repro + ".ply", [&](std::ostream& out) { geo::write_ply(out, cut_surface(), states); });
              geo::write_all(repro + ".front", [&](std::ostream& out) { geo::write_fronts(out, {{front.name, front.closed, {start, next}}}); });
            }
            throw geo::GeometryError(model + ": front '" + front.name + "', " + e.what() + "; " + (repro.empty() ? "run again with --repro FILE to keep the case" : "the case is in " + repro + ".ply and .front"));
          }
        }
        state->step = static_cast<std::uint32_t>(step + 1);
        json += std::string(json.size() > 1 ? "," : "") + "{\"front\":" + tool::quoted(front.name) + ",\"step\":" + std::to_string(step + 1) +
                ",\"triangles_cut\":" + std::to_string(work.triangles_cut) + ",\"crack_faces\":" + std::to_string(work.new_crack_faces) +
                ",\"attempts\":" + std::to_string(work.attempts) + ",\"repairs\":" + std::to_string(work.repairs) + ",\"seconds\":{\"near\":" + tool::number(work.near_seconds) + ",\"meet\":" + tool::number(work.meet_seconds) +
                ",\"split\":" + tool::number(work.split_seconds) + ",\"keep\":" + tool::number(work.keep_seconds) + ",\"stitch\":" + tool::number(work.stitch_seconds) +
                ",\"guard\":" + tool::number(work.guard_seconds) + ",\"total\":" + tool::number(work.seconds()) + "}}";
      }
    }
    geo::report(progress, "done", total, total);
    const auto mesh = cut_surface();
    geo::write_all(target, [&](std::ostream& out) { target.ends_with(".obj") ? geo::write_obj(out, mesh) : geo::write_ply(out, mesh, states, "kerf-crack"); });
    if (t.json) (target == "-" ? std::cerr : std::cout) << json << "]\n";
  });
}
