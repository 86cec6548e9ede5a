// Any text is either a scene that survives saving, or one error of kind input.

#include "fuzz.h"

#include "tafoni/scene/document/document.h"

std::vector<std::string> fuzz_seeds() {
  return {
      "[scene]\nseed = 7\nvoxel = 0.5 # m\n[terrain]\nsource = \"a.tif\"\nwindow = [1, 2,\n 3, 4]\n"
      "[[geology]]\ntype = \"strata\"\nthickness = 14.0\n[[layer]]\ntype = \"sea-cliff\"\nrange = 8.0\n"
      "[[layer]]\ntype = \"karst\"\nenabled = false\naltitude = [0, 1e3]\n[[layer]]\ntype = "
      "\"primitives\"\nfile = 'p.csv'\n",
      "[terrain]\nsource = \"a\"\n[[geology]]\ntype = \"fault\" # f\n[[geology.of]]\ntype = \"blend\"\n"
      "# b\n[[geology.of.of]]\ntype = \"fold\"\nname = \"n\"\n[[geology.of.of.of]]\ntype = \"planes\"\n"
      "[[geology.of.of]]\ntype = \"curve\"\n[[layer]]\ntype = \"hoodoo\"\n[[layer.rule]]\n",
      "terrain = {generator = \"coast\", width = 300}\nlayer = [{type = \"karst\", region = '''x\n'''}]\n",
      "[terrain]\nsource = \"\\u00e9\\\"\"\ninfluence = 15\namplitude = 7.5\ninterpolation = \"bilinear\"\n"};
}

static void grow(std::vector<tafoni::scene::GeologySettings>& list) {
  for (auto& geology : list) {
    grow(geology.of);
    if (geology.type == "blend") geology.of.insert(geology.of.begin(), {"planes", {}, 0});
    geology.seed = geology.seed < 0 ? 5 : -1;
  }
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace tafoni;
  scene::Document document;
  if (!accepts([&] { document = scene::parse_scene(as_text(data, size), "fuzz.toml"); })) return 0;
  // A changed document must still read back as itself, however odd the text is laid out.
  document.scene.voxel = document.scene.voxel == 2 ? 3 : 2;
  if (!document.layers.empty()) document.layers.erase(document.layers.begin());
  grow(document.geology);
  document.geology.push_back({"turbulence", {}, 0});
  require(scene::same(scene::parse_scene(scene::to_text(document), "fuzz.toml"), document));
  return 0;
}
