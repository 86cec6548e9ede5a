// record FILE N: records N edits of a small terrain in a journal, and says of each when it was made.
#include <cstdio>
#include <cstdlib>
#include <exception>

#include "tafoni/runtime/destructible_terrain.h"

int main(int argc, char** argv) try {
  using namespace tafoni;
  if (argc != 3) return 2;
  volume::ScalarGrid grid({{-4, -4, -4}, 1, {9, 9, 9}}, 2, volume::Precision::single);
  runtime::DestructibleTerrain terrain(std::move(grid));
  terrain.record(argv[1]);
  for (int i = 0; i < std::atoi(argv[2]); ++i) {
    terrain.explode({0, 0, 0.1 * i}, 2, 5);
    std::printf("made\n");
    std::fflush(stdout);
  }
  terrain.sync();
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
