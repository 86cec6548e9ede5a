#pragma once
// What every registered kind declares of itself, and how one is found by its name. A kind is one file; CMake
// globs its folder and writes the table all_…() of its entries (cmake/registry.cmake).

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "tafoni/core/params.h"

namespace tafoni {

/// The part that is alike for landforms, primitives, brushes, file formats and so on: scene files,
/// `tafoni list`, --help and the reference are made from it.
struct Declaration {
  std::string name = {};               ///< as scene files and commands say it
  std::string doc = {};                ///< what it is, one phrase without a full stop
  std::string source = {};             ///< a key of docs/sources.md, such as "[Paris19 §6.2]"; may be empty
  std::vector<ParamInfo> params = {};  ///< see ParamTable
};

/// Throws Error{usage}: there is no WHAT of this name, and which one is near or which there are.
[[noreturn]] void fail_unknown(std::string_view what, std::string_view name,
                               std::span<const std::string> known);

/// The entry of this name; `what` is what messages call its kind: "landform", "brush" …
/// Throws Error{usage} naming the nearest known one.
template <class Type>
const Type& find(std::span<const Type* const> all, std::string_view name, std::string_view what) {
  for (const Type* type : all)
    if (type->about.name == name) return *type;
  std::vector<std::string> known;
  for (const Type* type : all) known.push_back(type->about.name);
  fail_unknown(what, name, known);
}

}  // namespace tafoni
