// Dabs of radius 8, in strokes, in a grid of 512 x 512 x 256 samples in chunks of 32^3: triangles and normals
// of all touched chunks, by this program beside VTK's flying edges a chunk, in one process, dab by dab in
// turn since machines drift. VTK's samples are laid out for it beforehand, out of the clock. Prints CSV.
//
//   bench_dab [DABS] [THREADS]
//
// THREADS (1 unless given) are this program's; VTK gets one chunk after the other on as many.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "measure.h"
#include <time.h>

#include "tafoni/core/parallel.h"
#include "tafoni/core/random.h"
#include "tafoni/mesh/validate.h"
#include "tafoni/surface/dense_grid.h"
#include "tafoni/surface/grid_mesher.h"
#include "tafoni/volume/edit.h"

#if defined(TAFONI_BENCH_VTK)
#include <vtkFloatArray.h>
#include <vtkFlyingEdges3D.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#endif

namespace {

using namespace tafoni;

constexpr Vec3i size{512, 512, 256};
constexpr double radius = 8, amplitude = 4;
constexpr int stroke = 20;  ///< dabs, each within 6 of the one before
constexpr int side = volume::ScalarGrid::chunk_samples;

/// Of the calling thread, which a busy machine distorts less; of the wall where there are several threads.
bool by_wall = false;
double seconds() {
  return bench::clock_seconds(by_wall ? CLOCK_MONOTONIC : CLOCK_THREAD_CPUTIME_ID);
}

double height(double x, double y) {
  return 128 + 40 * std::sin(0.013 * x) * std::cos(0.017 * y) + 9 * std::sin(0.09 * x + 0.04 * y) +
         3 * std::sin(0.31 * x) * std::sin(0.27 * y);
}

/// Sums of waves over a lattice of caverns.
volume::ScalarGrid ground(volume::Precision precision) {
  std::vector<double> heights(static_cast<std::size_t>(size.x) * size.y), across(heights.size());
  for (int y = 0; y < size.y; ++y)
    for (int x = 0; x < size.x; ++x) {
      const auto at = static_cast<std::size_t>(y) * size.x + x;
      heights[at] = height(x, y);
      across[at] = std::sin(0.11 * x) * std::cos(0.12 * y) + 0.9;
    }
  volume::ScalarGrid grid({{}, 1, size}, static_cast<float>(-amplitude), precision);
  grid.edit(grid.samples(), [&](Vec3i first, std::span<float> row) {
    const double along = std::sin(0.1 * first.y) * std::cos(0.13 * first.z);
    const auto at = static_cast<std::size_t>(first.y) * size.x + first.x;
    for (std::size_t i = 0; i < row.size(); ++i)
      row[i] = static_cast<float>(std::clamp(
          std::min(heights[at + i] - first.z, 8 * (across[at + i] + along)), -amplitude, amplitude));
  });
  grid.compact();
  return grid;
}

std::uint64_t hash(const void* data, std::size_t bytes, std::uint64_t h) {
  const auto* p = static_cast<const unsigned char*>(data);
  for (std::size_t i = 0; i < bytes; ++i) h = (h ^ p[i]) * 0x100000001b3u;
  return h;
}

template <class Mesh>
std::uint64_t hash_of(const Mesh& m, std::uint64_t h) {
  h = hash(m.positions.data(), m.positions.size() * sizeof(Vec3f), h);
  h = hash(m.normals.data(), m.normals.size() * sizeof(Vec3f), h);
  return hash(m.triangles.data(), m.triangles.size() * sizeof(m.triangles[0]), h);
}

struct Row {
  std::string name;
  std::vector<double> times{};
  std::uint64_t triangles = 0, hash = 0xcbf29ce484222325u;
};

void print(Row& row) {
  std::sort(row.times.begin(), row.times.end());
  double sum = 0;
  for (double t : row.times) sum += t;
  std::printf("\"%s\",%.4f,%.4f,%.4f,%llu,%016llx\n", row.name.c_str(), 1e3 * row.times.front(),
              1e3 * row.times[row.times.size() / 2], 1e3 * sum / static_cast<double>(row.times.size()),
              static_cast<unsigned long long>(row.triangles), static_cast<unsigned long long>(row.hash));
}

/// The samples of one chunk's voxels.
struct Samples {
  Vec3i n;
  std::vector<float> values;
};

Samples samples_of(const volume::ScalarGrid& grid, Vec3i chunk) {
  const Vec3i lo = chunk * side;
  const volume::SampleBox box{lo,
                              {std::min(lo.x + side, size.x - 1), std::min(lo.y + side, size.y - 1),
                               std::min(lo.z + side, size.z - 1)}};
  Samples out{box.size(), {}};
  out.values.resize(static_cast<std::size_t>(out.n.x) * out.n.y * out.n.z);
  grid.read(box, out.values.data());
  return out;
}

#if defined(TAFONI_BENCH_VTK)
struct Flying {
  std::vector<vtkNew<vtkImageData>> images;
  vtkNew<vtkFlyingEdges3D> filter;

  Flying() : images(64) {
    filter->SetValue(0, 0.0);
    filter->ComputeNormalsOn();
    filter->ComputeGradientsOff();
    filter->ComputeScalarsOff();
  }
  void prepare(std::size_t at, Samples& samples) {
    images[at]->SetDimensions(samples.n.x, samples.n.y, samples.n.z);
    vtkNew<vtkFloatArray> scalars;
    scalars->SetArray(samples.values.data(), static_cast<vtkIdType>(samples.values.size()), 1);
    images[at]->GetPointData()->SetScalars(scalars);
  }
  std::uint64_t run(std::size_t at) {
    filter->SetInputData(images[at]);
    filter->Modified();
    filter->Update();
    return static_cast<std::uint64_t>(filter->GetOutput()->GetNumberOfPolys());
  }
};
#endif

/// This program's mesher, after every dab.
class Case {
 public:
  Case(const std::string& name, volume::Precision precision, bool polygons)
      : grid_(ground(precision)),
        mesher_({surface::Boundary::open, polygons}),
        edit_{"edit" + name},
        both_{"edit and mesh" + name} {
    const double start = seconds();
    mesher_.update(grid_, {});
    std::fprintf(stderr, "first mesh%s: %.3f s\n", name.c_str(), seconds() - start);
  }

  std::vector<surface::ChunkChange> dab(const volume::Tool& tool, volume::Edit edit) {
    const double start = seconds();
    const volume::SampleBox box = volume::apply(grid_, tool, edit, amplitude);
    const double edited = seconds();
    auto changes = mesher_.update(grid_, {&box, 1});
    both_.times.push_back(seconds() - start);
    edit_.times.push_back(edited - start);
    for (const auto& change : changes) {
      const auto m = mesher_.chunk(change.chunk);
      both_.triangles += m->triangles.size();
      both_.hash = hash_of(*m, both_.hash);
    }
    return changes;
  }
  void print_rows() {
    print(edit_);
    print(both_);
  }
  const volume::ScalarGrid& grid() const { return grid_; }
  mesh::Mesh assemble() const { return mesher_.assemble(); }

 private:
  volume::ScalarGrid grid_;
  surface::GridMesher mesher_;
  Row edit_, both_;
};

/// The same chunks whole, by this program and by VTK.
class WholeChunks {
 public:
  void mesh(const std::vector<Samples>& all) {
    double start = seconds(), hashing = 0;
    for (const Samples& s : all) {
      surface::polygonize_grid({s.values.data(), s.n.x, s.n.y, s.n.z, 1.0}, true, dense_);
      const double made = seconds();
      own_.triangles += dense_.triangles.size();
      own_.hash = hash_of(dense_, own_.hash);
      hashing += seconds() - made;
    }
    own_.times.push_back(seconds() - start - hashing);
  }
#if defined(TAFONI_BENCH_VTK)
  void mesh_by_vtk(std::vector<Samples>& all) {
    for (std::size_t i = 0; i < all.size(); ++i) flying_.prepare(i, all[i]);
    const double start = seconds();
    for (std::size_t i = 0; i < all.size(); ++i) vtk_.triangles += flying_.run(i);
    vtk_.times.push_back(seconds() - start);
  }
#else
  void mesh_by_vtk(std::vector<Samples>&) {}
#endif
  void print_rows() {
    print(own_);
    if (!vtk_.times.empty()) print(vtk_);
  }

 private:
  Row own_{"whole chunks, by polygonize_grid"}, vtk_{"whole chunks, by vtkFlyingEdges3D"};
  mesh::Mesh dense_;
#if defined(TAFONI_BENCH_VTK)
  Flying flying_;
#endif
};

/// Dabs along the ground, each near the one before it in its stroke.
class Strokes {
 public:
  volume::Tool next() {
    const bool first = count_++ % stroke == 0;
    x_ = first ? random_.uniform(20, size.x - 20)
               : std::clamp(x_ + random_.uniform(-6, 6), 20.0, size.x - 20.0);
    y_ = first ? random_.uniform(20, size.y - 20)
               : std::clamp(y_ + random_.uniform(-6, 6), 20.0, size.y - 20.0);
    return volume::Tool::sphere({x_, y_, height(x_, y_) - random_.uniform(-4, 4)}, radius);
  }

 private:
  Random random_{1};
  int count_ = 0;
  double x_ = 0, y_ = 0;
};

}  // namespace

int main(int argc, char** argv) {
  const int dabs = argc > 1 ? std::max(1, std::atoi(argv[1])) : 300;
  const int threads = argc > 2 ? std::max(1, std::atoi(argv[2])) : 1;
  setenv("VTK_SMP_MAX_THREADS", std::to_string(threads).c_str(), 1);
  set_thread_count(threads);
  by_wall = threads > 1;
  std::array cases{Case("", volume::Precision::single, false),
                   Case(", half precision", volume::Precision::half, false),
                   Case(", convex polygons too", volume::Precision::single, true)};
  WholeChunks chunks;
  Strokes strokes;
  std::uint64_t touched = 0;
  for (int dab = 0; dab < dabs; ++dab) {
    const volume::Tool tool = strokes.next();
    std::vector<Samples> samples;
    for (Case& c : cases) {
      const auto changes = c.dab(tool, dab % 2 ? volume::Edit::add : volume::Edit::remove);
      if (&c != &cases.front()) continue;
      for (const auto& change : changes) samples.push_back(samples_of(c.grid(), change.chunk));
    }
    touched += samples.size();
    chunks.mesh(samples);
    chunks.mesh_by_vtk(samples);
  }
  std::puts("what,best_ms,median_ms,mean_ms,triangles,result_hash");
  for (Case& c : cases) c.print_rows();
  chunks.print_rows();
  const mesh::MeshReport report = mesh::validate(cases.front().assemble());
  std::fprintf(stderr, "%.2f chunks a dab; of %llu triangles in all; the mesh is %s\n",
               static_cast<double>(touched) / dabs, static_cast<unsigned long long>(report.triangles),
               report.valid() ? "valid" : "NOT VALID");
  return report.valid() ? 0 : 1;
}
