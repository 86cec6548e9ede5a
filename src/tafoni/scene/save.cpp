#include <algorithm>
#include <span>

#include "tafoni/core/atomic_file.h"
#include "tafoni/core/error.h"
#include "tafoni/scene/document.h"
#include "tafoni/scene/impl/toml_lines.h"
#include "tafoni/scene/impl/types.h"

namespace tafoni::scene {
namespace {

/// One section or block of a document, seen as a list of parameters.
struct View {
  std::string header, type;  ///< "[[layer]]", "karst"; no type for a section
  std::vector<ParamInfo> common, own;
  const void* object = nullptr;
  const Values* values = nullptr;
  int line = 0;

  std::vector<ParamInfo> infos() const { return impl::joined(common, own); }
  Value value(const ParamInfo& info) const { return impl::loaded(common, object, *values, info); }
};

const Values no_values;

View view(const SceneSettings& scene) {
  return {"[scene]", {}, scene_params(), {}, &scene, &no_values, 0};
}
View view(const TerrainSettings& terrain) {
  std::vector<ParamInfo> own;
  if (!terrain.generator.empty()) own = impl::params_of_generator(terrain.generator);
  return {"[terrain]", {}, terrain_params(), std::move(own), &terrain, &terrain.values, 0};
}
View view(const GeologySettings& g) {
  return {"[[geology]]", g.type, {}, impl::params_of_geology(g.type), nullptr, &g.values, g.line};
}
View view(const Layer& l) {
  return {"[[layer]]", l.type, layer_params(), params_of_layer(l.type), &l.settings, &l.values, l.line};
}

/// An empty list has no text of its own: the key is left out.
std::string text_of(const Value& value) {
  const auto* list = std::get_if<std::vector<double>>(&value);
  return list && list->empty() ? std::string() : to_toml(value);
}

/// What differs from the defaults.
std::string fresh(const View& v) {
  std::string out = v.header + "\n";
  if (!v.type.empty()) out += "type = " + to_toml(v.type) + "\n";
  for (const ParamInfo& info : v.infos())
    if (const Value value = v.value(info); value != info.init)
      out += fmt::format("{} = {}\n", info.name, text_of(value));
  return out;
}

template <class T>
void append_blocks(std::string& out, const std::vector<T>& items) {
  for (const T& item : items) out += "\n" + fresh(view(item));
}

std::string fresh(const Document& document) {
  std::string out = fresh(view(document.scene));
  out = std::count(out.begin(), out.end(), '\n') > 1 ? out + "\n" : "";
  out += fresh(view(document.terrain));
  append_blocks(out, document.geology);
  append_blocks(out, document.layers);
  return out;
}

std::string edited(impl::Block block, const View& before, const View& now) {
  for (const ParamInfo& info : now.infos()) {
    const Value value = now.value(info);
    if (before.value(info) != value) impl::edit(block, info.name, text_of(value));
  }
  return block.text;
}

/// Joins texts of blocks so that a blank line stands between them.
void join(std::string& out, const std::string& text) {
  if (!out.empty() && !text.empty()) {
    if (out.back() != '\n') out += '\n';
    if (!out.ends_with("\n\n") && text.front() != '\n') out += '\n';
  }
  out += text;
}

/// The blocks [[name]] of a text, refilled in order with `now`: the ones that were read are edited where
/// they changed.
template <class T>
class Refill {
 public:
  Refill(const std::vector<T>& before, const std::vector<T>& now, const std::vector<impl::Block>& blocks)
      : before_(before), now_(now), blocks_(blocks) {}

  void one(std::string& out) {
    if (next_ < now_.size()) join(out, text(now_[next_++]));
  }
  void rest(std::string& out) {
    while (next_ < now_.size()) one(out);
  }

 private:
  std::string text(const T& item) const {
    const auto same_line = [&](const auto& other) { return item.line > 0 && other.line == item.line; };
    const auto old = std::find_if(before_.begin(), before_.end(), same_line);
    const auto block = std::find_if(blocks_.begin(), blocks_.end(), same_line);
    if (old == before_.end() || block == blocks_.end() || old->type != item.type) return fresh(view(item));
    return edited(*block, view(*old), view(item));
  }

  const std::vector<T>& before_;
  const std::vector<T>& now_;
  const std::vector<impl::Block>& blocks_;
  std::size_t next_ = 0;
};

std::string edited(const Document& before, const Document& now) {
  const auto blocks = impl::blocks(now.text);
  const auto count = [&](std::string_view name) {
    return std::count_if(blocks.begin(), blocks.end(), [&](const auto& b) { return b.name == name; });
  };
  auto layers_left = count("layer"), geology_left = count("geology");
  Refill geology(before.geology, now.geology, blocks);
  Refill layers(before.layers, now.layers, blocks);
  std::string out;
  const auto section = [&](const auto& settings) {
    const std::string text = fresh(view(settings));
    if (std::count(text.begin(), text.end(), '\n') > 1) join(out, text);
  };
  for (const impl::Block& block : blocks) {
    if (block.name == "scene") {
      join(out, edited(block, view(before.scene), view(now.scene)));
    } else if (block.name == "terrain") {
      join(out, edited(block, view(before.terrain), view(now.terrain)));
    } else if (block.name == "geology") {
      geology.one(out);
      if (--geology_left == 0) geology.rest(out);
    } else if (block.name == "layer") {
      if (count("geology") == 0) geology.rest(out);
      layers.one(out);
      if (--layers_left == 0) layers.rest(out);
    } else {
      join(out, block.text);
      if (&block == &blocks.front() && count("scene") == 0) section(now.scene);
      if (&block == &blocks.front() && count("terrain") == 0) section(now.terrain);
    }
  }
  geology.rest(out);
  layers.rest(out);
  return out;
}

bool reads_back(const std::string& text, const Document& document) {
  try {
    return same(parse_scene(text, document.directory / "scene"), document);
  } catch (const Error&) {
    return false;
  }
}

void rebase(std::string& path, const Document& document, const std::filesystem::path& directory) {
  if (path.empty() || std::filesystem::path(path).is_absolute()) return;
  path = std::filesystem::absolute(document.resolved(path)).lexically_normal().lexically_relative(directory);
}

}  // namespace

std::string to_text(const Document& document) {
  if (!document.text.empty()) {
    Document before;
    try {
      before = parse_scene(document.text, document.directory / "scene");
    } catch (const Error&) {
      return fresh(document);
    }
    if (same(before, document)) return document.text;
    std::string text = edited(before, document);
    if (reads_back(text, document)) return text;
  }
  return fresh(document);
}

void save_scene(const Document& document, const std::filesystem::path& file) {
  Document moved = document;
  const auto directory = std::filesystem::absolute(file).lexically_normal().parent_path();
  rebase(moved.terrain.source, document, directory);
  rebase(moved.terrain.domain, document, directory);
  for (Layer& layer : moved.layers) {
    for (std::string* path : {&layer.settings.region, &layer.settings.mask, &layer.settings.points})
      rebase(*path, document, directory);
    if (layer.type != primitives_layer) continue;
    if (const auto found = layer.values.find("file"); found != layer.values.end())
      rebase(std::get<std::string>(found->second), document, directory);
  }
  moved.directory = directory;
  AtomicFile out(file);
  out.write(to_text(moved));
  out.commit();
}

}  // namespace tafoni::scene
