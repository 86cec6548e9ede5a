#include "tafoni/scene/sculpt/impl/stroke_files.h"

#include <utility>

#include <fmt/format.h>

#include "tafoni/io/csv.h"
#include "tafoni/scene/sculpt/impl/own_journal.h"
#include "tafoni/scene/sculpt/journal.h"

namespace tafoni::scene::impl {
namespace {

std::string text_value(const Layer& layer, std::string_view name) {
  const auto found = layer.values.find(name);
  return found == layer.values.end() ? std::string() : std::get<std::string>(found->second);
}

}  // namespace

StrokeFiles stroke_files(const Layer& layer) {
  return {text_value(layer, "strokes"), text_value(layer, "journal")};
}

void set_journal(Layer& layer, const std::string& path) {
  layer.values["journal"] = path;
}

std::vector<Slot> read_strokes(const std::filesystem::path& file) {
  std::vector<Slot> out;
  for (Stroke& stroke : parse_strokes(io::read_text(file), file.string()))
    out.push_back({std::make_shared<Stroke>(std::move(stroke)), false});
  return out;
}

std::vector<Slot> slots_of(const Document& document, const Layer& layer, Progress& progress) {
  const StrokeFiles files = stroke_files(layer);
  std::vector<Slot> out;
  if (!files.strokes.empty()) out = read_strokes(document.resolve(files.strokes));
  if (!files.journal.empty()) {
    const Journal journal = Journal::open(document.resolve(files.journal));
    if (const auto other = document.file.empty() ? std::nullopt : other_scene(journal, document.file))
      progress.warn(
          fmt::format("{}: its strokes are those of {}, and change with them until a stroke here "
                      "makes a copy of them",
                      document.file, other->string()));
    for (const Journal::Entry& entry : journal.strokes()) out.push_back({entry.stroke, entry.muted});
  }
  return out;
}

}  // namespace tafoni::scene::impl
