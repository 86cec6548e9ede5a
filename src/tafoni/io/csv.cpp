// Comma-separated tables: lines and fields first, then columns found by their titles, then primitives
// whose columns are the parameters of their kind.

#include "tafoni/io/csv.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iostream>
#include <optional>
#include <span>
#include <string>

#include <fmt/ranges.h>

#include "tafoni/core/error.h"
#include "tafoni/core/input_file.h"
#include "tafoni/core/params.h"
#include "tafoni/io/impl/table.h"

namespace tafoni::io {
namespace {

using impl::shortened;
using impl::Table;

std::string lower(std::string_view s) {
  std::string out(s);
  for (char& c : out)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return out;
}

/// The header of a primitives file, and each row as it says.
class PrimitiveRows {
 public:
  PrimitiveRows(std::string_view text, std::string_view name) : table_(text, name) {
    if (!table_.next())
      fail(ErrorKind::input, "{}: is empty; expected a header with the columns kind, x, y, z and energy",
           name);
    for (const field::PrimitiveType* type : field::all_primitives()) kinds_.push_back(type->about.name);
    read_header();
  }

  std::vector<Primitive> read() {
    std::vector<Primitive> out;
    std::string chain;  // the id of the last primitive, where rows may add to it
    while (table_.next()) {
      table_.require_fields(titles_.size(), "the header");
      Primitive row = read_row();
      const std::string_view id = at(id_);
      if (!chain.empty() && row.kind == out.back().kind && id == chain) {
        extend(out.back(), row);
        continue;
      }
      finish_chain(out, chain);
      chain = row.kind->variable ? id : std::string_view{};
      if (row.kind->variable && id.empty())
        table_.bad("a {} needs an id: the rows of one id are its vertices", row.kind->about.name);
      out.push_back(std::move(row));
    }
    finish_chain(out, chain);
    return out;
  }

 private:
  static constexpr std::size_t absent = std::string::npos;
  static constexpr double energy_limit = 1e6;

  void read_header() {
    table_.trim_titles();
    std::vector<std::string> known(common.begin(), common.end());
    for (const field::PrimitiveType* type : field::all_primitives())
      for (const ParamInfo& info : type->about.params)
        if (std::find(known.begin(), known.end(), info.name) == known.end()) known.push_back(info.name);
    for (std::string_view field : table_.fields()) {
      const std::string title = lower(field);
      if (std::find(known.begin(), known.end(), title) == known.end()) {
        const std::string near = nearest(title.substr(0, 40), known);
        table_.bad("column \"{}\" is not known; {}", shortened(title),
                   near.empty() ? fmt::format("known are {}", fmt::join(known, ", "))
                                : fmt::format("did you mean {}?", near));
      }
      if (column(title) != absent) table_.bad("column {} is given twice", title);
      titles_.push_back(title);
    }
    for (std::string_view needed : std::span(common).first(5))
      if (column(needed) == absent)
        table_.bad("column {} is missing; needed are kind, x, y, z and energy", needed);
    kind_ = column("kind"), id_ = column("id"), energy_ = column("energy");
    for (std::size_t axis = 0; axis < 3; ++axis) position_[axis] = column(common[1 + axis]);
  }

  std::size_t column(std::string_view title) const {
    const auto found = std::find(titles_.begin(), titles_.end(), title);
    return found == titles_.end() ? absent : found - titles_.begin();
  }
  std::string_view at(std::size_t column) const {
    return column == absent ? std::string_view{} : table_.fields()[column];
  }

  Primitive read_row() {
    Primitive p;
    p.line = table_.line();
    const std::string word = lower(at(kind_));
    const auto found = std::find(kinds_.begin(), kinds_.end(), word);
    if (found == kinds_.end()) {
      const std::string near = nearest(word.substr(0, 40), kinds_);
      table_.bad("kind is \"{}\"; {}", shortened(word),
                 near.empty() ? fmt::format("known are {}", fmt::join(kinds_, ", "))
                              : fmt::format("did you mean {}?", near));
    }
    p.kind = field::all_primitives()[found - kinds_.begin()];
    p.position = {table_.number_at(position_[0], "x"), table_.number_at(position_[1], "y"),
                  table_.number_at(position_[2], "z")};
    const double energy = table_.number_at(energy_, "energy");
    if (std::fabs(energy) > energy_limit)
      table_.bad("energy = {} is outside {} to {} m", energy, -energy_limit, energy_limit);
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
        value = table_.number_at(c, info.name);
        if (value < info.min || value > info.max)
          table_.bad("{} = {} is outside {}", info.name, value, allowed(info));
      }
      p.shape.push_back(static_cast<float>(value));
    }
    for (std::size_t c = 0; c < titles_.size(); ++c) {
      if (at(c).empty() || std::find(common.begin(), common.end(), titles_[c]) != common.end()) continue;
      if (std::none_of(own.begin(), own.end(), [&](const ParamInfo& i) { return i.name == titles_[c]; }))
        table_.bad("a {} has no {}; leave the field empty", p.kind->about.name, titles_[c]);
    }
  }

  void extend(Primitive& chain, const Primitive& row) {
    if (row.energy != chain.energy || (row.shape != chain.shape && !at(column("radius")).empty()))
      table_.bad("energy and radius differ from those in line {}, where this {} begins", chain.line,
                 chain.kind->about.name);
    chain.further.push_back(row.position);
  }

  void finish_chain(const std::vector<Primitive>& out, const std::string& chain) const {
    if (!chain.empty() && out.back().further.empty())
      fail(ErrorKind::input, "{}:{}: {} \"{}\" is one row; give two or more of this id, one a vertex",
           table_.name(), out.back().line, out.back().kind->about.name, shortened(chain));
  }

  /// What every kind has; the first five are needed.
  static constexpr std::array<std::string_view, 6> common = {"kind", "x", "y", "z", "energy", "id"};

  Table table_;
  std::vector<std::string> kinds_, titles_;
  std::size_t kind_ = absent, id_ = absent, energy_ = absent;
  std::array<std::size_t, 3> position_{};
};

/// Without a header the first columns count, and what follows them must be text: with more numbers there is
/// no telling which is which.
std::vector<std::size_t> first_columns(const Table& table, std::size_t count, const std::string& wanted) {
  const auto& fields = table.fields();
  if (fields.size() < count) table.bad("has {} fields; expected {}", fields.size(), wanted);
  std::vector<std::size_t> places;
  for (std::size_t c = 0; c < count; ++c) places.push_back(c);
  for (std::size_t c = count; c < fields.size(); ++c)
    if (table.to_number(fields[c]))
      table.bad("has {} fields where {} are expected; name the columns in the first line{}", fields.size(),
                wanted, table.decimal_comma_hint());
  return places;
}

std::vector<std::size_t> named_columns(const Table& table, std::span<const std::string_view> columns,
                                       const std::string& wanted) {
  std::vector<std::string> titles;
  for (const std::string_view field : table.fields()) titles.push_back(lower(field));
  std::vector<std::size_t> places;
  for (const std::string_view column : columns) {
    const auto found = std::find(titles.begin(), titles.end(), column);
    if (found == titles.end())
      table.bad("column {} is missing; expected a header with the columns {}", column, wanted);
    if (std::find(found + 1, titles.end(), column) != titles.end())
      table.bad("column {} is given twice", column);
    places.push_back(found - titles.begin());
  }
  return places;
}

}  // namespace

std::vector<Primitive> parse_primitives_csv(std::string_view text, std::string_view name) {
  return PrimitiveRows(text, name).read();
}

std::vector<std::vector<double>> parse_numbers_csv(std::string_view text, std::string_view name,
                                                   std::span<const std::string_view> columns,
                                                   std::vector<std::uint32_t>* numbers) {
  Table table(text, name);
  const std::string wanted = fmt::format("{}", fmt::join(columns, ","));
  if (!table.next()) fail(ErrorKind::input, "{}: is empty; expected the columns {}", name, wanted);
  table.trim_titles();
  const std::size_t width = table.fields().size();
  const bool headless = table.to_number(table.fields().front()).has_value();
  const std::vector<std::size_t> places =
      headless ? first_columns(table, columns.size(), wanted) : named_columns(table, columns, wanted);
  std::vector<std::vector<double>> out;
  for (bool more = headless || table.next(); more; more = table.next()) {
    table.require_fields(width, "the first line");
    if (numbers) numbers->push_back(table.line());
    std::vector<double>& row = out.emplace_back();
    for (std::size_t c = 0; c < columns.size(); ++c) row.push_back(table.number_at(places[c], columns[c]));
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
