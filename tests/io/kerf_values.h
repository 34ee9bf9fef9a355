// Arrays like those of a body, and changes like those of a cut; a folder for their files.
#pragma once

#include <catch2/catch.hpp>
#include <filesystem>
#include <functional>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include "base/random.h"
#include "io/kerf_update.h"
#include "io/kerf_writer.h"
#include "kerf/body_file.h"
#include "kerf/files.h"

/// Arrays with rows of fixed and of variable length.
struct Values {
  std::vector<double> position;
  std::vector<std::uint32_t> count, to;
  std::vector<std::uint8_t> mark;
  std::vector<float> none;
  std::vector<geo::KerfArray> arrays() const {
    return {geo::kerf_array("position", std::span<const double>(position), 3),
            geo::kerf_array("count", std::span<const std::uint32_t>(count)),
            geo::kerf_array<std::uint32_t>("to", to.size(), 1,
                                           [this](geo::KerfSink& sink) {
                                             for (const auto x : to) sink.put(x);
                                           }),
            geo::kerf_array("mark", std::span<const std::uint8_t>(mark)),
            geo::kerf_array("none", std::span<const float>(none))};
  }
  std::string bytes() const {
    std::ostringstream out;
    geo::write_kerf(out, arrays());
    return out.str();
  }
};

inline Values random_values(geo::Random& random, std::size_t rows) {
  Values v;
  for (std::size_t i = 0; i < rows; ++i) {
    for (int k = 0; k < 3; ++k) v.position.push_back(random.uniform());
    v.count.push_back(random.below(60));
    for (std::uint32_t k = 0; k < v.count.back(); ++k) v.to.push_back(random.below(static_cast<std::uint32_t>(rows)));
    v.mark.push_back(0);
  }
  return v;
}

/// Changes a few rows, in values and length; appends some.
inline void change(Values& v, geo::Random& random, int changes) {
  while (changes-- > 0) {
    const std::uint32_t row = random.below(static_cast<std::uint32_t>(v.count.size()));
    std::size_t at = 0;
    for (std::uint32_t i = 0; i < row; ++i) at += v.count[i];
    const std::uint32_t count = random.below(60);
    v.to.erase(v.to.begin() + static_cast<std::ptrdiff_t>(at),
               v.to.begin() + static_cast<std::ptrdiff_t>(at + v.count[row]));
    std::vector<std::uint32_t> other(v.count[row] = count);
    for (auto& x : other) x = random.below(1000000);
    v.to.insert(v.to.begin() + static_cast<std::ptrdiff_t>(at), other.begin(), other.end());
    v.position[3 * row + random.below(3)] = random.uniform();
    v.mark[row] = 1;
    if (random.below(3) == 0) {
      v.position.insert(v.position.end(), {1, 2, 3});
      v.count.push_back(1);
      v.to.push_back(row);
      v.mark.push_back(0);
    }
  }
}

class Folder {
 public:
  Folder() : path_(std::filesystem::temp_directory_path() / ("kerf-file-" + std::to_string(std::random_device{}()))) {
    std::filesystem::create_directory(path_);
  }
  ~Folder() { std::filesystem::remove_all(path_); }
  std::string file(const std::string& name, const std::string& bytes = {}) const {
    const std::string path = (path_ / name).string();
    if (!bytes.empty()) geo::write_all(path, [&](std::ostream& out) { out << bytes; });
    return path;
  }

 private:
  std::filesystem::path path_;
};

inline std::uint64_t update(const std::string& path, const Values& v) {
  return geo::UpdatedFile(path).commit(v.arrays());
}

inline std::string refusal(const std::function<void()>& call) {
  try {
    call();
  } catch (const std::runtime_error& e) {
    return e.what();
  }
  return "read";
}
