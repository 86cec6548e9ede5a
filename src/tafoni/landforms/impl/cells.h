#pragma once
// Numbers in the rows of a table that a user wrote.

#include <optional>
#include <string_view>

#include "tafoni/core/params.h"
#include "tafoni/math/vec.h"

namespace tafoni::landforms::impl {

/// The number in a column; none where it is empty. Throws Error{usage} naming `where` and the column.
std::optional<double> number_in(const Row& row, std::string_view column, std::string_view where);
/// The same, of a column that must not be empty.
double required_number_in(const Row& row, std::string_view column, std::string_view where);
/// Three numbers separated by commas or blanks.
Vec3d point_in(const Row& row, std::string_view column, std::string_view where);
std::string_view text_in(const Row& row, std::string_view column);

}  // namespace tafoni::landforms::impl
