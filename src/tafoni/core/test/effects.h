#pragma once
// Whether parameters do what they are there for: what the tests of every registry ask of its declarations.

#include <algorithm>
#include <string>
#include <vector>

#include "tafoni/core/params.h"

namespace tafoni {

/// Both ends and the middle of a parameter's range, and a place in between that is no round number, since
/// what turns or repeats may look alike at the others. A list has its own length, or the length it has in
/// `values`.
inline std::vector<Value> values_to_try(const ParamInfo& info, const Values& values) {
  const double odd = info.min + 0.37 * (info.max - info.min), middle = (info.min + info.max) / 2;
  std::vector<Value> out;
  switch (info.kind) {
    case ValueKind::boolean:
      return {false, true};
    case ValueKind::choice:
      for (const std::string& choice : info.choices) out.emplace_back(choice);
      return out;
    case ValueKind::real:
      return {info.init, info.min, middle, odd, info.max};
    case ValueKind::integer:
      out.push_back(info.init);
      for (const double v : {info.min, middle, odd, info.max}) out.emplace_back(static_cast<std::int64_t>(v));
      return out;
    case ValueKind::numbers: {
      const auto given = values.find(info.name);
      const auto list = std::get<std::vector<double>>(given == values.end() ? info.init : given->second);
      for (const double v : {info.min, odd, info.max}) out.emplace_back(std::vector<double>(list.size(), v));
      out.emplace_back(list);
      return out;
    }
    case ValueKind::text:
    case ValueKind::rows:
      break;
  }
  return out;
}

/// Whether one of the values to try makes something else than another. make(values) gives what compares with
/// ==, or nullopt where the values do not go together. `values` is what a parameter starts from; a parameter
/// that has an effect in some case only is asked in that case.
template <class Make>
bool has_effect(const ParamInfo& info, Values values, const Make& make) {
  for (const auto& [name, value] : info.only_with) values[name] = value;
  decltype(make(values)) first;
  for (const Value& value : values_to_try(info, values)) {
    Values with = values;
    with[info.name] = value;
    auto made = make(with);
    if (!made) continue;
    if (first && *made != *first) return true;
    if (!first) first = std::move(made);
  }
  return false;
}

}  // namespace tafoni
