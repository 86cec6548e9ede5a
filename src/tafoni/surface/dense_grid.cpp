// Feeds a dense grid to the polygonizer's core: the signs of all samples first, which tell how much to
// reserve, then plane by plane straight into the mesh.

#include "tafoni/surface/dense_grid.h"

#include <vector>

#include "tafoni/core/error.h"
#include "tafoni/surface/impl/arena.h"
#include "tafoni/surface/impl/block.h"
#include "tafoni/surface/impl/lattice.h"

namespace tafoni::surface {
namespace {

/// How many words of solid bits, of 64 samples each, a row of samples takes.
int words_a_row(const DenseGrid& g) {
  return (g.nx + 63) / 64;
}

/// Every cell of the grid.
struct AllCells {
  explicit AllCells(const DenseGrid& g) : layers(g.nz - 1), mask((g.ny - 1) * words_a_row(g), 0) {
    const int words = words_a_row(g);
    for (int w = 0; w < std::ssize(mask); ++w) {
      const int cells = g.nx - 1 - 64 * (w % words);
      mask[w] = cells >= 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << cells) - 1;
    }
  }
  bool layer(int k) const { return k >= 0 && k < layers; }
  const std::uint64_t* rows(int) const { return mask.data(); }

  int layers;
  std::vector<std::uint64_t> mask;
};

/// Appends each plane to the mesh while it is in the cache.
struct DenseSink {
  const DenseGrid& grid;
  mesh::Mesh& mesh;
  bool normals;
  impl::Plane plane{};
  impl::Buffer<float> positions{}, directions{};

  void vertices(int k, const impl::PlaneOutput& out) {
    const std::size_t n = out.keys.size();
    plane.f = grid.samples + std::ptrdiff_t{k} * grid.nx * grid.ny;
    plane.k = k;
    plane.level = k;
    positions.reserve_extra(3 * (n + impl::kernel_slack));
    directions.reserve_extra(3 * (n + impl::kernel_slack));
    impl::place(plane, out.keys.data(), n, positions.data(), nullptr, normals ? directions.data() : nullptr);
    append(mesh.positions, positions.data(), n);
    if (normals) append(mesh.normals, directions.data(), n);
  }
  void triangles(const impl::PlaneOutput& out) {
    const auto* first = reinterpret_cast<const std::array<std::uint32_t, 3>*>(out.indices.data());
    mesh.triangles.insert(mesh.triangles.end(), first, first + out.indices.size() / 3);
  }
  static void append(std::vector<Vec3f>& to, const float* from, std::size_t n) {
    const auto* first = reinterpret_cast<const Vec3f*>(from);
    to.insert(to.end(), first, first + n);
  }
};

/// The solid bits of every sample: an eighth of a byte each, so that the grid itself is streamed once.
std::vector<std::uint64_t> all_signs(const DenseGrid& g) {
  std::vector<std::uint64_t> bits(std::ptrdiff_t{g.ny} * g.nz * words_a_row(g));
  impl::signs(g.samples, g.nx, g.ny * g.nz, bits.data());
  return bits;
}

/// Reserves the output: vertices exactly, triangles as many as a surface of few borders and handles has.
void reserve_output(const DenseGrid& g, const std::vector<std::uint64_t>& bits, bool normals,
                    mesh::Mesh& out) {
  const std::size_t row = words_a_row(g), plane = row * g.ny;
  std::uint64_t vertices = impl::count_differences(bits.data(), bits.data() + plane, bits.size() - plane);
  for (std::size_t at = 0; at < bits.size(); at += plane)
    vertices += impl::count_differences(bits.data() + at, bits.data() + at + row, plane - row);
  std::vector<std::uint64_t> next(row);
  const std::uint64_t last = std::uint64_t{1} << ((g.nx - 1) & 63);
  for (std::size_t at = 0; at < bits.size(); at += row) {
    for (std::size_t w = 0; w < row; ++w)
      next[w] = (bits[at + w] >> 1) | (w + 1 < row ? bits[at + w + 1] << 63 : 0);
    // The last sample of a row has no edge.
    next[row - 1] = (next[row - 1] & ~last) | (bits[at + row - 1] & last);
    vertices += impl::count_differences(bits.data() + at, next.data(), row);
  }
  impl::reserve_large(out.positions, vertices);
  if (normals) impl::reserve_large(out.normals, vertices);
  impl::reserve_large(out.triangles, 2 * vertices + vertices / 32 + 64);
}

}  // namespace

void polygonize_grid(const DenseGrid& grid, bool normals, mesh::Mesh& out) {
  for (int n : {grid.nx, grid.ny, grid.nz})
    if (n < 2 || n > 4096)
      fail(ErrorKind::usage,
           "a grid of {} x {} x {} samples cannot be meshed: each side takes 2 to 4096 samples", grid.nx,
           grid.ny, grid.nz);
  out.origin = {};
  out.positions.clear();
  out.normals.clear();
  out.colors.clear();
  out.texture.clear();
  out.triangles.clear();
  impl::BlockWalker walker;
  const std::vector<std::uint64_t> bits = all_signs(grid);
  reserve_output(grid, bits, normals, out);
  DenseSink sink{grid, out, normals};
  sink.plane.row_step = grid.nx;
  sink.plane.plane_step = grid.nx * grid.ny;
  sink.plane.nx = grid.nx, sink.plane.ny = grid.ny, sink.plane.nz = grid.nz;
  sink.plane.voxel = grid.spacing;
  sink.plane.margin = impl::margin_for(4096);
  walker.walk(grid.samples, grid.nx, grid.ny, grid.nz, grid.nx, std::ptrdiff_t{grid.nx} * grid.ny,
              AllCells(grid), sink, bits.data());
}

}  // namespace tafoni::surface
