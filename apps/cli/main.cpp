// Finds the command, lets it declare its options, runs it, and turns what it throws into one sentence and an
// exit status.
#include <algorithm>
#include <atomic>
#include <csignal>
#include <exception>
#include <memory>
#include <new>
#include <stdexcept>
#include <string_view>

#include "args.h"
#include "command.h"
#include "console.h"
#include <fcntl.h>
#include <fmt/core.h>
#include <unistd.h>

#include "tafoni/core/error.h"
#include "tafoni/core/parallel.h"
#include "tafoni/io/network.h"
#include "tafoni/io/outside.h"
#include "tafoni/scene/build/build.h"

namespace tafoni::cli {
namespace {

std::atomic<Progress*> interrupted{nullptr};

void on_signal(int) {
  if (Progress* progress = interrupted.load()) progress->cancel();
}

/// The first Ctrl-C asks the work to stop; the handler is gone then, so that a second one kills.
class Interruptible {
 public:
  explicit Interruptible(Progress& progress) {
    interrupted = &progress;
    struct sigaction action = {};
    action.sa_handler = on_signal;
    action.sa_flags = static_cast<int>(SA_RESETHAND);
    sigaction(SIGINT, &action, nullptr);
    sigaction(SIGTERM, &action, nullptr);
  }
  ~Interruptible() { interrupted = nullptr; }
};

constexpr const char* doc =
    "Turns heightfield terrain into true 3D: sea cliffs that overhang, caves to walk into.";
constexpr const char* footer =
    "Results go to stdout; warnings to stderr, and progress too on a terminal or with --progress.\n"
    "Exit codes: 0 done; 1 internal error or out of memory; 2 wrong arguments or parameters; 3 an input\n"
    "cannot be used; 4 a result cannot be written; 5 validate found a defect, or a walk of query did not\n"
    "arrive or led through rock; 130 interrupted (nothing half-written is left).";

struct Entry {
  std::unique_ptr<Args> args;
  std::function<int(Console&)> run;
};

int run(int argc, const char* const* argv) {
  CommonOptions common;
  std::vector<Entry> entries;
  std::vector<Args*> parsers;
  for (const Command* command : all_commands()) {
    auto args = std::make_unique<Args>(command->about.name, command->about.doc);
    auto body = command->setup(*args);
    common.declare(*args);
    if (!command->examples.empty()) args->footer("Examples:\n" + command->examples);
    parsers.push_back(args.get());
    entries.push_back({std::move(args), std::move(body)});
  }
  const Parsed parsed = parse(argc, argv, parsers, doc, footer, "tafoni " + std::string(scene::version()));
  Console console(common);
  if (parsed.command < 0) {
    console.result(parsed.output);
    console.flush();
    return 0;
  }
  if (common.threads) set_thread_count(static_cast<int>(*common.threads));
  if (common.network) io::allow_network();
  if (common.outside) io::allow_outside();
  const Interruptible guard(console);
  const int code = entries[parsed.command].run(console);
  console.flush();
  return code;
}

}  // namespace
}  // namespace tafoni::cli

namespace {

/// A standard stream that is closed would lend its number to the next file that is opened, and messages would
/// end up in it. What stands in its place here takes nothing.
void hold_standard_streams() {
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
    while (fcntl(stream, F_GETFD) < 0)
      if (open("/dev/null", O_RDONLY) < 0) break;
}

/// Whether what fails before the options are read is to be told as JSON.
bool wants_json(int argc, const char* const* argv) {
  return std::any_of(argv, argv + argc,
                     [](const char* word) { return std::string_view(word).starts_with("--json"); });
}

tafoni::Error as_error(const std::exception& thrown) {
  using tafoni::Error;
  using tafoni::ErrorKind;
  if (const auto* error = dynamic_cast<const Error*>(&thrown))
    return error->kind() == ErrorKind::cancelled
               ? Error(ErrorKind::cancelled, "interrupted; nothing half-written is left")
               : *error;
  if (dynamic_cast<const std::bad_alloc*>(&thrown) != nullptr ||
      dynamic_cast<const std::length_error*>(&thrown) != nullptr)
    return {ErrorKind::internal, "not enough memory; use a larger --voxel, a smaller --window, or --tiles"};
  return {ErrorKind::internal, fmt::format("internal error: {}; please report it", thrown.what())};
}

}  // namespace

int main(int argc, char** argv) {
  hold_standard_streams();
  // A file that grows beyond `ulimit -f` is one that cannot be written, not the end of the program.
  std::signal(SIGXFSZ, SIG_IGN);
  try {
    return tafoni::cli::run(argc, argv);
  } catch (const std::exception& thrown) {
    const tafoni::Error error = as_error(thrown);
    tafoni::cli::print_error(error, wants_json(argc, argv));
    return static_cast<int>(error.kind());
  }
}
