#pragma once
// Parameters as data. A type that has parameters declares one table; scene files, `tafoni list`, --help,
// --set and the reference page are all made from it.

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

namespace tafoni {

/// A table: rows of text by column. A checked one has every column in every row.
using Row = std::map<std::string, std::string, std::less<>>;
using Rows = std::vector<Row>;

/// A parameter's value: what a scene file or `--set` can say; rows, only a scene file.
using Value = std::variant<bool, std::int64_t, double, std::string, std::vector<double>, Rows>;
using Values = std::map<std::string, Value, std::less<>>;

enum class ValueKind { boolean, integer, real, text, choice, numbers, rows };

struct ParamInfo {
  std::string name;
  std::string doc;   ///< one sentence, no full stop
  std::string unit;  ///< "m", "deg", "" …
  ValueKind kind = ValueKind::real;
  Value init;
  double min = 0, max = 0;           ///< allowed range of integer, real and each of numbers
  std::vector<std::string> choices;  ///< of a choice
  std::size_t count = 0;             ///< of numbers: how many, 0 for any
  std::vector<ParamInfo> columns;    ///< of rows; their values are texts, whatever kind these hold
  /// "", or when it has an effect at all, to follow the word "only": "where faces is above 0".
  std::string only = {};
  /// What the other parameters are set to so that it has one, where values can bring that about.
  Values only_with = {};
  std::size_t offset = 0;  ///< of the member in its struct, bytes

  /// What `object`, a struct that has the parameter `info`, holds of it, and sets it. `value` has been
  /// checked.
  static Value load(const ParamInfo& info, const void* object);
  static void store(const ParamInfo& info, void* object, const Value& value);
};

/// What ParamTable does for every struct alike, so that it is compiled once.
class ParamList {
 public:
  const std::vector<ParamInfo>& infos() const { return infos_; }
  operator std::vector<ParamInfo>() const { return infos_; }

 protected:
  /// `member`, of a type that goes with `kind`, lies in `object`, which has the defaults.
  ParamInfo& add(std::string_view name, ValueKind kind, const void* object, const void* member,
                 std::string_view doc);
  void add_numbers(std::string_view name, ValueKind kind, const void* object, const void* member,
                   std::string_view unit, std::size_t count, double min, double max, std::string_view doc);
  void add_rows(std::string_view name, const void* object, const void* member, std::vector<ParamInfo> columns,
                std::string_view doc);
  void limit_last(std::string_view when, Values with);

 private:
  std::vector<ParamInfo> infos_;
};

/// The parameters of the plain struct P. Built once, in the file that declares P.
template <class P>
class ParamTable : public ParamList {
 public:
  ParamTable& real(std::string_view name, double P::*member, std::string_view unit, double min, double max,
                   std::string_view doc) {
    add_numbers(name, ValueKind::real, &defaults_, &(defaults_.*member), unit, 0, min, max, doc);
    return *this;
  }
  ParamTable& integer(std::string_view name, std::int64_t P::*member, std::string_view unit, std::int64_t min,
                      std::int64_t max, std::string_view doc) {
    add_numbers(name, ValueKind::integer, &defaults_, &(defaults_.*member), unit, 0, static_cast<double>(min),
                static_cast<double>(max), doc);
    return *this;
  }
  ParamTable& boolean(std::string_view name, bool P::*member, std::string_view doc) {
    add(name, ValueKind::boolean, &defaults_, &(defaults_.*member), doc);
    return *this;
  }
  ParamTable& text(std::string_view name, std::string P::*member, std::string_view doc) {
    add(name, ValueKind::text, &defaults_, &(defaults_.*member), doc);
    return *this;
  }
  ParamTable& choice(std::string_view name, std::string P::*member, std::vector<std::string> choices,
                     std::string_view doc) {
    add(name, ValueKind::choice, &defaults_, &(defaults_.*member), doc).choices = std::move(choices);
    return *this;
  }
  ParamTable& numbers(std::string_view name, std::vector<double> P::*member, std::string_view unit,
                      std::size_t count, double min, double max, std::string_view doc) {
    add_numbers(name, ValueKind::numbers, &defaults_, &(defaults_.*member), unit, count, min, max, doc);
    return *this;
  }
  /// A table of text; see column(). In a scene file [[layer.NAME]], once a row, or an array of inline tables.
  ParamTable& rows(std::string_view name, Rows P::*member, std::vector<ParamInfo> columns,
                   std::string_view doc) {
    add_rows(name, &defaults_, &(defaults_.*member), std::move(columns), doc);
    return *this;
  }
  /// Says of the parameter declared last that it does nothing but `when`; `with` brings that case about. A
  /// parameter without it must change what is made (a test over the registries sets each).
  ParamTable& only(std::string_view when, Values with = {}) {
    limit_last(when, std::move(with));
    return *this;
  }

 private:
  P defaults_{};
};

/// A column of ParamTable::rows(): any text. `init` is the text of a row that says nothing, or of
/// an empty cell.
ParamInfo column(std::string name, std::string init, std::string doc);
ParamInfo choice_column(std::string name, std::string init, std::vector<std::string> choices,
                        std::string doc);
/// `count` numbers, 0 for any, as numbers_in() reads them.
ParamInfo numbers_column(std::string name, std::string init, std::string unit, std::size_t count, double min,
                         double max, std::string doc);

/// Decimal numbers between commas or blanks; nullopt where there is anything else.
std::optional<std::vector<double>> numbers_in(std::string_view text);

/// Throws Error{usage} where a cell's text is not what its column holds.
void check_cell(const ParamInfo& column, const std::string& text, std::string_view where);

/// Checks `value` against `info` and converts where nothing is lost (an integer for a real, a number for a
/// list of one); gives rows the columns that they lack. Throws Error{usage}: "WHERE: NAME = 12 is outside 0
/// to 10 m".
Value check_value(const ParamInfo& info, const Value& value, std::string_view where);

/// Reads what `--set NAME=TEXT` says as `info`'s kind; rows cannot be said so. Throws Error{usage}.
Value parse_value(const ParamInfo& info, std::string_view text, std::string_view where);

/// Stores `values` into the object of `infos`. An unknown name is an error that names the nearest known one.
/// Rows that `values` do not name keep what the object has, with the columns that they lack.
void assign(std::span<const ParamInfo> infos, void* object, const Values& values, std::string_view where);

/// Finds a parameter by name, or throws Error{usage} naming the nearest known one.
const ParamInfo& find_param(std::span<const ParamInfo> infos, std::string_view name, std::string_view where);

/// The name nearest to `word` by edit distance, empty when none is near.
std::string nearest(std::string_view word, std::span<const std::string> known);

/// A value as a scene file writes it, on one line.
std::string to_toml(const Value& value);

/// "0 to 10 m", "soft | hard": what `info` allows, for help and error texts.
std::string allowed(const ParamInfo& info);

}  // namespace tafoni
