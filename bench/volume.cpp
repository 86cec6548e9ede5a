// Fields as volumes: how fast they are sampled, how large their files are, and what a way there and back
// costs.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "scene_s.h"
#include <fmt/core.h>
#include <unistd.h>

#include "tafoni/core/error.h"
#include "tafoni/core/parallel.h"
#include "tafoni/field/compiled.h"
#include "tafoni/scene/build/build.h"
#include "tafoni/scene/products/mesh_scene.h"
#include "tafoni/scene/products/volume_scene.h"
#include "tafoni/surface/polygonize.h"
#include "tafoni/volume/sample.h"

namespace {

using namespace tafoni;
namespace fs = std::filesystem;
using bench::seconds;

/// The least of three runs.
double least(const std::function<void()>& run) {
  double best = 1e30;
  for (int i = 0; i < 3; ++i) {
    const double start = seconds();
    run();
    best = std::min(best, seconds() - start);
  }
  return best;
}

void sampling() {
  fmt::print("\nScene S(10,000), 512 x 512 x 96 samples of 2.5 m about its middle\n");
  fmt::print("{:<34} {:>9} {:>12} {:>10} {:>8}\n", "", "seconds", "M samples/s", "MB", "ratio");
  const bench::Ground ground = bench::make_ground();
  field::CloudBuilder cloud({"point", bench::influence, {}});
  for (const bench::Sphere& s : bench::tunnels(10000)) field::add_point(cloud, s.center, s.radius, s.energy);
  const field::CompiledField field = field::compile(field::blend(
      {field::heightfield(ground.heights, {bench::influence, bench::amplitude}), cloud.finish()}));
  const double h = 2.5, middle = bench::extent / 2;
  const volume::GridFrame frame{{middle - 256 * h, middle - 256 * h, -48 * h}, h, {512, 512, 96}};
  const double samples = 512.0 * 512 * 96;
  const double brute = least([&] {
    std::vector<float> row(512 * 512);
    std::vector<Vec3d> points(row.size());
    for (int z = 0; z < frame.size.z; ++z) {
      for (int y = 0; y < 512; ++y)
        for (int x = 0; x < 512; ++x) points[y * 512 + x] = frame.position({x, y, z});
      field.values(points, row);
    }
  });
  const auto line = [&](const char* name, double time, double bytes) {
    fmt::print("{:<34} {:>9.3f} {:>12.1f} {:>10.1f} {:>8.1f}\n", name, time, samples / time / 1e6,
               bytes / 1e6, brute / time);
  };
  line("every sample, one by one (values())", brute, samples * 4);
  for (const double band : {0.0, 4 * h}) {
    std::uint64_t bytes = 0;
    const double time = least([&] {
      bytes = volume::sample(field, frame, {volume::Precision::single, band}).bytes();
    });
    line(band > 0 ? "sample(), band of 4 cells" : "sample(), all values", time, static_cast<double>(bytes));
  }
}

/// Mean and greatest distance of the vertices to the surface of `truth`, to first order.
std::pair<double, double> strays(const mesh::Mesh& mesh, const field::CompiledField& truth) {
  std::vector<Vec3d> points;
  for (const Vec3f p : mesh.positions) points.push_back(to_double(p));
  std::vector<float> f(points.size());
  std::vector<Vec3f> g(points.size());
  truth.gradients(points, f, g);
  double sum = 0, worst = 0;
  for (std::size_t i = 0; i < f.size(); ++i) {
    const double d = std::abs(f[i]) / std::max(0.2, length(to_double(g[i])));
    sum += d, worst = std::max(worst, d);
  }
  return {sum / static_cast<double>(points.size()), worst};
}

class Distance : public field::Function {
 public:
  explicit Distance(std::function<double(Vec3d)> at) : at_(std::move(at)) {}
  void values(std::span<const Vec3d> points, std::span<float> out) const override {
    for (std::size_t i = 0; i < points.size(); ++i) out[i] = static_cast<float>(at_(points[i]));
  }
  Interval range(const Box3d& box) const override {
    const double reach = length(box.size()) / 2, middle = at_(box.center());
    return {static_cast<float>(middle - reach - 1e-3), static_cast<float>(middle + reach + 1e-3)};
  }

 private:
  std::function<double(Vec3d)> at_;
};

void errors() {
  fmt::print(
      "\nField to grid of cell h to mesh of cell 0.37 m: distance of its vertices to the field's surface\n");
  fmt::print("{:<10} {:>6} {:>14} {:>12} {:>12} {:>8}\n", "", "h m", "predicted mm", "worst mm", "mean mm",
             "order");
  struct Shape {
    const char* name;
    std::function<double(Vec3d)> at;
    double curvature;  // k1 + k2 of the surface
  };
  for (const Shape& s :
       {Shape{"sphere 20", [](Vec3d p) { return 20 - length(p); }, 2.0 / 20},
        Shape{"torus 16/6", [](Vec3d p) { return 6 - std::hypot(std::hypot(p.x, p.y) - 16, p.z); },
              1.0 / 6 + 1.0 / 10}}) {
    const field::CompiledField truth = field::compile(field::function(std::make_shared<Distance>(s.at)));
    double before = 0;
    for (const double h : {2.0, 1.0, 0.5}) {
      const volume::ScalarGrid grid =
          volume::sample(truth, volume::frame_over({{-26, -26, -26}, {26, 26, 26}}, h), {});
      surface::PolygonizeSettings settings;
      settings.voxel = 0.37;
      settings.region = {{-25, -25, -25}, {25, 25, 25}};
      const mesh::Mesh mesh =
          surface::polygonize(field::compile(field::function(volume::as_function(grid))), settings);
      // The mesher's own straight edges err by its cell, so the grid's share is what the field of the grid
      // says.
      const auto [mean, worst] = strays(mesh, truth);
      fmt::print("{:<10} {:>6.2f} {:>14.2f} {:>12.2f} {:>12.2f} {:>8}\n", s.name, h,
                 1000 * (h * h + settings.voxel * settings.voxel) / 8 * s.curvature, 1000 * worst,
                 1000 * mean, before > 0 ? fmt::format("{:.2f}", std::log2(before / mean)) : "");
      before = mean;
    }
  }
}

struct Apart {
  double mean = 0, worst = 0;  ///< metres, as far as half a metre
  double moved = 0;            ///< share of vertices further than a millimetre
};

/// Distance of the vertices of `a` to the nearest of `b`.
Apart apart(const mesh::Mesh& a, const mesh::Mesh& b) {
  constexpr double cell = 0.5;
  using Key = std::array<std::int32_t, 3>;
  const auto world = [](const mesh::Mesh& mesh, std::size_t i) {
    return to_double(mesh.positions[i]) + mesh.origin;
  };
  const auto key = [&](Vec3d p) {
    return Key{static_cast<std::int32_t>(std::floor(p.x / cell)),
               static_cast<std::int32_t>(std::floor(p.y / cell)),
               static_cast<std::int32_t>(std::floor(p.z / cell))};
  };
  std::vector<std::pair<Key, std::uint32_t>> sorted(b.positions.size());
  for (std::size_t i = 0; i < sorted.size(); ++i)
    sorted[i] = {key(world(b, i)), static_cast<std::uint32_t>(i)};
  std::sort(sorted.begin(), sorted.end());
  Apart out;
  const double share = 1.0 / static_cast<double>(a.positions.size());
  for (std::size_t i = 0; i < a.positions.size(); ++i) {
    const Vec3d p = world(a, i);
    double best = cell;
    for (int n = 0; n < 27; ++n) {
      Key k = key(p);
      k[0] += n % 3 - 1, k[1] += n / 3 % 3 - 1, k[2] += n / 9 - 1;
      for (auto at = std::lower_bound(sorted.begin(), sorted.end(), std::pair{k, 0u});
           at != sorted.end() && at->first == k; ++at)
        best = std::min(best, length(world(b, at->second) - p));
    }
    out.mean += best * share, out.worst = std::max(out.worst, best);
    if (best > 1e-3) out.moved += share;
  }
  return out;
}

void karst(const fs::path& file, const fs::path& folder) {
  scene::Document document = scene::load_scene(file);
  for (const char* words : {"terrain.width=240", "terrain.height=240", "karst.sinks=6", "karst.faces=6",
                            "scene.voxel=2", "scene.boundary=solid", "scene.min_fragment=0"})
    scene::set(document, words);
  const scene::BuiltScene built = scene::build(document);
  const mesh::Mesh direct = scene::mesh_scene(built).mesh;
  const field::CompiledField truth = built.field_for(surface::Boundary::solid);
  const auto stray = [&](mesh::Mesh mesh) {
    const Vec3f shift = to_float(mesh.origin - built.terrain.origin);
    for (Vec3f& p : mesh.positions) p = p + shift;
    return strays(mesh, truth).first / built.voxel;
  };
  fmt::print("\n{}, 1,200 m square, voxel {:g} m, {} triangles: saved as a volume and meshed again\n",
             file.filename().string(), built.voxel, direct.triangles.size());
  fmt::print("{:<20} {:>7} {:>8} {:>7} {:>10} {:>11} {:>11} {:>9} {:>11}\n", "", "MB", "write s", "read s",
             "triangles", "mean, cells", "worst, cells", "moved %", "stray, cells");
  fmt::print("{:<20} {:>7} {:>8} {:>7} {:>10} {:>11} {:>11} {:>9} {:>11.4f}\n", "the mesh itself", "", "", "",
             direct.triangles.size(), "", "", "", stray(direct));
  struct Case {
    const char* name;
    volume::Precision precision;
    double band;  // cells
  };
  for (const Case& c :
       {Case{"band-4.vdb", volume::Precision::single, 4}, Case{"half-band-4.vdb", volume::Precision::half, 4},
        Case{"band-4.tvol", volume::Precision::single, 4},
        Case{"half-band-4.tvol", volume::Precision::half, 4},
        Case{"all.tvol", volume::Precision::single, 0}}) {
    const fs::path path = folder / c.name;
    const volume::SampleSettings settings{c.precision, c.band * built.voxel};
    const io::Volume volume =
        path.extension() == ".vdb" ? scene::level_set(built, settings) : scene::sample_scene(built, settings);
    double start = seconds();
    try {
      io::write_volume(path, volume);
    } catch (const Error& error) {
      fmt::print("{:<20} {}\n", c.name, error.what());
      continue;
    }
    const double write = seconds() - start;
    start = seconds();
    io::read_volume(path);
    const double read = seconds() - start;
    scene::Document again = scene::volume_document(path.string());
    again.scene.min_fragment = 0;
    const mesh::Mesh mesh = scene::mesh_scene(scene::build(again)).mesh;
    const Apart there = apart(direct, mesh), back = apart(mesh, direct);
    fmt::print("{:<20} {:>7.1f} {:>8.2f} {:>7.2f} {:>10} {:>11.2g} {:>11.2g} {:>9.3f} {:>11.4f}\n", c.name,
               static_cast<double>(fs::file_size(path)) / 1e6, write, read, mesh.triangles.size(),
               std::max(there.mean, back.mean) / built.voxel, std::max(there.worst, back.worst) / built.voxel,
               100 * std::max(there.moved, back.moved), stray(mesh));
  }
}

}  // namespace

int main(int argc, char** argv) {
  const fs::path folder = fs::temp_directory_path() / ("bench_volume." + std::to_string(::getpid()));
  fs::create_directories(folder);
  sampling();
  errors();
  if (argc > 1) karst(argv[1], folder);
  fs::remove_all(folder);
}
