#include "tafoni/grammar/impl/shared.h"

namespace tafoni::grammar {
namespace {

struct Empty final : Solid {
  double distance(Vec3d) const override { return -1e6; }
  Box3d bounds() const override { return {}; }
  std::vector<Bond> bonds() const override { return {}; }
};

}  // namespace

const SolidType& solid_empty() {
  static const SolidType type{"empty",
                              "Nothing: what a grammar begins with, and what ends a branch of it",
                              "[Zawadzki §2.1]",
                              {},
                              [](const Values& sizes) { return impl::made<Empty>({}, sizes, "empty"); },
                              [](Vec3d) { return Values{}; }};
  return type;
}

}  // namespace tafoni::grammar
