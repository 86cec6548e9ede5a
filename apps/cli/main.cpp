// Finds the command, lets it declare its options, runs it, and turns what it throws into one sentence and an
// exit status.
#include <atomic>
#include <csignal>
#include <exception>
#include <memory>
#include <new>

#include "args.h"
#include "command.h"
#include "console.h"
#include <fmt/core.h>

#include "tafoni/core/error.h"
#include "tafoni/core/parallel.h"
#include "tafoni/io/network.h"
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
    "cannot be used; 4 a result cannot be written; 5 validate found a defect; 130 interrupted (nothing\n"
    "half-written is left).";

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
  const Interruptible guard(console);
  const int code = entries[parsed.command].run(console);
  console.flush();
  return code;
}

}  // namespace
}  // namespace tafoni::cli

int main(int argc, char** argv) {
  using tafoni::cli::print_error;
  // A file that grows beyond `ulimit -f` is one that cannot be written, not the end of the program.
  std::signal(SIGXFSZ, SIG_IGN);
  try {
    return tafoni::cli::run(argc, argv);
  } catch (const tafoni::Error& error) {
    const bool cancelled = error.kind() == tafoni::ErrorKind::cancelled;
    print_error(cancelled ? "interrupted; nothing half-written is left" : error.what());
    return static_cast<int>(error.kind());
  } catch (const std::bad_alloc&) {
    print_error("not enough memory; use a larger --voxel, a smaller --window, or --tiles");
  } catch (const std::exception& error) {
    print_error(fmt::format("internal error: {}; please report it", error.what()));
  }
  return static_cast<int>(tafoni::ErrorKind::internal);
}
