// A document as text. Where it was read from a text, that text is cut into its blocks and only the values
// that differ are edited, so that comments and layout stay; what an edit made is read again before it is
// trusted.
#include <algorithm>
#include <iterator>
#include <span>

#include <fmt/format.h>

#include "tafoni/core/atomic_file.h"
#include "tafoni/core/error.h"
#include "tafoni/core/files.h"
#include "tafoni/io/source_name.h"
#include "tafoni/scene/document/document.h"
#include "tafoni/scene/document/impl/toml_lines.h"
#include "tafoni/scene/document/impl/types.h"

namespace tafoni::scene {
namespace {

/// One section or block of a document, seen as a list of parameters.
struct View {
  std::string header, type;  ///< "[[layer]]", "karst"; no type for a section
  std::vector<ParamInfo> common, own;
  const void* object = nullptr;
  const Values* values = nullptr;
  int line = 0;

  std::vector<ParamInfo> infos() const { return impl::join_params(common, own); }
  Value value(const ParamInfo& info) const { return impl::load_value(common, object, *values, info); }
};

const Values no_values;

View view(const SceneSettings& scene) {
  return {"[scene]", {}, scene_params(), {}, &scene, &no_values, 0};
}
View view(const TerrainSection& terrain) {
  std::vector<ParamInfo> own;
  if (!terrain.generator.empty()) own = impl::params_of_generator(terrain.generator);
  return {"[terrain]", {}, terrain_params(), std::move(own), &terrain, &terrain.values, 0};
}
/// `path` is what the header names, as "geology.of".
View view(const GeologySettings& g, const std::string& path) {
  return {"[[" + path + "]]", g.type, geology_params(), impl::params_of_geology(g.type), &g,
          &g.values,          g.line};
}
View view(const Layer& l, const std::string& path) {
  return {"[[" + path + "]]", l.type,    layer_params(), params_of_layer(l.type),
          &l.settings,        &l.values, l.line};
}

/// The cells of a row that differ from the defaults.
std::vector<std::string> cells(const ParamInfo& info, const Row& row) {
  std::vector<std::string> out;
  for (const ParamInfo& column : info.columns)
    if (const Value text = row.at(column.name); text != column.init)
      out.push_back(column.name + " = " + to_toml(text));
  return out;
}

/// An empty list has no text of its own, the key is left out; but a table may be emptied.
std::string text_of(const ParamInfo& info, const Value& value) {
  if (const auto* rows = std::get_if<Rows>(&value)) {
    if (rows->empty()) return value == info.init ? "" : "[]";
    std::string out = "[\n";
    for (const Row& row : *rows) out += fmt::format("  {{{}}},\n", fmt::join(cells(info, row), ", "));
    return out + "]";
  }
  const auto* list = std::get_if<std::vector<double>>(&value);
  return list && list->empty() ? std::string() : to_toml(value);
}

/// What differs from the defaults.
std::string fresh(const View& v) {
  std::string out = v.header + "\n";
  if (!v.type.empty()) out += "type = " + to_toml(v.type) + "\n";
  for (const ParamInfo& info : v.infos())
    if (const Value value = v.value(info); value != info.init)
      out += fmt::format("{} = {}\n", info.name, text_of(info, value));
  return out;
}

std::string fresh(const Layer& layer, const std::string& path) {
  return fresh(view(layer, path));
}

std::string fresh(const GeologySettings& geology, const std::string& path) {
  std::string out = fresh(view(geology, path));
  for (const GeologySettings& child : geology.of) out += "\n" + fresh(child, path + ".of");
  return out;
}

/// Writes nested geologies as an array of inline tables.
std::string inline_text(const std::vector<GeologySettings>& list) {
  std::string out;
  for (const GeologySettings& geology : list) {
    const View v = view(geology, "geology");
    out += (out.empty() ? "{type = " : ", {type = ") + to_toml(geology.type);
    for (const ParamInfo& info : v.infos())
      if (const Value value = v.value(info); value != info.init)
        out += fmt::format(", {} = {}", info.name, to_toml(value));
    out += geology.of.empty() ? "}" : ", of = " + inline_text(geology.of) + "}";
  }
  return "[" + out + "]";
}

template <class T>
void append_blocks(std::string& out, const std::vector<T>& items, const std::string& path) {
  for (const T& item : items) out += "\n" + fresh(item, path);
}

std::string fresh(const Document& document) {
  std::string out = fresh(view(document.scene));
  out = std::count(out.begin(), out.end(), '\n') > 1 ? out + "\n" : "";
  out += fresh(view(document.terrain));
  append_blocks(out, document.geology, "geology");
  append_blocks(out, document.layers, "layer");
  return out;
}

/// Joins texts of blocks so that a blank line stands between them.
void join(std::string& out, const std::string& text) {
  if (!out.empty() && !text.empty()) {
    if (out.back() != '\n') out += '\n';
    if (!out.ends_with("\n\n") && text.front() != '\n') out += '\n';
  }
  out += text;
}

/// Which row of `before` each row of `now` was: an equal one, else the one in its place; -1 for a new one.
std::vector<int> origins(const Rows& before, const Rows& now) {
  std::vector<int> out(now.size(), -1);
  std::vector<bool> used(before.size(), false);
  for (const bool equal : {true, false})
    for (std::size_t i = 0; i < now.size(); ++i)
      for (std::size_t j = equal ? 0 : i; out[i] < 0 && j < (equal ? before.size() : i + 1); ++j)
        if (j < before.size() && !used[j] && (!equal || before[j] == now[i])) {
          out[i] = static_cast<int>(j);
          used[j] = true;
        }
  return out;
}

/// The blocks [[layer.NAME]] of a table, made to say `now`.
std::vector<impl::Block> edit_rows(const std::vector<impl::Block>& blocks, const ParamInfo& info,
                                   const Rows& before, const Rows& now) {
  std::vector<impl::Block> out;
  const std::vector<int> from = origins(before, now);
  for (std::size_t i = 0; i < now.size(); ++i) {
    if (from[i] < 0) {
      out.push_back({blocks.front().name, 0, {}});
      out.back().text = fmt::format("[[{}]]\n", out.back().name);
      for (const std::string& cell : cells(info, now[i])) out.back().text += cell + "\n";
      continue;
    }
    const int j = from[i];
    out.push_back(blocks[j]);
    for (const ParamInfo& column : info.columns) {
      const std::string& text = now[i].at(column.name);
      if (text != before[j].at(column.name))
        impl::edit(out.back(), column.name, Value(text) == column.init ? "" : to_toml(text));
    }
  }
  return out;
}

void edit(std::vector<impl::Block>& parts, const ParamInfo& info, const Value& before, const Value& now) {
  const std::string nested = parts.front().name + "." + info.name;
  const auto is_row = [&](const impl::Block& part) { return part.name == nested; };
  std::vector<impl::Block> rows;
  std::copy_if(parts.begin(), parts.end(), std::back_inserter(rows), is_row);
  const auto* old_rows = std::get_if<Rows>(&before);
  if (rows.empty() || !old_rows || rows.size() != old_rows->size())
    return impl::edit(parts.front(), info.name, text_of(info, now));
  rows = edit_rows(rows, info, *old_rows, std::get<Rows>(now));
  const auto first = std::find_if(parts.begin(), parts.end(), is_row) - parts.begin();
  std::erase_if(parts, is_row);
  parts.insert(parts.begin() + first, rows.begin(), rows.end());
  if (rows.empty()) impl::edit(parts.front(), info.name, text_of(info, now));
}

/// The parts of a block, edited where a value changed.
std::vector<impl::Block> edit_parts(const impl::Block& block, const View& before, const View& now) {
  std::vector<impl::Block> parts = impl::parts(block);
  for (const ParamInfo& info : now.infos())
    if (const Value old = before.value(info), value = now.value(info); old != value)
      edit(parts, info, old, value);
  return parts;
}

std::string edit_text(const impl::Block& block, const View& before, const View& now) {
  std::string out;
  for (const impl::Block& part : edit_parts(block, before, now)) join(out, part.text);
  return out;
}

std::string edit_text(const impl::Block& block, const Layer& before, const Layer& now) {
  return edit_text(block, view(before, block.name), view(now, block.name));
}

std::string edit_text(const impl::Block& block, const GeologySettings& before, const GeologySettings& now);

/// The blocks [[path]] of a text, refilled in order with `now`: the ones that were read are edited where
/// they changed.
template <class T>
class Refill {
 public:
  Refill(const std::vector<T>& before, const std::vector<T>& now, const std::vector<impl::Block>& blocks,
         std::string path)
      : before_(before), now_(now), blocks_(blocks), path_(std::move(path)) {}

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
    if (old == before_.end() || block == blocks_.end() || old->type != item.type) return fresh(item, path_);
    return edit_text(*block, *old, item);
  }

  const std::vector<T>& before_;
  const std::vector<T>& now_;
  const std::vector<impl::Block>& blocks_;
  std::string path_;
  std::size_t next_ = 0;
};

std::string edit_text(const impl::Block& block, const GeologySettings& before, const GeologySettings& now) {
  const std::string nested = block.name + ".of";
  auto parts = edit_parts(block, view(before, block.name), view(now, block.name));
  const auto own = impl::statements(parts.front().text);
  if (std::any_of(own.begin(), own.end(),
                  [](const auto& s) { return s.kind == impl::Statement::key && s.name == "of"; })) {
    if (const std::string text = inline_text(now.of); text != inline_text(before.of))
      impl::edit(parts.front(), "of", text);
    return parts.front().text;
  }
  std::string out;
  for (const impl::Block& part : parts)
    if (part.name != nested) join(out, part.text);
  Refill(before.of, now.of, parts, nested).rest(out);
  return out;
}

std::string edit_text(const Document& before, const Document& now) {
  const auto blocks = impl::blocks(now.text);
  const auto count = [&](std::string_view name) {
    return std::count_if(blocks.begin(), blocks.end(), [&](const auto& b) { return b.name == name; });
  };
  auto layers_left = count("layer"), geology_left = count("geology");
  Refill geology(before.geology, now.geology, blocks, "geology");
  Refill layers(before.layers, now.layers, blocks, "layer");
  std::string out;
  const auto section = [&](const auto& settings) {
    const std::string text = fresh(view(settings));
    if (std::count(text.begin(), text.end(), '\n') > 1) join(out, text);
  };
  for (const impl::Block& block : blocks) {
    if (block.name == "scene") {
      join(out, edit_text(block, view(before.scene), view(now.scene)));
    } else if (block.name == "terrain") {
      join(out, edit_text(block, view(before.terrain), view(now.terrain)));
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
  io::SourceName name = io::split_source(path, document.directory);
  if (name.file.empty() || name.file.is_absolute()) return;
  const std::filesystem::path place = std::filesystem::absolute(document.directory / name.file);
  name.file = relative_to(directory, place);
  path = name.text();
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
    std::string text = edit_text(before, document);
    if (reads_back(text, document)) return text;
  }
  return fresh(document);
}

void save_scene(const Document& document, const std::filesystem::path& file) {
  Document moved = document;
  const auto directory = tidy(std::filesystem::absolute(follow_links(file))).parent_path();
  rebase(moved.terrain.source, document, directory);
  rebase(moved.terrain.domain, document, directory);
  for (Layer& layer : moved.layers)
    for (std::string* path : paths_of(layer)) rebase(*path, document, directory);
  moved.directory = directory;
  AtomicFile out(file);
  out.write(to_text(moved));
  out.commit();
}

}  // namespace tafoni::scene
