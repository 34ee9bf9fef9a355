// Fronts of kerf/files.h. Text, line by line: `front NAME`, then `step T` and a
// point a line; or `sheet NAME` with points and triangles. OBJ: each object with a polyline is a
// time step.
#include "kerf/files.h"

#include <algorithm>
#include <map>

#include "io/line_reader.h"

namespace geo {
namespace {

void check(const Front& front, const std::string& name, std::size_t least_steps) {
  const bool sheet = front.is_sheet();
  const std::string who = name + (sheet ? ": sheet '" : ": front '") + shown(front.name) + "' ";
  if (front.steps.size() < least_steps && !sheet)
    throw InputError(who + "has one time step only; it needs at least two to sweep anything (a sheet, triangles)");
  for (std::size_t s = 0; s < front.steps.size(); ++s) {
    for (const Vec3& p : front.steps[s])
      if (!in_range(p))
        throw InputError(who + "has a coordinate of no sensible size" + (sheet ? "" : " in step " + std::to_string(s)) +
                         "; repair the file");
    if (front.steps[s].size() < (front.closed ? 3u : 2u))
      throw InputError(who + "has " + std::to_string(front.steps[s].size()) + " point(s) in step " + std::to_string(s) +
                       "; it needs at least " + (front.closed ? "three" : "two"));
  }
}

// OBJ polylines: each object is a time step, in the order of its name.
std::vector<Front> from_obj(const std::string& bytes, const std::string& name, std::size_t least_steps) {
  LineReader lines(bytes, name);
  std::vector<std::string_view> words;
  std::vector<Vec3> points;
  std::map<std::string, std::vector<long long>> objects;
  std::string object = "step";
  while (lines.next(words)) {
    if (words[0] == "v") {
      if (words.size() < 4) lines.fail("a vertex needs three coordinates");
      points.push_back({lines.real(words[1]), lines.real(words[2]), lines.real(words[3])});
    } else if ((words[0] == "o" || words[0] == "g") && words.size() > 1) {
      object = std::string(words[1]);
    } else if (words[0] == "l") {
      auto& line = objects[object];
      for (std::size_t k = 1; k < words.size(); ++k) {
        auto i = lines.integer(words[k].substr(0, words[k].find('/')));
        if (i < 0) i += static_cast<long long>(points.size()) + 1;
        if (i < 1 || i > static_cast<long long>(points.size())) lines.fail("a line names a vertex that is not there");
        if (line.empty() || line.back() != i) line.push_back(i);
      }
    }
  }
  Front front;
  front.name = "obj";
  front.closed = !objects.empty() && std::all_of(objects.begin(), objects.end(), [](const auto& o) {
    return o.second.size() > 3 && o.second.front() == o.second.back();
  });
  for (auto& [key, line] : objects) {
    if (front.closed) line.pop_back();
    front.steps.emplace_back();
    for (const auto i : line) front.steps.back().push_back(points[static_cast<std::size_t>(i - 1)]);
  }
  check(front, name, least_steps);
  return {front};
}

std::vector<Front> parse(const std::string& bytes, const std::string& name, std::size_t least_steps) {
  LineReader lines(bytes, name);
  std::vector<std::string_view> words;
  std::vector<Front> fronts;
  bool sheet = false;  // whether the current entry is one
  const auto point = [&](std::size_t first) {
    if (words.size() != first + 3) lines.fail("a point is three numbers");
    return Vec3(lines.real(words[first]), lines.real(words[first + 1]), lines.real(words[first + 2]));
  };
  while (lines.next(words)) {
    if (words[0] == "front") {
      if (words.size() < 2 || words.size() > 3 || (words.size() == 3 && words[2] != "closed"))
        lines.fail("write 'front NAME' or 'front NAME closed'");
      fronts.push_back({.name = std::string(words[1]), .closed = words.size() == 3, .steps = {}, .triangles = {}});
      sheet = false;
    } else if (words[0] == "sheet") {
      if (words.size() != 2) lines.fail("write 'sheet NAME'");
      fronts.push_back({.name = std::string(words[1]), .closed = false, .steps = {{}}, .triangles = {}});
      sheet = true;
    } else if (fronts.empty()) {
      if (words[0] == "v" || words[0] == "o" || words[0] == "l" || words[0] == "g" || words[0] == "mtllib")
        return from_obj(bytes, name, least_steps);
      lines.fail("begins with '" + shown(words[0]) + "'; a front file begins with 'front NAME' or 'sheet NAME'");
    } else if (sheet && words[0] == "v") {
      fronts.back().steps[0].push_back(point(1));
    } else if (sheet) {
      if (words.size() != 4 || words[0] != "f") lines.fail("a sheet has points 'v x y z' and triangles 'f a b c'");
      Triangle t;
      for (std::size_t k = 0; k < 3; ++k) {
        const auto row = lines.integer(words[k + 1]);
        if (row < 1 || row > static_cast<long long>(fronts.back().steps[0].size()))
          lines.fail("a triangle names a point that is not there; points are numbered from 1 and stand before");
        t[k] = static_cast<std::uint32_t>(row - 1);
      }
      fronts.back().triangles.push_back(t);
    } else if (words[0] == "step") {
      if (words.size() != 2) lines.fail("write 'step T'");
      lines.real(words[1]);
      fronts.back().steps.emplace_back();
    } else {
      if (fronts.back().steps.empty()) lines.fail("a point stands before the first 'step'");
      fronts.back().steps.back().push_back(point(0));
    }
  }
  if (fronts.empty()) throw InputError(name + ": holds no front; write 'front NAME'");
  for (const auto& f : fronts) check(f, name, least_steps);
  return fronts;
}

}  // namespace

std::vector<Front> read_fronts(const std::string& path) { return parse_fronts(read_all(path), path); }
std::vector<Front> parse_fronts(const std::string& bytes, const std::string& name) { return parse(bytes, name, 2); }
std::vector<Front> read_curves(const std::string& path) { return parse(read_all(path), path, 1); }

void write_fronts(std::ostream& out, const std::vector<Front>& fronts) {
  out.precision(17);
  for (const auto& f : fronts) {
    if (f.is_sheet()) {
      out << "sheet " << f.name << '\n';
      for (const auto& p : f.steps[0]) out << "v " << p.x() << ' ' << p.y() << ' ' << p.z() << '\n';
      for (const auto& t : f.triangles) out << "f " << t[0] + 1 << ' ' << t[1] + 1 << ' ' << t[2] + 1 << '\n';
      continue;
    }
    out << "front " << f.name << (f.closed ? " closed" : "") << '\n';
    for (std::size_t s = 0; s < f.steps.size(); ++s) {
      out << "step " << s << '\n';
      for (const auto& p : f.steps[s]) out << p.x() << ' ' << p.y() << ' ' << p.z() << '\n';
    }
  }
}

}  // namespace geo
