// Any bytes as a .tvol. The header's checksum is mended, so that what stands behind it is reached.

#include "volume_check.h"

std::vector<std::string> fuzz_seeds() {
  using tafoni::volume::Precision;
  return {written_volume("tvol", Precision::single, {5, 4, 3}, 0.7f),
          written_volume("tvol", Precision::half, {25, 4, 3}, 0.7f),
          written_volume("tvol", Precision::single, {70, 2, 33}, 30),
          written_volume("tvol", Precision::half, {2, 200, 40}, 0.1f)};
}

/// The layout stands at the head of io/formats/tvol.cpp.
static void mend_checksum(std::string& file) {
  constexpr std::size_t lengths_at = 88, hash_at = 104, header_bytes = 112;
  if (file.size() < header_bytes) return;
  std::uint64_t text = 0, table = 0, hash = 0xcbf29ce484222325ull;
  std::memcpy(&text, file.data() + lengths_at, 8);
  std::memcpy(&table, file.data() + lengths_at + 8, 8);
  const std::uint64_t left = file.size() - header_bytes;
  if (text > left || table > left - text) return;
  for (std::size_t i = 0; i < header_bytes + text + table; ++i)
    if (i < hash_at || i >= header_bytes)
      hash = (hash ^ static_cast<unsigned char>(file[i])) * 0x100000001b3ull;
  std::memcpy(file.data() + hash_at, &hash, 8);
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::string file(reinterpret_cast<const char*>(data), size);
  mend_checksum(file);
  check_volume(std::as_bytes(std::span(file.data(), file.size())), "fuzz.tvol");
  return 0;
}
