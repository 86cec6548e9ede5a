#pragma once
// ESRI's grids of text: what GDAL takes for zero without a word.

#include <array>
#include <functional>
#include <string>
#include <string_view>

namespace tafoni::io::impl {

/// Gives a file's text to `look` in pieces that end where a word ends.
void read_words(const std::string& file, const std::function<void(std::string_view)>& look);

/// Throws Error{input}: the first row of heights begins with a letter.
[[noreturn]] void fail_first_row(const std::string& name, std::size_t line, std::string_view word);

/// Throws Error{input} where a word stands in place of a height. `file` is as GDAL opens it, `name` for
/// messages.
void check_grid_text(const std::string& file, const std::string& name);

/// Where the header of an ESRI grid of so many rows puts it, as GDAL's six numbers.
struct GridPlace {
  bool mixed = false;    ///< a corner in one direction and a centre in the other, which GDAL puts at 0
  bool missing = false;  ///< in one direction or both nothing; the south-west corner is at 0 there
  std::array<double, 6> transform{};
};
GridPlace grid_place(const std::string& file, int rows);

}  // namespace tafoni::io::impl
