#include "tafoni/io/outside.h"

#include <atomic>

namespace tafoni::io {
namespace {

std::atomic<bool> may_lie_outside{false};

}  // namespace

void allow_outside(bool allowed) {
  may_lie_outside = allowed;
}

bool outside_allowed() {
  return may_lie_outside;
}

}  // namespace tafoni::io
