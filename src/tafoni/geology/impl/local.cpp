#include "tafoni/geology/impl/local.h"

#include "tafoni/core/error.h"

namespace tafoni::geology::impl {

std::vector<Vec3d> triples(const std::vector<double>& numbers, std::size_t least, std::string_view where) {
  if (numbers.size() < 3 * least || numbers.size() % 3 != 0)
    fail(ErrorKind::usage, "{}: position has {} numbers, but needs x, y, z of {} or more", where,
         numbers.size(), least == 1 ? "one place" : fmt::format("{} places", least));
  std::vector<Vec3d> out;
  for (std::size_t i = 0; i < numbers.size(); i += 3)
    out.push_back({numbers[i], numbers[i + 1], numbers[i + 2]});
  return out;
}

}  // namespace tafoni::geology::impl
