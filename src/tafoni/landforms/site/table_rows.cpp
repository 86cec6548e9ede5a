#include "tafoni/landforms/site/table_rows.h"

#include <fmt/core.h>

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

std::optional<double> number_in(const Row& row, std::string_view column) {
  const auto numbers = numbers_in(text_in(row, column));
  return numbers && numbers->size() == 1 ? std::optional(numbers->front()) : std::nullopt;
}

Vec3d point_in(const Row& row, std::string_view column, std::string_view where) {
  const auto v = numbers_in(text_in(row, column));
  if (!v || v->size() != 3) fail(ErrorKind::usage, "{}: it needs {}, three numbers x y z", where, column);
  return {(*v)[0], (*v)[1], (*v)[2]};
}

double required_number_in(const Row& row, std::string_view column, std::string_view where) {
  const auto value = number_in(row, column);
  if (!value) fail(ErrorKind::usage, "{}: it needs a number for {}", where, column);
  return *value;
}

void warn_of_left_out(std::string_view what, std::ptrdiff_t used, std::ptrdiff_t given, Progress& progress) {
  if (used < given)
    progress.warn(
        fmt::format("{}: {} of {} places left out: outside the terrain or where the layer may not act; check "
                    "their positions",
                    what, given - used, given));
}

}  // namespace tafoni::landforms::impl
