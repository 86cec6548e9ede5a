#include "tafoni/landforms/rock/erosion.h"

#include <gtest/gtest.h>

#include "tafoni/field/compiled.h"

namespace tafoni::landforms {
namespace {

TEST(Erosion, EffectFollowsThePaper) {
  for (double beta : {0.0, 0.2, 1.0})
    for (double rho = 0; rho <= 1; rho += 0.25) {
      EXPECT_EQ(erosion_effect(rho, 0, beta), 0);
      EXPECT_NEAR(erosion_effect(1, 1, beta), beta, 1e-15);
      EXPECT_NEAR(erosion_effect(0, 1, beta), 1, 1e-15);
      for (double stress = 0.25; stress <= 1; stress += 0.25) {
        EXPECT_GT(erosion_effect(rho, stress, beta) + (rho == 1 && beta == 0),
                  erosion_effect(rho, stress - 0.25, beta));
        if (rho > 0 && beta < 1) {
          EXPECT_LT(erosion_effect(rho, stress, beta), erosion_effect(rho - 0.25, stress, beta));
        }
      }
    }
}

TEST(Erosion, TubeOpensToTheWantedRadius) {
  constexpr double amplitude = 7.5, open = 3, reach = 5, step = 1.2;
  field::CloudBuilder cloud{field::CloudSettings{}};
  for (int i = -40; i <= 40; ++i)
    add_point(cloud, {i * step, 0, 0}, reach, -tube_energy(amplitude, open, reach, step));
  const auto f = field::compile(field::blend({field::constant(amplitude), cloud.finish()}));
  for (double x = 0; x < 3; x += 0.13) {
    EXPECT_LT(f.value({x, 0, 0.97 * open}), 0);
    EXPECT_GT(f.value({x, 1.03 * open, 0}), 0);
  }
}

}  // namespace
}  // namespace tafoni::landforms
