#pragma once
// The case table of marching cubes, derived by rule instead of typed in.
//
// Corner c = x + 2y + 4z of a cell has bit c of the case set when it is solid. On an ambiguous face each
// solid corner is cut off by itself: a rule that sees only the face's own corners, so both cells agree.
// Loops are triangulated so that no diagonal joins two edges of one cell face; hence a diagonal is never
// an edge of the neighbour's too, no triangle is flat in a face, and the surface is 2-manifold.

#include <array>
#include <cstdint>

namespace tafoni::surface::impl {

/// Edges of a cell: x edges 0..3 (y + 2z), y edges 4..7 (4 + x + 2z), z edges 8..11 (8 + x + 2y).
struct CellCase {
  std::uint8_t triangles = 0;  ///< at most 5
  std::array<std::uint8_t, 15> edges{};
};

using CaseTable = std::array<CellCase, 256>;
const CaseTable& case_table();

}  // namespace tafoni::surface::impl
