#include "tafoni/terrain/generator.h"

#include "tafoni/core/error.h"

namespace tafoni::terrain {

const GeneratorType& find_generator(std::string_view name) {
  std::vector<std::string> known;
  for (const GeneratorType* type : all_generators()) {
    if (type->name == name) return *type;
    known.push_back(type->name);
  }
  const std::string near = nearest(name, known);
  if (!near.empty()) fail(ErrorKind::usage, "unknown generator \"{}\"; did you mean \"{}\"?", name, near);
  std::string list;
  for (const std::string& k : known) list += (list.empty() ? "" : ", ") + k;
  fail(ErrorKind::usage, "unknown generator \"{}\"; known are {}", name, list);
}

}  // namespace tafoni::terrain
