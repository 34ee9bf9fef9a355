// The order of the rooms, read from the includes: a room may include only what is above it (docs/design.md).
#include <algorithm>
#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <string>
#include <vector>

namespace fs = std::filesystem;

namespace {

const std::vector<std::string> rooms{"base",  "geometry", "surface",   "sampling", "graph",      "crack",
                                     "score", "body",     "mechanics", "contact",  "simulation", "io"};
// The paper's main claim is that surface and discretisation do not know each other.
const std::set<std::pair<std::string, std::string>> strangers{{"crack", "graph"}, {"crack", "sampling"}};
// Heavy libraries have one door each: the rooms whose sources may include them. No public header may.
const std::map<std::string, std::set<std::string>> doors{
    {"CGAL/", {"geometry"}}, {"gmp", {"crack"}},
    {"openvdb/", {"io"}},    {"pcl/", {"graph", "io"}},
    {"tbb/", {"base"}},      {"hwy/", {"geometry", "graph", "mechanics", "contact"}},
    {"toml++/", {"io"}},     {"nlohmann/", {"io"}},
    {"hdf5.h", {"io"}},      {"CLI/", {}},
    {"embree3/", {}},        {"png.h", {}}};

struct Include {
  fs::path file;
  std::size_t line;
  std::string name;
};

std::vector<Include> includes_of(const fs::path& file) {
  static const std::regex pattern(R"(^\s*#\s*include\s*[<"]([^>"]+)[>"])");
  std::vector<Include> found;
  std::ifstream in(file);
  std::string line;
  for (std::size_t number = 1; std::getline(in, line); ++number)
    if (std::smatch match; std::regex_search(line, match, pattern)) found.push_back({file, number, match[1]});
  return found;
}

std::vector<fs::path> sources_of(const fs::path& folder) {
  std::vector<fs::path> files;
  if (!fs::is_directory(folder)) return files;  // a room of the design with nothing in it yet
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    if (entry.path().extension() == ".h" || entry.path().extension() == ".cpp") files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

std::size_t rank(const std::string& room) {
  return static_cast<std::size_t>(std::find(rooms.begin(), rooms.end(), room) - rooms.begin());
}

const fs::path libgeo = fs::path(KERF_SOURCE_DIR) / "libgeo";

}  // namespace

TEST_CASE("a room includes only what is above it", "[architecture]") {
  std::size_t seen = 0;
  for (const auto& room : rooms)
    for (const auto& file : sources_of(libgeo / room))
      for (const auto& include : includes_of(file)) {
        const auto slash = include.name.find('/');
        const std::string other = include.name.substr(0, slash);
        if (slash == std::string::npos || rank(other) == rooms.size()) continue;
        ++seen;
        INFO(file.string() << ":" << include.line << " includes " << include.name);
        CHECK(rank(other) <= rank(room));
        CHECK(strangers.count({room, other}) == 0);
      }
  CHECK(seen > 100);
}

TEST_CASE("the library has the rooms of the design and no others", "[architecture]") {
  for (const auto& entry : fs::directory_iterator(libgeo))
    if (entry.is_directory()) {
      INFO(entry.path().string());
      CHECK(rank(entry.path().filename().string()) < rooms.size());
    }
  for (const auto& file : sources_of(libgeo)) {
    INFO(file.string());
    const std::string stem = file.stem().string();
    CHECK(stem != "utils");
    CHECK(stem != "common");
    CHECK(stem != "helpers");
  }
}

TEST_CASE("heavy libraries stay behind their doors", "[architecture]") {
  for (const auto& room : rooms)
    for (const auto& file : sources_of(libgeo / room))
      for (const auto& include : includes_of(file))
        for (const auto& [prefix, allowed] : doors)
          if (include.name.rfind(prefix, 0) == 0) {
            INFO(file.string() << ":" << include.line << " includes " << include.name);
            CHECK(allowed.count(room) == 1);
          }
}

TEST_CASE("public headers stand alone", "[architecture]") {
  std::size_t seen = 0;
  for (const auto& file : sources_of(libgeo / "include"))
    for (const auto& include : includes_of(file)) {
      ++seen;
      INFO(file.string() << ":" << include.line << " includes " << include.name);
      for (const auto& [prefix, allowed] : doors) CHECK(include.name.rfind(prefix, 0) != 0);
    }
  CHECK(seen > 50);
}

TEST_CASE("the library neither prints nor exits, and only io opens files", "[architecture]") {
  const std::regex prints(R"(std::c(out|err)\b|\bprintf\s*\(|\bf?puts\s*\(|\bstd::exit\b|\bexit\s*\(|\babort\s*\()");
  const std::regex opens(R"(\b(i|o)?fstream\b|\bfopen\s*\()");
  for (const auto& room : rooms)
    for (const auto& file : sources_of(libgeo / room)) {
      std::ifstream in(file);
      std::string line;
      for (std::size_t number = 1; std::getline(in, line); ++number) {
        line = line.substr(0, line.find("//"));
        INFO(file.string() << ":" << number << ": " << line);
        if (room != "io") CHECK_FALSE(std::regex_search(line, opens));
        if (room == "io" && file.stem() == "stream") continue;  // standard output is one of its two ends
        CHECK_FALSE(std::regex_search(line, prints));
      }
    }
}
