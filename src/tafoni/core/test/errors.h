#pragma once
// What tests ask of an error: the sentence that the user gets to read.

#include <functional>
#include <string>

#include "tafoni/core/error.h"

namespace tafoni {

/// What the Error says that `action` throws; "" where it throws none. Any other exception goes on.
inline std::string error_of(const std::function<void()>& action) {
  try {
    action();
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

}  // namespace tafoni
