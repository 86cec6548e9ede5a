// A long sculpting session: a scene with thousands of strokes, and what one more costs at each step.
//   bench_session [STROKES] [SHARE OF THOSE THAT ADD]

#include "tafoni/scene/session.h"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <vector>

#include "tafoni/core/random.h"

namespace {

using namespace tafoni;

double milliseconds(const std::function<void()>& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

struct Times {
  const char* name;
  std::vector<double> values;
  void print() {
    std::sort(values.begin(), values.end());
    std::printf("%-34s median %8.2f ms, 95th percentile %8.2f ms\n", name, values[values.size() / 2],
                values[values.size() * 95 / 100]);
  }
};

}  // namespace

int main(int argc, char** argv) {
  const int count = argc > 1 ? std::atoi(argv[1]) : 5000;
  const double adding = argc > 2 ? std::atof(argv[2]) : 0.25;
  const auto folder = std::filesystem::temp_directory_path() / "tafoni_bench_session";
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder);
  scene::Document document;
  document.directory = folder;
  document.scene.voxel = 1;
  document.terrain.generator = "coast";
  document.terrain.values = {{"width", std::int64_t{600}}, {"height", std::int64_t{600}}};
  scene::Session session(document, folder / "s.toml");
  const std::size_t layer = session.sculpt_layer();

  Random random(7);
  const auto stroke = [&] {
    scene::Stroke s;
    s.brush = "sphere";
    s.points = {{random.uniform(20, 580), random.uniform(20, 580), random.uniform(-5, 60)}};
    s.radius = random.uniform(3, 7);
    if (random.uniform() < adding) s.mode = "add";
    return s;
  };
  std::vector<scene::Stroke> many;
  for (int i = 0; i < count; ++i) many.push_back(stroke());
  std::printf("%d strokes in one transaction        %8.2f ms\n", count,
              milliseconds([&] { session.stroke(layer, many); }));
  std::printf("first update                         %8.2f ms\n", milliseconds([&] { session.update(); }));
  std::printf("first mesh                           %8.2f ms\n", milliseconds([&] { session.remesh(); }));

  Times stored{"one more: into the journal", {}}, updated{"one more: update", {}},
      meshed{"one more: its chunks meshed", {}}, undone{"undo, update and mesh", {}};
  for (int i = 0; i < 60; ++i) {
    const scene::Stroke one = stroke();
    stored.values.push_back(milliseconds([&] { session.stroke(layer, one); }));
    updated.values.push_back(milliseconds([&] { session.update(); }));
    meshed.values.push_back(milliseconds([&] { session.remesh(); }));
    if (i % 3 != 0) continue;
    undone.values.push_back(milliseconds([&] {
      session.undo(layer);
      session.update();
      session.remesh();
    }));
  }
  for (Times* t : {&stored, &updated, &meshed, &undone}) t->print();
  std::printf("fresh build of the same              %8.2f ms\n",
              milliseconds([&] { scene::build(session.document()); }));
  std::filesystem::remove_all(folder);
}
