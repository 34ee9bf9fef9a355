// The JSON and the buffer of a binary glTF 2.0 file.
#pragma once

#include <array>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <ostream>
#include <string>
#include <vector>

namespace geo {

/// A .glb in the making. Members return indices into the file's lists. Numbers of the
/// specification: targets 34962 (vertices) and 34963 (indices); types 5123 (16 bits), 5125 (32
/// bits), 5126 (floats).
class GlbFile {
 public:
  using Json = nlohmann::ordered_json;
  Json json = {{"asset", {{"version", "2.0"}, {"generator", "kerf-pieces"}}},
               {"scene", 0},
               {"scenes", Json::array()},
               {"nodes", Json::array()},
               {"meshes", Json::array()},
               {"materials", Json::array()},
               {"accessors", Json::array()},
               {"bufferViews", Json::array()}};

  /// Adds an accessor of vertices: `count` rows of `type` ("VEC3" …) of numbers of `component`.
  template <class T>
  std::size_t accessor(const std::vector<T>& values, int component, const char* type, std::size_t count) {
    json["accessors"].push_back({{"bufferView", view(values.data(), values.size() * sizeof(T), 34962)},
                                 {"componentType", component},
                                 {"count", count},
                                 {"type", type}});
    return json["accessors"].size() - 1;
  }
  /// Adds an accessor of positions, with their box. Precondition: there are some.
  std::size_t positions(const std::vector<float>& values);
  /// Adds an accessor of indices.
  std::size_t indices(const std::vector<std::uint32_t>& values);
  /// Adds bytes of an image as a buffer view.
  std::size_t bytes(const std::string& content);
  /// Adds a node.
  std::size_t node(Json description);
  /// Adds a mesh.
  std::size_t mesh(Json primitives, const std::string& name);
  /// Writes header, JSON and buffer. Throws OutputError where they do not fit into 4 GB.
  void write(std::ostream& out);

 private:
  std::size_t view(const void* values, std::size_t bytes, int target);
  std::string bytes_;
};

}  // namespace geo
