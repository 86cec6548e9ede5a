// Cuts text into lines, lines into fields, and fields into numbers. Most lines have no quote and are cut by
// searching for the separator; one with a quote is read field by field and may go on over line ends.

#include "tafoni/io/impl/table.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <utility>

namespace tafoni::io::impl {
namespace {

std::string_view trimmed(std::string_view s) {
  const auto first = s.find_first_not_of(" \t\r");
  if (first == std::string_view::npos) return {};
  s.remove_prefix(first);
  s.remove_suffix(s.size() - 1 - s.find_last_not_of(" \t\r"));
  return s;
}

/// Separators in the order in which they are thought of: a comma may be a decimal mark.
constexpr std::pair<char, std::string_view> separators[] = {
    {';', "semicolons"}, {'\t', "tabs"}, {',', "commas"}, {'|', "bars"}, {' ', "blanks"}};

/// Whether a record is one of fields between `separator`; two of them make three columns.
bool separates(std::string_view record, char separator) {
  if (std::count(record.begin(), record.end(), separator) < 2) return false;
  if (separator == ',') return true;
  // "x,<tab>y,<tab>z" has commas as separators and tabs for looks.
  for (std::size_t at = record.find(separator); at != record.npos; at = record.find(separator, at + 1))
    if (at > 0 && record[at - 1] == ',') return false;
  return true;
}

bool all_digits(std::string_view s) {
  return !s.empty() && s.find_first_not_of("0123456789") == s.npos;
}

}  // namespace

std::string shortened(std::string_view field) {
  if (field.size() <= 40) return std::string(field);
  std::size_t end = 40;
  while (end > 0 && (static_cast<unsigned char>(field[end]) & 0xc0) == 0x80) --end;
  return std::string(field.substr(0, end)) + "…";
}

Table::Table(std::string_view text, std::string_view name) : rest_(text), name_(name) {
  if (text.starts_with("PK\x03\x04"))
    fail(ErrorKind::input, "{}: is a spreadsheet or an archive; save the table as CSV", name);
  if (text.starts_with("\xff\xfe") || text.starts_with("\xfe\xff"))
    fail(ErrorKind::input, "{}: is UTF-16 text; save it as UTF-8", name);
  if (text.substr(0, 4096).find('\0') != text.npos)
    fail(ErrorKind::input, "{}: is not text; save the table as CSV", name);
  if (rest_.starts_with("\xef\xbb\xbf")) rest_.remove_prefix(3);
}

std::string_view Table::take_line() {
  const auto end = rest_.find('\n');
  std::string_view line = rest_.substr(0, end);
  // A carriage return alone ended lines on old systems.
  const auto lone = line.find('\r');
  const bool cut = lone != line.npos && lone + 1 < line.size();
  if (cut) line = line.substr(0, lone);
  rest_.remove_prefix(cut ? lone + 1 : end == rest_.npos ? rest_.size() : end + 1);
  ++next_line_;
  return line;
}

bool Table::next() {
  while (!rest_.empty()) {
    line_ = next_line_;
    const std::string_view before = rest_;
    const std::string_view record = take_line();
    const std::string_view shown = trimmed(record);
    if (shown.empty() || shown.front() == '#') continue;
    if (separator_ == 0 && shown.starts_with("sep=") && shown.size() == 5) {
      separator_ = shown.back();
      continue;
    }
    if (separator_ == 0) choose_separator(shown);
    fields_.clear();
    if (record.find('"') == record.npos) {
      // Blanks and tabs at the ends are no fields where they do not separate, and few mean them where they
      // do.
      split(separator_ == '\t' ? record : shown);
      return true;
    }
    // The record is read from the text again, since a quoted field may go on in the next line.
    unquoted_.clear();
    rest_ = before;
    --next_line_;
    std::string_view rest = rest_;
    for (bool more = true; more;) {
      fields_.push_back(take_field(rest));
      more = !rest.empty() && rest.front() == separator_;
      if (more) rest.remove_prefix(1);
    }
    const std::size_t taken = rest_.size() - rest.size();
    next_line_ += static_cast<std::uint32_t>(
        std::count(rest_.begin(), rest_.begin() + static_cast<std::ptrdiff_t>(taken), '\n'));
    rest_.remove_prefix(taken);
    take_line();
    return true;
  }
  return false;
}

void Table::choose_separator(std::string_view record) {
  separator_ = ',';
  for (const auto& [separator, name] : separators)
    if (separates(record, separator)) {
      separator_ = separator;
      return;
    }
}

void Table::split(std::string_view record) {
  for (;;) {
    if (separator_ == ' ') record = trimmed(record);
    const auto at = separator_ == ' ' ? record.find_first_of(" \t") : record.find(separator_);
    fields_.push_back(trimmed(record.substr(0, at)));
    if (at == record.npos) return;
    record.remove_prefix(at + 1);
  }
}

std::string_view Table::take_field(std::string_view& rest) {
  // A separator that is a blank or a tab is none of the blanks around a field.
  const auto blank = [&](char c) { return (c == ' ' || c == '\t') && c != separator_; };
  while (!rest.empty() && blank(rest.front())) rest.remove_prefix(1);
  while (separator_ == ' ' && !rest.empty() && rest.front() == ' ') rest.remove_prefix(1);
  if (!rest.empty() && rest.front() == '"') {
    const std::string_view field = take_quoted(rest);
    while (!rest.empty() && blank(rest.front())) rest.remove_prefix(1);
    if (!rest.empty() && rest.front() != separator_ && rest.front() != '\n' && rest.front() != '\r')
      bad("after the quoted \"{}\" there is more text before the next field; double the quotes that belong "
          "to "
          "a field",
          shortened(field));
    return field;
  }
  std::size_t end = 0;
  while (end < rest.size() && rest[end] != separator_ && rest[end] != '\n' && rest[end] != '\r') ++end;
  const std::string_view field = trimmed(rest.substr(0, end));
  rest.remove_prefix(end);
  return field;
}

std::string_view Table::take_quoted(std::string_view& rest) {
  rest.remove_prefix(1);
  const std::string_view begin = rest;
  bool doubled = false;
  std::size_t end = 0;
  for (;; ++end) {
    if (end == rest.size()) bad("a quote begins here and does not end; close it");
    if (rest[end] != '"') continue;
    if (end + 1 == rest.size() || rest[end + 1] != '"') break;
    doubled = true;
    ++end;
  }
  rest.remove_prefix(end + 1);
  const std::string_view field = begin.substr(0, end);
  if (!doubled) return trimmed(field);
  std::string& whole = unquoted_.emplace_back();
  for (std::size_t i = 0; i < field.size(); ++i) {
    whole += field[i];
    if (field[i] == '"') ++i;
  }
  return trimmed(whole);
}

void Table::trim_titles() {
  while (fields_.size() > 1 && fields_.back().empty()) fields_.pop_back();
}

void Table::require_fields(std::size_t count, std::string_view whose) {
  while (fields_.size() > count && fields_.back().empty()) fields_.pop_back();
  if (fields_.size() == count) return;
  std::string hint = decimal_comma_hint();
  if (fields_.size() == 1)
    for (const auto& [separator, name] : separators)
      if (separator != separator_ && separates(fields_.front(), separator))
        hint = fmt::format("; its fields are separated by {}, unlike those of the first line", name);
  bad("has {} fields where {} has {}{}", fields_.size(), whose, count,
      fields_.size() > count || fields_.size() == 1 ? hint : "");
}

std::string Table::decimal_comma_hint() const {
  // 447125,40,5909878,60
  const bool whole =
      separator_ == ',' && std::all_of(fields_.begin(), fields_.end(), [](std::string_view field) {
        return all_digits(field.substr(field.starts_with('-') || field.starts_with('+')));
      });
  return whole ? "; if its decimal marks are commas, write points, or put semicolons between the fields" : "";
}

double Table::number_at(std::size_t column, std::string_view title) {
  const std::string_view field = fields_[column];
  const auto value = to_number(field);
  if (!value) {
    const auto commas = std::count(field.begin(), field.end(), ',');
    const bool thousands = commas > 1 || (commas == 1 && field.find('.') != field.npos);
    bad("{} is \"{}\", which is not a number{}", title, shortened(field),
        commas > 0 ? thousands ? "; write it without separators of thousands"
                               : "; its comma may be a decimal mark or separate thousands: write a point or "
                                 "nothing"
                   : "");
  }
  if (!std::isfinite(*value)) bad("{} is \"{}\", which is not finite", title, shortened(field));
  const auto mark = field.find_first_of(".,");
  if (mark == field.npos) return *value;
  if (decimal_mark_ == 0) decimal_mark_ = field[mark], decimal_line_ = line_;
  if (decimal_mark_ != field[mark])
    bad("{} is \"{}\", where line {} has a decimal {}; use one of the two, and nothing between thousands",
        title, shortened(field), decimal_line_, decimal_mark_ == ',' ? "comma" : "point");
  return *value;
}

std::optional<double> Table::to_number(std::string_view field) const {
  if (field.starts_with('+')) field.remove_prefix(1);
  std::string pointed;
  if (const auto comma = field.find(','); comma != field.npos) {
    if (field.find_first_of(".,", comma + 1) != field.npos || field.find('.') != field.npos) return {};
    // In a quoted field of a table of commas, 1,234 may be twelve hundred.
    const std::string_view before = field.substr(field.starts_with('-'), comma - field.starts_with('-'));
    const std::string_view after = field.substr(comma + 1);
    if (separator_ == ',' && after.size() == 3 && before.size() <= 3 && all_digits(after)) return {};
    pointed = field;
    pointed[comma] = '.';
    field = pointed;
  }
  double value = 0;
  const auto [end, code] = std::from_chars(field.data(), field.data() + field.size(), value);
  if (end != field.data() + field.size()) return {};
  // The number is too large or too small; strtod tells which.
  if (code == std::errc::result_out_of_range) return std::strtod(std::string(field).c_str(), nullptr);
  if (code != std::errc()) return {};
  return value;
}

}  // namespace tafoni::io::impl
