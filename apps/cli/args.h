#pragma once
// The options of a subcommand. The parsing library stays behind it; values are checked by the program's own
// parameter rules, so that errors read the same everywhere.

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "tafoni/core/params.h"

namespace CLI {
class App;
}

namespace tafoni::cli {

class Args {
 public:
  Args(const std::string& name, const std::string& doc);
  ~Args();
  Args(const Args&) = delete;
  Args& operator=(const Args&) = delete;

  /// Options declared from here on are shown under this title.
  void group(const std::string& title) { group_ = title; }
  /// Sets the text below the options in --help.
  void footer(const std::string& text);

  void positional(const std::string& name, std::string& target, const std::string& doc, bool required = true);
  void flag(const std::string& flags, bool& target, const std::string& doc);
  void text(const std::string& flags, const std::string& value, std::string& target, const std::string& doc);
  /// Declares an option that may be given many times.
  void texts(const std::string& flags, const std::string& value, std::vector<std::string>& target,
             const std::string& doc);
  void choice(const std::string& flags, std::string& target, std::vector<std::string> choices,
              const std::string& doc);
  void number(const std::string& flags, const std::string& value, std::optional<double>& target, double min,
              double max, const std::string& unit, const std::string& doc);
  void integer(const std::string& flags, const std::string& value, std::optional<std::int64_t>& target,
               std::int64_t min, std::int64_t max, const std::string& doc);
  /// Numbers separated by commas, as one argument. `count` 0: any.
  void numbers(const std::string& flags, const std::string& value, std::vector<double>& target,
               std::size_t count, const std::string& doc);
  /// Like numbers(), but the value may be left out; `given` says whether the flag is there.
  void optional_numbers(const std::string& flags, const std::string& value, bool& given,
                        std::vector<double>& target, std::size_t count, const std::string& doc);

  /// What was declared, for the reference page.
  struct Entry {
    std::string flags, value, doc, group;
  };
  const std::vector<Entry>& entries() const { return entries_; }

  /// Checks and stores what was parsed. Throws Error{usage}.
  void apply() const;
  std::shared_ptr<CLI::App> app() const { return app_; }

 private:
  /// A text that `store` gets when the option is given.
  void add(const std::string& flags, const std::string& value, const std::string& doc,
           std::function<void(const std::string&)> store);
  void add_value(const std::string& flags, const std::string& value, const std::string& doc, ParamInfo info,
                 std::function<void(const Value&)> store);

  std::shared_ptr<CLI::App> app_;
  std::string group_ = "Options";
  std::vector<Entry> entries_;
  std::vector<std::function<void()>> after_;
};

/// What a command line asks for: one of `commands`, or -1 where `output` (help, version) is all.
struct Parsed {
  int command = -1;
  std::string output;
};
/// Throws Error{usage} naming the nearest known command or option.
Parsed parse(int argc, const char* const* argv, const std::vector<Args*>& commands, const std::string& doc,
             const std::string& footer, const std::string& version);

}  // namespace tafoni::cli
