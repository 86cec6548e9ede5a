// [Boggus]'s table 1: updates a second of a prism-field beside a single heightfield and cube voxels, at
// 10 to 1000 samples a side and a sphere a tenth of the side across. An update is one random sphere taken out
// and new geometry. The peers are the paper's: all quads of the heightfield, a cube of six quads for every
// voxel, made anew into a buffer that is used again. The prism-field is measured with the chunks that
// changed, and with all of them ("whole"). Model by model in turn in one process, since machines drift.
// Prints CSV.
//
//   bench_prism [THREADS]
//
// Voxels are left out above 200 a side: 10^9 cubes take minutes each time.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <string>
#include <vector>

#include "measure.h"
#include <time.h>

#include "tafoni/core/parallel.h"
#include "tafoni/core/random.h"
#include "tafoni/surface/prism_mesher.h"
#include "tafoni/volume/prism_convert.h"

namespace {

using namespace tafoni;

/// Of the calling thread, which a busy machine distorts less; of the wall where there are several threads.
bool by_wall = false;
double seconds() {
  return bench::clock_seconds(by_wall ? CLOCK_MONOTONIC : CLOCK_THREAD_CPUTIME_ID);
}

struct Vertex {
  Vec3f position, normal;
};

/// Where brute force puts its quads: no larger than a graphics card would be fed at once.
class Sink {
 public:
  void quad(Vec3f a, Vec3f b, Vec3f c, Vec3f d, Vec3f normal) {
    if (at_ + 4 > buffer_.size()) at_ = 0;
    for (const Vec3f& p : {a, b, c, d}) buffer_[at_++] = {p, normal};
    ++quads_;
  }
  std::uint64_t hash() const {
    std::uint64_t h = quads_;
    for (std::size_t n = 0; n < at_; n += 61) {
      std::uint32_t bits[3];
      std::memcpy(bits, &buffer_[n].position, sizeof bits);
      h = hash_combine(h, bits[0] ^ (std::uint64_t{bits[1]} << 21) ^ (std::uint64_t{bits[2]} << 42));
    }
    return h;
  }
  void clear() { at_ = 0; }
  std::uint64_t quads() const { return quads_; }

 private:
  std::vector<Vertex> buffer_ = std::vector<Vertex>(std::size_t{1} << 20);
  std::size_t at_ = 0;
  std::uint64_t quads_ = 0;
};

class Heightfield {
 public:
  explicit Heightfield(int n)
      : n_(n), heights_(static_cast<std::size_t>(n) * n, 0.6f * static_cast<float>(n)) {}

  void update(Vec3d c, double r, Sink& sink) {
    const int i0 = std::max(0, static_cast<int>(c.x - r)),
              i1 = std::min(n_ - 1, static_cast<int>(c.x + r) + 1);
    const int j0 = std::max(0, static_cast<int>(c.y - r)),
              j1 = std::min(n_ - 1, static_cast<int>(c.y + r) + 1);
    for (int j = j0; j <= j1; ++j)
      for (int i = i0; i <= i1; ++i) {
        const double left = r * r - (i - c.x) * (i - c.x) - (j - c.y) * (j - c.y);
        if (left <= 0) continue;
        const double half = std::sqrt(left);
        float& h = at(i, j);
        if (h > c.z - half && h < c.z + half) h = static_cast<float>(c.z - half);
      }
    sink.clear();
    for (int j = 0; j + 1 < n_; ++j)
      for (int i = 0; i + 1 < n_; ++i) {
        const float x = static_cast<float>(i), y = static_cast<float>(j);
        const float a = at(i, j), b = at(i + 1, j), d = at(i + 1, j + 1), e = at(i, j + 1);
        const Vec3f normal = normalized(Vec3f{a - b + e - d, a - e + b - d, 2});
        sink.quad({x, y, a}, {x + 1, y, b}, {x + 1, y + 1, d}, {x, y + 1, e}, normal);
      }
  }

 private:
  float& at(int i, int j) { return heights_[static_cast<std::size_t>(j) * n_ + i]; }
  int n_;
  std::vector<float> heights_;
};

class Voxels {
 public:
  explicit Voxels(int n) : n_(n), solid_(static_cast<std::size_t>(n) * n * n, 0) {
    for (int k = 0; k < n * 6 / 10; ++k)
      for (int j = 0; j < n; ++j)
        for (int i = 0; i < n; ++i) at(i, j, k) = 1;
  }

  void update(Vec3d c, double r, Sink& sink) {
    const auto lo = [](double v) { return std::max(0, static_cast<int>(v)); };
    const auto hi = [&](double v) { return std::min(n_ - 1, static_cast<int>(v) + 1); };
    for (int k = lo(c.z - r); k <= hi(c.z + r); ++k)
      for (int j = lo(c.y - r); j <= hi(c.y + r); ++j)
        for (int i = lo(c.x - r); i <= hi(c.x + r); ++i)
          if ((i - c.x) * (i - c.x) + (j - c.y) * (j - c.y) + (k - c.z) * (k - c.z) < r * r) at(i, j, k) = 0;
    sink.clear();
    for (int k = 0; k < n_; ++k)
      for (int j = 0; j < n_; ++j)
        for (int i = 0; i < n_; ++i)
          if (at(i, j, k)) cube(static_cast<float>(i), static_cast<float>(j), static_cast<float>(k), sink);
  }

 private:
  std::uint8_t& at(int i, int j, int k) {
    const std::size_t n = n_;
    return solid_[(static_cast<std::size_t>(k) * n + j) * n + static_cast<std::size_t>(i)];
  }
  static void cube(float x, float y, float z, Sink& s) {
    const float X = x + 1, Y = y + 1, Z = z + 1;
    s.quad({x, y, z}, {x, Y, z}, {X, Y, z}, {X, y, z}, {0, 0, -1});
    s.quad({x, y, Z}, {X, y, Z}, {X, Y, Z}, {x, Y, Z}, {0, 0, 1});
    s.quad({x, y, z}, {X, y, z}, {X, y, Z}, {x, y, Z}, {0, -1, 0});
    s.quad({x, Y, z}, {x, Y, Z}, {X, Y, Z}, {X, Y, z}, {0, 1, 0});
    s.quad({x, y, z}, {x, y, Z}, {x, Y, Z}, {x, Y, z}, {-1, 0, 0});
    s.quad({X, y, z}, {X, Y, z}, {X, Y, Z}, {X, y, Z}, {1, 0, 0});
  }
  int n_;
  std::vector<std::uint8_t> solid_;
};

class Prisms {
 public:
  explicit Prisms(int n) : fields_(volume::prism_box({{}, 1, 1, n, n}, 0, 0.6 * n)) {
    mesher_.update(fields_, {});
  }

  void update(Vec3d c, double r, bool whole) {
    volume::ColumnBox changed = fields_.apply(volume::Tool::sphere(c, r), volume::Edit::remove);
    if (whole) changed = {0, 0, fields_.frame().nx - 1, fields_.frame().ny - 1};
    for (const auto& change : mesher_.update(fields_, changed)) {
      const surface::PrismChunkMesh& chunk = mesher_.chunk(change.chunk);
      triangles_ += chunk.triangles.size();
      for (std::size_t n = 0; n < chunk.positions.size(); n += 61) {
        std::uint32_t bits[3];
        std::memcpy(bits, &chunk.positions[n], sizeof bits);
        hash_ =
            hash_combine(hash_, bits[0] ^ (std::uint64_t{bits[1]} << 21) ^ (std::uint64_t{bits[2]} << 42));
      }
    }
  }
  std::uint64_t hash() const { return hash_; }
  std::uint64_t triangles() const { return triangles_; }
  int layers() const { return fields_.layers(); }

 private:
  volume::PrismFields fields_;
  surface::PrismMesher mesher_;
  std::uint64_t hash_ = 0, triangles_ = 0;
};

struct Model {
  std::string name;
  std::function<void(Vec3d, double)> update;
  std::function<std::uint64_t()> hash;
  int batch;  ///< updates a turn
  double time = 0;
  int updates = 0;
};

void row(int n) {
  Heightfield heights(n);
  Voxels voxels(n <= 200 ? n : 2);
  Prisms prisms(n), whole(n);
  Sink height_sink, voxel_sink;
  std::vector<Model> models{
      {"heightfield", [&](Vec3d c, double r) { heights.update(c, r, height_sink); },
       [&] { return height_sink.hash(); }, 2},
      {"prism-field", [&](Vec3d c, double r) { prisms.update(c, r, false); }, [&] { return prisms.hash(); },
       10},
      {"prism-field whole", [&](Vec3d c, double r) { whole.update(c, r, true); },
       [&] { return whole.hash(); }, 1},
  };
  if (n <= 200)
    models.push_back({"voxels", [&](Vec3d c, double r) { voxels.update(c, r, voxel_sink); },
                      [&] { return voxel_sink.hash(); }, 1});
  const int turns = n <= 50 ? 100 : n <= 200 ? 12 : 5;
  for (int turn = 0; turn < turns; ++turn)
    for (std::size_t m = 0; m < models.size(); ++m) {
      Random random(7, turn);
      const double from = seconds();
      for (int k = 0; k < models[m].batch; ++k) {
        const double x = random.uniform(0, n - 1), y = random.uniform(0, n - 1);
        models[m].update({x, y, random.uniform(0, 0.6 * n)}, 0.05 * n);
      }
      models[m].time += seconds() - from;
      models[m].updates += models[m].batch;
    }
  for (const Model& m : models)
    std::printf("%d,%s,%d,%.1f,%d,%016llx\n", n, m.name.c_str(), m.updates, m.updates / m.time,
                m.name == "prism-field" ? prisms.layers() : 0, static_cast<unsigned long long>(m.hash()));
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  const int threads = argc > 1 ? std::atoi(argv[1]) : 1;
  set_thread_count(threads);
  by_wall = threads != 1;
  std::printf("samples a side,model,updates,updates a second,layers,hash\n");
  for (const int n : {10, 50, 200, 1000}) row(n);
}
