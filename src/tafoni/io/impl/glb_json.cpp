// Reading the JSON of a glTF file: each key, index and accessor is checked to exist, to be of its kind
// and to lie inside of the binary chunk before it is used.

#include "tafoni/io/impl/glb_json.h"

#include <cmath>

#include "tafoni/core/error.h"
#include "tafoni/io/impl/reading.h"

namespace tafoni::io::impl {
namespace {

constexpr Matrix identity = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};

int component_bytes(int type) {
  switch (type) {
    case 5120:
    case 5121:
      return 1;
    case 5122:
    case 5123:
      return 2;
    case 5125:
    case 5126:
      return 4;
    default:
      return 0;
  }
}

int components_of(std::string_view type) {
  if (type == "SCALAR") return 1;
  if (type == "VEC2") return 2;
  if (type == "VEC3") return 3;
  return type == "VEC4" ? 4 : 0;
}

std::string text_of(const Json& object, const char* key) {
  const auto found = object.find(key);
  return found != object.end() && found->is_string() ? found->get<std::string>() : std::string();
}

}  // namespace

std::uint32_t GltfAccessor::index(std::uint64_t i) const {
  const std::size_t at = i * stride;
  switch (component) {
    case 5121:
      return load<std::uint8_t>(bytes, at);
    case 5123:
      return load<std::uint16_t>(bytes, at);
    default:
      return load<std::uint32_t>(bytes, at);
  }
}

double GltfAccessor::value(std::uint64_t i, int k) const {
  const std::size_t at = i * stride + k * component_bytes(component);
  const auto scaled = [&](double v, double greatest) {
    return normalized ? std::max(v / greatest, -1.0) : v;
  };
  switch (component) {
    case 5120:
      return scaled(load<std::int8_t>(bytes, at), 127);
    case 5121:
      return scaled(load<std::uint8_t>(bytes, at), 255);
    case 5122:
      return scaled(load<std::int16_t>(bytes, at), 32767);
    case 5123:
      return scaled(load<std::uint16_t>(bytes, at), 65535);
    case 5125:
      return scaled(load<std::uint32_t>(bytes, at), 4294967295.0);
    default:
      return load<float>(bytes, at);
  }
}

Matrix multiply(const Matrix& a, const Matrix& b) {
  Matrix c{};
  for (std::size_t column = 0; column < 4; ++column)
    for (std::size_t row = 0; row < 4; ++row)
      for (std::size_t k = 0; k < 4; ++k) c[column * 4 + row] += a[k * 4 + row] * b[column * 4 + k];
  return c;
}

void GltfDocument::fail_read(std::string_view what) const {
  fail(ErrorKind::input, "{}: {}; the glTF is damaged or uses what is not supported.", file_, what);
}

std::uint64_t GltfDocument::size(const char* key) const {
  const auto list = json_.find(key);
  return list != json_.end() && list->is_array() ? list->size() : 0;
}

const Json& GltfDocument::at(const char* key, std::uint64_t index) const {
  if (index >= size(key) || !json_[key][index].is_object())
    fail_read(fmt::format("'{}' has no entry {}", key, index));
  return json_[key][index];
}

std::uint64_t GltfDocument::whole(const Json& object, const char* key, std::uint64_t init) const {
  const auto found = object.find(key);
  if (found == object.end()) return init;
  if (!found->is_number_unsigned()) fail_read(fmt::format("'{}' is not a whole number", key));
  return found->get<std::uint64_t>();
}

void GltfDocument::numbers(const Json& object, const char* key, std::span<double> out) const {
  const auto found = object.find(key);
  if (found == object.end()) return;
  if (!found->is_array() || found->size() != out.size())
    fail_read(fmt::format("'{}' is not {} numbers", key, out.size()));
  for (std::size_t i = 0; i < out.size(); ++i) {
    if (!(*found)[i].is_number()) fail_read(fmt::format("'{}' is not {} numbers", key, out.size()));
    out[i] = (*found)[i].get<double>();
  }
}

std::vector<std::uint64_t> GltfDocument::indices(const Json& object, const char* key) const {
  std::vector<std::uint64_t> result;
  const auto found = object.find(key);
  if (found == object.end()) return result;
  if (!found->is_array()) fail_read(fmt::format("'{}' is not a list", key));
  for (const Json& entry : *found) {
    if (!entry.is_number_unsigned()) fail_read(fmt::format("'{}' holds what is not an index", key));
    result.push_back(entry.get<std::uint64_t>());
  }
  return result;
}

GltfAccessor GltfDocument::accessor(std::uint64_t index) const {
  const Json& declared = at("accessors", index);
  if (declared.contains("sparse") || !declared.contains("bufferView"))
    fail_read("an accessor is sparse or has no data");
  const Json& view = at("bufferViews", whole(declared, "bufferView", 0));
  if (whole(view, "buffer", 0) != 0 || at("buffers", 0).contains("uri"))
    fail_read("its data is in another file, and only GLB with one buffer is read");
  GltfAccessor a;
  a.component = static_cast<int>(whole(declared, "componentType", 0) & 0xffff);
  a.components = components_of(text_of(declared, "type"));
  a.count = whole(declared, "count", 0);
  const auto flag = declared.find("normalized");
  a.normalized = flag != declared.end() && flag->is_boolean() && flag->get<bool>();
  const std::uint64_t element = component_bytes(a.component) * a.components;
  a.stride = whole(view, "byteStride", element);
  const std::uint64_t view_at = whole(view, "byteOffset", 0), view_bytes = whole(view, "byteLength", 0);
  const std::uint64_t offset = whole(declared, "byteOffset", 0);
  const bool sound = element > 0 && a.count > 0 && a.stride >= element && a.stride <= 4096 &&
                     view_at <= binary_.size() && view_bytes <= binary_.size() - view_at &&
                     offset <= view_bytes && view_bytes - offset >= element &&
                     a.count - 1 <= (view_bytes - offset - element) / a.stride;
  if (!sound) fail_read(fmt::format("accessor {} does not fit in its data", index));
  a.bytes = binary_.subspan(view_at + offset, view_bytes - offset);
  return a;
}

Matrix GltfDocument::transform(const Json& node) const {
  Matrix m = identity;
  numbers(node, "matrix", m);
  if (node.contains("matrix")) return m;
  double t[3] = {0, 0, 0}, q[4] = {0, 0, 0, 1}, s[3] = {1, 1, 1};
  numbers(node, "translation", t);
  numbers(node, "rotation", q);
  numbers(node, "scale", s);
  const double x = q[0], y = q[1], z = q[2], w = q[3];
  return {(1 - 2 * (y * y + z * z)) * s[0],
          2 * (x * y + z * w) * s[0],
          2 * (x * z - y * w) * s[0],
          0,
          2 * (x * y - z * w) * s[1],
          (1 - 2 * (x * x + z * z)) * s[1],
          2 * (y * z + x * w) * s[1],
          0,
          2 * (x * z + y * w) * s[2],
          2 * (y * z - x * w) * s[2],
          (1 - 2 * (x * x + y * y)) * s[2],
          0,
          t[0],
          t[1],
          t[2],
          1};
}

std::vector<std::uint64_t> GltfDocument::roots() const {
  if (size("scenes") > 0) return indices(at("scenes", whole(json_, "scene", 0)), "nodes");
  std::vector<std::uint64_t> all(size("nodes"));
  for (std::size_t i = 0; i < all.size(); ++i) all[i] = i;
  return all;
}

}  // namespace tafoni::io::impl
