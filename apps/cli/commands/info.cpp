// tafoni info: what an elevation model, a volume or a scene file holds, without building anything.
#include <memory>

#include "command.h"
#include "scene_run.h"
#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "tafoni/io/dem.h"
#include "tafoni/io/format.h"
#include "tafoni/io/volume_file.h"

namespace tafoni::cli::command_info {
namespace {

using Json = nlohmann::ordered_json;

Json dem_json(const std::string& file, const io::DemInfo& d) {
  return {{"file", file},
          {"driver", d.driver},
          {"type", d.type},
          {"width", d.width},
          {"height", d.height},
          {"bands", d.bands},
          {"band", d.band},
          {"crs", d.crs},
          {"unit", d.unit},
          {"pixel", {d.dx, d.dy}},
          {"angle_rad", d.angle},
          {"north_up", d.north_up},
          {"west", d.west},
          {"south", d.south},
          {"east", d.east},
          {"north", d.north},
          {"height_unit", d.height_unit},
          {"scale", d.scale},
          {"offset", d.offset},
          {"lowest_m", d.lowest},
          {"highest_m", d.highest},
          {"missing", d.missing},
          {"step_m", d.step},
          {"notes", d.notes}};
}

std::string dem_text(const std::string& file, const io::DemInfo& d) {
  std::string out;
  const auto row = [&](const char* name, const std::string& value) {
    out += fmt::format("{:<12} {}\n", name, value);
  };
  row("file", file);
  row("format", fmt::format("{}, {}, band {} of {}", d.driver, d.type, d.band, d.bands));
  row("size", fmt::format("{} x {} pixels of {:.6g} x {:.6g} {}{}", d.width, d.height, d.dx, d.dy, d.unit,
                          d.north_up ? "" : ", not north-up"));
  row("CRS", d.crs.empty() ? "unknown" : d.crs);
  row("extent", fmt::format("west {:.10g}, south {:.10g}, east {:.10g}, north {:.10g}", d.west, d.south,
                            d.east, d.north));
  row("heights", fmt::format("{:.6g} to {:.6g} m (stored in {})", d.lowest, d.highest, d.height_unit));
  row("missing", fmt::format("{:.3g} %", 100 * d.missing));
  if (d.step > 0) row("steps", fmt::format("{:.3g} m", d.step));
  for (const std::string& note : d.notes) row("note", note);
  return out;
}

Json values_json(const Values& values) {
  Json out = Json::object();
  for (const auto& [name, value] : values)
    std::visit([&, &key = name](const auto& v) { out[key] = v; }, value);
  return out;
}

Json volume_json(const std::string& file, const io::VolumeInfo& v) {
  const Vec3d lo = v.origin + v.frame.box().lo, hi = v.origin + v.frame.box().hi;
  Json out = {{"file", file},
              {"name", v.metadata.name},
              {"crs", v.metadata.crs},
              {"samples", {v.frame.size.x, v.frame.size.y, v.frame.size.z}},
              {"spacing_m", v.frame.spacing},
              {"precision", v.precision == volume::Precision::half ? "half" : "single"},
              {"low", {lo.x, lo.y, lo.z}},
              {"high", {hi.x, hi.y, hi.z}},
              {"least_m", v.values.lo},
              {"greatest_m", v.values.hi},
              {"chunks", v.chunks},
              {"full_chunks", v.full_chunks},
              {"memory_bytes", v.bytes}};
  out["generator"] = values_json(v.metadata.generator);
  return out;
}

std::string volume_text(const Json& v) {
  std::string out;
  const auto row = [&](const char* name, const std::string& value) {
    out += fmt::format("{:<12} {}\n", name, value);
  };
  const auto point = [](const Json& p) {
    return fmt::format("{:.10g} {:.10g} {:.10g}", p[0].get<double>(), p[1].get<double>(), p[2].get<double>());
  };
  row("file", v["file"]);
  row("volume", fmt::format("{} x {} x {} samples of {:g} m, {} precision", v["samples"][0].get<int>(),
                            v["samples"][1].get<int>(), v["samples"][2].get<int>(),
                            v["spacing_m"].get<double>(), v["precision"].get<std::string>()));
  row("CRS", v["crs"].get<std::string>().empty() ? "unknown" : v["crs"].get<std::string>());
  row("low corner", point(v["low"]));
  row("high corner", point(v["high"]));
  row("values", fmt::format("{:.6g} to {:.6g} m, positive in rock", v["least_m"].get<double>(),
                            v["greatest_m"].get<double>()));
  row("memory", fmt::format("{}, {} of {} chunks hold more than one value", as_bytes(v["memory_bytes"]),
                            with_commas(v["full_chunks"]), with_commas(v["chunks"])));
  if (!v["generator"].empty())
    row("made by", v["generator"].dump(-1, ' ', false, Json::error_handler_t::replace));
  return out;
}

Json settings_json(const std::vector<ParamInfo>& infos, const void* object) {
  Json out = Json::object();
  for (const ParamInfo& info : infos)
    std::visit([&](const auto& v) { out[info.name] = v; }, info.load(info, object));
  return out;
}

Json geology_json(const std::vector<scene::GeologySettings>& list) {
  Json out = Json::array();
  for (const scene::GeologySettings& g : list) {
    out.push_back({{"type", g.type}});
    out.back().update(settings_json(scene::geology_params(), &g));
    out.back().update(values_json(g.values));
    if (!g.of.empty()) out.back()["of"] = geology_json(g.of);
  }
  return out;
}

Json scene_json(const scene::Document& d) {
  Json out;
  out["scene"] = settings_json(scene::scene_params(), &d.scene);
  out["terrain"] = settings_json(scene::terrain_params(), &d.terrain);
  out["terrain"].update(values_json(d.terrain.values));
  out["geology"] = geology_json(d.geology);
  out["layers"] = Json::array();
  for (const auto& l : d.layers) {
    out["layers"].push_back({{"type", l.type}});
    out["layers"].back().update(settings_json(scene::layer_params(), &l.settings));
    out["layers"].back().update(values_json(l.values));
  }
  return out;
}

std::string list_text(const Values& values) {
  std::string out;
  for (const auto& [name, value] : values)
    out += fmt::format("{}{} = {}", out.empty() ? "" : ", ", name, to_toml(value));
  return out.empty() ? "defaults" : out;
}

std::string geology_text(const std::vector<scene::GeologySettings>& list, const std::string& indent) {
  std::string out;
  for (const scene::GeologySettings& g : list)
    out += fmt::format("{:<12} {}{}{}: {}\n", indent.empty() ? "geology" : "", indent, g.type,
                       g.name.empty() ? "" : " \"" + g.name + "\"", list_text(g.values)) +
           geology_text(g.of, indent + "  ");
  return out;
}

std::string scene_text(const scene::Document& d) {
  std::string out =
      fmt::format("scene        seed {}, voxel {}, boundary {}\n", d.scene.seed,
                  d.scene.voxel > 0 ? fmt::format("{:g} m", d.scene.voxel) : "automatic", d.scene.boundary);
  out += fmt::format("terrain      R = {:g} m, T = {:g} m, {}, {} distance{}\n", d.terrain.influence,
                     d.terrain.amplitude, d.terrain.interpolation, d.terrain.distance,
                     d.terrain.generator.empty() ? ""
                                                 : fmt::format(", generator {} ({})", d.terrain.generator,
                                                               list_text(d.terrain.values)));
  if (d.geology.empty()) out += "geology      default\n";
  out += geology_text(d.geology, "");
  for (const auto& l : d.layers) {
    out += fmt::format("layer        {}{}{}: {}\n", l.type,
                       l.settings.name.empty() ? "" : " \"" + l.settings.name + "\"",
                       l.settings.enabled ? "" : " (off)", list_text(l.values));
  }
  return out;
}

/// What a file of elevations or a volume holds, as JSON and as text.
std::pair<Json, std::string> source_of(const std::string& file, const io::DemOptions& options,
                                       Console& console) {
  if (io::can(file, io::Ability::read_volume)) {
    const Json json = volume_json(file, io::inspect_volume(file, console));
    return {json, volume_text(json)};
  }
  const io::DemInfo dem = io::inspect_dem(file, options, console);
  return {dem_json(file, dem), dem_text(file, dem)};
}

int run(const std::string& file, Console& console) {
  const auto print = [&](const Json& json, const std::string& text) {
    console.result(console.json() ? json_text(json) : text);
    return 0;
  };
  if (!is_scene_file(file)) {
    const auto [json, text] = source_of(file, {}, console);
    return print(json, text);
  }
  const scene::Document document = scene::load_scene(file);
  Json json = scene_json(document);
  std::string text = scene_text(document);
  if (!document.terrain.source.empty()) {
    const std::string source = document.resolve(document.terrain.source).string();
    const auto [own, lines] = source_of(source, scene::dem_options(document.terrain), console);
    json["source"] = own;
    text += lines;
  }
  return print(json, text);
}

std::function<int(Console&)> setup(Args& args) {
  auto file = std::make_shared<std::string>();
  args.positional("DEM|VOLUME|SCENE", *file, "Path of an elevation model, a volume or a scene file (.toml)");
  return [file](Console& console) { return run(*file, console); };
}

}  // namespace

const Command& declaration() {
  static const Command command{
      .about = {.name = "info",
                .doc = "Tell what an elevation model, a volume or a scene holds, and what would be fixed"},
      .examples = "  tafoni info dem.tif\n  tafoni info cave.vdb\n  tafoni info scene.toml --json",
      .setup = setup,
  };
  return command;
}

}  // namespace tafoni::cli::command_info
