// Every registry, the sections of a scene file and the commands are turned into entries of one form, which
// are printed as text, as JSON or as the Markdown of the reference.
#include "catalogue.h"

#include "command.h"
#include <fmt/core.h>

#include "tafoni/field/operator.h"
#include "tafoni/field/primitive.h"
#include "tafoni/geology/kind.h"
#include "tafoni/grammar/solid.h"
#include "tafoni/io/format.h"
#include "tafoni/landforms/landform.h"
#include "tafoni/scene/document/document.h"
#include "tafoni/scene/layers/layer.h"
#include "tafoni/scene/sculpt/brush.h"
#include "tafoni/terrain/generator.h"

namespace tafoni::cli {
namespace {

/// Declarations that have a name, a purpose, a source and parameters.
template <class T>
Topic topic(const char* name, const char* doc, std::span<const T* const> types) {
  Topic out{name, doc, {}};
  for (const T* type : types)
    out.entries.push_back(
        {type->about.name, type->about.doc, type->about.source, {}, type->about.params, {}});
  return out;
}

Topic brushes() {
  Topic out = topic("brushes", "What strokes are made with", scene::all_brushes());
  out.entries.insert(out.entries.begin(),
                     {"stroke",
                      "What every stroke can say besides its brush, its points (at) and the brush's own",
                      "[Paris19 §8.2]",
                      {},
                      scene::stroke_params(),
                      {}});
  return out;
}

Topic formats() {
  Topic out{"formats", "Files of meshes, pictures and volumes, chosen by extension", {}};
  for (const io::FormatType* type : io::all_formats()) {
    std::string note;
    for (const std::string& extension : type->extensions) note += (note.empty() ? "." : ", .") + extension;
    note += ":";
    if (type->write_mesh) note += " writes meshes";
    if (type->read_mesh) note += type->write_mesh ? " and reads them" : " reads meshes";
    if (type->write_image) note += " writes pictures";
    if (type->write_volume) note += type->open_volume ? " writes volumes and reads them" : " writes volumes";
    out.entries.push_back(
        {type->about.name, type->about.doc, type->about.source, note, type->about.params, {}});
  }
  return out;
}

Topic rocks() {
  Topic out{"geology", "Kinds of rock", {}};
  for (const geology::GeologyType* type : geology::all_geologies()) {
    const std::string note = type->max_children == 0 ? ""
                                                     : fmt::format("Takes {}, each written [[geology.of]].",
                                                                   geology::children_text(*type));
    out.entries.push_back(
        {type->about.name, type->about.doc, type->about.source, note, type->about.params, {}});
  }
  return out;
}

/// Each type of layer that no other topic shows.
void add_layers(Topic& topic) {
  for (const scene::LayerKind* kind : scene::all_layers()) {
    if (!kind->listed_as.empty()) continue;
    for (const scene::LayerType& type : kind->types)
      topic.entries.push_back({fmt::format("[[layer]] type = \"{}\"", type.about.name),
                               type.about.doc,
                               type.about.source,
                               {},
                               type.about.params,
                               {}});
  }
}

Topic sections() {
  Topic out{"scene", "Sections of a scene file", {}};
  const auto add = [&](const char* name, const char* doc, const std::vector<ParamInfo>& params) {
    out.entries.push_back({name, doc, {}, {}, params, {}});
  };
  add("[scene]", "What holds for the whole scene", scene::scene_params());
  add("[terrain]", "The elevation model and its field", scene::terrain_params());
  add("[[geology]]",
      "What every geology can say besides its type and the type's own parameters; several are blended, and "
      "[[geology.of]] nests one in another",
      scene::geology_params());
  add("[[layer]]", "What every layer can say besides its type and the type's own parameters",
      scene::layer_params());
  add_layers(out);
  return out;
}

Topic commands() {
  Topic out{"commands", "Subcommands of tafoni", {}};
  for (const Command* command : all_commands()) {
    Args args(command->about.name, command->about.doc);
    command->setup(args);
    out.entries.push_back(
        {command->about.name, command->about.doc, {}, command->examples, {}, args.entries()});
  }
  return out;
}

std::string init_text(const ParamInfo& info) {
  const std::string init = to_toml(info.init);
  return init == "\"\"" || init == "[]" ? "none" : init;
}

/// A table as a scene file may hold it, a row a line, without what goes without saying; empty when not one.
std::string rows_text(const ParamInfo& info) {
  const auto* rows = std::get_if<Rows>(&info.init);
  if (!rows || rows->empty()) return {};
  std::string out = "[\n";
  for (const Row& row : *rows) {
    std::string cells;
    for (const ParamInfo& column : info.columns) {
      const auto found = row.find(column.name);
      if (found == row.end() || Value(found->second) == column.init) continue;
      cells += fmt::format("{}{} = {}", cells.empty() ? "" : ", ", column.name, to_toml(found->second));
    }
    out += fmt::format("    {{{}}},\n", cells);
  }
  return out + "  ]";
}

Topic common_options() {
  CommonOptions options;
  Args args("common", "");
  options.declare(args);
  return {"options",
          "What every command takes",
          {{"common options", "On any command", {}, {}, {}, args.entries()}}};
}

struct TopicMaker {
  const char* name;
  Topic (*make)();
};

/// In the order of the reference. The names alone are asked for while commands are being set up, which the
/// topic of commands does itself.
std::span<const TopicMaker> topic_makers() {
  static const TopicMaker all[] = {
      {"commands", commands},
      {"options", common_options},
      {"scene", sections},
      {"landforms",
       [] { return topic("landforms", "Layers that shape the terrain", landforms::all_landforms()); }},
      {"geology", rocks},
      {"generators",
       [] { return topic("generators", "Built-in elevation models", terrain::all_generators()); }},
      {"brushes", brushes},
      {"primitives",
       [] { return topic("primitives", "Leaves of construction trees", field::all_primitives()); }},
      {"operators",
       [] { return topic("operators", "How trees are combined, moved and eroded", field::all_operators()); }},
      {"solids", [] { return topic("solids", "What grammar caves are made of", grammar::all_solids()); }},
      {"formats", formats},
  };
  return all;
}

/// What a parameter does and where, with its columns where it is a table.
std::string doc_text(const ParamInfo& info, const char* separator) {
  std::string out = info.doc;
  if (!info.only.empty()) out += ". Only " + info.only;
  for (const ParamInfo& column : info.columns)
    out +=
        fmt::format("{}{} = {}{}: {}", separator, column.name, init_text(column),
                    column.kind == ValueKind::text ? "" : fmt::format(" ({})", allowed(column)), column.doc);
  return out;
}

/// Cells of a Markdown table must not hold a bar.
std::string cell(std::string text) {
  for (std::size_t i = 0; (i = text.find('|', i)) != std::string::npos; i += 2) text.insert(i, "\\");
  return text;
}

std::string flags_text(const Args::Entry& option) {
  std::string flags = option.flags;
  if (const auto comma = flags.find(','); comma != std::string::npos) flags.replace(comma, 1, ", ");
  return option.value.empty() ? flags : flags + " " + option.value;
}

void markdown(std::string& out, const CatalogueEntry& entry, bool examples) {
  out += fmt::format("### {}\n\n{}.{}\n\n", entry.name, entry.doc,
                     entry.source.empty() ? "" : fmt::format(" Source: {}.", entry.source));
  if (!entry.note.empty())
    out += examples ? fmt::format("```sh\n{}\n```\n\n", entry.note) : entry.note + "\n\n";
  if (!entry.params.empty()) {
    out += "| parameter | default | allowed | what it does |\n|---|---|---|---|\n";
    for (const ParamInfo& info : entry.params)
      out += fmt::format("| `{}` | {} | {} | {} |\n", info.name,
                         rows_text(info).empty() ? cell(init_text(info)) : "as `tafoni list` prints it",
                         cell(allowed(info)), cell(doc_text(info, "; ")));
    out += "\n";
  }
  if (!entry.options.empty()) {
    out += "| option | what it does |\n|---|---|\n";
    for (const Args::Entry& option : entry.options)
      out += fmt::format("| `{}` | {} |\n", cell(flags_text(option)), cell(option.doc));
    out += "\n";
  }
}

}  // namespace

std::vector<Topic> catalogue() {
  std::vector<Topic> out;
  for (const TopicMaker& maker : topic_makers()) out.push_back(maker.make());
  return out;
}

std::string topic_names() {
  std::string out;
  const std::span<const TopicMaker> all = topic_makers();
  for (std::size_t i = 0; i < all.size(); ++i)
    out += (i == 0 ? "" : i + 1 == all.size() ? " or " : ", ") + std::string(all[i].name);
  return out;
}

std::string markdown(const std::vector<Topic>& topics) {
  std::string out =
      "# Reference\n\nWritten by `tafoni list --markdown` from the declarations in the code.\n\n";
  for (const Topic& topic : topics) {
    std::string title = topic.name;
    title[0] = static_cast<char>(title[0] - 'a' + 'A');
    out += fmt::format("## {}\n\n{}.\n\n", title, topic.doc);
    for (const CatalogueEntry& entry : topic.entries) markdown(out, entry, topic.name == "commands");
  }
  while (out.ends_with("\n\n")) out.pop_back();
  return out;
}

std::string text(const Topic& topic) {
  std::string out = fmt::format("{}: {}\n", topic.name, topic.doc);
  for (const CatalogueEntry& entry : topic.entries)
    out += fmt::format("  {:<14} {}\n", entry.name, entry.doc);
  return out;
}

std::string text(const CatalogueEntry& entry) {
  std::string out = fmt::format("{}: {}\n", entry.name, entry.doc);
  if (!entry.source.empty()) out += fmt::format("source: {}\n", entry.source);
  if (!entry.note.empty()) out += entry.note + "\n";
  for (const ParamInfo& info : entry.params) {
    const std::string rows = rows_text(info);
    out += fmt::format("\n  {} = {}   ({})\n      {}\n", info.name, rows.empty() ? init_text(info) : rows,
                       allowed(info), doc_text(info, "\n        "));
  }
  for (const Args::Entry& option : entry.options)
    out += fmt::format("\n  {}\n      {}\n", flags_text(option), option.doc);
  return out;
}

}  // namespace tafoni::cli
