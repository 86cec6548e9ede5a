// Strokes as text: one line a stroke, NAME=VALUE after the brush, or an array of JSON objects. Names and
// values are checked against the brush's declaration, and a default is not written.
#include "tafoni/scene/sculpt/stroke.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include <nlohmann/json.hpp>

#include "tafoni/core/error.h"
#include "tafoni/scene/document/impl/types.h"
#include "tafoni/scene/sculpt/brush.h"

namespace tafoni::scene {
namespace {

using Words = std::vector<std::pair<std::string, std::string>>;

/// Cuts at blanks outside of quotes into NAME=VALUE; the first word stands alone.
Words words(std::string_view line, std::string_view where) {
  Words out;
  std::string word;
  bool quoted = false, any = false;
  const auto flush = [&] {
    if (!any) return;
    const auto equals = word.find('=');
    if (out.empty())
      out.emplace_back(word, "");
    else if (equals == std::string::npos)
      fail(ErrorKind::usage, "{}: \"{}\" must be NAME=VALUE, as in radius=5", where, word.substr(0, 60));
    else
      out.emplace_back(word.substr(0, equals), word.substr(equals + 1));
    word.clear();
    any = false;
  };
  for (const char c : line) {
    if (c == '"') {
      quoted = !quoted;
      any = true;
    } else if (!quoted && (c == ' ' || c == '\t' || c == '\r' || c == '\n')) {
      flush();
    } else {
      word += c;
      any = true;
    }
  }
  if (quoted) fail(ErrorKind::usage, "{}: a quote is not closed", where);
  flush();
  return out;
}

std::vector<Vec3d> parse_points(std::string_view text, std::string_view where) {
  std::vector<Vec3d> out;
  const auto wrong = [&](std::string_view point) {
    fail(ErrorKind::usage, "{}: at: \"{}\" must be X,Y,Z in metres; several points are joined by /", where,
         point.substr(0, 60));
  };
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find('/', begin), text.size());
    const std::string_view point = text.substr(begin, end - begin);
    double v[3];
    const char* at = point.data();
    const char* const last = at + point.size();
    for (int c = 0; c < 3; ++c) {
      const auto [stop, code] = std::from_chars(at, last, v[c]);
      const bool more = c < 2;
      if (code != std::errc() || !std::isfinite(v[c]) || (more ? stop == last || *stop != ',' : stop != last))
        wrong(point);
      at = stop + (more ? 1 : 0);
    }
    out.push_back({v[0], v[1], v[2]});
    begin = end + 1;
  }
  return out;
}

const ParamInfo& param(const std::vector<ParamInfo>& infos, std::string_view name, const Stroke& stroke,
                       std::string_view where) {
  if (std::none_of(infos.begin(), infos.end(), [&](const ParamInfo& i) { return i.name == name; })) {
    std::vector<std::string> known = {"at"};
    for (const ParamInfo& info : infos) known.push_back(info.name);
    std::string list;
    for (const std::string& k : known) list += (list.empty() ? "" : ", ") + k;
    const std::string near = nearest(name.substr(0, 100), known);
    fail(ErrorKind::usage, "{}: the brush {} has no \"{}\"; {}", where, stroke.brush, name.substr(0, 60),
         near.empty() ? "known are " + list : fmt::format("did you mean \"{}\"?", near));
  }
  return find_param(infos, name, where);
}

void check(const Stroke& stroke, const BrushType& brush, std::string_view where) {
  const std::size_t n = stroke.points.size();
  if (n < brush.min_points || n > brush.max_points) {
    const std::string wanted = brush.min_points == brush.max_points ? fmt::format("{}", brush.min_points)
                               : n < brush.min_points ? fmt::format("at least {}", brush.min_points)
                                                      : fmt::format("at most {}", brush.max_points);
    fail(ErrorKind::usage, "{}: the brush {} takes {} point{}, not {}; give them as at=X,Y,Z/X,Y,Z", where,
         brush.about.name, wanted, wanted.ends_with(" 1") || wanted == "1" ? "" : "s", n);
  }
  params_of_brush(brush, stroke.values);  // throws where what they depend on is unknown
  for (const auto& [name, value] : stroke.values)
    if (const auto* text = std::get_if<std::string>(&value);
        text && text->find_first_of("\"\n\r") != std::string::npos)
      fail(ErrorKind::usage, "{}: {} has a quote or a line break in it", where, name);
  for (const Vec3d p : stroke.points)
    if (!(std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}) <= 1e9))
      fail(ErrorKind::usage, "{}: the point {},{},{} is no position in metres", where, p.x, p.y, p.z);
}

/// Reads NAME with whatever `value` makes of its parameter; a parameter may depend on those before it.
template <class F>
void assign_one(Stroke& stroke, const BrushType& brush, std::string_view name, std::string_view where,
                F&& value) {
  const auto infos = impl::join_params(stroke_params(), params_of_brush(brush, stroke.values));
  const ParamInfo& info = param(infos, name, stroke, where);
  impl::store(stroke_params(), &stroke, stroke.values, info, value(info));
}

std::vector<Vec3d> json_points(const nlohmann::json& at, std::string_view where) {
  const auto wrong = [&]() {
    fail(ErrorKind::usage, "{}: \"at\" must be [x, y, z] or a list of such", where);
  };
  if (!at.is_array() || at.empty()) wrong();
  std::vector<Vec3d> out;
  const auto point = [&](const nlohmann::json& p) {
    if (!p.is_array() || p.size() != 3 ||
        !std::all_of(p.begin(), p.end(), [](const nlohmann::json& v) { return v.is_number(); }))
      wrong();
    out.push_back({p[0].get<double>(), p[1].get<double>(), p[2].get<double>()});
  };
  if (at[0].is_array())
    for (const nlohmann::json& p : at) point(p);
  else
    point(at);
  return out;
}

Value json_value(const nlohmann::json& v, std::string_view name, std::string_view where) {
  if (v.is_boolean()) return v.get<bool>();
  if (v.is_number_integer()) return v.get<std::int64_t>();
  if (v.is_number()) return v.get<double>();
  if (v.is_string()) return v.get<std::string>();
  if (v.is_array() && std::all_of(v.begin(), v.end(), [](const nlohmann::json& n) { return n.is_number(); }))
    return v.get<std::vector<double>>();
  fail(ErrorKind::usage, "{}: \"{}\" must be text, a number or a list of numbers", where, name);
}

Stroke json_stroke(const nlohmann::json& object, std::string_view where) {
  if (!object.is_object()) fail(ErrorKind::usage, "{}: must be an object with \"brush\" and \"at\"", where);
  const auto name = object.find("brush");
  if (name == object.end() || !name->is_string())
    fail(ErrorKind::usage, "{}: needs \"brush\", the name of one", where);
  Stroke stroke;
  stroke.brush = name->get<std::string>();
  const BrushType& brush = find_brush(stroke.brush);
  // What decides which other parameters there are comes first.
  for (const bool first : {true, false})
    for (const auto& [key, value] : object.items()) {
      const bool declared = std::any_of(brush.about.params.begin(), brush.about.params.end(),
                                        [k = key](const ParamInfo& i) { return i.name == k; });
      if (key == "brush" || declared != first) continue;
      if (key == "at") {
        stroke.points = json_points(value, where);
        continue;
      }
      assign_one(stroke, brush, key, where, [&, v = json_value(value, key, where)](const ParamInfo& info) {
        return check_value(info, v, where);
      });
    }
  check(stroke, brush, where);
  return stroke;
}

std::vector<Stroke> parse_json(std::string_view text, std::string_view name) {
  const nlohmann::json root = nlohmann::json::parse(text, nullptr, false);
  if (root.is_discarded()) fail(ErrorKind::input, "{}: is not valid JSON", name);
  std::vector<Stroke> out;
  const auto one = [&](const nlohmann::json& object) {
    try {
      out.push_back(json_stroke(object, fmt::format("{}: stroke {}", name, out.size() + 1)));
    } catch (const Error& error) {
      throw Error(ErrorKind::input, error.what());
    }
  };
  if (root.is_array())
    for (const nlohmann::json& object : root) one(object);
  else
    one(root);
  return out;
}

std::string shown(const Value& value) {
  if (const auto* list = std::get_if<std::vector<double>>(&value)) {
    std::string out;
    for (const double v : *list) out += fmt::format("{}{}", out.empty() ? "" : ",", v);
    return out;
  }
  if (const auto* text = std::get_if<std::string>(&value))
    return text->find_first_of(" \t=") == std::string::npos && !text->empty() ? *text : "\"" + *text + "\"";
  return to_toml(value);
}

}  // namespace

const std::vector<ParamInfo>& stroke_params() {
  static const std::vector<ParamInfo> params =
      ParamTable<Stroke>()
          .choice("mode", &Stroke::mode, {"carve", "add"},
                  "What the stroke does: carve takes rock away, add puts some there")
          .real("radius", &Stroke::radius, "m", 0.01, 1e4,
                "How far the new surface is from the stroke's skeleton: the radius of a ball or a tunnel")
          .real("strength", &Stroke::strength, "", 0.01, 1,
                "How firmly the stroke acts: 1 cuts through solid rock and fills open air, less only dents "
                "the surface")
          .real("roughness", &Stroke::roughness, "", 0, 0.6,
                "How far noise displaces the walls at most, in radii: more makes them rougher, 0 leaves them "
                "smooth")
          .integer("seed", &Stroke::seed, "", 0, std::int64_t{1} << 53,
                   "Varies what is random in the stroke: another seed makes another stroke of the same kind");
  return params;
}

Stroke parse_stroke(std::string_view line, std::string_view where) {
  const Words parts = words(line, where);
  if (parts.empty())
    fail(ErrorKind::usage, "{}: is empty; write a brush and its points, as in sphere at=10,20,5", where);
  Stroke stroke;
  stroke.brush = parts.front().first;
  const BrushType& brush = find_brush(stroke.brush);
  for (std::size_t i = 1; i < parts.size(); ++i) {
    const auto& [name, text] = parts[i];
    if (name == "at") {
      const auto more = parse_points(text, where);
      stroke.points.insert(stroke.points.end(), more.begin(), more.end());
    } else {
      // Text keeps the blanks that stand in its quotes, which JSON can say too.
      assign_one(stroke, brush, name, where, [&, &value = text](const ParamInfo& info) {
        return info.kind == ValueKind::text ? check_value(info, value, where)
                                            : parse_value(info, value, where);
      });
    }
  }
  check(stroke, brush, where);
  return stroke;
}

std::string to_text(const Stroke& stroke) {
  const BrushType& brush = find_brush(stroke.brush);
  std::string out = stroke.brush + " at=";
  for (std::size_t i = 0; i < stroke.points.size(); ++i) {
    const Vec3d p = stroke.points[i];
    out += fmt::format("{}{},{},{}", i == 0 ? "" : "/", p.x, p.y, p.z);
  }
  for (const ParamInfo& info : impl::join_params(stroke_params(), params_of_brush(brush, stroke.values)))
    if (const Value value = impl::load_value(stroke_params(), &stroke, stroke.values, info);
        value != info.init)
      out += fmt::format(" {}={}", info.name, shown(value));
  return out;
}

std::string shown_stroke(const Stroke& stroke) {
  constexpr std::size_t shown = 100;
  const std::string text = to_text(stroke);
  return text.size() > shown ? text.substr(0, shown) + "…" : text;
}

std::vector<Stroke> parse_strokes(std::string_view text, std::string_view name) {
  const auto first = text.find_first_not_of(" \t\r\n");
  if (first != std::string_view::npos && (text[first] == '[' || text[first] == '{'))
    return parse_json(text, name);
  std::vector<Stroke> out;
  std::size_t number = 0;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    const std::string_view line = text.substr(begin, end - begin);
    begin = end + 1;
    ++number;
    const auto start = line.find_first_not_of(" \t\r");
    if (start == std::string_view::npos || line[start] == '#') continue;
    const std::string where = fmt::format("{}:{}", name, number);
    try {
      out.push_back(parse_stroke(line, where));
    } catch (const Error& error) {
      const std::string_view what = error.what();
      if (what.starts_with(where)) throw Error(ErrorKind::input, error.what());
      fail(ErrorKind::input, "{}: {}", where, what);
    }
  }
  return out;
}

}  // namespace tafoni::scene
