#pragma once
// Keeps the warnings of what is done with it.

#include <string>
#include <vector>

#include "tafoni/core/progress.h"

namespace tafoni {

struct HeardWarnings final : Progress {
  std::vector<std::string> said;
  void on_warn(std::string_view sentence) override { said.emplace_back(sentence); }
};

}  // namespace tafoni
