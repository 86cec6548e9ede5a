#pragma once
// The one exception type of the program and the exit codes it maps to.

#include <stdexcept>
#include <string>

#include <fmt/core.h>

namespace tafoni {

/// What kind of thing went wrong; the value is the process exit code.
enum class ErrorKind : int {
  internal = 1,     ///< a bug in tafoni
  usage = 2,        ///< wrong arguments or parameters
  input = 3,        ///< a file that cannot be used as it is
  output = 4,       ///< a result that cannot be written
  invalid = 5,      ///< `validate` found a defect
  cancelled = 130,  ///< Ctrl-C
};

/// One clear sentence for the user: what is wrong, where, what to do.
class Error : public std::runtime_error {
 public:
  Error(ErrorKind kind, const std::string& sentence) : std::runtime_error(sentence), kind_(kind) {}
  ErrorKind kind() const { return kind_; }

 private:
  ErrorKind kind_;
};

/// fail() for what has been made ready, so that callers hold no more than a call.
[[noreturn]] void fail_with(ErrorKind kind, fmt::string_view text, fmt::format_args args);

/// Throws Error with the sentence that `text` and `args` make, as fmt::format() writes it.
template <class... Args>
[[noreturn]] void fail(ErrorKind kind, fmt::format_string<Args...> text, Args&&... args) {
  fail_with(kind, text, fmt::make_format_args(args...));
}

}  // namespace tafoni
