// Any text as a file of strokes, line by line or as JSON: what is read reads back the same from the lines
// that are written of it.

#include "fuzz.h"

#include "tafoni/scene/sculpt/stroke.h"

std::vector<std::string> fuzz_seeds() {
  return {
      "# by hand\nsphere at=500000.5,5500000.25,12 radius=4 strength=0.5\n\n"
      "cave at=120,80,14/150,95,12 radius=4 chambers=1 seed=9007199254740992\n",
      "paint at=1,2,3 mask=\"sea caves\" hardness=1\r\narch at=1,2,3/4,5,6 roughness=0 mode=add\n",
      "curve at=0,0,0/1e3,-2,.5/7,8,9 smooth=false\nskeletal kind=ellipsoid at=1,2,3/4,5,6 \"hx=3\" "
      "turn=90\n",
      R"([{"brush": "sphere", "at": [1, 2, 3], "radius": 4.5, "seed": 7},)"
      R"( {"brush": "cave", "at": [[1, 2, 3], [4, 5, 6.5]], "mode": "carve", "chambers": 2}])",
      R"({"brush": "paint", "at": [1, 2, 3], "mask": "a b", "strength": 1})"};
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace tafoni;
  const std::string_view text = as_text(data, size);
  accepts([&] { scene::parse_stroke(text, "--stroke"); }, {ErrorKind::usage});
  std::vector<scene::Stroke> strokes;
  if (!accepts([&] { strokes = scene::parse_strokes(text, "fuzz.strokes"); })) return 0;
  std::string lines;
  for (const scene::Stroke& stroke : strokes) lines += scene::to_text(stroke) + "\n";
  require(scene::parse_strokes(lines, "again.strokes") == strokes);
  return 0;
}
