#include "mesh_check.h"

std::vector<std::string> fuzz_seeds() {
  std::string binary = "tafoni: metres, z up, origin 447123.25 5909876.5 57";
  binary.resize(80, ' ');
  binary += std::string("\2\0\0\0", 4);
  for (const float corner : {0.0f, 1.0f}) {
    const float facet[12] = {0, 0, 1, corner, 0, 0, 1, 0, corner, 0, 2, 0};
    binary.append(reinterpret_cast<const char*>(facet), sizeof facet);
    binary += std::string(2, '\0');
  }
  return {
      binary,
      "solid x\nfacet normal 0 0 1\nouter loop\nvertex 447123.37 5909876.54 57.2\nvertex 447124 5909876 57\n"
      "vertex 447123 5909877 57\nendloop\nendfacet\nendsolid x\n",
      "solid\nfacet\nouter loop\nvertex 0 0 0\nvertex 1 0 -0\nvertex 0 1e-9 0\nendloop\nendfacet\nfacet\n"
      "outer loop\nvertex 1 0 0\nvertex 1 1 0\nvertex 0 1 0\nendloop\nendfacet\n"};
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  check_mesh(std::as_bytes(std::span(data, size)), "fuzz.stl");
  return 0;
}
