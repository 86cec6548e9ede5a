// glTF 2.0 binary: one mesh in a node whose extras hold what glTF has no place for, y up. The reader
// gathers the triangles of every node of the default scene; what it does not know it refuses by a
// sentence.

#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "tafoni/io/format.h"
#include "tafoni/io/impl/glb_json.h"
#include "tafoni/io/impl/json_text.h"
#include "tafoni/io/impl/placing.h"
#include "tafoni/io/impl/reading.h"
#include "tafoni/io/impl/seams.h"
#include "tafoni/io/impl/writing.h"
#include "tafoni/io/mesh_file.h"

namespace tafoni::io::format_glb {
namespace {

using impl::GltfAccessor;
using impl::GltfDocument;
using impl::Json;
using impl::Matrix;

constexpr std::uint32_t glb_magic = 0x46546c67, json_chunk = 0x4e4f534a, binary_chunk = 0x004e4942;
constexpr int gl_ubyte = 5121, gl_ushort = 5123, gl_uint = 5125, gl_float = 5126, gl_array = 34962,
              gl_elements = 34963;

/// Pictures begin at their upper edge in glTF.
constexpr Vec2<float> v_down(Vec2<float> p) {
  return {p.x, 1.0f - p.y};
}

Json to_json(const Value& value) {
  return std::visit([](const auto& v) { return Json(v); }, value);
}

/// The parts of the binary chunk, one after the other; each is a multiple of four bytes.
class Layout {
 public:
  explicit Layout(Json& json) : json_(json) {}
  /// Adds a buffer view with one accessor; returns the accessor's index.
  int add(std::uint64_t bytes, int target, Json accessor) {
    accessor["bufferView"] = static_cast<int>(json_["bufferViews"].size());
    json_["bufferViews"].push_back(
        {{"buffer", 0}, {"byteOffset", size_}, {"byteLength", bytes}, {"target", target}});
    json_["accessors"].push_back(std::move(accessor));
    size_ += bytes;
    return static_cast<int>(json_["accessors"].size()) - 1;
  }
  std::uint64_t size() const { return size_; }

 private:
  Json& json_;
  std::uint64_t size_ = 0;
};

Json position_accessor(const mesh::Mesh& mesh, std::uint64_t vertices) {
  Box3f box;
  for (const Vec3f p : mesh.positions) box.expand(impl::y_up(p));
  return {{"componentType", gl_float},
          {"type", "VEC3"},
          {"count", vertices},
          {"min", {box.lo.x, box.lo.y, box.lo.z}},
          {"max", {box.hi.x, box.hi.y, box.hi.z}}};
}

Json extras_of(const mesh::Mesh& mesh, const MeshMetadata& metadata) {
  Json extras = {{"world_origin", {mesh.origin.x, mesh.origin.y, mesh.origin.z}},
                 {"world_axes", "x east, y up, z south; metres"}};
  if (!metadata.crs.empty()) extras["crs"] = metadata.crs;
  for (const auto& [name, value] : metadata.generator) extras["generator"][name] = to_json(value);
  return extras;
}

Json document_of(const mesh::Mesh& mesh, std::uint64_t vertices, const MeshOutput& output) {
  const MeshMetadata& metadata = output.metadata;
  const MeshForm& form = output.form;
  // Some programs keep the asset's extras alone, others the nodes' alone.
  const Json extras = extras_of(mesh, metadata);
  Json json = {{"asset", {{"version", "2.0"}, {"generator", "tafoni"}, {"extras", extras}}}};
  Layout layout(json);
  Json attributes;
  attributes["POSITION"] = layout.add(vertices * 12, gl_array, position_accessor(mesh, vertices));
  if (!mesh.normals.empty())
    attributes["NORMAL"] = layout.add(vertices * 12, gl_array,
                                      {{"componentType", gl_float}, {"type", "VEC3"}, {"count", vertices}});
  if (!mesh.colors.empty() && form.float_colors)
    attributes["COLOR_0"] = layout.add(vertices * 12, gl_array,
                                       {{"componentType", gl_float}, {"type", "VEC3"}, {"count", vertices}});
  else if (!mesh.colors.empty())
    attributes["COLOR_0"] = layout.add(
        vertices * 4, gl_array,
        {{"componentType", gl_ubyte}, {"normalized", true}, {"type", "VEC4"}, {"count", vertices}});
  if (!mesh.texture.empty())
    attributes["TEXCOORD_0"] = layout.add(
        vertices * 8, gl_array, {{"componentType", gl_float}, {"type", "VEC2"}, {"count", vertices}});
  const int indices =
      layout.add(mesh.triangles.size() * 12, gl_elements,
                 {{"componentType", gl_uint}, {"type", "SCALAR"}, {"count", mesh.triangles.size() * 3}});
  json["buffers"] = Json::array({{{"byteLength", layout.size()}}});
  json["materials"] = Json::array(
      {{{"name", metadata.name + "_rock"},  // Godot shares materials of one name between scenes
        {"doubleSided", true},
        {"pbrMetallicRoughness",
         {{"baseColorFactor", mesh.colors.empty() ? Json{0.28, 0.25, 0.21, 1.0} : Json{1.0, 1.0, 1.0, 1.0}},
          {"metallicFactor", 0.0},
          {"roughnessFactor", 0.95}}}}});
  json["meshes"] = Json::array(
      {{{"name", metadata.name},
        {"primitives",
         Json::array({{{"attributes", attributes}, {"indices", indices}, {"material", 0}, {"mode", 4}}})}}});
  json["nodes"] = Json::array({{{"name", metadata.name}, {"mesh", 0}, {"extras", extras}}});
  json["scenes"] = Json::array({{{"name", metadata.name}, {"nodes", {0}}}});
  json["scene"] = 0;
  return json;
}

void put_color(std::string& block, const std::array<std::uint8_t, 4>& color, bool as_floats) {
  if (!as_floats) return impl::put(block, color);
  for (std::size_t k = 0; k < 3; ++k) impl::put(block, static_cast<float>(color[k]) / 255);
}

void write(AtomicFile& out, const mesh::Mesh& mesh, const MeshOutput& output, Progress& progress) {
  // A vertex has one pair of texture coordinates here, so that those on seams stand there several times.
  const impl::Seams seams(mesh);
  const bool textured = !mesh.texture.empty();
  const std::uint64_t vertices = textured ? seams.pairs.size() : mesh.positions.size();
  const auto vertex = [&](std::size_t i) { return textured ? seams.vertex[i] : i; };
  const Json json = document_of(mesh, vertices, output);
  std::string text = impl::json_text(json);
  text.resize((text.size() + 3) / 4 * 4, ' ');
  const std::uint64_t binary = json["buffers"][0]["byteLength"];
  const std::uint64_t total = 12 + 8 + text.size() + 8 + binary;
  if (total > 0xffffffffull)
    fail(ErrorKind::output,
         "A GLB file holds at most 4 GiB and this mesh takes {:.1f} GiB; write PLY, tiles or a simplified "
         "mesh.",
         static_cast<double>(total) / (1u << 30));

  std::string header;
  for (const std::uint64_t word : {std::uint64_t{glb_magic}, std::uint64_t{2}, total,
                                   std::uint64_t{text.size()}, std::uint64_t{json_chunk}})
    impl::put(header, static_cast<std::uint32_t>(word));
  header += text;
  impl::put(header, static_cast<std::uint32_t>(binary));
  impl::put(header, binary_chunk);
  out.write(header);
  impl::write_items(out, vertices, progress, [&](std::string& block, std::size_t i) {
    impl::put(block, impl::y_up(mesh.positions[vertex(i)]));
  });
  if (!mesh.normals.empty())
    impl::write_items(out, vertices, silent(), [&](std::string& block, std::size_t i) {
      impl::put(block, impl::y_up(mesh.normals[vertex(i)]));
    });
  if (!mesh.colors.empty())
    impl::write_items(out, vertices, silent(), [&](std::string& block, std::size_t i) {
      put_color(block, mesh.colors[vertex(i)], output.form.float_colors);
    });
  impl::write_items(out, seams.pairs.size(), silent(),
                    [&](std::string& block, std::size_t i) { impl::put(block, v_down(seams.pairs[i])); });
  impl::write_items(out, mesh.triangles.size(), progress, [&](std::string& block, std::size_t i) {
    impl::put(block, textured ? seams.corners[i] : mesh.triangles[i]);
  });
}

/// The world origin that extras state.
std::optional<Vec3d> origin_of(const Json& object) {
  const auto extras = object.find("extras");
  if (extras == object.end() || !extras->is_object() || !extras->contains("world_origin")) return {};
  const Json& o = (*extras)["world_origin"];
  if (!o.is_array() || o.size() != 3 || !o[0].is_number() || !o[1].is_number() || !o[2].is_number())
    return {};
  return Vec3d{o[0].get<double>(), o[1].get<double>(), o[2].get<double>()};
}

/// The volume that a node's matrix makes of a unit cube; negative where it mirrors.
double orientation(const Matrix& m) {
  return dot(cross(Vec3d{m[0], m[1], m[2]}, Vec3d{m[4], m[5], m[6]}), Vec3d{m[8], m[9], m[10]});
}

/// Letters of an extension's name that are shown.
constexpr std::size_t shown_letters = 60;

/// Whether a file that requires the extension has the same triangles without it: it is of materials,
/// pictures, lights or words about the file, or it lets positions be stored as whole numbers, which are read.
bool leaves_geometry(std::string_view extension) {
  static constexpr std::string_view names[] = {
      "KHR_mesh_quantization", "KHR_texture_transform",   "KHR_texture_basisu",  "EXT_texture_webp",
      "EXT_texture_avif",      "MSFT_texture_dds",        "KHR_lights_punctual", "EXT_lights_image_based",
      "KHR_xmp_json_ld",       "EXT_structural_metadata", "EXT_mesh_features"};
  return extension.starts_with("KHR_materials_") || extension.starts_with("EXT_materials_") ||
         std::find(std::begin(names), std::end(names), extension) != std::end(names);
}

/// Gathers the triangles of every node of the default scene, in world axes.
class Reader {
 public:
  Reader(const GltfDocument& document, std::size_t file_bytes)
      : document_(document), most_items_(std::min<std::uint64_t>(4 * file_bytes + least_items, 0xffffffff)) {}

  mesh::Mesh run() {
    refuse_unknown_extensions();
    const std::vector<Instance> instances = find_instances();
    count(instances);
    for (const Instance& instance : instances) add_mesh(document_.at("meshes", instance.mesh), instance);
    if (mesh_.triangles.empty()) document_.fail_read("it holds no triangles");
    if (!all_normals_) mesh_.normals.clear();
    if (!all_colors_) mesh_.colors.clear();
    impl::place(mesh_, positions_, origin_);
    if (all_textured_) impl::join_seams(mesh_, pairs_);
    return std::move(mesh_);
  }

 private:
  /// A mesh as a node places it.
  struct Instance {
    std::uint64_t mesh = 0;
    Matrix matrix{};
    std::optional<Vec3d> origin;
  };

  void refuse_unknown_extensions() const {
    const auto needed = document_.json().find("extensionsRequired");
    if (needed == document_.json().end() || !needed->is_array()) return;
    for (const Json& entry : *needed) {
      if (!entry.is_string()) document_.fail_read("extensionsRequired holds what is not a name");
      const std::string name = entry.get<std::string>();
      if (name.ends_with("_compression"))
        document_.fail_read(fmt::format("it is compressed by {}", name.substr(0, shown_letters)));
      if (!leaves_geometry(name))
        document_.fail_read(fmt::format("it cannot be read without the extension {}, which is not known here",
                                        name.substr(0, shown_letters)));
    }
  }

  /// The nodes of the default scene that have a mesh. Nodes form trees, so that each is placed once.
  std::vector<Instance> find_instances() {
    struct Visit {
      std::uint64_t node;
      Matrix parent;
      std::optional<Vec3d> origin;
    };
    std::vector<Visit> open;
    std::vector<bool> seen(document_.size("nodes"), false);
    const auto visit = [&](std::uint64_t node, const Matrix& parent, const std::optional<Vec3d>& origin) {
      document_.at("nodes", node);
      if (seen[node])
        document_.fail_read(
            fmt::format("node {} stands below itself or in two places, where nodes form trees", node));
      seen[node] = true;
      open.push_back({node, parent, origin});
    };
    // gltfpack keeps the asset's extras alone, other programs the nodes' alone.
    const auto asset = document_.json().find("asset");
    if (asset != document_.json().end() && asset->is_object()) origin_ = origin_of(*asset);
    for (const std::uint64_t root : document_.roots())
      visit(root, {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}, origin_);
    std::vector<Instance> instances;
    while (!open.empty()) {
      const Visit at = open.back();
      open.pop_back();
      const Json& node = document_.at("nodes", at.node);
      const Matrix matrix = impl::multiply(at.parent, document_.transform(node));
      const std::optional<Vec3d> own = origin_of(node), origin = own ? own : at.origin;
      if (!origin_) origin_ = origin;
      for (const std::uint64_t child : document_.indices(node, "children")) visit(child, matrix, origin);
      if (node.contains("mesh")) instances.push_back({document_.whole(node, "mesh", 0), matrix, origin});
    }
    return instances;
  }

  /// Instances multiply a small file: all of it is counted before any of it is made.
  void count(const std::vector<Instance>& instances) const {
    std::vector<std::optional<std::uint64_t>> items(document_.size("meshes"));
    std::uint64_t total = 0;
    for (const Instance& instance : instances) {
      const Json& mesh = document_.at("meshes", instance.mesh);
      std::optional<std::uint64_t>& own = items[instance.mesh];
      if (!own) own = items_of(mesh);
      total += *own;
      if (total > most_items_)
        document_.fail_read(
            fmt::format("{} nodes repeat its meshes to more than {} vertices and corners, the most that are "
                        "read from a file of its size",
                        instances.size(), most_items_));
    }
  }

  std::uint64_t items_of(const Json& mesh) const {
    // Those of points and lines are met and left out each time.
    const auto primitives = mesh.find("primitives");
    const bool any = primitives != mesh.end() && primitives->is_array();
    std::uint64_t items = any ? primitive_items * primitives->size() : 0;
    for_each_primitive(mesh, [&](const Json& primitive) {
      const std::uint64_t vertices = positions_of(primitive).count;
      items += vertices;
      items += primitive.contains("indices")
                   ? document_.accessor(document_.whole(primitive, "indices", 0)).count
                   : vertices;
    });
    return items;
  }

  /// body(primitive) for those of triangles.
  template <class Body>
  void for_each_primitive(const Json& mesh, Body&& body) const {
    const auto primitives = mesh.find("primitives");
    if (primitives == mesh.end() || !primitives->is_array()) return;
    for (const Json& primitive : *primitives) {
      if (!primitive.is_object()) document_.fail_read("a primitive is not an object");
      const std::uint64_t mode = document_.whole(primitive, "mode", 4);
      if (mode == 5 || mode == 6) document_.fail_read("it has triangle strips or fans");
      if (mode == 4) body(primitive);
    }
  }

  GltfAccessor positions_of(const Json& primitive) const {
    const auto found = primitive.find("attributes");
    if (found == primitive.end() || !found->is_object()) document_.fail_read("a primitive has no attributes");
    if (!found->contains("POSITION")) document_.fail_read("a primitive has no POSITION");
    const GltfAccessor positions = document_.accessor(document_.whole(*found, "POSITION", 0));
    if (positions.components != 3) document_.fail_read("POSITION is not VEC3");
    return positions;
  }

  void add_mesh(const Json& mesh, const Instance& instance) {
    // Nodes of different origins come together in one file; the first origin is the mesh's.
    const Vec3d shift = instance.origin ? *instance.origin - *origin_ : Vec3d{};
    for_each_primitive(mesh,
                       [&](const Json& primitive) { add_primitive(primitive, instance.matrix, shift); });
  }

  void add_primitive(const Json& primitive, const Matrix& m, Vec3d shift) {
    const GltfAccessor positions = positions_of(primitive);
    const Json& attributes = primitive["attributes"];
    const std::uint64_t base = positions_.size(), count = positions.count;
    for (std::uint64_t i = 0; i < count; ++i) {
      const double x = positions.value(i, 0), y = positions.value(i, 1), z = positions.value(i, 2);
      const Vec3d turned{m[0] * x + m[4] * y + m[8] * z + m[12], m[1] * x + m[5] * y + m[9] * z + m[13],
                         m[2] * x + m[6] * y + m[10] * z + m[14]};
      positions_.push_back(impl::z_up(turned) + shift);
    }
    add_normals(attributes, count, m);
    add_colors(attributes, count);
    add_texture(attributes, count);
    add_triangles(primitive, base, count, orientation(m) < 0);
  }

  void add_normals(const Json& attributes, std::uint64_t count, const Matrix& m) {
    const std::uint64_t base = mesh_.normals.size();
    mesh_.normals.resize(base + count);
    all_normals_ &= attributes.contains("NORMAL");
    if (!all_normals_) return;
    const GltfAccessor normals = document_.accessor(document_.whole(attributes, "NORMAL", 0));
    if (normals.components != 3 || normals.count != count)
      document_.fail_read("NORMAL does not fit POSITION");
    // The cofactors of m turn normals, whatever the scale.
    const Vec3d a{m[0], m[1], m[2]}, b{m[4], m[5], m[6]}, c{m[8], m[9], m[10]};
    const bool plain = a == Vec3d{1, 0, 0} && b == Vec3d{0, 1, 0} && c == Vec3d{0, 0, 1};
    const double turn = orientation(m) < 0 ? -1 : 1;
    const Vec3d bc = cross(b, c) * turn, ca = cross(c, a) * turn, ab = cross(a, b) * turn;
    for (std::uint64_t i = 0; i < count; ++i) {
      const Vec3d n{normals.value(i, 0), normals.value(i, 1), normals.value(i, 2)};
      const Vec3d w = plain ? n : normalized(bc * n.x + ca * n.y + ab * n.z);
      mesh_.normals[base + i] = to_float(impl::z_up(w));
    }
  }

  void add_colors(const Json& attributes, std::uint64_t count) {
    const std::uint64_t base = mesh_.colors.size();
    mesh_.colors.resize(base + count, {255, 255, 255, 255});
    all_colors_ &= attributes.contains("COLOR_0");
    if (!all_colors_) return;
    const GltfAccessor colors = document_.accessor(document_.whole(attributes, "COLOR_0", 0));
    if (colors.components < 3 || colors.count != count) document_.fail_read("COLOR_0 does not fit POSITION");
    for (std::uint64_t i = 0; i < count; ++i)
      for (int k = 0; k < colors.components; ++k) {
        const double v = colors.value(i, k);
        mesh_.colors[base + i][k] = static_cast<std::uint8_t>(v > 0 ? std::min(v, 1.0) * 255 + 0.5 : 0.0);
      }
  }

  void add_texture(const Json& attributes, std::uint64_t count) {
    all_textured_ &= attributes.contains("TEXCOORD_0");
    if (!all_textured_) return;
    const GltfAccessor pairs = document_.accessor(document_.whole(attributes, "TEXCOORD_0", 0));
    if (pairs.components != 2 || pairs.count != count)
      document_.fail_read("TEXCOORD_0 does not fit POSITION");
    for (std::uint64_t i = 0; i < count; ++i)
      pairs_.push_back(
          v_down({static_cast<float>(pairs.value(i, 0)), static_cast<float>(pairs.value(i, 1))}));
  }

  /// What is mirrored turns its triangles inside out, so that two of their corners change places [glTF].
  void add_triangles(const Json& primitive, std::uint64_t base, std::uint64_t count, bool mirrored) {
    const auto corner = [&](std::uint64_t v) {
      if (v >= count) document_.fail_read(fmt::format("an index names vertex {} of {}", v, count));
      return static_cast<std::uint32_t>(base + v);
    };
    const auto add = [&](std::uint64_t u, std::uint64_t v, std::uint64_t w) {
      mesh_.triangles.push_back({corner(u), corner(mirrored ? w : v), corner(mirrored ? v : w)});
    };
    if (!primitive.contains("indices")) {
      for (std::uint64_t i = 0; i + 2 < count; i += 3) add(i, i + 1, i + 2);
      return;
    }
    const GltfAccessor indices = document_.accessor(document_.whole(primitive, "indices", 0));
    if (indices.components != 1 ||
        (indices.component != gl_ubyte && indices.component != gl_ushort && indices.component != gl_uint))
      document_.fail_read("indices are not whole numbers");
    for (std::uint64_t i = 0; i + 2 < indices.count; i += 3)
      add(indices.index(i), indices.index(i + 1), indices.index(i + 2));
  }

  /// What even the smallest file may hold: about 100 MB of mesh.
  static constexpr std::uint64_t least_items = 1u << 21;
  /// What the work for a primitive costs besides that for its vertices.
  static constexpr std::uint64_t primitive_items = 16;

  const GltfDocument& document_;
  std::uint64_t most_items_;
  std::optional<Vec3d> origin_;
  mesh::Mesh mesh_;
  std::vector<Vec3d> positions_;
  std::vector<Vec2<float>> pairs_;  ///< texture coordinates of vertices
  bool all_normals_ = true, all_colors_ = true, all_textured_ = true;
};

mesh::Mesh read(std::span<const std::byte> bytes, std::string_view file) {
  const auto bad = [&](std::string_view what) {
    fail(ErrorKind::input, "{}: {}; the file is damaged or is not a GLB file.", file, what);
  };
  if (bytes.size() < 20 || impl::load<std::uint32_t>(bytes, 0) != glb_magic) bad("the GLB header is missing");
  if (impl::load<std::uint32_t>(bytes, 4) != 2) bad("its version is not 2");
  if (impl::load<std::uint32_t>(bytes, 8) > bytes.size()) bad("it is shorter than its header says");
  const std::uint64_t json_bytes = impl::load<std::uint32_t>(bytes, 12);
  if (impl::load<std::uint32_t>(bytes, 16) != json_chunk || json_bytes > bytes.size() - 20)
    bad("the JSON chunk is missing or truncated");
  std::span<const std::byte> binary;
  const std::size_t next = 20 + json_bytes;
  if (bytes.size() >= next + 8 && impl::load<std::uint32_t>(bytes, next + 4) == binary_chunk) {
    const std::uint64_t size = impl::load<std::uint32_t>(bytes, next);
    if (size > bytes.size() - next - 8) bad("the binary chunk is truncated");
    binary = bytes.subspan(next + 8, size);
  }
  const std::string_view text = impl::as_text(bytes.subspan(20, json_bytes));
  Json json = impl::read_json(text);
  if (!json.is_object()) bad("its JSON cannot be parsed");
  const GltfDocument document(std::move(json), binary, file);
  return Reader(document, bytes.size()).run();
}

}  // namespace

const FormatType& declaration() {
  static const FormatType type{
      .about = {.name = "glb",
                .doc = "glTF 2.0 binary with normals, texture coordinates and vertex colours, y "
                       "up; the world origin and CRS stand in the extras of asset and node",
                .source = "[glTF]"},
      .extensions = {"glb"},
      .write_mesh = write,
      .read_mesh = read,
      .texture = true,
      .float_colors = true,
      .ups = "y",
  };
  return type;
}

}  // namespace tafoni::io::format_glb
