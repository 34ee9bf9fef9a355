// Names are checked here once, since they become paths below the data set's folder.
#include "dataset/models.h"

#include <algorithm>
#include <filesystem>
#include <map>
#include <sstream>

#include <kerf/error.h>
#include <kerf/files.h>

namespace dataset {
namespace {

namespace fs = std::filesystem;

// Throws InputError for a name that leaves the data set's folder, or that a file cannot have.
void check_name(const std::string& name, const std::string& where) {
  const auto bad = [&](const std::string& why) {
    throw geo::InputError(where + ": the model's name '" + name + "' " + why +
                          "; give it another in a list: NAME, a tab, PATH");
  };
  if (name.empty()) bad("is empty");
  if (name.size() > 200) bad("has more than 200 bytes");
  for (const char c : name)
    if (static_cast<unsigned char>(c) < 0x20 || c == '\\' || c == '\x7f') bad("has a character that is not allowed");
  std::string part;
  for (std::istringstream parts(name + '/'); std::getline(parts, part, '/');)
    if (part.empty() || part == "." || part == ".." || part.starts_with("fractured_"))
      bad("is no path below a folder, or a fracture's");
  if (name.back() == '/') bad("is no path below a folder");
}

void read_list(const std::string& list, std::vector<ModelFile>& models) {
  std::istringstream lines(geo::read_all(list));
  const fs::path folder = fs::path(list).parent_path();
  std::string line;
  for (std::size_t number = 1; std::getline(lines, line); ++number) {
    if (!line.empty() && line.back() == '\r') line.pop_back();
    const std::string where = list + ":" + std::to_string(number);
    if (line.find('\0') != line.npos) throw geo::InputError(where + ": is no text; give a list of paths");
    const auto begin = line.find_first_not_of(" \t");
    if (begin == line.npos || line[begin] == '#') continue;
    const auto tab = line.find('\t', begin);
    const fs::path path = tab == line.npos ? line.substr(begin) : line.substr(tab + 1);
    if (path.empty()) throw geo::InputError(where + ": has no path behind the tab");
    models.push_back({tab == line.npos ? path.stem().string() : line.substr(begin, tab - begin),
                      path.is_absolute() ? path.string() : (folder / path).string()});
    check_name(models.back().name, where);
  }
}

}  // namespace

std::vector<ModelFile> list_models(const std::vector<std::string>& arguments) {
  std::vector<ModelFile> models;
  for (const auto& argument : arguments) {
    if (argument == "-") throw geo::InputError("-: a model of a data set needs a name; give a file");
    if (argument.ends_with(".txt")) {
      read_list(argument, models);
      continue;
    }
    models.push_back({fs::path(argument).stem().string(), argument});
    check_name(models.back().name, argument);
  }
  std::map<std::string, std::string> path_of;
  for (const auto& [name, path] : models) {
    if (std::error_code error; !fs::exists(path, error))
      throw geo::MissingInputError(path + ": cannot be opened (" +
                                   (error ? error.message() : "No such file or directory") + "); check the name");
    const auto [known, fresh] = path_of.try_emplace(name, path);
    if (!fresh)
      throw geo::InputError(path + ": two models are called '" + name + "', the other is " + known->second +
                            "; give them names in a list: NAME, a tab, PATH");
  }
  return models;
}

}  // namespace dataset
