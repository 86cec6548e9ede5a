#pragma once
// Counter-based random numbers: a value depends on (seed, stream, index) alone, never on call order
// across threads, so generators give the same bytes at any thread count.

#include <cstdint>
#include <type_traits>

namespace tafoni {

/// A bijective 64-bit mixer (the finaliser of SplitMix64 [Steele14]).
constexpr std::uint64_t mix64(std::uint64_t x) {
  x += 0x9e3779b97f4a7c15ull;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ull;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebull;
  return x ^ (x >> 31);
}

constexpr std::uint64_t hash_combine(std::uint64_t a, std::uint64_t b) {
  return mix64(a ^ (mix64(b) + 0x2545f4914f6cdd1dull));
}

/// An `enum class Stream` names what the streams of one seed are for.
template <class Stream>
requires std::is_enum_v<Stream>
constexpr std::uint64_t hash_combine(std::uint64_t seed, Stream stream) {
  return hash_combine(seed, static_cast<std::uint64_t>(stream));
}

/// A stream of numbers; copying it copies the position.
class Random {
 public:
  template <class Stream>
  requires std::is_enum_v<Stream>
  constexpr Random(std::uint64_t seed, Stream stream) : key_(hash_combine(seed, stream)) {}
  constexpr explicit Random(std::uint64_t seed, std::uint64_t stream = 0)
      : key_(hash_combine(seed, stream)) {}

  constexpr std::uint64_t next() { return at(counter_++); }
  /// Uniform in [0, 1), 53 bits.
  constexpr double uniform() { return static_cast<double>(next() >> 11) * 0x1p-53; }
  constexpr double uniform(double lo, double hi) { return lo + (hi - lo) * uniform(); }
  /// Uniform in [0, n), n > 0, without modulo bias worth naming for n < 2^32.
  constexpr std::uint64_t below(std::uint64_t n) {
    return static_cast<std::uint64_t>((static_cast<unsigned __int128>(next()) * n) >> 64);
  }
  /// The value at a given index, whatever was drawn before.
  constexpr std::uint64_t at(std::uint64_t index) const { return mix64(key_ ^ mix64(index)); }

 private:
  std::uint64_t key_;
  std::uint64_t counter_ = 0;
};

}  // namespace tafoni
