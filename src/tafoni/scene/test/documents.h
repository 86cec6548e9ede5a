#pragma once
// Scene files for the tests of reading, changing and writing them.

#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tafoni/core/error.h"
#include "tafoni/landforms/landform.h"
#include "tafoni/scene/document.h"

namespace tafoni::scene {

inline constexpr std::string_view full = R"(# The coast, second try.
[scene]
seed = 7
voxel = 0.5            # metres

[terrain]
source = "pointsal.tif"   # anything GDAL reads
window = [
  10, 20,   # column, row
  300, 200,
]

[[geology]]
type = "strata"
thickness = 14.0

# Storm waves.
[[layer]]
type = "sea-cliff"
sea_level = 3.0
range = 8.25   # as measured

[[layer]]
type = "karst"
enabled = true
region = "plateau.geojson"
altitude = [20, 120.5]

[[layer]]
type = "primitives"
file = "spheres.csv"
)";

inline constexpr std::string_view nested = R"([terrain]
source = "a.tif"

# Left of the fault.
[[geology]]
type = "contact"
dip = 80.0

[[geology.of]]
type = "turbulence"

# Right of it.
[[geology.of]]
type = "fold"
name = "anticline"   # as mapped

# What is folded.
[[geology.of.of]]
type = "strata"
thickness = [4, 9]   # log of the well

[[geology]]
type = "sphere"
position = [1, 2, 3]

[[layer]]
type = "karst"
)";

/// What parsing the text says is wrong with it.
inline std::string message(std::string_view text) {
  try {
    parse_scene(text, "dir/s.toml");
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::input);
    return error.what();
  }
  return "no error";
}

/// A layer with a table of two rows between two others, for each landform that has a table.
struct TableScene {
  std::string type, table, column, text;
};

inline std::vector<TableScene> table_scenes() {
  std::vector<TableScene> out;
  for (const auto* type : landforms::all_landforms())
    for (const ParamInfo& info : type->params)
      if (!info.columns.empty()) {
        const std::string& column = info.columns.front().name;
        const std::string row = fmt::format("[[layer.{}]]\n{} = ", info.name, column);
        out.push_back({type->name, info.name, column,
                       fmt::format("[terrain]\nsource = \"a.tif\"\n\n[[layer]]\ntype = \"karst\"\n\n"
                                   "[[layer]]\ntype = \"{}\"\n\n# One.\n{}\"A\"  # kept\n\n# Two.\n{}2\n\n"
                                   "# Last.\n[[layer]]\ntype = \"sea-cliff\"\n",
                                   type->name, row, row)});
      }
  return out;
}

}  // namespace tafoni::scene
