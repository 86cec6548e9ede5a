// Dabs of radius 8, in strokes, in a grid of 512 x 512 x 256 samples in chunks of 32^3: triangles and normals
// of all touched chunks, by this program beside VTK's flying edges a chunk, in one process, dab by dab in
// turn since machines drift. VTK's samples are laid out for it beforehand, out of the clock. Prints CSV.
//
//   bench_dab [DABS] [THREADS]
//
// THREADS (1 unless given) are this program's; VTK gets one chunk after the other on as many.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <time.h>

#include "tafoni/core/parallel.h"
#include "tafoni/core/random.h"
#include "tafoni/mesh/dense.h"
#include "tafoni/mesh/grid_mesher.h"
#include "tafoni/mesh/validate.h"
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
  timespec now{};
  clock_gettime(by_wall ? CLOCK_MONOTONIC : CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
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
      const auto at = static_cast<std::size_t>(y) * size.x + static_cast<std::size_t>(x);
      heights[at] = height(x, y);
      across[at] = std::sin(0.11 * x) * std::cos(0.12 * y) + 0.9;
    }
  volume::ScalarGrid grid({{}, 1, size}, static_cast<float>(-amplitude), precision);
  grid.edit(grid.samples(), [&](Vec3i first, std::span<float> row) {
    const double along = std::sin(0.1 * first.y) * std::cos(0.13 * first.z);
    const auto at = static_cast<std::size_t>(first.y) * size.x + static_cast<std::size_t>(first.x);
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
  out.values.resize(static_cast<std::size_t>(out.n.x) * out.n.y * static_cast<std::size_t>(out.n.z));
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

}  // namespace

int main(int argc, char** argv) {
  const int dabs = argc > 1 ? std::max(1, std::atoi(argv[1])) : 300;
  const int threads = argc > 2 ? std::max(1, std::atoi(argv[2])) : 1;
  setenv("VTK_SMP_MAX_THREADS", std::to_string(threads).c_str(), 1);
  set_thread_count(threads);
  by_wall = threads > 1;
  struct Case {
    volume::ScalarGrid grid;
    mesh::GridMesher mesher;
    Row edit, both;
  };
  std::vector<std::unique_ptr<Case>> cases;
  const auto add = [&](const std::string& name, volume::Precision precision, bool polygons) {
    cases.push_back(std::unique_ptr<Case>(new Case{ground(precision),
                                                   mesh::GridMesher({mesh::Boundary::open, polygons}),
                                                   {"edit" + name},
                                                   {"edit and mesh" + name}}));
    const double start = seconds();
    cases.back()->mesher.update(cases.back()->grid, {});
    std::fprintf(stderr, "first mesh%s: %.3f s\n", name.c_str(), seconds() - start);
  };
  add("", volume::Precision::single, false);
  add(", half precision", volume::Precision::half, false);
  add(", convex polygons too", volume::Precision::single, true);
  Row chunks{"whole chunks, by polygonize_grid"}, vtk{"whole chunks, by vtkFlyingEdges3D"};
  mesh::Mesh dense;
#if defined(TAFONI_BENCH_VTK)
  Flying flying;
#endif
  Random random(1);
  std::uint64_t touched = 0;
  double x = 0, y = 0;
  for (int dab = 0; dab < dabs; ++dab) {
    const bool first = dab % stroke == 0;
    x = first ? random.uniform(20, size.x - 20) : std::clamp(x + random.uniform(-6, 6), 20.0, size.x - 20.0);
    y = first ? random.uniform(20, size.y - 20) : std::clamp(y + random.uniform(-6, 6), 20.0, size.y - 20.0);
    const auto tool = volume::Tool::sphere({x, y, height(x, y) - random.uniform(-4, 4)}, radius);
    const auto what = dab % 2 ? volume::Edit::add : volume::Edit::remove;
    std::vector<mesh::GridMesher::Change> changes;
    for (const auto& c : cases) {
      const double start = seconds();
      const volume::SampleBox box = volume::apply(c->grid, tool, what, amplitude);
      const double edited = seconds();
      const auto now = c->mesher.update(c->grid, {&box, 1});
      c->both.times.push_back(seconds() - start);
      c->edit.times.push_back(edited - start);
      if (c == cases.front()) changes = now;
      for (const auto& change : now) {
        const auto m = c->mesher.chunk(change.chunk);
        c->both.triangles += m->triangles.size();
        c->both.hash = hash_of(*m, c->both.hash);
      }
    }
    touched += changes.size();
    std::vector<Samples> samples;
    for (const auto& change : changes) samples.push_back(samples_of(cases.front()->grid, change.chunk));
    double start = seconds(), hashing = 0;
    for (const Samples& s : samples) {
      mesh::polygonize_grid({s.values.data(), s.n.x, s.n.y, s.n.z, 1.0}, true, dense);
      const double made = seconds();
      chunks.triangles += dense.triangles.size();
      chunks.hash = hash_of(dense, chunks.hash);
      hashing += seconds() - made;
    }
    chunks.times.push_back(seconds() - start - hashing);
#if defined(TAFONI_BENCH_VTK)
    for (std::size_t i = 0; i < samples.size(); ++i) flying.prepare(i, samples[i]);
    start = seconds();
    for (std::size_t i = 0; i < samples.size(); ++i) vtk.triangles += flying.run(i);
    vtk.times.push_back(seconds() - start);
#endif
  }
  std::puts("what,best_ms,median_ms,mean_ms,triangles,result_hash");
  for (const auto& c : cases) print(c->edit), print(c->both);
  print(chunks);
  if (!vtk.times.empty()) print(vtk);
  const mesh::MeshReport report = mesh::validate(cases.front()->mesher.assemble());
  std::fprintf(stderr, "%.2f chunks a dab; of %llu triangles in all; the mesh is %s\n",
               static_cast<double>(touched) / dabs, static_cast<unsigned long long>(report.triangles),
               report.valid() ? "valid" : "NOT VALID");
  return report.valid() ? 0 : 1;
}
