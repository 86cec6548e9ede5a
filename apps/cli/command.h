#pragma once
// What the program knows of a subcommand. A subcommand is one file in commands/.

#include <functional>
#include <span>
#include <string>

#include "args.h"
#include "console.h"

#include "tafoni/core/registry.h"

namespace tafoni::cli {

struct Command {
  Declaration about = {};
  std::string examples = {};  ///< for --help and the reference, one a line
  /// Declares the options and gives what to run once they are parsed; its result is the exit code.
  std::function<int(Console&)> (*setup)(Args&) = nullptr;
};

/// Every subcommand, sorted by name; commands/NAME.cpp defines `const Command& declaration()` in its
/// namespace `command_NAME`.
std::span<const Command* const> all_commands();

}  // namespace tafoni::cli
