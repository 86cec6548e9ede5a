#include "tafoni/io/mesh_file.h"
#include "tafoni/scene/products/mesh_scene.h"

using namespace tafoni;

int main() {
  const auto text = R"(
    terrain = { generator = "coast", width = 300, height = 200 }
    layer = [{ type = "sea-cliff", range = 8.0 }]
  )";
  const scene::BuiltScene coast = scene::build(scene::parse_scene(text, "coast.toml"));
  const field::CompiledField rock = coast.field_for(surface::Boundary::solid);
  const bool in_the_air = rock.value({150, 100, 500}) < 0;  // what is solid is above 0
  io::write_mesh("coast.glb", scene::mesh_scene(coast).mesh);
  return in_the_air ? 0 : 1;
}
