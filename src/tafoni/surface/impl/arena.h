#pragma once
// Memory in large pages. A first touch of a 4 KiB page costs about as much as making the 170 triangles that
// fill it, so large outputs ask the system for 2 MiB pages.

#include <cstddef>
#include <cstring>
#include <memory>
#include <new>
#include <span>
#include <type_traits>
#include <vector>

namespace tafoni::surface::impl {

/// Asks for large pages where memory is touched for the first time. A hint: nothing depends on it.
void advise_large_pages(void* memory, std::size_t bytes);

/// Reserves room and advises large pages for it.
template <class T>
void reserve_large(std::vector<T>& out, std::size_t n) {
  if (n <= out.capacity()) return;
  out.reserve(n);
  advise_large_pages(out.data(), n * sizeof(T));
}

/// Hands out memory that lives as long as the arena. Not for several threads at once.
class Arena {
 public:
  template <class T>
  std::span<T> allocate(std::size_t n) {
    static_assert(std::is_trivially_copyable_v<T> && alignof(T) <= 64);
    return {static_cast<T*>(bytes(n * sizeof(T))), n};
  }
  template <class T>
  std::span<T> copy(const T* from, std::size_t n) {
    const std::span<T> to = allocate<T>(n);
    if (n) std::memcpy(static_cast<void*>(to.data()), from, n * sizeof(T));
    return to;
  }
  /// Makes all that was handed out invalid and uses the last block again.
  void clear() {
    if (blocks_.size() > 1) blocks_.erase(blocks_.begin(), blocks_.end() - 1);
    used_ = 0;
  }

 private:
  struct Free {
    void operator()(std::byte* block) const { ::operator delete(block, alignment); }
  };
  static constexpr std::align_val_t alignment{std::size_t{2} << 20};

  void* bytes(std::size_t n);

  std::vector<std::unique_ptr<std::byte, Free>> blocks_;
  std::size_t used_ = 0, size_ = 0;
};

}  // namespace tafoni::surface::impl
