#pragma once
// Numbers in the rows of a table, whose columns have checked them, and what is said of places given.

#include <cstddef>
#include <optional>
#include <string_view>

#include "tafoni/core/params.h"
#include "tafoni/core/progress.h"
#include "tafoni/math/vec.h"

namespace tafoni::landforms::impl {

/// The number in a column; none where it is empty.
std::optional<double> number_in(const Row& row, std::string_view column);
/// The number in a column that must not be empty. Throws Error{usage}: "WHERE: it needs COLUMN".
double required_number_in(const Row& row, std::string_view column, std::string_view where);
/// The three numbers in a column that must not be empty, likewise.
Vec3d point_in(const Row& row, std::string_view column, std::string_view where);
/// The text in a column without the blanks around it; empty where there is none.
std::string_view text_in(const Row& row, std::string_view column);

/// Warns where some of the places that a parameter gave are not used. `what` is "LANDFORM: PARAMETER".
void warn_of_left_out(std::string_view what, std::ptrdiff_t used, std::ptrdiff_t given, Progress& progress);

}  // namespace tafoni::landforms::impl
