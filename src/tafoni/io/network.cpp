#include "tafoni/io/network.h"

#include <atomic>

namespace tafoni::io {
namespace {

std::atomic<bool> may_fetch{false};

}  // namespace

void allow_network() {
  may_fetch = true;
}

bool network_allowed() {
  return may_fetch;
}

}  // namespace tafoni::io
