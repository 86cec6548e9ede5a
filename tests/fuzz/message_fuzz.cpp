// Any bytes are either the message of one edit, the same that the edit gives, or one error of kind input; and
// a small terrain makes the edit, or refuses it with one sentence and stays as it was.

#include <memory>

#include "fuzz.h"

#include "tafoni/runtime/destructible_terrain.h"

using namespace tafoni;
using runtime::Message;
using runtime::Operation;

std::vector<std::string> fuzz_seeds() {
  using volume::Edit;
  using volume::Tool;
  std::vector<Vec3d> ball;
  for (int i = 0; i < 20; ++i)
    ball.push_back(2 * Vec3d{std::cos(2.4 * i), std::sin(2.4 * i), std::cos(0.15 * i)});
  const std::vector<Operation> operations = {
      runtime::ToolUse{Tool::sphere({1, 2, 0}, 1.5), Edit::remove},
      runtime::ToolUse{Tool::capsule({-3, 0, 0}, {3, 1, -1}, 0.7), Edit::add},
      runtime::ToolUse{Tool::box({0, 0, -1}, {1, 2, 0.5}, 0.3), Edit::remove},
      runtime::ToolUse{Tool::hull(ball), Edit::add},
      runtime::Explosion{{0, 1, 0}, 3, 5},
      runtime::Radial{{0, 0, 0}, 4, {-3, 1, 0}},
      runtime::Rewind{2},
  };
  std::vector<std::string> seeds;
  for (const Operation& operation : operations) {
    const Message message = runtime::encode(operation);
    seeds.emplace_back(reinterpret_cast<const char*>(message.data()), message.size());
  }
  return seeds;
}

namespace {

/// Level ground of 40^3 samples, of which an edit may look at half.
std::unique_ptr<runtime::DestructibleTerrain> level() {
  volume::ScalarGrid grid({{-5, -5, -5}, 0.25, {40, 40, 40}}, 0);
  grid.edit(grid.samples(), [&](Vec3i first, std::span<float> row) {
    for (float& v : row) v = static_cast<float>(-grid.frame().position(first).z);
  });
  runtime::DestructibleTerrainSettings settings;
  settings.band = 1;
  settings.rewind = true;
  settings.edit_work = 32000;
  settings.memory = 4 << 20;
  return std::make_unique<runtime::DestructibleTerrain>(std::move(grid), Vec3d{}, settings);
}

void apply(const Message& message) {
  static std::unique_ptr<runtime::DestructibleTerrain> terrain;
  if (!terrain || terrain->version() > 200) terrain = level();
  const std::uint64_t version = terrain->version();
  try {
    terrain->apply({&message, 1});
    require(terrain->version() == version + 1);
    for (const Vec3i& chunk : terrain->snapshot()->chunks())
      for (const Vec3f& p : terrain->chunk(chunk).mesh->positions)
        require(std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z));
  } catch (const Error& error) {
    require(error.kind() == ErrorKind::usage && terrain->version() == version);
    if (std::string_view(error.what()).find("memory") != std::string_view::npos) terrain = level();
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Message message(size);
  if (size > 0) std::memcpy(message.data(), data, size);
  if (accepts([&] { require(runtime::encode(runtime::decode(message)) == message); })) apply(message);
  return 0;
}
