// Values are checked against what a parameter allows, then stored where its member lies in the struct. Every
// message names where the value came from, the parameter, and what it may be.

#include "tafoni/core/params.h"

#include <algorithm>
#include <cmath>
#include <locale>
#include <sstream>
#include <utility>

#include "tafoni/core/byte_text.h"
#include "tafoni/core/error.h"

namespace tafoni {
namespace {

std::string trim(std::string_view text) {
  const auto first = text.find_first_not_of(" \t\r\n");
  if (first == std::string_view::npos) return {};
  const auto last = text.find_last_not_of(" \t\r\n");
  return std::string(text.substr(first, last - first + 1));
}

std::string lower(std::string_view text) {
  std::string out(text);
  for (char& c : out)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return out;
}

/// A decimal number and nothing else, whatever the locale.
std::optional<double> number(std::string_view text) {
  std::istringstream in{std::string(text)};
  in.imbue(std::locale::classic());
  double value = 0;
  if (!(in >> value) || in.peek() != std::istringstream::traits_type::eof()) return std::nullopt;
  return value;
}

std::optional<std::int64_t> whole(std::string_view text) {
  std::istringstream in{std::string(text)};
  in.imbue(std::locale::classic());
  std::int64_t value = 0;
  if (!(in >> value) || in.peek() != std::istringstream::traits_type::eof()) return std::nullopt;
  return value;
}

/// Null when a double is not exactly some 64-bit integer.
std::optional<std::int64_t> exact_integer(double v) {
  if (!(v >= -0x1p63 && v < 0x1p63) || v != std::floor(v)) return std::nullopt;
  return static_cast<std::int64_t>(v);
}

std::string with_unit(const std::string& text, const std::string& unit) {
  return unit.empty() ? text : text + " " + unit;
}

std::string range(const ParamInfo& info) {
  const bool low = std::isfinite(info.min), high = std::isfinite(info.max);
  if (low && high) return with_unit(fmt::format("{} to {}", info.min, info.max), info.unit);
  if (low) return with_unit(fmt::format("{}", info.min), info.unit) + " or more";
  if (high) return with_unit(fmt::format("{}", info.max), info.unit) + " or less";
  return info.unit.empty() ? "any number" : "any number of " + info.unit;
}

/// What kind of value the parameter takes, as the end of "must be …".
std::string wanted(const ParamInfo& info) {
  const bool bounded = std::isfinite(info.min) || std::isfinite(info.max);
  switch (info.kind) {
    case ValueKind::boolean:
      return "true or false";
    case ValueKind::integer:
      return bounded ? "a whole number, " + range(info) : "a whole number";
    case ValueKind::real:
      return bounded ? "a number, " + range(info) : "a number";
    case ValueKind::text:
      return "text";
    case ValueKind::choice:
      return "one of " + allowed(info);
    case ValueKind::numbers:
    case ValueKind::rows:
      return allowed(info);
  }
  return {};
}

[[noreturn]] void wrong_kind(const ParamInfo& info, std::string_view shown, std::string_view where) {
  fail(ErrorKind::usage, "{}: {} must be {}, not {}", where, info.name, wanted(info), shown);
}

void check_range(const ParamInfo& info, double v, std::string_view shown, std::string_view where) {
  if (std::isfinite(v) && v >= info.min && v <= info.max) return;
  fail(ErrorKind::usage, "{}: {} = {} is outside {}", where, info.name, shown, range(info));
}

Value checked_numbers(const ParamInfo& info, const Value& value, std::string_view where) {
  std::vector<double> list;
  if (const auto* many = std::get_if<std::vector<double>>(&value))
    list = *many;
  else if (const auto* real = std::get_if<double>(&value))
    list = {*real};
  else if (const auto* integer = std::get_if<std::int64_t>(&value))
    list = {static_cast<double>(*integer)};
  else
    wrong_kind(info, to_toml(value), where);
  if (info.count != 0 && list.size() != info.count)
    fail(ErrorKind::usage, "{}: {} = {} has {} number{}, but must have {}", where, info.name, to_toml(list),
         list.size(), list.size() == 1 ? "" : "s", info.count);
  for (double v : list) check_range(info, v, fmt::format("{}", v), where);
  return list;
}

Value checked_choice(const ParamInfo& info, const Value& value, std::string_view where) {
  const auto* text = std::get_if<std::string>(&value);
  if (!text) wrong_kind(info, to_toml(value), where);
  if (std::find(info.choices.begin(), info.choices.end(), *text) != info.choices.end()) return value;
  const std::string near = nearest(*text, info.choices);
  fail(ErrorKind::usage, "{}: {} = \"{}\" is not one of {}{}", where, info.name, *text, allowed(info),
       near.empty() ? "" : fmt::format("; did you mean \"{}\"?", near));
}

Value checked_rows(const ParamInfo& info, const Value& value, std::string_view where) {
  // An empty array has no kind of its own.
  if (const auto* none = std::get_if<std::vector<double>>(&value); none && none->empty()) return Rows{};
  const auto* rows = std::get_if<Rows>(&value);
  if (!rows) wrong_kind(info, to_toml(value), where);
  Rows out = *rows;
  for (std::size_t i = 0; i < out.size(); ++i) {
    const std::string row = fmt::format("{}: {}, row {}", where, info.name, i + 1);
    for (auto& [name, text] : out[i]) {
      const ParamInfo& column = find_param(info.columns, name, row);
      check_cell(column, text, row);
      if (trim(text).empty()) text = std::get<std::string>(column.init);
    }
    for (const ParamInfo& column : info.columns)
      out[i].try_emplace(column.name, std::get<std::string>(column.init));
  }
  return out;
}

/// Where a parameter of the struct `object` lies, of the type that goes with its kind.
template <class M>
const M& member_of(const void* object, const ParamInfo& info) {
  return *reinterpret_cast<const M*>(static_cast<const unsigned char*>(object) + info.offset);
}
template <class M>
M& member_of(void* object, const ParamInfo& info) {
  return *reinterpret_cast<M*>(static_cast<unsigned char*>(object) + info.offset);
}

/// Edit distance with swaps of neighbours counted as one (optimal string alignment).
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> before(b.size() + 1), last(b.size() + 1), row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) last[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t change = a[i - 1] == b[j - 1] ? 0 : 1;
      row[j] = std::min({last[j] + 1, row[j - 1] + 1, last[j - 1] + change});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
        row[j] = std::min(row[j], before[j - 2] + 1);
    }
    std::swap(before, last);
    std::swap(last, row);
  }
  return last[b.size()];
}

std::string quote(const std::string& text) {
  std::string out = "\"";
  for (const char c : to_utf8(text)) {
    const auto byte = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\')
      out += {'\\', c};
    else if (c == '\n')
      out += "\\n";
    else if (c == '\t')
      out += "\\t";
    else if (byte < 0x20 || byte == 0x7f)
      out += fmt::format("\\u{:04X}", byte);
    else
      out += c;
  }
  return out + '"';
}

/// How the command line writes a list: "1,2,3".
std::string list_example(const ParamInfo& info) {
  std::string out;
  for (std::size_t i = 1; i <= (info.count == 0 ? 3 : info.count); ++i)
    out += fmt::format("{}{}", out.empty() ? "" : ",", i);
  return out;
}

/// Numbers between commas, in brackets or not.
Value parse_list(const ParamInfo& info, std::string_view text, std::string_view where) {
  std::string_view body = text;
  if (!body.empty() && body.front() == '[' && body.back() == ']') body = body.substr(1, body.size() - 2);
  std::vector<double> list;
  bool wrong = false;
  for (std::size_t begin = 0; !trim(body).empty() && begin <= body.size();) {
    const std::size_t end = std::min(body.find(',', begin), body.size());
    const auto v = number(trim(body.substr(begin, end - begin)));
    wrong = wrong || !v;
    list.push_back(v.value_or(0));
    begin = end + 1;
  }
  if (wrong || (info.count != 0 && list.size() != info.count))
    fail(ErrorKind::usage, "{}: {} must be {}, written as in {}, not {}", where, info.name, allowed(info),
         list_example(info), quote(std::string(text)));
  return check_value(info, list, where);
}

/// TOML tells reals from integers by the point or the exponent.
std::string real_text(double v) {
  std::string out = fmt::format("{}", v);
  if (std::isfinite(v) && out.find_first_of(".e") == std::string::npos) out += ".0";
  return out;
}

std::string row_text(const Row& row) {
  std::string out = "{";
  for (const auto& [name, text] : row) out += (out.size() > 1 ? ", " : "") + name + " = " + quote(text);
  return out + "}";
}

}  // namespace

Value ParamInfo::load(const ParamInfo& info, const void* object) {
  switch (info.kind) {
    case ValueKind::boolean:
      return member_of<bool>(object, info);
    case ValueKind::integer:
      return member_of<std::int64_t>(object, info);
    case ValueKind::real:
      return member_of<double>(object, info);
    case ValueKind::text:
    case ValueKind::choice:
      return member_of<std::string>(object, info);
    case ValueKind::numbers:
      return member_of<std::vector<double>>(object, info);
    case ValueKind::rows:
      break;
  }
  return member_of<Rows>(object, info);
}

void ParamInfo::store(const ParamInfo& info, void* object, const Value& value) {
  std::visit([&]<class M>(const M& v) { member_of<M>(object, info) = v; }, value);
}

ParamInfo& ParamList::add(std::string_view name, ValueKind kind, const void* object, const void* member,
                          std::string_view doc) {
  ParamInfo& info = infos_.emplace_back();
  info.name = name;
  info.doc = doc;
  info.kind = kind;
  info.offset = static_cast<const unsigned char*>(member) - static_cast<const unsigned char*>(object);
  info.init = ParamInfo::load(info, object);
  return info;
}

void ParamList::add_numbers(std::string_view name, ValueKind kind, const void* object, const void* member,
                            std::string_view unit, std::size_t count, double min, double max,
                            std::string_view doc) {
  ParamInfo& info = add(name, kind, object, member, doc);
  info.unit = unit;
  info.count = count;
  info.min = min;
  info.max = max;
}

void ParamList::add_rows(std::string_view name, const void* object, const void* member,
                         std::vector<ParamInfo> columns, std::string_view doc) {
  ParamInfo& info = add(name, ValueKind::rows, object, member, doc);
  info.columns = std::move(columns);
  info.init = check_value(info, info.init, "default");
}

void ParamList::limit_last(std::string_view when, Values with) {
  infos_.back().only = when;
  infos_.back().only_with = std::move(with);
}

ParamInfo column(std::string name, std::string init, std::string doc) {
  ParamInfo info;
  info.name = std::move(name);
  info.doc = std::move(doc);
  info.kind = ValueKind::text;
  info.init = std::move(init);
  return info;
}

ParamInfo choice_column(std::string name, std::string init, std::vector<std::string> choices,
                        std::string doc) {
  ParamInfo info = column(std::move(name), std::move(init), std::move(doc));
  info.kind = ValueKind::choice;
  info.choices = std::move(choices);
  return info;
}

ParamInfo numbers_column(std::string name, std::string init, std::string unit, std::size_t count, double min,
                         double max, std::string doc) {
  ParamInfo info = column(std::move(name), std::move(init), std::move(doc));
  info.kind = count == 1 ? ValueKind::real : ValueKind::numbers;
  info.unit = std::move(unit);
  info.count = count;
  info.min = min;
  info.max = max;
  return info;
}

std::optional<std::vector<double>> numbers_in(std::string_view text) {
  constexpr std::string_view between = ", \t\r\n";
  std::vector<double> out;
  while (true) {
    text.remove_prefix(std::min(text.find_first_not_of(between), text.size()));
    if (text.empty()) return out;
    const std::size_t end = std::min(text.find_first_of(between), text.size());
    const auto value = number(text.substr(0, end));
    if (!value) return std::nullopt;
    out.push_back(*value);
    text.remove_prefix(end);
  }
}

void check_cell(const ParamInfo& column, const std::string& text, std::string_view where) {
  if (trim(text).empty()) return;
  if (column.kind == ValueKind::choice) checked_choice(column, text, where);
  if (column.kind != ValueKind::real && column.kind != ValueKind::numbers) return;
  const auto numbers = numbers_in(text);
  if (!numbers || (column.count != 0 && numbers->size() != column.count))
    wrong_kind(column, quote(text), where);
  for (const double v : *numbers) check_range(column, v, fmt::format("{}", v), where);
}

Value check_value(const ParamInfo& info, const Value& value, std::string_view where) {
  const auto* integer = std::get_if<std::int64_t>(&value);
  const auto* real = std::get_if<double>(&value);
  switch (info.kind) {
    case ValueKind::boolean:
      if (!std::holds_alternative<bool>(value)) break;
      return value;
    case ValueKind::text:
      if (!std::holds_alternative<std::string>(value)) break;
      return value;
    case ValueKind::integer: {
      const auto exact = integer ? std::optional(*integer) : real ? exact_integer(*real) : std::nullopt;
      if (!exact) break;
      check_range(info, static_cast<double>(*exact), fmt::format("{}", *exact), where);
      return *exact;
    }
    case ValueKind::real: {
      if (!integer && !real) break;
      const double v = integer ? static_cast<double>(*integer) : *real;
      check_range(info, v, fmt::format("{}", v), where);
      return v;
    }
    case ValueKind::choice:
      return checked_choice(info, value, where);
    case ValueKind::numbers:
      return checked_numbers(info, value, where);
    case ValueKind::rows:
      return checked_rows(info, value, where);
  }
  wrong_kind(info, to_toml(value), where);
}

Value parse_value(const ParamInfo& info, std::string_view raw, std::string_view where) {
  const std::string text = trim(raw);
  const std::string shown = quote(text);
  switch (info.kind) {
    case ValueKind::boolean: {
      const std::string word = lower(text);
      if (word == "true" || word == "yes" || word == "on" || word == "1") return true;
      if (word == "false" || word == "no" || word == "off" || word == "0") return false;
      wrong_kind(info, shown, where);
    }
    case ValueKind::integer:
      if (const auto v = whole(text)) return check_value(info, *v, where);
      if (const auto v = number(text); v && exact_integer(*v)) return check_value(info, *v, where);
      wrong_kind(info, shown, where);
    case ValueKind::real:
      if (const auto v = number(text)) return check_value(info, *v, where);
      wrong_kind(info, shown, where);
    case ValueKind::text:
    case ValueKind::choice:
      return check_value(info, text, where);
    case ValueKind::rows:
      fail(ErrorKind::usage, "{}: {} is a table, which only a scene file can give", where, info.name);
    case ValueKind::numbers:
      break;
  }
  return parse_list(info, text, where);
}

void assign(std::span<const ParamInfo> infos, void* object, const Values& values, std::string_view where) {
  for (const auto& [name, value] : values) {
    const ParamInfo& info = find_param(infos, name, where);
    ParamInfo::store(info, object, check_value(info, value, where));
  }
  for (const ParamInfo& info : infos)
    if (info.kind == ValueKind::rows && !values.contains(info.name))
      ParamInfo::store(info, object, check_value(info, ParamInfo::load(info, object), where));
}

const ParamInfo& find_param(std::span<const ParamInfo> infos, std::string_view name, std::string_view where) {
  std::vector<std::string> known;
  for (const ParamInfo& info : infos) {
    if (info.name == name) return info;
    known.push_back(info.name);
  }
  if (known.empty())
    fail(ErrorKind::usage, "{}: unknown parameter \"{}\"; it has no parameters", where, name);
  const std::string near = nearest(name, known);
  if (!near.empty())
    fail(ErrorKind::usage, "{}: unknown parameter \"{}\"; did you mean \"{}\"?", where, name, near);
  std::string list;
  for (std::size_t i = 0; i < known.size(); ++i)
    list += (i == 0 ? "" : i + 1 == known.size() ? " and " : ", ") + known[i];
  fail(ErrorKind::usage, "{}: unknown parameter \"{}\"; known {} {}", where, name,
       known.size() == 1 ? "is" : "are", list);
}

std::string nearest(std::string_view word, std::span<const std::string> known) {
  const std::string sought = lower(word);
  std::string best;
  std::size_t best_distance = 0;
  for (const std::string& name : known) {
    const std::string candidate = lower(name);
    const std::size_t longer = std::max(sought.size(), candidate.size());
    const std::size_t shorter = std::min(sought.size(), candidate.size());
    // Beyond a third of the letters it is another word; the start of a word is near whatever is left. A word
    // may be a whole file by mistake, whose length alone tells.
    const std::size_t most = std::max<std::size_t>(longer / 3, 1);
    const bool start = sought.size() >= 3 && candidate.compare(0, sought.size(), sought) == 0;
    if (!start && longer - shorter > most) continue;
    const std::size_t distance = edit_distance(sought, candidate);
    if (!start && (distance > most || distance >= longer)) continue;
    if (best.empty() || distance < best_distance) {
      best = name;
      best_distance = distance;
    }
  }
  return best;
}

std::string to_toml(const Value& value) {
  if (const auto* v = std::get_if<bool>(&value)) return *v ? "true" : "false";
  if (const auto* v = std::get_if<std::int64_t>(&value)) return fmt::format("{}", *v);
  if (const auto* v = std::get_if<double>(&value)) return real_text(*v);
  if (const auto* v = std::get_if<std::string>(&value)) return quote(*v);
  std::string out = "[";
  if (const auto* rows = std::get_if<Rows>(&value)) {
    for (const Row& row : *rows) out += (out.size() > 1 ? ", " : "") + row_text(row);
    return out + "]";
  }
  for (double v : std::get<std::vector<double>>(value)) out += (out.size() > 1 ? ", " : "") + real_text(v);
  return out + "]";
}

std::string allowed(const ParamInfo& info) {
  switch (info.kind) {
    case ValueKind::boolean:
      return "true or false";
    case ValueKind::text:
      return "text";
    case ValueKind::integer:
    case ValueKind::real:
      return range(info);
    case ValueKind::choice: {
      std::string out;
      for (const std::string& choice : info.choices) out += (out.empty() ? "" : " | ") + choice;
      return out;
    }
    case ValueKind::rows: {
      std::string out;
      for (const ParamInfo& column : info.columns) out += (out.empty() ? "" : ", ") + column.name;
      return "rows of " + out;
    }
    case ValueKind::numbers:
      break;
  }
  const std::string each = ", each " + range(info);
  if (info.count == 0) return "numbers" + each;
  return fmt::format("{} number{}", info.count, info.count == 1 ? "" : "s") + each;
}

}  // namespace tafoni
