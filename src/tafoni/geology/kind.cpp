#include "tafoni/geology/kind.h"

#include <string>

#include "tafoni/core/error.h"

namespace tafoni::geology {

const GeologyType& find_geology(std::string_view name) {
  std::vector<std::string> known;
  for (const GeologyType* type : all_geologies()) {
    if (type->name == name) return *type;
    known.push_back(type->name);
  }
  const std::string near = nearest(name, known);
  if (!near.empty()) fail(ErrorKind::usage, "unknown geology \"{}\"; did you mean \"{}\"?", name, near);
  std::string list;
  for (const std::string& k : known) list += (list.empty() ? "" : ", ") + k;
  fail(ErrorKind::usage, "unknown geology \"{}\"; known are {}", name, list);
}

GeologyPtr make_geology(std::string_view name, const Values& values, std::vector<GeologyPtr> children,
                        Vec3d origin, std::uint64_t seed) {
  const GeologyType& type = find_geology(name);
  if (children.size() < type.min_children || children.size() > type.max_children) {
    if (type.max_children == 0)
      fail(ErrorKind::usage, "{}: takes no children, but has {}", name, children.size());
    fail(ErrorKind::usage, "{}: takes {} to {} children, but has {}", name, type.min_children,
         type.max_children, children.size());
  }
  Values valid;
  for (const auto& [key, value] : values)
    valid[key] = checked(find_param(type.params, key, name), value, name);
  return type.make(valid, std::move(children), origin, seed);
}

GeologyPtr default_geology(Vec3d origin, std::uint64_t seed) {
  return make_geology("strata", {}, {}, origin, seed);
}

}  // namespace tafoni::geology
