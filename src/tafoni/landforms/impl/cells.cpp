#include "tafoni/landforms/impl/cells.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "tafoni/core/error.h"

namespace tafoni::landforms::impl {

std::string_view text_in(const Row& row, std::string_view column) {
  const auto found = row.find(column);
  if (found == row.end()) return {};
  std::string_view text = found->second;
  while (!text.empty() && (text.front() == ' ' || text.front() == '\t')) text.remove_prefix(1);
  while (!text.empty() && (text.back() == ' ' || text.back() == '\t')) text.remove_suffix(1);
  return text;
}

std::optional<double> number_in(const Row& row, std::string_view column, std::string_view where) {
  const std::string_view text = text_in(row, column);
  if (text.empty()) return {};
  double value = 0;
  const auto [end, wrong] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (wrong != std::errc() || end != text.data() + text.size() || !std::isfinite(value))
    fail(ErrorKind::usage, "{}: {} = \"{}\" is not a number", where, column, text);
  return value;
}

Vec3d point_in(const Row& row, std::string_view column, std::string_view where) {
  const std::string_view text = text_in(row, column);
  std::string_view left = text;
  double v[3];
  for (double& out : v) {
    left.remove_prefix(std::min(left.find_first_not_of(", \t"), left.size()));
    const auto [end, wrong] = std::from_chars(left.data(), left.data() + left.size(), out);
    if (wrong != std::errc() || !std::isfinite(out))
      fail(ErrorKind::usage, "{}: {} = \"{}\" must be three numbers, x y z", where, column, text);
    left.remove_prefix(static_cast<std::size_t>(end - left.data()));
  }
  if (left.find_first_not_of(", \t") != left.npos)
    fail(ErrorKind::usage, "{}: {} = \"{}\" must be three numbers, x y z", where, column, text);
  return {v[0], v[1], v[2]};
}

double required_number_in(const Row& row, std::string_view column, std::string_view where) {
  const auto value = number_in(row, column, where);
  if (!value) fail(ErrorKind::usage, "{}: every row needs a number for {}", where, column);
  return *value;
}

}  // namespace tafoni::landforms::impl
