// Shades the faces that PrismFaces finds: for the whole as one separated, 2-manifold mesh with colours, for
// drawing by chunks whose vertices are numbered by level and surface.

#include "tafoni/surface/prism_mesher.h"

#include <algorithm>
#include <cstring>
#include <utility>

#include "tafoni/core/error.h"
#include "tafoni/core/parallel.h"
#include "tafoni/mesh/inner/size32.h"
#include "tafoni/surface/impl/prism_faces.h"
#include "tafoni/surface/impl/separate.h"

namespace tafoni::surface {

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

/// Fills the positions of all levels of the block's columns, relative to the frame's origin.
void place(const ColumnFrame& frame, const PrismFaces& faces, std::vector<Vec3f>& out) {
  const ColumnBox& box = faces.block().box;
  const std::span<const float> levels = faces.cells().levels();
  out.resize(levels.size());
  std::size_t n = 0;
  for (int j = box.j0; j <= box.j1; ++j)
    for (int i = box.i0; i <= box.i1; ++i) {
      const bool last = i == box.i1 && j == box.j1;
      const std::size_t end = last         ? levels.size()
                              : i < box.i1 ? faces.cells().first_level(i + 1, j)
                                           : faces.cells().first_level(box.i0, j + 1);
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
  for (std::int32_t n = 0; n < std::ssize(faces); ++n) {
    if (faces[n].surface != PrismSurface::middle) continue;
    std::array<std::int32_t, 3> level{faces[n].level[0], faces[n].level[1], faces[n].level[2]};
    std::sort(level.begin(), level.end());  // a level is of one column, so that three of them name a triangle
    walls.push_back({level[0], level[1], level[2], n});
  }
  std::sort(walls.begin(), walls.end());
  for (std::size_t w = 1; w < walls.size(); ++w) {
    const auto &a = walls[w - 1], &b = walls[w];
    if (a[0] != b[0] || a[1] != b[1] || a[2] != b[2]) continue;
    hidden[a[3]] = hidden[b[3]] = true;
  }
}

/// Four floats, so that a sum is one load, one addition and one store.
struct alignas(16) Sum {
  float v[4] = {};
};

/// What meshing some chunks needs; one a thread.
struct Workspace {
  PrismFaces faces;
  std::vector<std::array<std::int32_t, 4>> walls;
  std::vector<bool> hidden;
  std::vector<Vec3f> places;
  // A vertex is a level and a surface: key 3 level + surface.
  std::vector<Sum> normals;
  std::vector<std::int32_t> ids;  ///< by key, in the chunk at work; -1: none
  std::vector<std::size_t> keys;  ///< by id
  PrismChunkMesh made;            ///< to be compared with the one that is held
};

std::size_t vertex_key(const PrismFace& f, std::size_t k) {
  return std::size_t{3} * f.level[k] + static_cast<std::size_t>(f.surface);
}

/// Normals of all vertices, each summed in the order of the cells around it, whatever box they are in.
void add_normals(Workspace& work, const std::vector<PrismFace>& faces) {
  work.normals.assign(3 * work.places.size(), {});
  for (std::size_t at = 0; at < faces.size(); ++at) {
    if (work.hidden[at]) continue;
    const PrismFace& f = faces[at];
    const auto corner = [&](std::size_t k) { return work.places[f.level[k]]; };
    const Vec3f a = corner(0), n = cross(corner(1) - a, corner(2) - a);
    const Sum area{{n.x, n.y, n.z, 0}};
    for (std::size_t k = 0; k < 3; ++k) {
      Sum& sum = work.normals[vertex_key(f, k)];
      for (std::size_t c = 0; c < 4; ++c) sum.v[c] += area.v[c];
    }
  }
}

void emit_chunk(const ColumnBox& cells, const std::vector<PrismFace>& faces, Workspace& work,
                PrismChunkMesh& out) {
  out.positions.clear(), out.normals.clear(), out.surfaces.clear(), out.triangles.clear();
  work.keys.clear();
  for (int j = cells.j0; j <= cells.j1; ++j) {
    const auto [begin, end] = work.faces.in_row(cells.i0, cells.i1 + 1, j);
    for (std::size_t at = begin; at < end; ++at) {
      if (work.hidden[at]) continue;
      const PrismFace& f = faces[at];
      std::array<std::uint32_t, 3> triangle;
      for (std::size_t k = 0; k < 3; ++k) {
        std::int32_t& id = work.ids[vertex_key(f, k)];
        if (id < 0) {
          id = mesh::inner::size32(work.keys);
          work.keys.push_back(vertex_key(f, k));
        }
        triangle[k] = id;
      }
      out.triangles.push_back(triangle);
    }
  }
  const std::size_t n = work.keys.size();
  out.positions.resize(n), out.normals.resize(n), out.surfaces.resize(n);
  for (std::size_t v = 0; v < n; ++v) {
    const std::size_t key = work.keys[v];
    const Sum& sum = work.normals[key];
    out.positions[v] = work.places[key / 3];
    out.surfaces[v] = static_cast<PrismSurface>(key % 3);
    out.normals[v] = unit_or_up({sum.v[0], sum.v[1], sum.v[2]});
    work.ids[key] = -1;
  }
}

/// The cells of the chunks from (a0, b0) to (a1, b1).
ColumnBox cells_of(const ColumnFrame& frame, int a0, int b0, int a1, int b1) {
  constexpr int side = PrismMesher::chunk_cells;
  return {a0 * side, b0 * side, std::min((a1 + 1) * side, frame.nx - 1) - 1,
          std::min((b1 + 1) * side, frame.ny - 1) - 1};
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
  std::vector<Pieces> parts(std::ptrdiff_t{wide} * high);
  parallel_for(std::ssize(parts), [&](std::int64_t n) {
    const int i = static_cast<int>(n % wide) * block, j = static_cast<int>(n / wide) * block;
    const ColumnBox cells{i, j, std::min(i + block, frame.nx - 1) - 1, std::min(j + block, frame.ny - 1) - 1};
    PrismFaces faces;
    Pieces& out = parts[n];
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
        triangle[k] = ((std::int64_t{cj} * frame.nx + ci) << 24) | level;
        if (placed[f.level[k]]) continue;
        placed[f.level[k]] = true;
        out.places.emplace_back(triangle[k], places[f.level[k]]);
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

void shade(mesh::Mesh& mesh, const std::vector<std::uint8_t>& surfaces, const PrismMeshSettings& settings) {
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

mesh::Mesh polygonize(const PrismFields& fields, const PrismMeshSettings& settings,
                      std::vector<PrismSurface>* surfaces) {
  Pieces pieces = collect(fields, settings.dead);
  mesh::Mesh mesh;
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

namespace {

/// Whether two chunks' meshes have the same bytes.
bool same(const PrismChunkMesh& x, const PrismChunkMesh& y) {
  const auto equal = [](const auto& a, const auto& b) {
    return a.size() == b.size() &&
           (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof a[0]) == 0);
  };
  return equal(x.triangles, y.triangles) && equal(x.positions, y.positions) && equal(x.normals, y.normals) &&
         equal(x.surfaces, y.surfaces);
}

/// Chunks (a0, b0) to (a1, b1).
struct ChunkBox {
  int a0, b0, a1, b1;
};

}  // namespace

struct PrismMesher::State {
  PrismMeshSettings settings;
  ColumnFrame frame;
  int wide = 0, high = 0;
  std::uint64_t version = 0;
  std::vector<PrismChunkMesh> chunks;
  std::vector<Workspace> work;
  PrismChunkMesh nothing;

  PrismChunkMesh& at(int a, int b) { return chunks[std::ptrdiff_t{b} * wide + a]; }
  ChunkBox touched(const ColumnBox& changed) const;
  void make(const PrismFields& fields, const ChunkBox& group, Workspace& work);
};

/// The chunks that depend on some columns.
ChunkBox PrismMesher::State::touched(const ColumnBox& changed) const {
  // A column's air moves the seams of those around it: the cells at these change, from two below it to one
  // above, and normals a cell further. Walls beyond do not: seams only divide what lies between the same
  // ends.
  constexpr int reach = 2;
  const auto chunk_of = [](int cell, int count) { return std::clamp(cell / chunk_cells, 0, count - 1); };
  return {chunk_of(std::max(0, changed.i0 - reach - 1), wide),
          chunk_of(std::max(0, changed.j0 - reach - 1), high), chunk_of(changed.i1 + reach, wide),
          chunk_of(changed.j1 + reach, high)};
}

/// Makes the meshes of chunks beside each other together, since what lies around them is looked at, too.
void PrismMesher::State::make(const PrismFields& fields, const ChunkBox& group, Workspace& own) {
  const auto& faces =
      own.faces.run(fields, cells_of(frame, group.a0, group.b0, group.a1, group.b1), true, settings.dead);
  place(frame, own.faces, own.places);
  mark_hidden(faces, own.walls, own.hidden);
  add_normals(own, faces);
  own.ids.resize(std::max(own.ids.size(), own.normals.size()), -1);
  for (int b = group.b0; b <= group.b1; ++b)
    for (int a = group.a0; a <= group.a1; ++a) {
      emit_chunk(cells_of(frame, a, b, a, b), faces, own, own.made);
      PrismChunkMesh& held = at(a, b);
      if (same(held, own.made)) continue;
      std::swap(held, own.made);
      held.version = version;
    }
}

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

const PrismChunkMesh& PrismMesher::chunk(Vec3i chunk) const {
  State& s = *state_;
  const bool known = chunk.x >= 0 && chunk.x < s.wide && chunk.y >= 0 && chunk.y < s.high && chunk.z == 0;
  return known ? s.at(chunk.x, chunk.y) : s.nothing;
}

std::vector<Vec3i> PrismMesher::chunks() const {
  std::vector<Vec3i> out;
  for (int b = 0; b < state_->high; ++b)
    for (int a = 0; a < state_->wide; ++a)
      if (!state_->at(a, b).triangles.empty()) out.push_back({a, b, 0});
  return out;
}

std::vector<ChunkChange> PrismMesher::update(const PrismFields& fields, const ColumnBox& changed) {
  State& s = *state_;
  const ColumnFrame& frame = fields.frame();
  ColumnBox box = changed;
  if (s.version == 0) {
    s.frame = frame;
    s.wide = (frame.nx + chunk_cells - 2) / chunk_cells, s.high = (frame.ny + chunk_cells - 2) / chunk_cells;
    s.chunks.resize(std::ptrdiff_t{s.wide} * s.high);
    box = {0, 0, frame.nx - 1, frame.ny - 1};
  } else if (!(frame == s.frame)) {
    fail(ErrorKind::usage, "a prism mesher got another frame than before; use a new one");
  }
  ++s.version;
  std::vector<ChunkChange> out;
  if (box.empty()) return out;
  const ChunkBox all = s.touched(box);
  // As many groups of chunks as there is work for.
  int side = 4;
  const auto groups = [&](int from, int to) { return (to - from) / side + 1; };
  while (side > 1 && groups(all.a0, all.a1) * groups(all.b0, all.b1) < thread_count()) side /= 2;
  const std::int64_t wide = groups(all.a0, all.a1), count = wide * groups(all.b0, all.b1);
  const std::int64_t parts = std::min<std::int64_t>(count, 2 * thread_count());
  if (std::ssize(s.work) < parts) s.work.resize(parts);
  parallel_for(parts, [&](std::int64_t part) {
    for (std::int64_t g = count * part / parts; g < count * (part + 1) / parts; ++g) {
      const int a = all.a0 + static_cast<int>(g % wide) * side,
                b = all.b0 + static_cast<int>(g / wide) * side;
      s.make(fields, {a, b, std::min(a + side - 1, all.a1), std::min(b + side - 1, all.b1)}, s.work[part]);
    }
  });
  for (int b = all.b0; b <= all.b1; ++b)
    for (int a = all.a0; a <= all.a1; ++a)
      if (s.at(a, b).version == s.version) out.push_back({{a, b, 0}, s.version});
  return out;
}

}  // namespace tafoni::surface
