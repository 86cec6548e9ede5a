#include "tafoni/io/network.h"

#include <atomic>

namespace tafoni::io {
namespace {

std::atomic<bool> allowed{false};

}  // namespace

void allow_network() {
  allowed = true;
}

bool network_allowed() {
  return allowed;
}

}  // namespace tafoni::io
