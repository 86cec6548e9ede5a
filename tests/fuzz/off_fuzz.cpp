#include "mesh_check.h"

std::vector<std::string> fuzz_seeds() {
  return {"OFF # a square\n# and more\n4 1 0\n0 0 0\n1 0 0 # corner\n1 1 0\n0 1 0\n4 0 1 2 3 255 0 0\n",
          "COFF\n3 2 3\n447123.37 5909876.54 57.2 1 0 0 1\n447124 5909876.5 57 1 0 0 1\n447123 5909877 57 0 "
          "0 0 1\n"
          "3 0 1 2\n3 2 1 0\n",
          "3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2"};
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  check_mesh(std::as_bytes(std::span(data, size)), "fuzz.off");
  return 0;
}
