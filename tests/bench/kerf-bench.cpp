// kerf-bench: how fast, beside whom.
#include "bench.h"
#include "tool.h"

int main(int argc, char** argv) {
  tool::Tool t(
      "kerf-bench", "Measures parts of Kerf beside other libraries, in one run.",
      "  kerf-bench crack\n  kerf-bench crack --frequency 11 --frequency 45 --json\n  kerf-bench crack --frequency 22 "
      "--model bear.off\n  kerf-bench block --cuts 100\n  kerf-bench graph --nodes 100000 --json");
  std::string what;
  bench::Options options;
  std::vector<std::string> frequencies, nodes;
  t.argument(
      "WHAT", what,
      "break: impacts at run time; crack: progressive cutting beside CGAL; block: many cuts, remeshed; fracture: a "
      "body that breaks along cells, beside one that does not; graph: its "
      "parts beside other "
      "libraries; concave: distances around concave edges; contact: self-contact of a sliced block; dataset: "
      "fractures for learning; live: "
      "kerf-live with a client that cuts; mechanics: "
      "time steps beside Bullet; python: the module beside C++; score: prescoring, one thread and all; simulation: a "
      "halved pumpkin with more and more nodes; validate: "
      "mechanics against formulas; wasm: cutting, scoring, a step in WebAssembly beside native ones");
  t.option("--frequency", frequencies, "Sizes of the pumpkin, 20 f^2 triangles each (11, 22, 45, 89, 179)");
  t.option("--nodes", nodes,
           "How many nodes there are (10000, 100000, 1000000; mechanics: 4000, 27000; contact: 230, 920, 3700; "
           "simulation: 2000, 8000, 32000, 128000, 512000, 1000000, after the scenes of the samples)");
  t.option("--cuts", options.cuts, "How many cuts go through the block");
  t.option("--model", options.models,
           "Closed meshes to measure as well; live: these alone, each cut into a heap of pieces");
  return t.run(argc, argv, [&] {
    std::map<std::string, int (*)(const bench::Options&)> known{
        {"crack", bench::crack},       {"block", bench::block},      {"graph", bench::graph},
        {"concave", bench::concave},   {"contact", bench::contact},  {"mechanics", bench::mechanics},
        {"dataset", bench::dataset},   {"live", bench::live},        {"score", bench::score},
        {"validate", bench::validate}, {"break", bench::impact},     {"simulation", bench::simulation},
        {"wasm", bench::wasm},         {"fracture", bench::fracture}};
#ifdef KERF_PYTHON_SCRIPT
    known["python"] = bench::python;
#endif
    if (!known.count(what))
      throw tool::UsageError(
          "nothing is known about '" + what +
          "'; there are break, crack, block, fracture, graph, concave, contact, dataset, live, mechanics, score, "
          "simulation, validate, wasm and, with "
          "KERF_PYTHON, python");
    if (options.cuts < 10 || options.cuts > 100000) throw tool::UsageError("--cuts is from 10 to 100000");
    for (const auto& f : frequencies) options.frequencies.push_back(std::atoi(f.c_str()));
    for (const int f : options.frequencies)
      if (f < 1 || f > 2000) throw tool::UsageError("--frequency is from 1 to 2000");
    if (frequencies.empty())
      options.frequencies =
          what == "score" || what == "python" ? std::vector<int>{45} : std::vector<int>{11, 22, 45, 89, 179};
    for (const auto& n : nodes) options.nodes.push_back(std::strtoul(n.c_str(), nullptr, 10));
    for (const auto n : options.nodes)
      if (n < 100 || n > 100000000) throw tool::UsageError("--nodes is from 100 to 100000000");
    if (nodes.empty())
      options.nodes = what == "concave"      ? std::vector<std::size_t>{100000}
                      : what == "contact"    ? std::vector<std::size_t>{230, 920, 3700}
                      : what == "mechanics"  ? std::vector<std::size_t>{4000, 27000}
                      : what == "simulation" ? std::vector<std::size_t>{2000, 8000, 32000, 128000, 512000, 1000000}
                                             : std::vector<std::size_t>{10000, 100000, 1000000};
    options.scenes = nodes.empty();
    options.json = t.json;
    known.at(what)(options);
  });
}
