#pragma once
// Scene files for the tests of reading, changing and writing them.

#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tafoni/core/error.h"
#include "tafoni/landforms/landform.h"
#include "tafoni/scene/document/document.h"

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

/// Something that a column takes, another for another `n`.
inline std::string cell_text(const ParamInfo& column, std::size_t n) {
  switch (column.kind) {
    case ValueKind::choice:
      return column.choices[n % column.choices.size()];
    case ValueKind::real:
      return fmt::format("{}", n);
    case ValueKind::numbers:
      return fmt::format("{}, 0.5, 0.25", n);
    default:
      return std::string(n + 1, 'A');
  }
}

/// A layer with a table of two rows between two others, for each landform that has a table.
struct TableScene {
  std::string type, table, column, text;
  std::string cell[4];  ///< of that column; the table holds the first two
};

inline std::vector<TableScene> table_scenes() {
  std::vector<TableScene> out;
  for (const auto* type : landforms::all_landforms())
    for (const ParamInfo& info : type->about.params)
      if (!info.columns.empty()) {
        const ParamInfo& column = info.columns.front();
        TableScene scene{type->about.name, info.name, column.name, "", {}};
        for (std::size_t n = 0; n < 4; ++n) scene.cell[n] = cell_text(column, n);
        const std::string second = column.kind == ValueKind::real      ? scene.cell[1]
                                   : column.kind == ValueKind::numbers ? "[" + scene.cell[1] + "]"
                                                                       : "\"" + scene.cell[1] + "\"";
        const std::string row = fmt::format("[[layer.{}]]\n{} = ", info.name, column.name);
        scene.text = fmt::format(
            "[terrain]\nsource = \"a.tif\"\n\n[[layer]]\ntype = \"karst\"\n\n"
            "[[layer]]\ntype = \"{}\"\n\n# One.\n{}\"{}\"  # kept\n\n# Two.\n{}{}\n\n"
            "# Last.\n[[layer]]\ntype = \"sea-cliff\"\n",
            type->about.name, row, scene.cell[0], row, second);
        out.push_back(scene);
      }
  return out;
}

}  // namespace tafoni::scene
