#pragma once
// Counts, which are whole and of any integer type, as real numbers.

#include <cstdint>

namespace tafoni {

/// `part` of `whole`, from 0 to 1 where it is a part.
inline double ratio(std::int64_t part, std::int64_t whole) {
  return static_cast<double>(part) / static_cast<double>(whole);
}

/// The mean of a list that is not empty, summed in its order.
template <class List>
double mean(const List& list) {
  double sum = 0;
  for (const auto v : list) sum += v;
  return sum / static_cast<double>(list.size());
}

}  // namespace tafoni
