#include "tafoni/mesh/prism_mesh.h"

#include <algorithm>

#include "tafoni/core/error.h"
#include "tafoni/core/parallel.h"
#include "tafoni/mesh/impl/prism_faces.h"
#include "tafoni/mesh/impl/separate.h"

namespace tafoni::mesh {

using impl::PrismFace;
using impl::PrismFaces;
using volume::ColumnBox;
using volume::ColumnFrame;
using volume::PrismFields;

namespace {

Vec3f unit_or_up(Vec3f n) {
  const float l = length(n);
  return l > 0 ? n * (1 / l) : Vec3f{0, 0, 1};
}

/// Of every level of the block's columns, relative to the frame's origin.
void place(const ColumnFrame& frame, const PrismFaces& faces, std::vector<Vec3f>& out) {
  const ColumnBox& box = faces.block().box;
  const std::span<const float> levels = faces.cells().levels();
  out.resize(levels.size());
  std::size_t n = 0;
  for (int j = box.j0; j <= box.j1; ++j)
    for (int i = box.i0; i <= box.i1; ++i) {
      const bool last = i == box.i1 && j == box.j1;
      const std::size_t end =
          last ? levels.size()
               : static_cast<std::size_t>(i < box.i1 ? faces.cells().first_level(i + 1, j)
                                                     : faces.cells().first_level(box.i0, j + 1));
      const float x = static_cast<float>(i * frame.dx), y = static_cast<float>(j * frame.dy);
      for (; n < end; ++n) out[n] = {x, y, levels[n]};
    }
}

/// Marks the walls that two cells put back to back where both are solid, each over other slabs: nothing
/// shows.
void mark_hidden(const std::vector<PrismFace>& faces, std::vector<std::array<std::int32_t, 4>>& walls,
                 std::vector<bool>& hidden) {
  walls.clear();
  hidden.assign(faces.size(), false);
  for (std::size_t n = 0; n < faces.size(); ++n) {
    if (faces[n].surface != PrismSurface::middle) continue;
    std::array<std::int32_t, 3> level{faces[n].level[0], faces[n].level[1], faces[n].level[2]};
    std::sort(level.begin(), level.end());  // a level is of one column, so that three of them name a triangle
    walls.push_back({level[0], level[1], level[2], static_cast<std::int32_t>(n)});
  }
  std::sort(walls.begin(), walls.end());
  for (std::size_t w = 1; w < walls.size(); ++w) {
    const auto &a = walls[w - 1], &b = walls[w];
    if (a[0] != b[0] || a[1] != b[1] || a[2] != b[2]) continue;
    hidden[static_cast<std::size_t>(a[3])] = hidden[static_cast<std::size_t>(b[3])] = true;
  }
}

/// What meshing one chunk needs; one a thread.
struct Workspace {
  PrismFaces faces;
  std::vector<std::array<std::int32_t, 4>> walls;
  std::vector<bool> hidden;
  std::vector<Vec3f> places, normals;
  std::vector<std::int32_t> ids;
};

void mesh_chunk(const PrismFields& fields, const ColumnBox& cells, volume::DeadPoints dead, Workspace& work,
                PrismChunk& out) {
  out.positions.clear(), out.normals.clear(), out.surfaces.clear(), out.triangles.clear();
  const std::vector<PrismFace>& faces = work.faces.run(fields, cells, true, dead);
  if (faces.empty()) return;
  place(fields.frame(), work.faces, work.places);
  const std::size_t keys = 3 * work.faces.cells().levels().size();
  work.normals.assign(keys, {});
  work.ids.assign(keys, -1);
  mark_hidden(faces, work.walls, work.hidden);
  for (std::size_t at = 0; at < faces.size(); ++at) {
    if (work.hidden[at]) continue;
    const PrismFace& f = faces[at];
    std::size_t level[3], key[3];
    for (std::size_t k = 0; k < 3; ++k) {
      level[k] = static_cast<std::size_t>(f.level[k]);
      key[k] = 3 * level[k] + static_cast<std::size_t>(f.surface);
    }
    const Vec3f a = work.places[level[0]];
    const Vec3f area = cross(work.places[level[1]] - a, work.places[level[2]] - a);
    for (std::size_t k : key) work.normals[k] += area;
    if (!f.own) continue;
    std::array<std::uint32_t, 3> triangle;
    for (std::size_t k = 0; k < 3; ++k) {
      std::int32_t& id = work.ids[key[k]];
      if (id < 0) {
        id = static_cast<std::int32_t>(out.positions.size());
        out.positions.push_back(work.places[level[k]]);
        out.surfaces.push_back(f.surface);
      }
      triangle[k] = static_cast<std::uint32_t>(id);
    }
    out.triangles.push_back(triangle);
  }
  out.normals.resize(out.positions.size());
  for (std::size_t k = 0; k < keys; ++k)
    if (work.ids[k] >= 0) out.normals[static_cast<std::size_t>(work.ids[k])] = unit_or_up(work.normals[k]);
}

/// A vertex of the whole: its column and which of the column's levels.
using Key = std::uint64_t;

struct Pieces {
  std::vector<std::array<Key, 3>> triangles;
  std::vector<std::uint8_t> surfaces;
  std::vector<std::pair<Key, Vec3f>> places;
};

Pieces collect(const PrismFields& fields, volume::DeadPoints dead) {
  constexpr int block = 64;
  const ColumnFrame& frame = fields.frame();
  const int wide = (frame.nx + block - 2) / block, high = (frame.ny + block - 2) / block;
  std::vector<Pieces> parts(static_cast<std::size_t>(wide) * static_cast<std::size_t>(high));
  parallel_for(static_cast<std::int64_t>(parts.size()), [&](std::int64_t n) {
    const int i = static_cast<int>(n % wide) * block, j = static_cast<int>(n / wide) * block;
    const ColumnBox cells{i, j, std::min(i + block, frame.nx - 1) - 1, std::min(j + block, frame.ny - 1) - 1};
    PrismFaces faces;
    Pieces& out = parts[static_cast<std::size_t>(n)];
    const auto& all = faces.run(fields, cells, false, dead);
    std::vector<Vec3f> places;
    place(frame, faces, places);
    const ColumnBox& box = faces.block().box;
    std::vector<bool> placed(faces.cells().levels().size(), false);
    for (const PrismFace& f : all) {
      std::array<Key, 3> triangle;
      for (std::size_t k = 0; k < 3; ++k) {
        const int ci = box.i0 + f.column[k] % box.width(), cj = box.j0 + f.column[k] / box.width();
        const std::int32_t level = f.level[k] - faces.cells().first_level(ci, cj);
        triangle[k] = ((static_cast<Key>(cj) * static_cast<Key>(frame.nx) + static_cast<Key>(ci)) << 24) |
                      static_cast<Key>(level);
        if (placed[static_cast<std::size_t>(f.level[k])]) continue;
        placed[static_cast<std::size_t>(f.level[k])] = true;
        out.places.emplace_back(triangle[k], places[static_cast<std::size_t>(f.level[k])]);
      }
      out.triangles.push_back(triangle);
      out.surfaces.push_back(static_cast<std::uint8_t>(f.surface));
    }
  });
  Pieces whole;
  for (Pieces& p : parts) {
    whole.triangles.insert(whole.triangles.end(), p.triangles.begin(), p.triangles.end());
    whole.surfaces.insert(whole.surfaces.end(), p.surfaces.begin(), p.surfaces.end());
    whole.places.insert(whole.places.end(), p.places.begin(), p.places.end());
    p = {};
  }
  std::sort(whole.places.begin(), whole.places.end(),
            [](const auto& a, const auto& b) { return a.first < b.first; });
  whole.places.erase(std::unique(whole.places.begin(), whole.places.end(),
                                 [](const auto& a, const auto& b) { return a.first == b.first; }),
                     whole.places.end());
  return whole;
}

void shade(Mesh& mesh, const std::vector<std::uint8_t>& surfaces, const PrismMeshSettings& settings) {
  mesh.normals.assign(mesh.positions.size(), {});
  std::vector<std::array<std::uint32_t, 5>> sums(mesh.positions.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& v = mesh.triangles[t];
    const Vec3f n =
        cross(mesh.positions[v[1]] - mesh.positions[v[0]], mesh.positions[v[2]] - mesh.positions[v[0]]);
    for (auto k : v) {
      mesh.normals[k] += n;
      for (std::size_t c = 0; c < 4; ++c) sums[k][c] += settings.colors[surfaces[t]][c];
      ++sums[k][4];
    }
  }
  mesh.colors.resize(mesh.positions.size());
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    mesh.normals[v] = unit_or_up(mesh.normals[v]);
    for (std::size_t c = 0; c < 4; ++c)
      mesh.colors[v][c] = static_cast<std::uint8_t>((sums[v][c] + sums[v][4] / 2) / sums[v][4]);
  }
}

}  // namespace

Mesh polygonize(const PrismFields& fields, const PrismMeshSettings& settings,
                std::vector<PrismSurface>* surfaces) {
  Pieces pieces = collect(fields, settings.dead);
  Mesh mesh;
  mesh.origin = fields.frame().origin;
  const auto index = [&](Key key) {
    const auto at = std::lower_bound(pieces.places.begin(), pieces.places.end(), key,
                                     [](const auto& p, Key k) { return p.first < k; });
    return static_cast<std::uint32_t>(at - pieces.places.begin());
  };
  mesh.triangles.reserve(pieces.triangles.size());
  for (const auto& t : pieces.triangles) mesh.triangles.push_back({index(t[0]), index(t[1]), index(t[2])});
  mesh.positions.reserve(pieces.places.size());
  for (const auto& [key, place] : pieces.places) mesh.positions.push_back(place);
  impl::separate(mesh, pieces.surfaces);
  shade(mesh, pieces.surfaces, settings);
  if (surfaces) {
    surfaces->clear();
    for (std::uint8_t s : pieces.surfaces) surfaces->push_back(static_cast<PrismSurface>(s));
  }
  return mesh;
}

struct PrismMesher::State {
  PrismMeshSettings settings;
  ColumnFrame frame;
  int wide = 0, high = 0;
  std::uint64_t version = 0;
  std::vector<PrismChunk> chunks;
  std::vector<Workspace> work;
};

PrismMesher::PrismMesher(const PrismMeshSettings& settings) : state_(std::make_unique<State>()) {
  state_->settings = settings;
}
PrismMesher::~PrismMesher() = default;
PrismMesher::PrismMesher(PrismMesher&&) noexcept = default;
PrismMesher& PrismMesher::operator=(PrismMesher&&) noexcept = default;

int PrismMesher::chunks_x() const {
  return state_->wide;
}

int PrismMesher::chunks_y() const {
  return state_->high;
}

const PrismChunk& PrismMesher::chunk(ChunkIndex at) const {
  return state_->chunks[static_cast<std::size_t>(at.b) * static_cast<std::size_t>(state_->wide) +
                        static_cast<std::size_t>(at.a)];
}

std::vector<PrismMesher::ChunkIndex> PrismMesher::update(const PrismFields& fields,
                                                         const ColumnBox& changed) {
  State& s = *state_;
  const ColumnFrame& frame = fields.frame();
  ColumnBox box = changed;
  if (s.version == 0) {
    s.frame = frame;
    s.wide = (frame.nx + chunk_cells - 2) / chunk_cells, s.high = (frame.ny + chunk_cells - 2) / chunk_cells;
    s.chunks.resize(static_cast<std::size_t>(s.wide) * static_cast<std::size_t>(s.high));
    box = {0, 0, frame.nx - 1, frame.ny - 1};
  } else if (!(frame == s.frame)) {
    fail(ErrorKind::usage, "a prism mesher got another frame than before; use a new one");
  }
  ++s.version;
  std::vector<ChunkIndex> touched;
  if (box.empty()) return touched;
  // A column moves the seams of those around it, and so the cells, walls and normals up to three cells away.
  constexpr int reach = 3;
  const auto chunk_of = [](int cell, int count) { return std::clamp(cell / chunk_cells, 0, count - 1); };
  const int a0 = chunk_of(std::max(0, box.i0 - reach - 1), s.wide), a1 = chunk_of(box.i1 + reach, s.wide);
  const int b0 = chunk_of(std::max(0, box.j0 - reach - 1), s.high), b1 = chunk_of(box.j1 + reach, s.high);
  for (int b = b0; b <= b1; ++b)
    for (int a = a0; a <= a1; ++a) touched.push_back({a, b});
  const int parts = static_cast<int>(std::min<std::size_t>(touched.size(), 64));
  if (static_cast<int>(s.work.size()) < parts) s.work.resize(static_cast<std::size_t>(parts));
  parallel_for(parts, [&](std::int64_t part) {
    const std::size_t n = touched.size(), p = static_cast<std::size_t>(part);
    const std::size_t end = n * (p + 1) / static_cast<std::size_t>(parts);
    for (std::size_t k = n * p / static_cast<std::size_t>(parts); k < end; ++k) {
      const int i = touched[k].a * chunk_cells, j = touched[k].b * chunk_cells;
      const ColumnBox cells{i, j, std::min(i + chunk_cells, frame.nx - 1) - 1,
                            std::min(j + chunk_cells, frame.ny - 1) - 1};
      PrismChunk& chunk = s.chunks[static_cast<std::size_t>(touched[k].b) * static_cast<std::size_t>(s.wide) +
                                   static_cast<std::size_t>(touched[k].a)];
      mesh_chunk(fields, cells, s.settings.dead, s.work[p], chunk);
      chunk.version = s.version;
    }
  });
  return touched;
}

}  // namespace tafoni::mesh
