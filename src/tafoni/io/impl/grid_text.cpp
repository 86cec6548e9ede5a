// GDAL turns words it does not know into 0 and puts grids whose header it does not understand at 0. The text
// is looked through once for words, much faster than its numbers are read.

#include "tafoni/io/impl/grid_text.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <map>
#include <memory>
#include <string_view>
#include <utility>

#include <cpl_vsi.h>

#include "tafoni/core/error.h"
#include "tafoni/io/impl/reading.h"

namespace tafoni::io::impl {
namespace {

struct CloseText {
  void operator()(VSILFILE* file) const { VSIFCloseL(file); }
};

/// Bytes of a header, and of a piece that is looked through at once.
constexpr std::size_t header_bytes = 4096, piece_bytes = 1 << 20;
/// What lines of the header begin with; GDAL also takes "null" for one.
constexpr std::string_view header_words[] = {"ncols", "nrows", "xll",    "yll", "cellsize",
                                             "dx",    "dy",    "nodata", "null"};
/// Letters of a word that is shown.
constexpr std::size_t shown_letters = 20;

bool is_space(char c) {
  return c == ' ' || (c >= '\t' && c <= '\r');
}

/// Characters that numbers and the space between them are made of.
const std::array<bool, 256>& number_characters() {
  static const std::array<bool, 256> table = [] {
    std::array<bool, 256> t{};
    for (const char c : std::string_view("0123456789+-.,eE \t\r\n\v\f"))
      t[static_cast<unsigned char>(c)] = true;
    return t;
  }();
  return table;
}

/// Looks through text that comes in pieces.
class WordSearch {
 public:
  explicit WordSearch(const std::string& name) : name_(name) {}

  /// `piece` ends where a word ends.
  void look(std::string_view piece) {
    if (first_) check_first_row(piece);
    std::size_t counted = 0;
    for (auto at = next_odd(piece, piece.begin()); at != piece.end();) {
      auto begin = at, end = at;
      while (begin != piece.begin() && !is_space(begin[-1])) --begin;
      while (end != piece.end() && !is_space(*end)) ++end;
      const std::string_view word = piece.substr(begin - piece.begin(), end - begin);
      lines_ += std::count(piece.begin() + static_cast<std::ptrdiff_t>(counted), begin, '\n');
      counted = begin - piece.begin();
      if (!is_no_number(word) && !in_header(piece, counted))
        fail(ErrorKind::input,
             "{}, line {}: \"{}\" stands where a height belongs; write nan for missing ones.", name_,
             lines_ + 1, word.substr(0, shown_letters));
      at = next_odd(piece, end);
    }
    lines_ += std::count(piece.begin() + static_cast<std::ptrdiff_t>(counted), piece.end(), '\n');
    first_ = false;
  }

 private:
  using Place = std::string_view::const_iterator;

  /// The header ends for GDAL where a line does not begin with a letter, so that it leaves out a row that
  /// does.
  void check_first_row(std::string_view piece) const {
    std::size_t line = 1;
    for (std::size_t at = 0; at < piece.size(); at = piece.find('\n', at) + 1, ++line) {
      const bool letter = std::isalpha(static_cast<unsigned char>(piece[at])) != 0;
      if (letter && !in_header(piece, at))
        fail_first_row(name_, line,
                       piece.substr(at, piece.substr(at, shown_letters).find_first_of(" \t\r\n")));
      if (!letter || piece.find('\n', at) == piece.npos) return;
    }
  }

  /// The next character that is no number's, or a sign before none.
  static Place next_odd(std::string_view piece, Place from) {
    const auto& plain = number_characters();
    for (; from != piece.end(); ++from) {
      if (!plain[static_cast<unsigned char>(*from)]) return from;
      if (*from != '-' && *from != '+') continue;
      const char next = from + 1 == piece.end() ? ' ' : from[1];
      if (next != '.' && (next < '0' || next > '9')) return from;
    }
    return from;
  }

  /// Whether the line of a word begins with one that headers have.
  bool in_header(std::string_view piece, std::size_t at) const {
    if (!first_) return false;
    const std::size_t line = piece.substr(0, at).rfind('\n') + 1;
    const std::string word = lower_case(piece.substr(piece.find_first_not_of(" \t", line), shown_letters));
    return std::any_of(std::begin(header_words), std::end(header_words),
                       [&](std::string_view known) { return word.starts_with(known); });
  }

  const std::string& name_;
  std::size_t lines_ = 0;
  bool first_ = true;
};

}  // namespace

void read_words(const std::string& file, const std::function<void(std::string_view)>& look) {
  const std::unique_ptr<VSILFILE, CloseText> in(VSIFOpenL(file.c_str(), "rb"));
  if (!in) return;
  std::string text;
  for (bool more = true; more;) {
    const std::size_t kept = text.size();
    text.resize(kept + piece_bytes);
    const std::size_t got = VSIFReadL(text.data() + kept, 1, piece_bytes, in.get());
    text.resize(kept + got);
    more = got > 0;
    const auto last = std::find_if(text.rbegin(), text.rend(), is_space);
    // A word that has no end is none that is read.
    const std::size_t whole = more && last != text.rend() ? text.rend() - last : text.size();
    look(std::string_view(text).substr(0, whole));
    text.erase(0, whole);
  }
}

void check_grid_text(const std::string& file, const std::string& name) {
  WordSearch search(name);
  read_words(file, [&](std::string_view piece) { search.look(piece); });
}

void fail_first_row(const std::string& name, std::size_t line, std::string_view word) {
  fail(ErrorKind::input,
       "{}, line {}: \"{}\" begins the heights and would be taken for the header; write a number for missing "
       "ones, and name it in the header.",
       name, line, word.substr(0, shown_letters));
}

GridPlace grid_place(const std::string& file, int rows) {
  GridPlace out;
  const std::unique_ptr<VSILFILE, CloseText> in(VSIFOpenL(file.c_str(), "rb"));
  if (!in) return out;
  std::string text(header_bytes, '\0');
  text.resize(VSIFReadL(text.data(), 1, text.size(), in.get()));
  std::map<std::string, double> words;
  std::string key;
  for (std::size_t at = 0; at < text.size();) {
    while (at < text.size() && is_space(text[at])) ++at;
    const std::size_t begin = at;
    while (at < text.size() && !is_space(text[at])) ++at;
    std::string_view token = std::string_view(text).substr(begin, at - begin);
    double value = 0;
    if (token.starts_with('+')) token.remove_prefix(1);
    const bool number =
        std::from_chars(token.data(), token.data() + token.size(), value).ptr == token.data() + token.size();
    if (number && !key.empty())
      words.emplace(std::exchange(key, ""), value);
    else if (number)
      break;  // two numbers in a row: the header has ended
    else
      key = lower_case(token);
  }
  const auto has = [&](const char* word) { return words.count(word) > 0; };
  const double dx = words[has("dx") ? "dx" : "cellsize"], dy = words[has("dy") ? "dy" : "cellsize"];
  if (!(dx > 0) || !(dy > 0)) return out;
  const bool x_centre = has("xllcenter"), y_centre = has("yllcenter");
  const bool x = x_centre || has("xllcorner"), y = y_centre || has("yllcorner");
  const std::string low = lower_case(text);
  out.missing = low.find("xll") == low.npos || low.find("yll") == low.npos;
  out.mixed = x && y && x_centre != y_centre;
  out.transform = {words[x_centre ? "xllcenter" : "xllcorner"] - (x_centre ? dx / 2 : 0),
                   dx,
                   0,
                   words[y_centre ? "yllcenter" : "yllcorner"] - (y_centre ? dy / 2 : 0) + rows * dy,
                   0,
                   -dy};
  return out;
}

}  // namespace tafoni::io::impl
