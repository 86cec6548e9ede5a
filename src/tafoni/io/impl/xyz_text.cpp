// GDAL turns words it does not know into 0, and fills with 0 what no line names: where all heights are whole
// and below 256 and some are 0, nothing tells the two apart. Lines are taken apart here as GDAL does.

#include "tafoni/io/impl/xyz_text.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstring>
#include <memory>
#include <string_view>
#include <utility>

#include <cpl_conv.h>
#include <cpl_string.h>
#include <cpl_vsi.h>

#include "tafoni/core/error.h"
#include "tafoni/io/impl/reading.h"

namespace tafoni::io::impl {
namespace {

struct CloseXyz {
  void operator()(VSILFILE* file) const { VSIFCloseL(file); }
};

/// Letters of the longest line that GDAL reads; it takes a longer one for the end of the file.
constexpr std::size_t longest_line = 99;
/// Letters up to which a longer line is found to be one.
constexpr int seen_line = 1 << 16;
/// Letters of a word that is shown.
constexpr std::size_t shown_of_word = 20;

/// Columns of x, y and z.
struct Columns {
  int x = 0, y = 1, z = 2;
};

/// What a first line is that has letters.
Columns columns_of(const char* line) {
  const CPLStringList words(CSLTokenizeString2(line, " ,\t;", CSLT_HONOURSTRINGS));
  Columns out{-1, -1, -1};
  for (int i = 0; i < words.Count(); ++i) {
    const std::string word = lower_case(words[i]);
    if (word == "x" || word.starts_with("lon") || word.starts_with("east"))
      out.x = i;
    else if (word == "y" || word.starts_with("lat") || word.starts_with("north"))
      out.y = i;
    else if (word == "z" || word.starts_with("alt") || word == "height")
      out.z = i;
  }
  return out.x >= 0 && out.y >= 0 && out.z >= 0 ? out : Columns{};
}

/// GDAL's sign of a header: letters that no number has.
bool is_header(std::string_view line) {
  return std::any_of(line.begin(), line.end(),
                     [](unsigned char c) { return c == '"' || (std::isalpha(c) && c != 'e' && c != 'E'); });
}

/// The comma where it divides whole numbers from fractions in a line, a point where points or nothing do,
/// 0 where the line does not tell.
char decimal_sign(std::string_view line) {
  if (line.find('.') != line.npos) return '.';
  int commas = 0, separators = 0;
  bool between = true;
  for (const char c : line) {
    commas += c == ',';
    separators += c == '\t' || c == ';' || (c == ' ' && !between);
    between = c == ' ' || c == '\t' || c == ';';
  }
  if (commas >= 2 && separators == 0) return '.';
  return commas > 0 && separators > 0 ? ',' : '\0';
}

class XyzLines {
 public:
  XyzLines(const std::string& name, Columns columns) : name_(name), columns_(columns) {}

  /// Whether the line holds a pixel, whose position is then in x and y.
  bool look(std::string_view line, std::size_t number) {
    if (sign_ == '\0') sign_ = decimal_sign(line);
    number_ = number;
    int column = 0;
    bool between = true, any = false;
    for (std::size_t i = 0; i < line.size(); ++i) {
      const char c = line[i];
      if (c == ' ') {
        column += !between;
        between = true;
      } else if ((c == ',' && sign_ != ',') || c == '\t' || c == ';') {
        ++column;
        between = any = true;
      } else {
        if (between) take(column, line.substr(i));
        between = false;
        any = true;
      }
    }
    return any;
  }

  double x = 0, y = 0;

 private:
  void take(int column, std::string_view rest) {
    if (column == columns_.x)
      x = number(rest, false);
    else if (column == columns_.y)
      y = number(rest, false);
    else if (column == columns_.z)
      number(rest, true);
  }

  double number(std::string_view rest, bool may_miss) {
    const std::string_view ends = sign_ == ',' ? " \t;\r" : " ,\t;\r";
    word_.assign(rest.substr(0, rest.find_first_of(ends)));
    if (sign_ == ',') std::replace(word_.begin(), word_.end(), ',', '.');
    double value = 0;
    const char* const begin = word_.data() + word_.starts_with('+');
    const auto [end, error] = std::from_chars(begin, word_.data() + word_.size(), value);
    const bool whole = error != std::errc::invalid_argument && end == word_.data() + word_.size();
    if ((whole && std::isfinite(value)) || (may_miss && is_no_number(word_))) return value;
    fail(ErrorKind::input, "{}, line {}: \"{}\" stands where a {} belongs{}.", name_, number_,
         word_.substr(0, shown_of_word), may_miss ? "height" : "coordinate",
         may_miss ? "; leave out the line, or write nan" : "; write numbers alone");
  }

  std::string name_;
  Columns columns_;
  char sign_ = '\0';
  std::size_t number_ = 0;
  std::string word_;
};

}  // namespace

PixelRuns check_xyz_text(const std::string& file, const std::string& name,
                         const std::array<double, 6>& transform, int width, int height) {
  const bool packed = lower_case(file).ends_with("xyz.gz") && !file.starts_with("/vsigzip/");
  const std::unique_ptr<VSILFILE, CloseXyz> in(VSIFOpenL(((packed ? "/vsigzip/" : "") + file).c_str(), "rb"));
  PixelRuns missing;
  if (!in) return missing;
  std::uint64_t next = 0;
  std::size_t number = 0;
  bool begun = false;
  XyzLines lines(name, {});
  while (const char* line = CPLReadLine2L(in.get(), seen_line, nullptr)) {
    ++number;
    if (std::strlen(line) > longest_line)
      fail(ErrorKind::input,
           "{}, line {}: is longer than {} letters and ends the grid; leave out what follows z.", name,
           number, longest_line);
    if (!begun && *line == '/') continue;
    if (!std::exchange(begun, true) && is_header(line)) {
      lines = XyzLines(name, columns_of(line));
      continue;
    }
    if (!lines.look(line, number)) continue;
    const double col = std::floor((lines.x - transform[0]) / transform[1]),
                 row = std::floor((lines.y - transform[3]) / transform[5]);
    if (!(col >= 0 && col < width && row >= 0 && row < height)) continue;
    const std::uint64_t at = static_cast<std::uint64_t>(row) * width + static_cast<std::uint64_t>(col);
    missing.add(next, at);
    next = std::max(next, at + 1);
  }
  missing.add(next, static_cast<std::uint64_t>(width) * height);
  return missing;
}

}  // namespace tafoni::io::impl
