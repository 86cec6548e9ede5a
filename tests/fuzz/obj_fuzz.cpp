#include "mesh_check.h"

std::vector<std::string> fuzz_seeds() {
  return {
      "# tafoni: metres, y up\n# world origin 447123.25 5909876.5 57.125\nv 0 0 0 0.5 0.5 1\nv 3 0 0 1 1 1\n"
      "v 0 0 -4 0 0 0\nvn 0 1 0\nvt 0.5 0.25\nvt 1\nf 1/1/1 2/2/1 3/1/1\n",
      "mtllib a.mtl\r\nv 447123.37 5909876.54 57.2\r\nv 447124.37 5909876.54 57.2\r\nv 447123.37 5909877.5 "
      "57\r\n"
      "v 1e-3 +2 .5\r\ng side\r\nf 1 2 3 4\r\nf -4//-1 -3 -1\r\n",
      "v 0 0 0\nv 1 0 0\nv 1 1 0\nvn 0 0 1\nvn 1 0 0\nf 1//1 2//1 3//2\nf 3//1 2//1 1//2\n"};
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  check_mesh(std::as_bytes(std::span(data, size)), "fuzz.obj");
  return 0;
}
