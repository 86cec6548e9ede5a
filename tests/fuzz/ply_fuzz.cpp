#include "mesh_check.h"

std::vector<std::string> fuzz_seeds() {
  const std::string vertex = "property double x\nproperty double y\nproperty double z\n";
  const std::string face = "element face 1\nproperty list uchar int vertex_indices\nend_header\n";
  std::string little =
      "ply\nformat binary_little_endian 1.0\ncomment tafoni: metres, y up\nelement vertex 3\n" + vertex +
      face;
  for (const double v :
       {447123.37, 57.2, -5909876.54, 447124.0, 57.0, -5909876.0, 447123.0, 57.0, -5909877.0})
    little.append(reinterpret_cast<const char*>(&v), sizeof v);
  little += std::string("\x03\0\0\0\0\1\0\0\0\2\0\0\0", 13);
  std::string big =
      "ply\nformat binary_big_endian 1.0\nelement vertex 3\nproperty short x\nproperty short y\n"
      "property short z\nproperty list uchar uchar more\nelement face 1\n"
      "property list uchar ushort vertex_index\nend_header\n";
  big += std::string("\0\0\0\0\0\0\1\7\0\1\0\0\0\0\0\0\0\0\0\1\1\2\0", 23);
  big += std::string("\x03\0\0\0\1\0\2", 7);
  return {little, big,
          "ply\nformat ascii 1.0\ncomment world origin 447000 5909000 0\nelement vertex 3\nproperty float x\n"
          "property float y\nproperty float z\nproperty float nx\nproperty float ny\nproperty float nz\n"
          "property uchar red\nproperty uchar green\nproperty uchar blue\nelement face 1\n"
          "property list uchar int vertex_indices\nelement edge 1\nproperty int a\nend_header\n"
          "0 0 0 0 0 1 255 0 9\n1 0 0 0 0 1 9 9 9\n0 1 0.5 0 0 1 1 2 3\n3 0 1 2\n7\n"};
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  check_mesh(std::as_bytes(std::span(data, size)), "fuzz.ply");
  return 0;
}
