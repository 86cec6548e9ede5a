#include "tafoni/terrain/generator.h"

#include "tafoni/core/error.h"

namespace tafoni::terrain {

const GeneratorType& find_generator(std::string_view name) {
  return find(all_generators(), name, "generator");
}

}  // namespace tafoni::terrain
