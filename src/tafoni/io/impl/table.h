#pragma once
// Tables as spreadsheets and other programs write them, record by record.

#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "tafoni/core/error.h"

namespace tafoni::io::impl {

/// Walks the records that hold something. Fields are separated by what the first record has: semicolons,
/// tabs, commas, bars or blanks. Fields in quotes may hold anything, "" for a quote. A byte order mark, line
/// ends of any system, Excel's line "sep=;", blank lines and lines that begin with # are passed over. Throws
/// Error{input} for what is no table of text.
class Table {
 public:
  Table(std::string_view text, std::string_view name);

  /// False at the end. Throws Error{input} where a quote does not end.
  bool next();
  /// Of the record's beginning.
  std::uint32_t line() const { return line_; }
  std::string_view name() const { return name_; }
  /// Without blanks and quotes around them; valid until next().
  const std::vector<std::string_view>& fields() const { return fields_; }
  /// Drops empty fields after the last title, as spreadsheets add them.
  void trim_titles();
  /// Throws Error{input} unless the record has so many fields; empty ones beyond them are dropped. `whose` is
  /// what has that many: "the header".
  void require_fields(std::size_t count, std::string_view whose);

  /// Throws Error{input} unless the field is a finite number. A decimal comma is one where no other field has
  /// a decimal point.
  double number_at(std::size_t column, std::string_view title);
  /// The number that a field is, as far as one field can tell.
  std::optional<double> to_number(std::string_view field) const;
  /// Why more numbers than columns may stand in a record; empty when there is no telling.
  std::string decimal_comma_hint() const;

  template <class... Args>
  [[noreturn]] void bad(fmt::format_string<Args...> text, Args&&... args) const {
    fail(ErrorKind::input, "{}:{}: {}", name_, line_, fmt::format(text, std::forward<Args>(args)...));
  }

 private:
  std::string_view take_line();
  void choose_separator(std::string_view record);
  void split(std::string_view record);
  std::string_view take_field(std::string_view& rest);
  std::string_view take_quoted(std::string_view& rest);

  std::string_view rest_, name_;
  std::uint32_t line_ = 0, next_line_ = 1;
  char separator_ = 0;     ///< 0 until the first record is met
  char decimal_mark_ = 0;  ///< point or comma, once a number had one
  std::uint32_t decimal_line_ = 0;
  std::vector<std::string_view> fields_;
  std::deque<std::string> unquoted_;  ///< fields of this record that hold quotes of their own
};

/// What of a field goes into a message.
std::string shortened(std::string_view field);

}  // namespace tafoni::io::impl
