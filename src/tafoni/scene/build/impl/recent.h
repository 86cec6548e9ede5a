#pragma once
// Keeps what was made lately under a key that says what it depends on.

#include <cstddef>
#include <cstdint>
#include <map>

namespace tafoni::scene::impl {

/// Keeps `limit` values; the one not used for the longest time goes first.
template <class Key, class T>
class Recent {
 public:
  explicit Recent(std::size_t limit) : limit_(limit) {}

  /// The result under a key; null when it is not there.
  const T* find(const Key& key) {
    const auto found = items_.find(key);
    if (found == items_.end()) return nullptr;
    found->second.used = ++clock_;
    return &found->second.value;
  }
  const T& put(const Key& key, T value) {
    if (items_.size() >= limit_) {
      auto oldest = items_.begin();
      for (auto at = items_.begin(); at != items_.end(); ++at)
        if (at->second.used < oldest->second.used) oldest = at;
      items_.erase(oldest);
    }
    return items_.insert_or_assign(key, Item{std::move(value), ++clock_}).first->second.value;
  }
  /// The result under a key; `make` makes it unless it is there.
  template <class F>
  const T& get(const Key& key, F&& make) {
    if (const T* found = find(key)) return *found;
    return put(key, make());
  }

 private:
  struct Item {
    T value;
    std::uint64_t used = 0;
  };
  std::map<Key, Item> items_;
  std::size_t limit_;
  std::uint64_t clock_ = 0;
};

}  // namespace tafoni::scene::impl
