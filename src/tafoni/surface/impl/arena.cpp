#include "tafoni/surface/impl/arena.h"

#include <algorithm>
#include <cstdint>

#if defined(__linux__)
#include <sys/mman.h>
#endif

namespace tafoni::surface::impl {

void advise_large_pages(void* memory, std::size_t bytes) {
#if defined(__linux__)
  constexpr std::uintptr_t page = std::uintptr_t{2} << 20;
  const auto begin = (reinterpret_cast<std::uintptr_t>(memory) + page - 1) & ~(page - 1);
  const auto end = (reinterpret_cast<std::uintptr_t>(memory) + bytes) & ~(page - 1);
  if (begin < end) madvise(reinterpret_cast<void*>(begin), end - begin, MADV_HUGEPAGE);
#else
  (void)memory, (void)bytes;
#endif
}

void* Arena::bytes(std::size_t n) {
  n = (n + 63) & ~std::size_t{63};
  if (used_ + n > size_) {
    constexpr std::size_t least = std::size_t{4} << 20, most = std::size_t{64} << 20;
    size_ = std::max({n, std::min(2 * size_, most), least});
    blocks_.emplace_back(static_cast<std::byte*>(::operator new(size_, alignment)));
    advise_large_pages(blocks_.back().get(), size_);
    used_ = 0;
  }
  used_ += n;
  return blocks_.back().get() + used_ - n;
}

}  // namespace tafoni::surface::impl
