#include "tafoni/grammar/solid.h"

#include "tafoni/core/error.h"

namespace tafoni::grammar {

const SolidType& find_solid(std::string_view name) {
  return find(all_solids(), name, "solid");
}

}  // namespace tafoni::grammar
