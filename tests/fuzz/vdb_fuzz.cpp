// Any bytes as an OpenVDB file.

#include "volume_check.h"

std::vector<std::string> fuzz_seeds() {
  using tafoni::volume::Precision;
  std::vector<std::string> out = {written_volume("vdb", Precision::single, {24, 8, 8}, 0.7f),
                                  written_volume("vdb", Precision::half, {24, 8, 8}, 0.7f),
                                  written_volume("vdb", Precision::single, {40, 8, 8}, 30),
                                  written_volume("vdb", Precision::single, {16, 8, 8}, 0)};
  // A build without OpenVDB writes none: the beginning of one.
  sound_seeds = !out[0].empty();
  if (!sound_seeds) out = {std::string(" BDV\0\0\0\0\xe0\0\0\0", 12) + std::string(60, '\0')};
  return out;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  check_volume(std::as_bytes(std::span(data, size)), "fuzz.vdb");
  return 0;
}
