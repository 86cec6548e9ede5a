// A cache in shards by hash, each with a list by last use and a lock of its own; tiles are made outside of
// the lock.

#include "tafoni/query/impl/tile.h"

namespace tafoni::query::impl {

TilePtr TileCache::get(Vec3i index, const std::function<TilePtr(Vec3i)>& make) {
  const std::size_t hash = Hash()(index);
  Shard& shard = shards_[(hash >> 32) % shard_count];
  const auto held = [&]() -> TilePtr {
    const auto it = shard.by_index.find(index);
    if (it == shard.by_index.end()) return nullptr;
    shard.recent.splice(shard.recent.begin(), shard.recent, it->second);
    return it->second->tile;
  };
  {
    const std::lock_guard lock(shard.mutex);
    if (TilePtr tile = held()) return tile;
  }
  TilePtr fresh = make(index);
  const std::lock_guard lock(shard.mutex);
  ++shard.made;
  if (TilePtr tile = held()) return tile;
  shard.recent.push_front({index, fresh});
  shard.by_index.emplace(index, shard.recent.begin());
  shard.bytes += fresh->bytes() + entry_bytes;
  while (shard.bytes > limit_ && shard.recent.size() > 1) {
    const Entry& last = shard.recent.back();
    shard.bytes -= last.tile->bytes() + entry_bytes;
    shard.by_index.erase(last.index);
    shard.recent.pop_back();
  }
  return fresh;
}

void TileCache::drop(Vec3i lo, Vec3i hi) {
  for (Shard& shard : shards_) {
    const std::lock_guard lock(shard.mutex);
    for (auto it = shard.recent.begin(); it != shard.recent.end();) {
      const Vec3i i = it->index;
      if (i.x < lo.x || i.y < lo.y || i.z < lo.z || i.x > hi.x || i.y > hi.y || i.z > hi.z) {
        ++it;
        continue;
      }
      shard.bytes -= it->tile->bytes() + entry_bytes;
      shard.by_index.erase(i);
      it = shard.recent.erase(it);
    }
  }
}

TileCache::Stats TileCache::stats() const {
  Stats sum;
  for (const Shard& shard : shards_) {
    const std::lock_guard lock(shard.mutex);
    sum.tiles += shard.recent.size();
    sum.bytes += shard.bytes;
    sum.made += shard.made;
  }
  return sum;
}

}  // namespace tafoni::query::impl
