#pragma once
// Reading the JSON of a glTF file with every access checked.

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

#include "tafoni/math/vec.h"

namespace tafoni::io::impl {

using Json = nlohmann::json;

/// A view of one accessor's elements, checked to lie inside the binary chunk.
struct GltfAccessor {
  std::span<const std::byte> bytes;  ///< from the first element on
  std::uint64_t count = 0;
  std::uint64_t stride = 0;
  int component = 0;   ///< GL type: 5121, 5123, 5125, 5126 …
  int components = 0;  ///< of an element
  bool normalized = false;

  std::uint32_t index(std::uint64_t i) const;
  /// Component k of element i; normalised integers come as numbers in [0, 1] or [-1, 1].
  double value(std::uint64_t i, int k) const;
};

/// A 4x4 matrix, column-major as glTF has it.
using Matrix = std::array<double, 16>;
Matrix multiply(const Matrix& a, const Matrix& b);

/// A parsed glTF document over its binary chunk.
class GltfDocument {
 public:
  GltfDocument(Json json, std::span<const std::byte> binary, std::string_view file)
      : json_(std::move(json)), binary_(binary), file_(file) {}

  /// The object json[key][index].
  const Json& at(const char* key, std::uint64_t index) const;
  std::uint64_t size(const char* key) const;
  /// A whole number that is not negative, or `init` when the key is absent.
  std::uint64_t whole(const Json& object, const char* key, std::uint64_t init) const;
  GltfAccessor accessor(std::uint64_t index) const;
  /// A node's own transform.
  Matrix transform(const Json& node) const;
  /// The nodes that stand at the top of the default scene.
  std::vector<std::uint64_t> roots() const;
  /// The indices that object[key] lists; none when it is absent.
  std::vector<std::uint64_t> indices(const Json& object, const char* key) const;
  const Json& json() const { return json_; }
  [[noreturn]] void fail_read(std::string_view what) const;

 private:
  void numbers(const Json& object, const char* key, std::span<double> out) const;

  Json json_;
  std::span<const std::byte> binary_;
  std::string_view file_;
};

}  // namespace tafoni::io::impl
