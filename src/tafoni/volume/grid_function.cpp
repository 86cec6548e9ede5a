#include <memory>

#include "tafoni/volume/scalar_grid.h"

namespace tafoni::volume {
namespace {

/// Holds a copy of its own, so that edits of the original change no compiled field.
class GridFunction final : public field::Function {
 public:
  explicit GridFunction(const ScalarGrid& grid) : grid_(grid) {}

  void values(std::span<const Vec3d> points, std::span<float> out) const override {
    grid_.values(points, out);
  }
  void gradients(std::span<const Vec3d> points, std::span<Vec3f> out) const override {
    grid_.gradients(points, out);
  }
  Interval range(const Box3d& box) const override { return grid_.range(box); }

 private:
  ScalarGrid grid_;
};

}  // namespace

field::FunctionPtr as_function(const ScalarGrid& grid) {
  return std::make_shared<GridFunction>(grid);
}

}  // namespace tafoni::volume
