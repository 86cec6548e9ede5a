// Bytes that begin as a GLB does are read as they are. Others are taken for the JSON of one, over a binary
// chunk that stays the same: mutations of a whole file rarely get past its lengths.

#include "mesh_check.h"

namespace {

std::string word(std::size_t value) {
  const auto bits = static_cast<std::uint32_t>(value);
  return {reinterpret_cast<const char*>(&bits), sizeof bits};
}

std::string glb(std::string json) {
  std::string binary;
  for (const float v : {0.0f, 0.0f, 0.0f, 1.0f, 0.0f, 0.0f, 0.0f, 1.0f, 0.0f, 0.0f, 0.0f, 1.0f})
    binary.append(reinterpret_cast<const char*>(&v), sizeof v);
  binary += std::string("\0\0\1\0\2\0\0\0\2\0\3\0", 12);
  json.resize((json.size() + 3) / 4 * 4, ' ');
  return "glTF" + word(2) + word(28 + json.size() + binary.size()) + word(json.size()) + "JSON" + json +
         word(binary.size()) + std::string("BIN\0", 4) + binary;
}

const std::string json =
    R"({"asset":{"version":"2.0","extras":{"world_origin":[447123.25,5909876.5,57]}},"scene":0,"scenes":[{"nodes":[0,3]}],)"
    R"("nodes":[{"children":[1,2],"translation":[447123.37,57.2,-5909876.54]},{"mesh":0,"rotation":[0,0.7,0,0.7]},)"
    R"({"mesh":0,"scale":[2,2,2],"extras":{"world_origin":[0,0,0]}},{"mesh":1,"matrix":[1,0,0,0,0,1,0,0,0,0,1,0,9,0,0,1]}],)"
    R"("meshes":[{"primitives":[{"attributes":{"POSITION":0,"NORMAL":0,"COLOR_0":0,"TEXCOORD_0":2},"indices":1}]},)"
    R"({"primitives":[{"attributes":{"POSITION":0}}]}],"buffers":[{"byteLength":60}],)"
    R"("accessors":[{"bufferView":0,"componentType":5126,"type":"VEC3","count":4},)"
    R"({"bufferView":1,"componentType":5123,"type":"SCALAR","count":6},)"
    R"({"bufferView":0,"componentType":5126,"type":"VEC2","count":4,"byteOffset":8}],)"
    R"("bufferViews":[{"buffer":0,"byteLength":48},{"buffer":0,"byteOffset":48,"byteLength":12}]})";

}  // namespace

std::vector<std::string> fuzz_seeds() {
  return {
      json, glb(json),
      R"({"nodes":[{"children":[1,1]},{"mesh":0}],"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],)"
      R"("buffers":[{}],"bufferViews":[{"buffer":0,"byteLength":60,"byteStride":12}],)"
      R"("accessors":[{"bufferView":0,"componentType":5122,"normalized":true,"type":"VEC3","count":3}]})"};
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  check_mesh(std::as_bytes(std::span(text.starts_with("glTF") ? text : glb(text))), "fuzz.glb");
  return 0;
}
