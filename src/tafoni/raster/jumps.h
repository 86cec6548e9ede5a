#pragma once
// Heights that no ground has: neighbours that differ by far more than a pixel lets a slope do.

#include <cstddef>
#include <span>
#include <vector>

namespace tafoni::raster {

struct Jumps {
  std::size_t count = 0;  ///< pairs of neighbours across an edge
  double height = 0;      ///< the greatest difference; 0 where there is none
  int col = 0, row = 0;   ///< where that is
};

/// Counts the neighbours that differ by more than a limit, in rows that come one after another; NaN differs
/// from nothing.
class JumpSearch {
 public:
  explicit JumpSearch(double limit) : limit_(static_cast<float>(limit)) {}
  void add(std::span<const float> row);
  /// The next row does not lie beside the last, but so many rows further on.
  void skip(int rows);
  const Jumps& jumps() const { return jumps_; }

 private:
  void look(const float* from, const float* to, std::size_t count);
  float limit_;
  int row_ = 0;
  std::vector<float> above_;
  Jumps jumps_;
};

}  // namespace tafoni::raster
