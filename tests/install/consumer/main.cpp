// A sphere of rock, carved by a smaller one: does the installed library work outside its tree?
#include <cstdio>

#include "tafoni/field/compiled.h"
#include "tafoni/field/tree.h"

int main() {
  tafoni::field::CloudBuilder cloud({});
  tafoni::field::add_point(cloud, {0, 0, 0}, 10, 4);
  tafoni::field::add_point(cloud, {0, 0, 0}, 5, -3);
  auto field = tafoni::field::compile(tafoni::field::blend({tafoni::field::constant(-1), cloud.finish()}));
  std::printf("%g %g\n", field.value({0, 0, 0}), field.value({20, 0, 0}));
  return field.value({0, 0, 0}) == 0.0f && field.value({20, 0, 0}) == -1.0f ? 0 : 1;
}
