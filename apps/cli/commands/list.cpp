// tafoni list: the catalogue of what the program knows, as text, JSON or Markdown.
#include <algorithm>
#include <memory>

#include "catalogue.h"
#include "command.h"
#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "tafoni/core/registry.h"

namespace tafoni::cli::command_list {
namespace {

using Json = nlohmann::ordered_json;

struct List {
  std::string topic, name;
  bool markdown = false;
};

Json to_json(const CatalogueEntry& entry) {
  Json json = {{"name", entry.name}, {"doc", entry.doc}};
  if (!entry.source.empty()) json["source"] = entry.source;
  if (!entry.note.empty()) json["note"] = entry.note;
  for (const ParamInfo& info : entry.params) {
    Json param = {{"name", info.name}, {"doc", info.doc}, {"unit", info.unit}, {"allowed", allowed(info)}};
    if (!info.only.empty()) param["only"] = info.only;
    std::visit([&](const auto& v) { param["default"] = v; }, info.init);
    for (const ParamInfo& column : info.columns)
      param["columns"].push_back(
          {{"name", column.name}, {"doc", column.doc}, {"default", std::get<std::string>(column.init)}});
    json["params"].push_back(std::move(param));
  }
  for (const Args::Entry& option : entry.options)
    json["options"].push_back({{"flags", option.flags}, {"value", option.value}, {"doc", option.doc}});
  return json;
}

/// The item called `name`; throws naming the nearest one.
template <class T>
const T& find_named(const std::vector<T>& items, const std::string& name, const std::string& what) {
  std::vector<std::string> known;
  for (const T& item : items) {
    if (item.name == name) return item;
    known.push_back(item.name);
  }
  fail_unknown(what, name, known);
}

/// A name may stand as it is written in a scene file: "karst" for [[layer]] type = "karst".
bool is_called(const CatalogueEntry& entry, std::string_view name) {
  if (entry.name == name) return true;
  std::string_view own = entry.name;
  if (const auto quote = own.find('"'); quote != own.npos)
    own = own.substr(quote + 1, own.size() - quote - 2);
  else
    while (own.starts_with('[') && own.ends_with(']')) own = own.substr(1, own.size() - 2);
  return own == name;
}

/// What is called `name`, whatever its topic.
void print_entries(const std::vector<Topic>& topics, const std::string& name, Console& console) {
  Json json = Json::array();
  std::string out;
  std::vector<std::string> known, names;
  for (const Topic& topic : topics) {
    names.push_back(topic.name);
    known.push_back(topic.name);
    for (const CatalogueEntry& entry : topic.entries) {
      known.push_back(entry.name);
      if (!is_called(entry, name)) continue;
      out += fmt::format("{}{}, {}", out.empty() ? "" : "\n", topic.name, text(entry));
      json.push_back(to_json(entry));
      json.back()["topic"] = topic.name;
    }
  }
  if (json.empty()) fail_unknown("topic or name", name, nearest(name, known).empty() ? names : known);
  console.result(console.json() ? json_text(json.size() == 1 ? json[0] : json) : out);
}

bool is_topic(const std::vector<Topic>& topics, const std::string& name) {
  return std::any_of(topics.begin(), topics.end(), [&](const Topic& topic) { return topic.name == name; });
}

int run(const List& list, Console& console) {
  const std::vector<Topic> topics = catalogue();
  if (list.markdown) {
    if (console.json())
      fail(ErrorKind::usage, "--markdown and --json are two forms of the same; give one of them");
    console.result(markdown(topics));
    return 0;
  }
  if (!list.topic.empty() && list.name.empty() && !is_topic(topics, list.topic)) {
    print_entries(topics, list.topic, console);
    return 0;
  }
  std::vector<Topic> chosen = topics;
  if (!list.topic.empty()) chosen = {find_named(topics, list.topic, "topic")};
  if (!list.name.empty()) {
    const CatalogueEntry& entry = find_named(chosen.front().entries, list.name, "name");
    console.result(console.json() ? json_text(to_json(entry)) : text(entry));
    return 0;
  }
  Json json = Json::object();
  std::string out;
  for (const Topic& topic : chosen) {
    out += (out.empty() ? "" : "\n") + text(topic);
    for (const CatalogueEntry& entry : topic.entries) json[topic.name].push_back(to_json(entry));
  }
  console.result(console.json() ? json_text(json) : out);
  return 0;
}

std::function<int(Console&)> setup(Args& args) {
  auto list = std::make_shared<List>();
  args.positional("TOPIC", list->topic,
                  "What to list: " + topic_names() + ", or the name of an entry alone; default: all", false);
  args.positional("NAME", list->name,
                  "Entry of the topic to show with its purpose, source and parameters; default: all of them, "
                  "by their purpose",
                  false);
  args.flag("--markdown", list->markdown, "Prints the whole reference as Markdown");
  return [list](Console& console) { return run(*list, console); };
}

}  // namespace

const Command& declaration() {
  static const Command command{
      .about = {.name = "list", .doc = "List what the program knows, with every parameter"},
      .examples =
          "  tafoni list landforms\n  tafoni list karst\n"
          "  tafoni list --markdown > reference.md",
      .setup = setup,
  };
  return command;
}

}  // namespace tafoni::cli::command_list
