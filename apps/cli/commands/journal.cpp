// tafoni journal: checks a journal of either kind, prints what it holds, and saves what stands before a
// damage.
#include "tafoni/runtime/journal.h"

#include <memory>
#include <set>

#include "command.h"
#include "command_files.h"
#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "tafoni/core/error.h"
#include "tafoni/scene/sculpt/journal.h"

namespace tafoni::cli::command_journal {
namespace {

using Json = nlohmann::ordered_json;
namespace fs = std::filesystem;

/// What a journal holds, in both forms.
struct Report {
  Json json = {};
  std::string text = {};
  std::string damage = {};
  std::size_t standing = 0;
};

Json list_of(Vec3d p) {
  return {p.x, p.y, p.z};
}

Json tool_json(const runtime::ToolUse& use) {
  constexpr const char* kinds[] = {"sphere", "capsule", "box", "hull"};
  const volume::ToolData data = use.tool.data();
  Json out{{"does", use.edit == volume::Edit::remove ? "remove" : "add"},
           {"tool", kinds[static_cast<std::size_t>(data.kind)]},
           {"points", Json::array()}};
  for (const Vec3d p : data.points) out["points"].push_back(list_of(p));
  if (!data.sizes.empty()) out["sizes"] = data.sizes;
  return out;
}

Json operation_json(const runtime::Message& message) {
  struct Describe {
    Json operator()(const runtime::ToolUse& use) const { return tool_json(use); }
    Json operator()(const runtime::Explosion& e) const {
      return {{"does", "explode"}, {"at", list_of(e.center)}, {"radius", e.radius}, {"energy", e.energy}};
    }
    Json operator()(const runtime::Radial& r) const {
      return {{"does", "change"}, {"at", list_of(r.center)}, {"radius", r.radius}, {"change", r.change}};
    }
    Json operator()(const runtime::Rewind& r) const { return {{"does", "rewind"}, {"version", r.version}}; }
  };
  try {
    return std::visit(Describe(), runtime::decode(message));
  } catch (const Error& error) {
    return {{"does", "nothing"}, {"because", error.what()}};
  }
}

/// "does=explode at=[1,2,3] radius=4.0".
std::string operation_text(const Json& operation) {
  std::string out;
  for (const auto& [name, value] : operation.items())
    out += fmt::format("{}{}{}", out.empty() ? "" : " ", name == "does" ? "" : name + "=",
                       value.is_string() ? value.get<std::string>() : value.dump());
  return out;
}

/// Lists the edits in one of the forms alone, for there may be millions.
Report edits_report(const std::string& file, const std::string& to, bool as_json) {
  const runtime::JournalContents journal = runtime::survey_journal(file);
  Report out{.damage = journal.damage, .standing = journal.edits.size()};
  if (!to.empty() && !runtime::make_journal(to, journal.base, journal.edits))
    fail(ErrorKind::usage, "{}: exists already; give a new name to save what stands", to);
  const std::string base = fmt::format("{:016x}", journal.base);
  out.json = {{"file", file},
              {"kind", "edits"},
              {"base", base},
              {"damage", journal.damage},
              {"unfinished_bytes", journal.damage.empty() ? journal.torn : 0},
              {"edits", Json::array()}};
  out.text = fmt::format("edits of the terrain {}: {}\n", base, journal.edits.size());
  for (std::size_t i = 0; i < journal.edits.size(); ++i) {
    const Json operation = operation_json(journal.edits[i]);
    if (as_json) {
      out.json["edits"].push_back({{"edit", i + 1}});
      out.json["edits"].back().update(operation);
    } else {
      out.text += fmt::format("{:>6} {}\n", i + 1, operation_text(operation));
    }
  }
  if (journal.damage.empty() && journal.torn > 0)
    out.text += fmt::format("{} bytes of an edit that a crash left unfinished follow; it is left out\n",
                            journal.torn);
  return out;
}

Report strokes_report(const std::string& file, const std::string& to) {
  const scene::Journal::Remains journal = scene::Journal::salvage(file, to);
  Report out{.damage = journal.damage, .standing = journal.history.size()};
  std::set<std::int64_t> applied;
  for (const auto& entry : journal.strokes) applied.insert(entry.id);
  out.json = {{"file", file},
              {"kind", "strokes"},
              {"scene", journal.scene},
              {"damage", journal.damage},
              {"strokes", Json::array()}};
  out.text =
      fmt::format("strokes{}: {} applied, {} undone\n", journal.scene.empty() ? "" : " of " + journal.scene,
                  applied.size(), journal.history.size() - applied.size());
  for (const auto& entry : journal.history) {
    const std::string stroke = scene::to_text(*entry.stroke);
    const bool acts = applied.contains(entry.id);
    out.text += fmt::format("{:>6} {:<6} {}\n", entry.id,
                            !acts         ? "undone"
                            : entry.muted ? "muted"
                                          : "",
                            stroke);
    out.json["strokes"].push_back({{"id", entry.id},
                                   {"after", entry.before},
                                   {"applied", acts},
                                   {"muted", entry.muted},
                                   {"stroke", stroke}});
  }
  return out;
}

int run(const std::string& file, const std::string& to, Console& console) {
  if (!to.empty()) check_output(to, {file});
  Report report =
      runtime::is_journal(file) ? edits_report(file, to, console.json()) : strokes_report(file, to);
  if (console.json())
    console.result(report.json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n");
  else
    console.result(report.text);
  if (report.damage.empty()) return 0;
  if (to.empty())
    fail(ErrorKind::input, "{}; {} stand before the damage, and --salvage NEW saves them", report.damage,
         report.standing);
  console.warn(
      fmt::format("{}; {} that stand before the damage are in {}", report.damage, report.standing, to));
  return 0;
}

std::function<int(Console&)> setup(Args& args) {
  struct Options {
    std::string file, to;
  };
  auto o = std::make_shared<Options>();
  args.positional("FILE", o->file, "Path of a journal: of a sculpt layer's strokes, or of a game's edits");
  args.text("--salvage", "NEW", o->to,
            "Journal to write with all that stands before the first damage; it must be a new file");
  return [o](Console& console) { return run(o->file, o->to, console); };
}

}  // namespace

const Command& declaration() {
  static const Command command{
      .about = {.name = "journal", .doc = "Check a journal of strokes or of edits, print and salvage it"},
      .examples =
          "  tafoni journal scene.sculpt.journal\n"
          "  tafoni journal game.edits --json\n"
          "  tafoni journal scene.sculpt.journal --salvage saved.journal",
      .setup = setup,
  };
  return command;
}

}  // namespace tafoni::cli::command_journal
