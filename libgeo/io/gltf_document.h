// A glTF 2.0 file, binary or text, that is read: its JSON, its buffers, and the numbers of its
// accessors.
#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace geo {

/// Rows of numbers of an accessor: integers that are normalised are fractions, matrices have
/// columns one after another.
struct GltfRows {
  std::vector<double> values;
  std::size_t width = 0;  ///< numbers in a row
  std::size_t count = 0;  ///< rows
  /// The numbers of a row.
  const double* row(std::size_t i) const { return values.data() + i * width; }
};

/// A document in memory. Members throw InputError for descriptions that the specification forbids.
class GltfDocument {
 public:
  using Json = nlohmann::json;

  /// Parses a .glb or .gltf. `bytes` must outlive the document; files that it names are looked for
  /// in the folder of `name` and below. Throws InputError: damaged, another version, or an
  /// extension that is required and not known here, which the message names.
  GltfDocument(const std::string& bytes, const std::string& name);

  /// Throws InputError with the file's name first.
  [[noreturn]] void fail(const std::string& what) const;
  /// The whole JSON.
  const Json& json() const { return json_; }
  /// Extensions that the file uses, does not require, and that are not known here.
  const std::vector<std::string>& unknown_extensions() const { return unknown_; }

  /// The member of an object; null where there is none.
  static const Json& member(const Json& object, const char* key);
  /// The description of an extension of an object; null where it has none.
  static const Json& extension(const Json& object, const char* name);
  /// The number of entries of a list of the file, as "nodes".
  std::size_t count(const char* list) const;
  /// An entry of such a list. Throws InputError where there is none.
  const Json& entry(const char* list, std::size_t index) const;
  /// The index that a member of an object holds; empty where it has none. Throws InputError for
  /// anything but an index.
  std::optional<std::size_t> index(const Json& object, const char* key) const;
  /// As index(), or `fallback` where there is none.
  std::size_t size(const Json& object, const char* key, std::size_t fallback) const;
  /// The indices of a list; empty where there is none.
  std::vector<std::size_t> indices(const Json& object, const char* key) const;
  /// The numbers of a list of `count` of them; empty where there is none.
  std::vector<double> numbers(const Json& object, const char* key, std::size_t count) const;
  /// A text; empty where there is none.
  static std::string text(const Json& object, const char* key);

  /// The numbers of an accessor, sparse ones replaced. They are kept for further calls. Throws
  /// InputError where it exceeds its buffer or has an unknown type.
  const GltfRows& rows(std::size_t accessor);
  /// The bytes of a buffer view.
  std::string_view view(std::size_t buffer_view);
  /// The bytes that a `data:` URI holds, or that a file beside this one has. Throws InputError.
  std::string at_uri(const std::string& uri) const;

 private:
  void read_container(const std::string& bytes);
  void check_extensions();
  std::string_view buffer(std::size_t index);
  GltfRows read_rows(std::size_t accessor);
  void replace_sparse(const Json& sparse, const Json& accessor, GltfRows& rows);
  void decode(std::string_view from, std::size_t stride, const Json& accessor, GltfRows& rows) const;

  std::string name_;
  std::size_t file_size_ = 0;
  Json json_;
  std::string_view binary_;  // chunk of a .glb
  bool has_binary_ = false;
  std::vector<std::string> unknown_;
  std::map<std::size_t, std::string> buffers_;  // those read from URIs
  std::map<std::size_t, GltfRows> rows_;
};

}  // namespace geo
