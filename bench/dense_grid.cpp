// A dense 512 x 512 x 256 grid of samples to triangles with normals: this program beside VTK's flying edges
// and OpenVDB's volumeToMesh, in one process, the runs interleaved since machines drift. Prints CSV.
//
//   bench_dense_grid [RUNS] [THREADS]
//
// THREADS (1 unless given) are VTK's and OpenVDB's; a dense grid is meshed here by one thread.

#include "tafoni/surface/dense_grid.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <string>
#include <vector>

#include "measure.h"

#include "tafoni/core/parallel.h"
#include "tafoni/mesh/validate.h"

#if defined(TAFONI_BENCH_VTK)
#include <vtkCellArray.h>
#include <vtkFloatArray.h>
#include <vtkFlyingEdges3D.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#endif
#if defined(TAFONI_BENCH_OPENVDB)
#include <openvdb/openvdb.h>
#include <openvdb/tools/Dense.h>
#include <openvdb/tools/VolumeToMesh.h>
#include <tbb/global_control.h>
#endif

namespace {

using namespace tafoni;

constexpr int nx = 512, ny = 512, nz = 256;

/// A rough terrain riddled with tunnels: six million triangles.
std::vector<float> samples() {
  std::vector<float> f(static_cast<std::size_t>(nx) * ny * nz);
  parallel_for(nz, [&](std::int64_t k) {
    float* out = f.data() + static_cast<std::size_t>(k) * nx * ny;
    for (int j = 0; j < ny; ++j)
      for (int i = 0; i < nx; ++i) {
        const double x = i * 0.09, y = j * 0.09, z = static_cast<double>(k) * 0.09;
        const double ground = 14 + 5 * std::sin(0.13 * x) * std::cos(0.17 * y) + std::sin(0.9 * x + 0.4 * y);
        const double caves =
            std::sin(x) * std::cos(y) + std::sin(y) * std::cos(z) + std::sin(z) * std::cos(x);
        *out++ = static_cast<float>(std::min(ground - z, caves + 0.4));
      }
  });
  return f;
}

std::uint64_t hash(const void* data, std::size_t bytes, std::uint64_t h = 0xcbf29ce484222325u) {
  const auto* p = static_cast<const unsigned char*>(data);
  for (std::size_t i = 0; i < bytes; ++i) h = (h ^ p[i]) * 0x100000001b3u;
  return h;
}

struct Result {
  std::uint64_t vertices = 0, triangles = 0, hash = 0;
};

struct Contender {
  std::string name;
  std::function<void()> run;
  std::function<Result()> result;
  std::vector<double> times{}, cpu_times{};
};

Result result_of(const mesh::Mesh& m) {
  std::uint64_t h = hash(m.positions.data(), m.positions.size() * sizeof(Vec3f));
  h = hash(m.normals.data(), m.normals.size() * sizeof(Vec3f), h);
  h = hash(m.triangles.data(), m.triangles.size() * sizeof(m.triangles[0]), h);
  return {m.positions.size(), m.triangles.size(), h};
}

}  // namespace

int main(int argc, char** argv) {
  const int runs = argc > 1 ? std::max(1, std::atoi(argv[1])) : 5;
  const int threads = argc > 2 ? std::max(1, std::atoi(argv[2])) : 1;
  // The header of vtkSMPTools in VTK 9.1 is not C++20, but its environment is read before the first loop.
  setenv("VTK_SMP_MAX_THREADS", std::to_string(threads).c_str(), 1);
  const std::vector<float> f = samples();
  const surface::DenseGrid grid{f.data(), nx, ny, nz, 1.0};
  std::vector<Contender> contenders;

  float sum = 0;
  contenders.push_back({"read the grid once",
                        [&] {
                          float lanes[16] = {};
                          for (std::size_t i = 0; i < f.size(); i += 16)
                            for (std::size_t l = 0; l < 16; ++l) lanes[l] += f[i + l];
                          for (float l : lanes) sum += l;
                        },
                        [&] {
                          return Result{0, 0, static_cast<std::uint64_t>(sum != 0)};
                        }});

  mesh::Mesh reused, fresh;
  contenders.push_back({"tafoni, output reused", [&] { surface::polygonize_grid(grid, true, reused); },
                        [&] { return result_of(reused); }});
  contenders.push_back({"tafoni, output new",
                        [&] {
                          fresh = mesh::Mesh{};
                          surface::polygonize_grid(grid, true, fresh);
                        },
                        [&] { return result_of(fresh); }});

#if defined(TAFONI_BENCH_VTK)
  vtkNew<vtkImageData> image;
  image->SetDimensions(nx, ny, nz);
  vtkNew<vtkFloatArray> scalars;
  scalars->SetArray(const_cast<float*>(f.data()), static_cast<vtkIdType>(f.size()), 1);
  image->GetPointData()->SetScalars(scalars);
  vtkNew<vtkFlyingEdges3D> flying;
  flying->SetInputData(image);
  flying->SetValue(0, 0.0);
  flying->ComputeNormalsOn();
  flying->ComputeGradientsOff();
  flying->ComputeScalarsOff();
  const auto vtk_result = [&] {
    vtkPolyData* out = flying->GetOutput();
    return Result{static_cast<std::uint64_t>(out->GetNumberOfPoints()),
                  static_cast<std::uint64_t>(out->GetNumberOfPolys()), 0};
  };
  contenders.push_back({"vtkFlyingEdges3D",
                        [&] {
                          flying->Modified();
                          flying->Update();
                        },
                        vtk_result});
#endif

#if defined(TAFONI_BENCH_OPENVDB)
  openvdb::initialize();
  openvdb::FloatGrid::Ptr volume = openvdb::FloatGrid::create(-1.0f);
  {
    const openvdb::tools::Dense<const float, openvdb::tools::LayoutXYZ> dense(
        openvdb::CoordBBox({0, 0, 0}, {nx - 1, ny - 1, nz - 1}), f.data());
    openvdb::tools::copyFromDense(dense, *volume, 0.0f);
  }
  std::vector<openvdb::Vec3s> points;
  std::vector<openvdb::Vec4I> quads;
  contenders.push_back({"OpenVDB volumeToMesh (quads, no normals)",
                        [&] {
                          const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                                          threads);
                          points.clear();
                          quads.clear();
                          openvdb::tools::volumeToMesh(*volume, points, quads, 0.0);
                        },
                        [&] {
                          return Result{points.size(), 2 * quads.size(),
                                        hash(points.data(), points.size() * sizeof(points[0]))};
                        }});
#endif

  for (int run = 0; run < runs; ++run)
    for (Contender& c : contenders) {
      const double start = bench::wall_seconds(), cpu_start = bench::cpu_seconds();
      c.run();
      c.cpu_times.push_back(bench::cpu_seconds() - cpu_start);
      c.times.push_back(bench::wall_seconds() - start);
    }
  const mesh::MeshReport report = mesh::validate(reused);
  std::puts("contender,best_s,median_s,best_cpu_s,vertices,triangles,result_hash");
  for (Contender& c : contenders) {
    std::sort(c.times.begin(), c.times.end());
    const Result r = c.result();
    std::printf("\"%s\",%.4f,%.4f,%.4f,%llu,%llu,%016llx\n", c.name.c_str(), c.times.front(),
                c.times[c.times.size() / 2], *std::min_element(c.cpu_times.begin(), c.cpu_times.end()),
                static_cast<unsigned long long>(r.vertices), static_cast<unsigned long long>(r.triangles),
                static_cast<unsigned long long>(r.hash));
  }
  std::fprintf(stderr, "tafoni's mesh is %s: %llu vertices\n", report.valid() ? "valid" : "NOT VALID",
               static_cast<unsigned long long>(report.vertices));
  return report.valid() ? 0 : 1;
}
