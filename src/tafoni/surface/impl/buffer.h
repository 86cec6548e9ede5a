#pragma once
// Growable memory without initialisation: filled by kernels, reused from chunk to chunk.

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <memory>
#include <type_traits>

namespace tafoni::surface::impl {

template <class T>
class Buffer {
  static_assert(std::is_trivially_copyable_v<T>);

 public:
  T* data() { return data_.get(); }
  const T* data() const { return data_.get(); }
  T* end() { return data_.get() + size_; }
  std::size_t size() const { return size_; }
  void clear() { size_ = 0; }
  /// Counts `n` elements that were written at end().
  void commit(std::size_t n) { size_ += n; }
  /// Makes room for `extra` elements beyond the last.
  void reserve_extra(std::size_t extra) {
    if (size_ + extra <= capacity_) return;
    capacity_ = std::max(size_ + extra, capacity_ + capacity_ / 2);
    std::unique_ptr<T[]> grown(new T[capacity_]);
    if (size_) std::memcpy(static_cast<void*>(grown.get()), data_.get(), size_ * sizeof(T));
    data_ = std::move(grown);
  }

 private:
  std::unique_ptr<T[]> data_;
  std::size_t size_ = 0, capacity_ = 0;
};

}  // namespace tafoni::surface::impl
