// tafoni sculpt: adds strokes to a scene's journal, takes them back, mutes or lists them.
#include <algorithm>
#include <memory>

#include "command.h"
#include "scene_run.h"
#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "tafoni/core/error.h"
#include "tafoni/core/params.h"
#include "tafoni/io/csv.h"
#include "tafoni/scene/session.h"

namespace tafoni::cli::command_sculpt {
namespace {

using Json = nlohmann::ordered_json;

struct Sculpt {
  std::string scene_file, layer, new_layer, strokes_file, write;
  std::vector<std::string> strokes;
  std::optional<std::int64_t> undo, redo, go_to, mute, unmute;
  bool list = false, all = false;
  SceneOptions scene;
  OutputOptions outputs;
};

std::vector<scene::Stroke> strokes_of(const Sculpt& s) {
  std::vector<scene::Stroke> out;
  for (const std::string& text : s.strokes)
    out.push_back(scene::parse_stroke(text, fmt::format("--stroke \"{}\"", text)));
  if (s.strokes_file.empty()) return out;
  const auto more = scene::parse_strokes(io::read_text(s.strokes_file),
                                         s.strokes_file == "-" ? "standard input" : s.strokes_file);
  out.insert(out.end(), more.begin(), more.end());
  return out;
}

void print_list(const std::vector<scene::Journal::Entry>& strokes, Console& console) {
  if (console.json()) {
    Json list = Json::array();
    for (const auto& entry : strokes)
      list.push_back({{"id", entry.id}, {"muted", entry.muted}, {"stroke", scene::to_text(*entry.stroke)}});
    console.result(json_text(list));
    return;
  }
  std::string out;
  for (const auto& entry : strokes)
    out += fmt::format("{:>6} {} {}\n", entry.id > 0 ? std::to_string(entry.id) : "file",
                       entry.muted ? "muted" : "     ", scene::to_text(*entry.stroke));
  console.result(out);
}

std::string as_file(const std::vector<scene::Journal::Entry>& strokes) {
  std::string out =
      "# Strokes of a sculpt layer, one a line; strokes = \"THIS FILE\" in the layer reads them.\n";
  for (const auto& entry : strokes)
    if (!entry.muted) out += scene::to_text(*entry.stroke) + "\n";
  return out;
}

/// The layer that strokes go to or are asked of. A name that no layer has is a slip of the pen.
std::size_t layer_of(const Sculpt& s, scene::Session& session) {
  const auto& layers = session.document().layers;
  std::vector<std::string> known;
  for (const scene::Layer& layer : layers) known.push_back(scene::shown_name(layer));
  const auto has = [&](const std::string& name) {
    return std::find(known.begin(), known.end(), name) != known.end();
  };
  if (!s.new_layer.empty()) {
    if (!s.layer.empty()) fail(ErrorKind::usage, "--layer and --new-layer exclude each other");
    if (has(s.new_layer))
      fail(ErrorKind::usage, "--new-layer {}: {} has a layer of this name; give --layer {}", s.new_layer,
           s.scene_file, s.new_layer);
    return session.sculpt_layer(s.new_layer);
  }
  if (s.layer.empty() || has(s.layer)) return session.sculpt_layer(s.layer);
  const std::string near = nearest(s.layer, known);
  fail(ErrorKind::usage, "--layer {}: {} has no layer of this name; {}give --new-layer {} to make one",
       s.layer, s.scene_file, near.empty() ? "" : fmt::format("did you mean \"{}\"? Or ", near), s.layer);
}

void check_ids(const Sculpt& s, scene::Session& session, std::size_t layer) {
  const bool asked = s.go_to || s.mute || s.unmute;
  const auto history = asked && !session.missing_journal(layer) ? session.history(layer)
                                                                : std::vector<scene::Journal::Entry>();
  for (const auto& [name, id] : {std::pair{"--go-to", s.go_to}, {"--mute", s.mute}, {"--unmute", s.unmute}}) {
    const auto is_it = [id = id](const auto& entry) { return entry.id == *id; };
    if (id && *id != 0 && std::none_of(history.begin(), history.end(), is_it))
      fail(ErrorKind::usage, "{} {}: the layer has no stroke {}; see --all", name, *id, *id);
  }
}

/// What changes the journal, in the order in which --help names it. What was done goes to `done`.
void edit(const Sculpt& s, scene::Session& session, std::size_t layer,
          const std::vector<scene::Stroke>& strokes, bool changes, Json& done, Console& console) {
  const auto other = changes ? session.borrowed_from(layer) : std::nullopt;
  if (const auto missing = session.missing_journal(layer); missing && !strokes.empty())
    console.warn(
        fmt::format("{} was missing and is begun anew; earlier strokes are not there", missing->string()));
  const auto say = [&](const char* what, std::size_t n) {
    done[what] = n;
    if (!console.json()) console.print(fmt::format("{}  {} stroke{}\n", what, n, n == 1 ? "" : "s"));
  };
  if (s.undo) say("undone", session.undo(layer, *s.undo));
  if (s.redo) say("redone", session.redo(layer, *s.redo));
  if (s.go_to) {
    session.go_to(layer, *s.go_to);
    say("applied", session.strokes(layer).size());
  }
  const auto mute = [&](const char* what, std::int64_t id, bool muted) {
    const bool changed = session.mute_stroke(layer, id, muted);
    done[what] = changed ? 1 : 0;
    if (!console.json())
      console.print(fmt::format("{}  stroke {}{}\n", what, id, changed ? "" : ", as it was before"));
  };
  if (s.mute) mute("muted", *s.mute, true);
  if (s.unmute) mute("unmuted", *s.unmute, false);
  if (!strokes.empty()) {
    session.stroke(layer, strokes);
    say("stored", strokes.size());
  }
  if (other && !console.json())
    console.print(fmt::format("copied  the strokes of {}, which stay there as they were\n", other->string()));
}

/// Before anything is changed: an output that cannot be written must not leave half the work done.
void check_files(const Sculpt& s, const scene::Session& session) {
  CommandFiles files;
  files.reads(s.strokes_file);
  files.writes(s.write);
  if (s.outputs.any()) return check_outputs(session.document(), s.scene_file, s.outputs, files);
  files.reads(s.scene_file);
  for (const auto& input : inputs_of(session.document())) files.reads(input);
}

int run(const Sculpt& s, Console& console) {
  if (!is_scene_file(s.scene_file))
    fail(ErrorKind::usage,
         "{}: strokes are kept with a scene file; make one with tafoni amplify --save-scene", s.scene_file);
  const bool changes =
      !s.strokes.empty() || !s.strokes_file.empty() || s.undo || s.redo || s.go_to || s.mute || s.unmute;
  const bool builds = s.outputs.any();
  if (!changes && !builds && !s.list && !s.all && s.write.empty())
    fail(ErrorKind::usage,
         "nothing to do: give --stroke, --strokes, --undo, --redo, --go-to, --mute, --unmute, --list, --all, "
         "--write "
         "or -o FILE");
  if (changes && s.outputs.dry_run)
    fail(ErrorKind::usage, "--dry-run: writes nothing, and strokes are kept; leave out one of them");
  if (console.json() && (s.list || s.all) && builds)
    fail(ErrorKind::usage,
         "--json: prints the strokes or the report of a build; leave out --list or the outputs");
  if (!builds) s.scene.check_none("is for what is built; give -o FILE, too");
  const auto strokes = strokes_of(s);
  scene::Session session = scene::Session::open(s.scene_file);
  const std::size_t layer = layer_of(s, session);
  check_files(s, session);
  // What is refused is refused before anything is changed.
  if (builds) {
    scene::Document trial = session.document();
    s.scene.apply(trial);
  }
  session.check_strokes(strokes);
  check_ids(s, session, layer);
  Json done = Json::object();
  edit(s, session, layer, strokes, changes, done, console);
  if (console.json() && !s.list && !s.all && !builds) console.result(json_text(done));
  if (s.list || s.all) print_list(s.all ? session.history(layer) : session.strokes(layer), console);
  if (!s.write.empty()) {
    check_files(s, session);  // the layer's journal may be new
    const auto written = session.strokes(layer);
    write_file(s.write, as_file(written));
    const auto acting = std::count_if(written.begin(), written.end(), [](const auto& e) { return !e.muted; });
    if (!console.json())
      console.print(fmt::format("wrote  {} stroke{} to {}\n", acting, acting == 1 ? "" : "s", s.write));
  }
  if (!builds) return 0;
  scene::Document document = session.document();
  s.scene.apply(document);
  run_scene(document, s.scene_file, s.outputs, console);
  return 0;
}

std::function<int(Console&)> setup(Args& args) {
  auto s = std::make_shared<Sculpt>();
  args.positional("SCENE", s->scene_file, "Path of a scene file (.toml)");
  args.text("--layer", "NAME", s->layer,
            "Name of the sculpt layer; default: the last one, which is made where there is none");
  args.text("--new-layer", "NAME", s->new_layer, "Name of a sculpt layer to add after the others");
  args.group("Strokes");
  args.texts(
      "--stroke", "STROKE", s->strokes,
      "Stroke to add: a brush, points and parameters, as in \"sphere at=10,20,5 radius=4\"; may be repeated");
  args.text("--strokes", "FILE", s->strokes_file,
            "Path of a file of strokes to add, one a line or JSON; - reads standard input");
  args.integer("--undo", "N", s->undo, 1, 1000000000, "Takes back the last N strokes");
  args.integer("--redo", "N", s->redo, 1, 1000000000, "Brings back N strokes that were taken back");
  args.integer("--go-to", "ID", s->go_to, 0, std::int64_t{1} << 53,
               "Goes to the moment when stroke ID was the last, undone or not; 0 is the beginning");
  args.integer("--mute", "ID", s->mute, 1, std::int64_t{1} << 53,
               "Leaves the stroke ID out without forgetting it");
  args.integer("--unmute", "ID", s->unmute, 1, std::int64_t{1} << 53, "Lets the stroke ID act again");
  args.flag("--list", s->list, "Prints the layer's strokes with their ids");
  args.flag("--all", s->all, "Prints every stroke ever made, those that were undone, too");
  args.text("--write", "FILE", s->write,
            "Text file to write the layer's strokes to, which a layer can take as strokes = \"FILE\"");
  s->scene.declare(args);
  s->outputs.declare(args);
  return [s](Console& console) { return run(*s, console); };
}

}  // namespace

const Command& declaration() {
  static const Command command{
      .about = {.name = "sculpt", .doc = "Add strokes to a scene, or take them back"},
      .examples =
          "  tafoni sculpt scene.toml --stroke \"sphere at=120,80,14 radius=6\" --preview view.png\n"
          "  tafoni sculpt scene.toml --stroke \"cave at=120,80,14/150,95,12 radius=3 chambers=1\"\n"
          "  tafoni sculpt scene.toml --undo 2 --list",
      .setup = setup,
  };
  return command;
}

}  // namespace tafoni::cli::command_sculpt
