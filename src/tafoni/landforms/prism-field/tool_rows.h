#pragma once
// Tables of tools in scene files: what [Boggus]'s artist does with the mouse, written down.

#include <string_view>
#include <vector>

#include "tafoni/core/params.h"
#include "tafoni/volume/tool.h"

namespace tafoni::landforms::impl {

struct ToolUse {
  volume::Tool tool;
  volume::Edit mode;
};

std::vector<ParamInfo> tool_columns();

/// One a row, local: positions of the rows are world positions. Throws Error{usage} naming the row.
std::vector<ToolUse> tools_of(const Rows& rows, Vec3d origin, std::string_view where);

}  // namespace tafoni::landforms::impl
