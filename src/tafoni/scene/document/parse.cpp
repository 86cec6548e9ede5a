// A scene file is parsed to tables, and each key of a table is looked up among the parameters of its block:
// what is unknown or out of range is told with its line. No other file includes the TOML parser.
#include <algorithm>
#include <optional>

#include <toml++/toml.h>

#include "tafoni/core/byte_text.h"
#include "tafoni/core/error.h"
#include "tafoni/geology/kind.h"
#include "tafoni/scene/document/document.h"
#include "tafoni/scene/document/impl/types.h"

namespace tafoni::scene {
namespace {

/// What of a user's word goes into a message: short and on one line.
std::string shown(std::string_view word, std::size_t most = 60) {
  std::string out;
  for (char c : word.substr(0, most)) out += c >= 0 && c < ' ' ? '?' : c;
  return word.size() > most ? out + "…" : out;
}

/// Tables within tables that a header or a key may make: no scene has half as many, and the parser goes down
/// into each by a call.
constexpr int most_dots = 64;

/// Counts the dots of headers and keys before the parser sees them. Outside of strings and comments a value
/// has few, and what no key has in it begins the count anew.
class DotCount {
 public:
  explicit DotCount(std::string_view text) : text_(text) {}

  /// The line of the first that has too many, or 0.
  int line_of_too_many() {
    std::vector<int> outer;  // dots down to each inline table that is open
    int above = 0, run = 0, key = 0;
    while (at_ < text_.size()) {
      const char c = text_[at_];
      if (c == '"' || c == '\'') {
        step_over_string(c);
        continue;
      }
      ++at_;
      if (c == '.' && above + ++run > most_dots) return line_;
      if (c == '=') key = run;
      if (c == '{') {
        outer.push_back(key);
        above += key;
      }
      if (c == '}' && !outer.empty()) {
        key = outer.back();
        outer.pop_back();
        above -= key;
      }
      if (c == '#') at_ = std::min(text_.find('\n', at_), text_.size());
      if (c == '\n') ++line_;
      if (std::string_view("\n=,[]{}").find(c) != std::string_view::npos) run = 0;
    }
    return 0;
  }

 private:
  void step_over_string(char quote) {
    const bool several_lines = text_.substr(at_, 3) == std::string(3, quote);
    const std::string end(several_lines ? 3 : 1, quote);
    for (at_ += end.size(); at_ < text_.size(); ++at_) {
      if (text_.substr(at_, end.size()) == end) break;
      if (text_[at_] == '\n' && !several_lines) return;
      if (text_[at_] == '\n') ++line_;
      if (text_[at_] == '\\' && quote == '"' && text_.substr(at_ + 1, 1) != "\n") ++at_;
    }
    at_ = std::min(at_ + end.size(), text_.size());
    // Two quotes more may stand before the three that end a string of several lines.
    for (int more = 0; several_lines && more < 2 && text_.substr(at_, 1) == end.substr(1, 1); ++more) ++at_;
  }

  std::string_view text_;
  std::size_t at_ = 0;
  int line_ = 1;
};

std::string place(const std::filesystem::path& file, const toml::source_region& source) {
  return source.begin ? fmt::format("{}:{}", file.string(), source.begin.line) : file.string();
}

std::string_view kind_of(const toml::node& node) {
  switch (node.type()) {
    case toml::node_type::table:
      return "a table";
    case toml::node_type::array:
      return "an array";
    case toml::node_type::date:
    case toml::node_type::time:
    case toml::node_type::date_time:
      return "a date or a time";
    default:
      return "a value";
  }
}

/// A value as parameters hold them; empty for what none can hold.
std::optional<Value> to_value(const toml::node& node) {
  if (const auto* v = node.as_boolean()) return Value(v->get());
  if (const auto* v = node.as_integer()) return Value(v->get());
  if (const auto* v = node.as_floating_point()) return Value(v->get());
  if (const auto* v = node.as_string()) return Value(from_utf8(v->get()));
  const auto* array = node.as_array();
  if (!array) return {};
  std::vector<double> numbers;
  for (const toml::node& item : *array) {
    if (const auto* i = item.as_integer())
      numbers.push_back(static_cast<double>(i->get()));
    else if (const auto* f = item.as_floating_point())
      numbers.push_back(f->get());
    else
      return {};
  }
  return Value(std::move(numbers));
}

/// A cell of a table: text, or the text of numbers, true or false.
std::optional<std::string> to_cell(const toml::node& node) {
  if (const auto* v = node.as_string()) return from_utf8(v->get());
  const auto value = to_value(node);
  if (!value) return {};
  const std::string text = to_toml(*value);
  return node.is_array() ? text.substr(1, text.size() - 2) : text;
}

class Reader {
 public:
  explicit Reader(const std::filesystem::path& file) : file_(file) {}

  [[noreturn]] void unknown(const toml::key& key, const std::string& owner,
                            const std::vector<std::string>& known) const {
    const std::string near = nearest(key.str().substr(0, 100), known);
    std::string list;
    for (const std::string& name : known) list += (list.empty() ? "" : ", ") + name;
    fail(ErrorKind::input, "{}: unknown key \"{}\" in {}; {}", place(file_, key.source()), shown(key.str()),
         owner, near.empty() ? "known are " + list : fmt::format("did you mean \"{}\"?", near));
  }

  static Lines lines(const toml::table& table) {
    Lines out = {{"", static_cast<int>(table.source().begin.line)}};
    for (auto&& [key, node] : table) out.emplace(key.str(), static_cast<int>(key.source().begin.line));
    return out;
  }

  /// Reads every key of `table` but those of `others`.
  void block(const toml::table& table, const std::string& owner, const std::vector<std::string>& others,
             const std::vector<ParamInfo>& common, void* object, const std::vector<ParamInfo>& own,
             Values& values) const {
    for (auto&& [key, node] : table) {
      if (std::find(others.begin(), others.end(), key.str()) != others.end()) continue;
      const auto find = [&, k = key.str()](const std::vector<ParamInfo>& infos) -> const ParamInfo* {
        for (const ParamInfo& info : infos)
          if (info.name == k) return &info;
        return nullptr;
      };
      const ParamInfo* info = find(common);
      if (!info) info = find(own);
      if (!info) {
        std::vector<std::string> known = others;
        for (const ParamInfo& i : common) known.push_back(i.name);
        for (const ParamInfo& i : own) known.push_back(i.name);
        unknown(key, owner, known);
      }
      const std::string where = place(file_, key.source());
      const auto value = info->kind == ValueKind::rows ? rows(node, *info, owner) : to_value(node);
      if (!value)
        fail(ErrorKind::input, "{}: {} must be {}, not {}", where, info->name, allowed(*info), kind_of(node));
      impl::store(common, object, values, *info, as_input([&] { return check_value(*info, *value, where); }));
    }
  }

  /// Empty for what is not an array of tables.
  std::optional<Value> rows(const toml::node& node, const ParamInfo& info, const std::string& owner) const {
    const auto* array = node.as_array();
    if (!array) return {};
    Rows out;
    for (const toml::node& item : *array) {
      const auto* table = item.as_table();
      if (!table) return {};
      Row& row = out.emplace_back();
      for (auto&& [key, cell] : *table) {
        const auto column = std::find_if(info.columns.begin(), info.columns.end(),
                                         [k = key.str()](const ParamInfo& c) { return c.name == k; });
        const std::string which = fmt::format("{}: {}, row {}", owner, info.name, out.size());
        if (column == info.columns.end()) {
          std::vector<std::string> known;
          for (const ParamInfo& c : info.columns) known.push_back(c.name);
          unknown(key, which, known);
        }
        const auto text = to_cell(cell);
        if (!text)
          fail(ErrorKind::input, "{}: {}: {} must be text or numbers, not {}", place(file_, key.source()),
               which, column->name, kind_of(cell));
        const std::string where = fmt::format("{}: {}", place(file_, key.source()), which);
        as_input([&] { check_cell(*column, *text, where); });
        row.emplace(key.str(), *text);
      }
    }
    return Value(std::move(out));
  }

  /// What the key "type" of a block says.
  std::string type(const toml::table& table, std::string_view owner, std::string_view example) const {
    const toml::node* node = table.get("type");
    if (!node) {
      fail(ErrorKind::input, "{}: [[{}]] has no type; add, for example, type = \"{}\"",
           place(file_, table.source()), owner, example);
    }
    const auto* text = node->as_string();
    if (!text)
      fail(ErrorKind::input, "{}: type must be text, for example \"{}\"", place(file_, node->source()),
           example);
    return text->get();
  }

  /// The tables of [[name]]; `key` is its last word.
  std::vector<const toml::table*> blocks(const toml::table& root, std::string_view name,
                                         std::string_view key) const {
    std::vector<const toml::table*> out;
    const toml::node* node = root.get(key);
    if (!node) return out;
    const auto* array = node->as_array();
    const bool tables = array && std::all_of(array->begin(), array->end(),
                                             [](const toml::node& item) { return item.is_table(); });
    if (!tables)
      fail(ErrorKind::input, "{}: {} must be written [[{}]], once for each", place(file_, node->source()),
           name, name);
    for (const toml::node& item : *array) out.push_back(item.as_table());
    return out;
  }

  const toml::table* section(const toml::table& root, std::string_view name) const {
    const toml::node* node = root.get(name);
    if (!node) return nullptr;
    if (const auto* table = node->as_table()) return table;
    fail(ErrorKind::input, "{}: {} must be a section, written [{}]", place(file_, node->source()), name,
         name);
  }

  /// Errors of the parameter tables speak of usage; in a file they are input.
  template <class F>
  static auto as_input(F&& f) -> decltype(f()) {
    try {
      return f();
    } catch (const Error& error) {
      throw Error(ErrorKind::input, shown(error.what(), 500));
    }
  }
  template <class F>
  auto of_type(const toml::table& table, F&& f) const -> decltype(f()) {
    try {
      return f();
    } catch (const Error& error) {
      const toml::node* type = table.get("type");
      fail(ErrorKind::input, "{}: {}", place(file_, type ? type->source() : table.source()),
           shown(error.what(), 500));
    }
  }

 private:
  const std::filesystem::path& file_;
};

void read_terrain(const Reader& reader, const toml::table& table, TerrainSection& terrain,
                  const std::filesystem::path& file) {
  static const std::vector<ParamInfo> none;
  const std::vector<ParamInfo>* own = &none;
  if (const auto* generator = table.get("generator")) {
    if (const auto* name = generator->as_string(); name && !name->get().empty()) {
      try {
        own = &impl::params_of_generator(name->get());
      } catch (const Error& error) {
        fail(ErrorKind::input, "{}: {}", place(file, generator->source()), shown(error.what(), 500));
      }
    }
  }
  terrain.lines = Reader::lines(table);
  reader.block(table, "[terrain]", {}, terrain_params(), &terrain, *own, terrain.values);
}

void read_layer(const Reader& reader, const toml::table& table, Document& document) {
  Layer layer;
  layer.line = static_cast<int>(table.source().begin.line);
  layer.type = reader.type(table, "layer", "karst");
  const auto& own = reader.of_type(table, [&]() -> decltype(auto) { return params_of_layer(layer.type); });
  reader.block(table, fmt::format("layer \"{}\"", layer.type), {"type"}, layer_params(), &layer.settings, own,
               layer.values);
  document.layers.push_back(std::move(layer));
}

/// `path` is what its header names: "geology", "geology.of" and so on.
GeologySettings read_geology(const Reader& reader, const toml::table& table, const std::string& path,
                             int depth) {
  constexpr int deepest = 32;
  GeologySettings out;
  out.line = static_cast<int>(table.source().begin.line);
  out.type = reader.type(table, path, "strata");
  const auto& own =
      reader.of_type(table, [&]() -> decltype(auto) { return impl::params_of_geology(out.type); });
  reader.block(table, fmt::format("geology \"{}\"", out.type), {"type", "of"}, geology_params(), &out, own,
               out.values);
  const std::string nested = path + ".of";
  const auto children = reader.blocks(table, nested, "of");
  reader.of_type(table, [&] {
    if (depth == deepest && !children.empty())
      fail(ErrorKind::input, "geology is nested more than {} deep", deepest);
    // What is wrong with its values or the number of its children is known before these are read.
    const std::vector<geology::GeologyPtr> any(children.size(),
                                               geology::make_geology("turbulence", {}, {}, {}, 0));
    geology::make_geology(out.type, out.values, any, {}, 0);
  });
  for (const auto* child : children) out.of.push_back(read_geology(reader, *child, nested, depth + 1));
  return out;
}

}  // namespace

Document parse_scene(std::string_view text, const std::filesystem::path& file) {
  if (const std::size_t at = first_not_utf8(text); at != std::string_view::npos)
    fail(ErrorKind::input,
         "{}:{}: is not UTF-8; save it as UTF-8, and write bytes of names that are none as in "
         "'d\\xE9nivel\\xE9'",
         file.string(), 1 + std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(at), '\n'));
  if (const int line = DotCount(text).line_of_too_many(); line > 0)
    fail(ErrorKind::input,
         "{}:{}: a header or key has more than {} dots, each of which nests a table; name "
         "fewer parts",
         file.string(), line, most_dots);
  toml::table root;
  try {
    root = toml::parse(text);
  } catch (const toml::parse_error& error) {
    fail(ErrorKind::input, "{}: is not valid TOML: {}", place(file, error.source()),
         shown(error.description(), 300));
  }
  static const std::vector<ParamInfo> none;
  static const std::vector<std::string> known = {"scene", "terrain", "geology", "layer"};
  const Reader reader(file);
  for (auto&& [key, node] : root)
    if (std::find(known.begin(), known.end(), key.str()) == known.end())
      reader.unknown(key, "the scene", known);

  Document document;
  document.directory = file.parent_path();
  document.file = file.string();
  document.text = text;
  Values no_values;
  if (const auto* table = reader.section(root, "scene")) {
    document.scene.lines = Reader::lines(*table);
    reader.block(*table, "[scene]", {}, scene_params(), &document.scene, none, no_values);
  }
  if (const auto* table = reader.section(root, "terrain"))
    read_terrain(reader, *table, document.terrain, file);
  for (const auto* table : reader.blocks(root, "geology", "geology"))
    document.geology.push_back(read_geology(reader, *table, "geology", 1));
  for (const auto* table : reader.blocks(root, "layer", "layer")) read_layer(reader, *table, document);
  check(document);
  return document;
}

}  // namespace tafoni::scene
