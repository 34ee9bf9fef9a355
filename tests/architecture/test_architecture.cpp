// The order of the modules, read from the includes: a module includes only those before it
// (docs/design.md).
#include <algorithm>
#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <map>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

namespace fs = std::filesystem;

namespace {

// Modules and inner modules, lowest first, as cmake/modules.cmake lists them. A folder that is not
// named there is not a module.
const std::vector<std::string> modules = [] {
  std::istringstream order(KERF_MODULE_ORDER);
  return std::vector<std::string>(std::istream_iterator<std::string>(order), {});
}();

// The module of each public header: the lowest one that defines functions of it.
const std::map<std::string, std::string> public_headers{
    {"appearance", "io"},
    {"body", "body"},
    {"body_file", "io"},
    {"check", "surface"},
    {"complex", "surface"},
    {"contact", "contact/detection"},
    {"crack", "crack"},
    {"error", "base"},
    {"export", "io"},
    {"files", "io"},
    {"glue", "crack"},
    {"graph", "graph"},
    {"hierarchy", "surface"},
    {"indirect", "base"},
    {"impact", "jobs"},
    {"jobs", "jobs"},
    {"kerf", "jobs"},
    {"material", "mechanics/material"},
    {"mesh", "surface"},
    {"nodes", "sampling"},
    {"parallel", "base"},
    {"peridynamics", "io"},
    {"pieces", "surface"},
    {"potential", "mechanics/terms"},
    {"progress", "base"},
    {"repair", "surface"},
    {"scene", "simulation"},
    {"score", "score"},
    {"simulation", "simulation"},
    {"solid", "mechanics/solver"},
    {"vec", "base"},
    {"vectors", "geometry"},
};

// The paper's main claim is that surface and discretisation do not know each other.
const std::set<std::pair<std::string, std::string>> strangers{{"crack", "graph"}, {"crack", "sampling"}};

// Modules (up to the first slash) whose sources may include a heavy library, and whether their
// private headers may.
struct Door {
  std::set<std::string> modules;
  bool headers = false;
};
const std::map<std::string, Door> doors{
    {"CGAL/", {{"geometry"}}},
    {"gmp", {{"crack"}, true}},
    {"boost/", {{"crack", "geometry"}, true}},
    {"xxhash.h", {{"io"}}},
    {"zlib.h", {{"io"}}},
    {"openvdb/", {{"io"}}},
    {"pcl/", {{"graph", "io"}}},
    {"tbb/", {{"base"}}},
    {"hwy/", {{"base", "geometry", "graph", "mechanics", "contact"}, true}},
    {"toml++/", {{"io"}, true}},
    {"nlohmann/", {{"io"}, true}},
    {"hdf5.h", {{"io"}}},
    {"assimp/", {{"io"}, true}},
    {"CLI/", {}},
    {"embree3/", {}},
    {"png.h", {}},
};

const fs::path libgeo = fs::path(KERF_SOURCE_DIR) / "libgeo";

struct Include {
  std::size_t line;
  std::string name;
};

std::vector<Include> includes_of(const fs::path& file) {
  static const std::regex pattern(R"(^\s*#\s*include\s*[<"]([^>"]+)[>"])");
  std::vector<Include> found;
  std::ifstream in(file);
  std::string line;
  for (std::size_t number = 1; std::getline(in, line); ++number)
    if (std::smatch match; std::regex_search(line, match, pattern)) found.push_back({number, match[1]});
  return found;
}

/// All sources below a folder, sorted; at least one.
std::vector<fs::path> sources_below(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    if (entry.path().extension() == ".h" || entry.path().extension() == ".cpp") files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  REQUIRE_FALSE(files.empty());
  return files;
}

/// The module of a file named relative to libgeo or, for a public header, to its include folder;
/// empty where it is none.
std::string module_of(const std::string& name) {
  if (name.rfind("kerf/", 0) == 0) {
    const auto found = public_headers.find(fs::path(name).stem().string());
    return found == public_headers.end() ? "" : found->second;
  }
  return fs::path(name).parent_path().generic_string();
}

std::string name_in_libgeo(const fs::path& file) {
  const std::string name = fs::relative(file, libgeo).generic_string();
  return name.rfind("include/", 0) == 0 ? name.substr(8) : name;
}

std::size_t rank(const std::string& module) {
  return static_cast<std::size_t>(std::find(modules.begin(), modules.end(), module) - modules.begin());
}

bool is_own(const std::string& include) {
  return fs::exists(libgeo / include) || fs::exists(libgeo / "include" / include);
}

/// A cycle among these nodes as "a -> b -> a"; empty where there is none.
std::string find_cycle(const std::map<std::string, std::set<std::string>>& edges) {
  std::map<std::string, int> state;  // 1: on the path, 2: done
  std::vector<std::string> path;
  std::string cycle;
  const std::function<bool(const std::string&)> visit = [&](const std::string& node) {
    state[node] = 1;
    path.push_back(node);
    if (const auto found = edges.find(node); found != edges.end())
      for (const auto& next : found->second) {
        if (state[next] == 1) {
          for (auto at = std::find(path.begin(), path.end(), next); at != path.end(); ++at) cycle += *at + " -> ";
          cycle += next;
          return true;
        }
        if (state[next] == 0 && visit(next)) return true;
      }
    path.pop_back();
    state[node] = 2;
    return false;
  };
  for (const auto& [node, unused] : edges)
    if (state[node] == 0 && visit(node)) break;
  return cycle;
}

}  // namespace

TEST_CASE("a module includes only those before it", "[architecture]") {
  std::size_t seen = 0;
  for (const auto& file : sources_below(libgeo)) {
    const std::string own = module_of(name_in_libgeo(file));
    for (const auto& include : includes_of(file)) {
      if (!is_own(include.name)) continue;
      ++seen;
      const std::string other = module_of(include.name);
      INFO(file.string() << ":" << include.line << " (" << own << ") includes " << include.name << " (" << other
                         << ")");
      CHECK(rank(other) <= rank(own));
      CHECK(strangers.count({own, other}) == 0);
    }
  }
  CHECK(seen > 1000);
}

TEST_CASE("the library has the modules of the design and no others", "[architecture]") {
  std::set<std::string> found;
  for (const auto& file : sources_below(libgeo)) {
    INFO(file.string());
    const std::string module = module_of(name_in_libgeo(file));
    CHECK(rank(module) < modules.size());
    found.insert(module);
    const std::string stem = file.stem().string();
    for (const std::string vague : {"utils", "util", "common", "helpers", "misc"}) CHECK(stem != vague);
  }
  CHECK(found.size() == modules.size());
  for (const auto& [name, module] : public_headers) {
    INFO(name);
    CHECK(fs::exists(libgeo / "include" / "kerf" / (name + ".h")));
    CHECK(rank(module) < modules.size());
  }
}

TEST_CASE("no include cycle, between files or between modules", "[architecture]") {
  CHECK(find_cycle({{"a", {"b"}}, {"b", {"c"}}, {"c", {"b"}}}) == "b -> c -> b");
  std::map<std::string, std::set<std::string>> files, inner, outer;
  for (const auto& file : sources_below(libgeo)) {
    const std::string name = name_in_libgeo(file), own = module_of(name);
    for (const auto& include : includes_of(file)) {
      if (!is_own(include.name)) continue;
      // A source of several vector targets includes itself, on purpose.
      if (include.name != name) files[name].insert(include.name);
      const std::string other = module_of(include.name);
      if (other != own) inner[own].insert(other);
      const std::string from = own.substr(0, own.find('/')), to = other.substr(0, other.find('/'));
      if (from != to) outer[from].insert(to);
    }
  }
  CHECK(files.size() > 300);
  CHECK(inner.size() > 15);
  CHECK(find_cycle(files) == "");
  CHECK(find_cycle(inner) == "");
  CHECK(find_cycle(outer) == "");
}

TEST_CASE("public headers stand alone", "[architecture]") {
  std::size_t seen = 0;
  for (const auto& file : sources_below(libgeo / "include"))
    for (const auto& include : includes_of(file)) {
      ++seen;
      INFO(file.string() << ":" << include.line << " includes " << include.name);
      const bool open = include.name.rfind("kerf/", 0) == 0 || include.name.rfind("Eigen/", 0) == 0 ||
                        include.name.find_first_of("/.") == std::string::npos;  // a header of the standard library
      CHECK(open);
    }
  CHECK(seen > 100);
}

TEST_CASE("heavy libraries stay behind their doors", "[architecture]") {
  std::size_t seen = 0;
  for (const auto& file : sources_below(libgeo)) {
    const std::string own = module_of(name_in_libgeo(file)), module = own.substr(0, own.find('/'));
    for (const auto& include : includes_of(file))
      for (const auto& [prefix, door] : doors)
        if (include.name.rfind(prefix, 0) == 0) {
          ++seen;
          INFO(file.string() << ":" << include.line << " includes " << include.name);
          CHECK(door.modules.count(module) == 1);
          if (!door.headers) CHECK(file.extension() == ".cpp");
        }
  }
  CHECK(seen > 20);
}

TEST_CASE("sources with SIMD kernels choose the instruction sets before Highway does", "[architecture]") {
  std::size_t seen = 0;
  for (const auto& file : sources_below(libgeo)) {
    const auto includes = includes_of(file);
    const auto at = [&](const std::string& name) {
      return std::find_if(includes.begin(), includes.end(), [&](const Include& i) { return i.name == name; });
    };
    if (at("hwy/foreach_target.h") == includes.end()) continue;
    ++seen;
    INFO(file.string() << " must include base/simd_targets.h before hwy/foreach_target.h");
    CHECK(at("base/simd_targets.h") < at("hwy/foreach_target.h"));
  }
  CHECK(seen > 10);
}

TEST_CASE("the library neither prints nor exits, and only io opens files", "[architecture]") {
  const std::regex prints(R"(std::c(out|err)\b|\bprintf\s*\(|\bf?puts\s*\(|\bstd::exit\b|\bexit\s*\(|\babort\s*\()");
  const std::regex opens(R"(\b(i|o)?fstream\b|\bfopen\s*\()");
  for (const auto& file : sources_below(libgeo)) {
    const bool io = module_of(name_in_libgeo(file)) == "io";
    std::ifstream in(file);
    std::string line;
    for (std::size_t number = 1; std::getline(in, line); ++number) {
      line = line.substr(0, line.find("//"));
      INFO(file.string() << ":" << number << ": " << line);
      if (!io) CHECK_FALSE(std::regex_search(line, opens));
      if (io && file.stem() == "stream") continue;  // standard output is one of its two ends
      CHECK_FALSE(std::regex_search(line, prints));
    }
  }
}
