// GRASS writes edges in degrees, minutes, seconds and a letter for the hemisphere, and * for null
// (r.out.ascii). GDAL makes 51 of 51:30:00N, 0 of *, and whole numbers of fractions where the header says so.

#include "tafoni/io/impl/grass_text.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <map>
#include <string_view>

#include "tafoni/core/error.h"
#include "tafoni/io/impl/grid_text.h"
#include "tafoni/io/impl/reading.h"

namespace tafoni::io::impl {
namespace {

/// Letters of a word that is shown.
constexpr std::size_t shown_of_cell = 20;

std::optional<double> plain_number(std::string_view text) {
  if (text.starts_with('+')) text.remove_prefix(1);
  std::string word(text);
  std::replace(word.begin(), word.end(), ',', '.');
  double value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error == std::errc::invalid_argument || end != word.data() + word.size() || !std::isfinite(value))
    return std::nullopt;
  return value;
}

/// Degrees from 51:30:00N, 51:30N or 51.5N; `letters` are the hemispheres, the negative one last.
std::optional<double> degrees_of(std::string_view text, std::string_view letters) {
  if (text.empty()) return std::nullopt;
  const std::size_t letter =
      letters.find(static_cast<char>(std::toupper(static_cast<unsigned char>(text.back()))));
  if (letter != letters.npos) text.remove_suffix(1);
  double sign = letter == 1 ? -1 : 1, value = 0, part = 1;
  if (text.starts_with('-')) {
    sign = -sign;
    text.remove_prefix(1);
  }
  for (bool more = true; more; part *= 60) {
    const std::size_t colon = text.find(':');
    more = colon != text.npos;
    const std::optional<double> number = plain_number(text.substr(0, colon));
    const bool seconds = part > 60, too_many = part > 3600;
    if (!number || *number < 0 || too_many || (seconds && more) || (part > 1 && *number >= 60))
      return std::nullopt;
    value += *number / part;
    text.remove_prefix(more ? colon + 1 : text.size());
  }
  return sign * value;
}

/// Goes through the text that comes in pieces: lines of the header, then words.
class GrassText {
 public:
  GrassText(const std::string& name, bool whole) : name_(name), whole_(whole) {}

  void look(std::string_view piece) {
    while (header_ && !piece.empty()) {
      const std::size_t end = std::min(piece.find('\n'), piece.size());
      std::string_view line = piece.substr(0, end);
      while (!line.empty() && std::isspace(static_cast<unsigned char>(line.front()))) line.remove_prefix(1);
      header_ = line.empty() || (std::isalpha(static_cast<unsigned char>(line.front())) && is_key(line));
      if (!header_ && std::isalpha(static_cast<unsigned char>(line.front())))
        fail_first_row(name_, line_, line.substr(0, line.find_first_of(" \t\r")));
      if (!header_) break;
      piece.remove_prefix(std::min(end + 1, piece.size()));
      ++line_;
    }
    std::size_t begin = 0;
    for (std::size_t i = 0; i <= piece.size(); ++i) {
      if (i < piece.size() && !std::isspace(static_cast<unsigned char>(piece[i]))) continue;
      if (i > begin) cell(piece.substr(begin, i - begin));
      begin = i + 1;
      line_ += i < piece.size() && piece[i] == '\n';
    }
  }

  GrassGrid finish(int width, int height) {
    std::array<double, 4> edges{};
    bool plain = true;
    static constexpr const char* keys[] = {"north", "south", "east", "west"};
    for (std::size_t i = 0; i < 4; ++i) {
      const std::string& text = header_words_[keys[i]];
      const std::optional<double> number = plain_number(text);
      plain = plain && number.has_value();
      const std::optional<double> edge = number ? number : degrees_of(text, i < 2 ? "NS" : "EW");
      if (!edge)
        fail(ErrorKind::input, "{}: its header says \"{}: {}\", which is neither a number nor degrees as {}.",
             name_, keys[i], text.substr(0, 2 * shown_of_cell), i < 2 ? "51:30:00N" : "3:15:00W");
      edges[i] = *edge;
    }
    if (edges[2] < edges[3] && !plain) edges[2] += 360;  // over the date line
    if (!plain)
      out_.transform = {edges[3], (edges[2] - edges[3]) / width,  0, edges[0],
                        0,        -(edges[0] - edges[1]) / height};
    const std::string& null = header_words_["null"];
    out_.null_is_word = !null.empty() && !plain_number(null) && !is_no_number(null);
    return std::move(out_);
  }

 private:
  bool is_key(std::string_view line) {
    const std::size_t colon = line.find(':');
    if (colon == line.npos) return false;
    std::string_view value = line.substr(colon + 1);
    const auto blank = [](char c) { return std::isspace(static_cast<unsigned char>(c)) != 0; };
    while (!value.empty() && blank(value.front())) value.remove_prefix(1);
    while (!value.empty() && blank(value.back())) value.remove_suffix(1);
    std::string key = lower_case(line.substr(0, colon));
    while (!key.empty() && blank(key.back())) key.pop_back();
    header_words_[key] = value;
    return true;
  }

  void cell(std::string_view word) {
    const std::string& null = header_words_["null"];
    const std::optional<double> number = plain_number(word);
    const std::uint64_t at = cells_++;
    if (!number && (word == "*" || word == null || is_no_number(word))) return out_.missing.add(at, at + 1);
    if (!number)
      fail(ErrorKind::input, "{}, line {}: \"{}\" stands where a height belongs; write nan for missing ones.",
           name_, line_, word.substr(0, shown_of_cell));
    if (whole_ && word.find_first_of(".,eE") != word.npos)
      fail(ErrorKind::input,
           "{}, line {}: \"{}\" stands in a grid whose header says type: int; write type: double there.",
           name_, line_, word.substr(0, shown_of_cell));
  }

  const std::string& name_;
  bool whole_, header_ = true;
  std::map<std::string, std::string> header_words_;
  std::size_t line_ = 1;
  std::uint64_t cells_ = 0;
  GrassGrid out_;
};

}  // namespace

GrassGrid read_grass_text(const std::string& file, const std::string& name, int width, int height,
                          bool whole) {
  GrassText text(name, whole);
  read_words(file, [&](std::string_view piece) { text.look(piece); });
  return text.finish(width, height);
}

}  // namespace tafoni::io::impl
