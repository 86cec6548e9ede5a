#include "tafoni/grammar/impl/shared.h"

namespace tafoni::grammar::solid_empty {
namespace {

struct Empty final : Solid {
  double distance(Vec3d) const override { return -1e6; }
  Box3d bounds() const override { return {}; }
  std::vector<Bond> bonds() const override { return {}; }
};

}  // namespace

const SolidType& declaration() {
  static const SolidType type{
      .about = {.name = "empty",
                .doc = "Nothing: what a grammar begins with, and what ends a branch of it",
                .source = "[Zawadzki §2.1]"},
      .make = [](const Values& sizes) { return impl::make_solid<Empty>({}, sizes, "empty"); },
      .fit = [](Vec3d) { return Values{}; },
  };
  return type;
}

}  // namespace tafoni::grammar::solid_empty
