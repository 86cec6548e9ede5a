#include "tafoni/scene/csv.h"

#include <array>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <optional>
#include <string>

#include "tafoni/core/error.h"
#include "tafoni/core/params.h"

namespace tafoni::scene {
namespace {

std::string_view trimmed(std::string_view s) {
  const auto first = s.find_first_not_of(" \t\r");
  if (first == std::string_view::npos) return {};
  s.remove_prefix(first);
  s.remove_suffix(s.size() - 1 - s.find_last_not_of(" \t\r"));
  if (s.size() >= 2 && s.front() == '"' && s.back() == '"') s = s.substr(1, s.size() - 2);
  return s;
}

/// What of a field goes into a message: short and printable.
std::string shown(std::string_view field) {
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
      const std::string_view line = trimmed(rest_.substr(0, end));
      rest_.remove_prefix(end == std::string_view::npos ? rest_.size() : end + 1);
      ++number_;
      if (line.empty() || line.front() == '#') continue;
      split(line);
      return true;
    }
    return false;
  }
  std::uint32_t number() const { return number_; }
  const std::vector<std::string_view>& fields() const { return fields_; }

  template <class... Args>
  [[noreturn]] void bad(fmt::format_string<Args...> text, Args&&... args) const {
    fail(ErrorKind::input, "{}:{}: {}", name_, number_, fmt::format(text, std::forward<Args>(args)...));
  }

  double number_at(std::size_t column, std::string_view title) const {
    const auto field = fields_[column];
    const auto value = to_number(field);
    if (!value) bad("{} is \"{}\", which is not a number", title, shown(field));
    if (!std::isfinite(*value)) bad("{} is \"{}\", which is not finite", title, shown(field));
    return *value;
  }
  static std::optional<double> to_number(std::string_view field) {
    if (field.starts_with('+')) field.remove_prefix(1);
    double value = 0;
    const auto [end, code] = std::from_chars(field.data(), field.data() + field.size(), value);
    if (end != field.data() + field.size()) return {};
    // Too large or too small: strtod tells which.
    if (code == std::errc::result_out_of_range) return std::strtod(std::string(field).c_str(), nullptr);
    if (code != std::errc()) return {};
    return value;
  }

 private:
  void split(std::string_view line) {
    fields_.clear();
    for (;;) {
      const auto comma = line.find(',');
      fields_.push_back(trimmed(line.substr(0, comma)));
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

float checked_float(const Lines& lines, std::size_t column, std::string_view title, double lo, double hi) {
  const double value = lines.number_at(column, title);
  if (value < lo || value > hi) lines.bad("{} = {} is outside {} to {} m", title, value, lo, hi);
  return static_cast<float>(value);
}

}  // namespace

std::vector<Primitive> parse_primitives_csv(std::string_view text, std::string_view name) {
  static const std::vector<std::string> titles = {"kind", "x", "y", "z", "radius", "energy"};
  enum { kind, x, y, z, radius, energy, count };
  constexpr std::string_view expected = "kind,x,y,z,radius,energy";

  Lines lines(text, name);
  if (!lines.next()) fail(ErrorKind::input, "{}: is empty; expected the header {}", name, expected);
  const std::size_t width = lines.fields().size();
  std::array<std::size_t, count> column;
  column.fill(width);
  for (std::size_t i = 0; i < width; ++i) {
    const std::string title = lower(lines.fields()[i]);
    std::size_t which = 0;
    while (which < count && titles[which] != title) ++which;
    if (which == count) {
      const std::string near = nearest(title.substr(0, 40), titles);
      lines.bad("column \"{}\" is not known{}; expected the header {}", shown(title),
                near.empty() ? "" : fmt::format(" (did you mean {}?)", near), expected);
    }
    if (column[which] != width) lines.bad("column {} is given twice", title);
    column[which] = i;
  }
  for (std::size_t i = 0; i < count; ++i)
    if (column[i] == width) lines.bad("column {} is missing; expected the header {}", titles[i], expected);

  std::vector<Primitive> out;
  while (lines.next()) {
    if (lines.fields().size() != width)
      lines.bad("has {} fields where the header has {}", lines.fields().size(), width);
    Primitive p;
    p.line = lines.number();
    const std::string word = lower(lines.fields()[column[kind]]);
    if (word != "point" && word != "sphere")
      lines.bad("kind is \"{}\"; expected point or sphere", shown(word));
    p.sphere = word == "sphere";
    p.position = {lines.number_at(column[x], "x"), lines.number_at(column[y], "y"),
                  lines.number_at(column[z], "z")};
    p.radius = checked_float(lines, column[radius], "radius", 1e-3, 1e5);
    p.energy = checked_float(lines, column[energy], "energy", -1e6, 1e6);
    out.push_back(p);
  }
  return out;
}

std::vector<Vec3d> parse_points_csv(std::string_view text, std::string_view name) {
  Lines lines(text, name);
  if (!lines.next()) fail(ErrorKind::input, "{}: is empty; expected the columns x,y,z", name);
  std::array<std::size_t, 3> column = {0, 1, 2};
  const std::array<std::string_view, 3> titles = {"x", "y", "z"};
  std::size_t width = lines.fields().size();
  const bool headless = Lines::to_number(lines.fields().front()).has_value();
  if (headless) {
    if (width < 3) lines.bad("has {} fields; expected x,y,z", width);
  } else {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      std::size_t i = 0;
      while (i < width && lower(lines.fields()[i]) != titles[axis]) ++i;
      if (i == width)
        lines.bad("column {} is missing; expected a header with the columns x,y,z", titles[axis]);
      column[axis] = i;
    }
  }
  std::vector<Vec3d> out;
  for (bool more = headless || lines.next(); more; more = lines.next()) {
    if (lines.fields().size() != width)
      lines.bad("has {} fields where the first line has {}", lines.fields().size(), width);
    out.push_back(
        {lines.number_at(column[0], "x"), lines.number_at(column[1], "y"), lines.number_at(column[2], "z")});
  }
  return out;
}

std::string read_text(const std::filesystem::path& file, std::uint64_t limit) {
  std::error_code code;
  if (std::filesystem::is_directory(file, code))
    fail(ErrorKind::input, "{}: is a folder; expected a file", file.string());
  std::ifstream in(file, std::ios::binary);
  if (!in) {
    fail(ErrorKind::input, "{}: {}", file.string(),
         std::filesystem::exists(file, code) ? "cannot be read; check its permissions" : "does not exist");
  }
  const auto size = std::filesystem::file_size(file, code);
  if (!code && size > limit)
    fail(ErrorKind::input, "{}: is {} bytes long; at most {} can be read", file.string(), size, limit);
  std::string text{std::istreambuf_iterator<char>(in), {}};
  if (in.bad()) fail(ErrorKind::input, "{}: cannot be read to its end", file.string());
  return text;
}

}  // namespace tafoni::scene
