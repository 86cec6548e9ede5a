#pragma once
// Numbers in the rows of a table, whose columns have checked them.

#include <optional>
#include <string_view>

#include "tafoni/core/params.h"
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

}  // namespace tafoni::landforms::impl
