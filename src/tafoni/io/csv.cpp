// Comma-separated tables: lines and fields first, then columns found by their titles, then primitives
// whose columns are the parameters of their kind.

#include "tafoni/io/csv.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <iostream>
#include <optional>
#include <span>
#include <string>

#include <fmt/ranges.h>

#include "tafoni/core/error.h"
#include "tafoni/core/input_file.h"
#include "tafoni/core/params.h"

namespace tafoni::io {
namespace {

std::string_view trim(std::string_view s) {
  const auto first = s.find_first_not_of(" \t\r");
  if (first == std::string_view::npos) return {};
  s.remove_prefix(first);
  s.remove_suffix(s.size() - 1 - s.find_last_not_of(" \t\r"));
  if (s.size() >= 2 && s.front() == '"' && s.back() == '"') s = s.substr(1, s.size() - 2);
  return s;
}

/// What of a field goes into a message: short and printable.
std::string printable(std::string_view field) {
  std::string out;
  for (char c : field.substr(0, 40)) out += c >= ' ' && c < 127 ? c : '?';
  return field.size() > 40 ? out + "…" : out;
}

/// Walks the lines that hold something.
class Lines {
 public:
  Lines(std::string_view text, std::string_view name) : rest_(text), name_(name) {
    if (rest_.starts_with("\xef\xbb\xbf")) rest_.remove_prefix(3);
  }

  bool next() {
    while (!rest_.empty()) {
      const auto end = rest_.find('\n');
      const std::string_view line = trim(rest_.substr(0, end));
      rest_.remove_prefix(end == std::string_view::npos ? rest_.size() : end + 1);
      ++number_;
      if (line.empty() || line.front() == '#') continue;
      split(line);
      return true;
    }
    return false;
  }
  std::uint32_t number() const { return number_; }
  std::string_view name() const { return name_; }
  const std::vector<std::string_view>& fields() const { return fields_; }

  template <class... Args>
  [[noreturn]] void bad(fmt::format_string<Args...> text, Args&&... args) const {
    fail(ErrorKind::input, "{}:{}: {}", name_, number_, fmt::format(text, std::forward<Args>(args)...));
  }

  double number_at(std::size_t column, std::string_view title) const {
    const auto field = fields_[column];
    const auto value = to_number(field);
    if (!value) bad("{} is \"{}\", which is not a number", title, printable(field));
    if (!std::isfinite(*value)) bad("{} is \"{}\", which is not finite", title, printable(field));
    return *value;
  }
  static std::optional<double> to_number(std::string_view field) {
    if (field.starts_with('+')) field.remove_prefix(1);
    double value = 0;
    const auto [end, code] = std::from_chars(field.data(), field.data() + field.size(), value);
    if (end != field.data() + field.size()) return {};
    // The number is too large or too small; strtod tells which.
    if (code == std::errc::result_out_of_range) return std::strtod(std::string(field).c_str(), nullptr);
    if (code != std::errc()) return {};
    return value;
  }

 private:
  void split(std::string_view line) {
    fields_.clear();
    for (;;) {
      const auto comma = line.find(',');
      fields_.push_back(trim(line.substr(0, comma)));
      if (comma == std::string_view::npos) return;
      line.remove_prefix(comma + 1);
    }
  }

  std::string_view rest_, name_;
  std::uint32_t number_ = 0;
  std::vector<std::string_view> fields_;
};

std::string lower(std::string_view s) {
  std::string out(s);
  for (char& c : out)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return out;
}

/// The header of a primitives file, and each row as it says.
class PrimitiveRows {
 public:
  PrimitiveRows(std::string_view text, std::string_view name) : lines_(text, name) {
    if (!lines_.next())
      fail(ErrorKind::input, "{}: is empty; expected a header with the columns kind, x, y, z and energy",
           name);
    for (const field::PrimitiveType* type : field::all_primitives()) kinds_.push_back(type->about.name);
    read_header();
  }

  std::vector<Primitive> read() {
    std::vector<Primitive> out;
    std::string chain;  // the id of the last primitive, where rows may add to it
    while (lines_.next()) {
      if (lines_.fields().size() != titles_.size())
        lines_.bad("has {} fields where the header has {}", lines_.fields().size(), titles_.size());
      Primitive row = read_row();
      const std::string_view id = at(id_);
      if (!chain.empty() && row.kind == out.back().kind && id == chain) {
        extend(out.back(), row);
        continue;
      }
      finish_chain(out, chain);
      chain = row.kind->variable ? id : std::string_view{};
      if (row.kind->variable && id.empty())
        lines_.bad("a {} needs an id: the rows of one id are its vertices", row.kind->about.name);
      out.push_back(std::move(row));
    }
    finish_chain(out, chain);
    return out;
  }

 private:
  static constexpr std::size_t absent = std::string::npos;
  static constexpr double energy_limit = 1e6;

  void read_header() {
    std::vector<std::string> known(common.begin(), common.end());
    for (const field::PrimitiveType* type : field::all_primitives())
      for (const ParamInfo& info : type->about.params)
        if (std::find(known.begin(), known.end(), info.name) == known.end()) known.push_back(info.name);
    for (std::string_view field : lines_.fields()) {
      const std::string title = lower(field);
      if (std::find(known.begin(), known.end(), title) == known.end()) {
        const std::string near = nearest(title.substr(0, 40), known);
        lines_.bad("column \"{}\" is not known; {}", printable(title),
                   near.empty() ? fmt::format("known are {}", fmt::join(known, ", "))
                                : fmt::format("did you mean {}?", near));
      }
      if (column(title) != absent) lines_.bad("column {} is given twice", title);
      titles_.push_back(title);
    }
    for (std::string_view needed : std::span(common).first(5))
      if (column(needed) == absent)
        lines_.bad("column {} is missing; needed are kind, x, y, z and energy", needed);
    kind_ = column("kind"), id_ = column("id"), energy_ = column("energy");
    for (std::size_t axis = 0; axis < 3; ++axis) position_[axis] = column(common[1 + axis]);
  }

  std::size_t column(std::string_view title) const {
    const auto found = std::find(titles_.begin(), titles_.end(), title);
    return found == titles_.end() ? absent : found - titles_.begin();
  }
  std::string_view at(std::size_t column) const {
    return column == absent ? std::string_view{} : lines_.fields()[column];
  }

  Primitive read_row() {
    Primitive p;
    p.line = lines_.number();
    const std::string word = lower(at(kind_));
    const auto found = std::find(kinds_.begin(), kinds_.end(), word);
    if (found == kinds_.end()) {
      const std::string near = nearest(word.substr(0, 40), kinds_);
      lines_.bad("kind is \"{}\"; {}", printable(word),
                 near.empty() ? fmt::format("known are {}", fmt::join(kinds_, ", "))
                              : fmt::format("did you mean {}?", near));
    }
    p.kind = field::all_primitives()[found - kinds_.begin()];
    p.position = {lines_.number_at(position_[0], "x"), lines_.number_at(position_[1], "y"),
                  lines_.number_at(position_[2], "z")};
    const double energy = lines_.number_at(energy_, "energy");
    if (std::fabs(energy) > energy_limit)
      lines_.bad("energy = {} is outside {} to {} m", energy, -energy_limit, energy_limit);
    p.energy = static_cast<float>(energy);
    read_shape(p);
    return p;
  }

  void read_shape(Primitive& p) {
    // The vertices of a chain are rows, not numbers of its shape.
    const auto own =
        std::span(p.kind->about.params).first(p.kind->variable ? 1 : p.kind->about.params.size());
    for (const ParamInfo& info : own) {
      double value = std::get<double>(info.init);
      if (const std::size_t c = column(info.name); !at(c).empty()) {
        value = lines_.number_at(c, info.name);
        if (value < info.min || value > info.max)
          lines_.bad("{} = {} is outside {}", info.name, value, allowed(info));
      }
      p.shape.push_back(static_cast<float>(value));
    }
    for (std::size_t c = 0; c < titles_.size(); ++c) {
      if (at(c).empty() || std::find(common.begin(), common.end(), titles_[c]) != common.end()) continue;
      if (std::none_of(own.begin(), own.end(), [&](const ParamInfo& i) { return i.name == titles_[c]; }))
        lines_.bad("a {} has no {}; leave the field empty", p.kind->about.name, titles_[c]);
    }
  }

  void extend(Primitive& chain, const Primitive& row) {
    if (row.energy != chain.energy || (row.shape != chain.shape && !at(column("radius")).empty()))
      lines_.bad("energy and radius differ from those in line {}, where this {} begins", chain.line,
                 chain.kind->about.name);
    chain.further.push_back(row.position);
  }

  void finish_chain(const std::vector<Primitive>& out, const std::string& chain) const {
    if (!chain.empty() && out.back().further.empty())
      fail(ErrorKind::input, "{}:{}: {} \"{}\" is one row; give two or more of this id, one a vertex",
           lines_.name(), out.back().line, out.back().kind->about.name, printable(chain));
  }

  /// What every kind has; the first five are needed.
  static constexpr std::array<std::string_view, 6> common = {"kind", "x", "y", "z", "energy", "id"};

  Lines lines_;
  std::vector<std::string> kinds_, titles_;
  std::size_t kind_ = absent, id_ = absent, energy_ = absent;
  std::array<std::size_t, 3> position_{};
};

}  // namespace

std::vector<Primitive> parse_primitives_csv(std::string_view text, std::string_view name) {
  return PrimitiveRows(text, name).read();
}

std::vector<std::vector<double>> parse_numbers_csv(std::string_view text, std::string_view name,
                                                   std::span<const std::string_view> columns,
                                                   std::vector<std::uint32_t>* numbers) {
  Lines lines(text, name);
  const std::string wanted = fmt::format("{}", fmt::join(columns, ","));
  if (!lines.next()) fail(ErrorKind::input, "{}: is empty; expected the columns {}", name, wanted);
  std::vector<std::size_t> places;
  const std::size_t width = lines.fields().size();
  const bool headless = Lines::to_number(lines.fields().front()).has_value();
  if (headless && width < columns.size()) lines.bad("has {} fields; expected {}", width, wanted);
  for (std::size_t c = 0; c < columns.size(); ++c) {
    std::size_t i = headless ? c : 0;
    while (!headless && i < width && lower(lines.fields()[i]) != columns[c]) ++i;
    if (i == width)
      lines.bad("column {} is missing; expected a header with the columns {}", columns[c], wanted);
    places.push_back(i);
  }
  std::vector<std::vector<double>> out;
  for (bool more = headless || lines.next(); more; more = lines.next()) {
    if (lines.fields().size() != width)
      lines.bad("has {} fields where the first line has {}", lines.fields().size(), width);
    if (numbers) numbers->push_back(lines.number());
    std::vector<double>& row = out.emplace_back();
    for (std::size_t c = 0; c < columns.size(); ++c) row.push_back(lines.number_at(places[c], columns[c]));
  }
  return out;
}

std::vector<Vec3d> parse_points_csv(std::string_view text, std::string_view name) {
  constexpr std::string_view columns[] = {"x", "y", "z"};
  std::vector<Vec3d> out;
  for (const auto& row : parse_numbers_csv(text, name, columns)) out.push_back({row[0], row[1], row[2]});
  return out;
}

std::string read_text(const std::filesystem::path& path, std::uint64_t limit) {
  const auto too_long = [&](std::string_view name) {
    fail(ErrorKind::input, "{}: holds more than {} MB; at most that can be read", name, limit >> 20);
  };
  if (path != "-") {
    const InputFile file(path);
    if (file.size() > limit) too_long(path.string());
    return file.whole();
  }
  std::string text;
  for (std::array<char, 65536> part{}; std::cin.read(part.data(), part.size()) || std::cin.gcount() > 0;) {
    text.append(part.data(), std::cin.gcount());
    if (text.size() > limit) too_long("standard input");
  }
  return text;
}

}  // namespace tafoni::io
