#include "tafoni/core/registry.h"

#include "tafoni/core/error.h"

namespace tafoni {

void fail_unknown(std::string_view what, std::string_view name, std::span<const std::string> known) {
  constexpr std::size_t shown = 100;  // letters of a name that may be a whole file by mistake
  name = name.substr(0, shown);
  if (const std::string near = nearest(name, known); !near.empty())
    fail(ErrorKind::usage, "there is no {} \"{}\"; did you mean \"{}\"?", what, name, near);
  std::string list;
  for (const std::string& k : known) list += (list.empty() ? "" : ", ") + k;
  fail(ErrorKind::usage, "there is no {} \"{}\"; known are {}", what, name, list);
}

}  // namespace tafoni
