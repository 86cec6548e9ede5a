// Runs a fuzz target without libFuzzer: mutates its seeds a given number of times, the same way each run. An
// input that ends the program is left in the file TARGET.input; sanitizers need abort_on_error=1 for that.
// usage: TARGET [COUNT [SEED]]

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <iterator>

#include "fuzz.h"
#include <fcntl.h>

#include "tafoni/core/random.h"

namespace {

/// Pieces that parsers treat specially.
const std::vector<std::string> tokens = {"[",
                                         "]",
                                         "[[",
                                         "]]",
                                         "{",
                                         "}",
                                         "\"",
                                         "'",
                                         "\"\"\"",
                                         "'''",
                                         "=",
                                         ".",
                                         ",",
                                         "#",
                                         "\n",
                                         "\r\n",
                                         "\\",
                                         "\\u0000",
                                         "nan",
                                         "inf",
                                         "-",
                                         "+",
                                         "1e999",
                                         "1e-999",
                                         "9223372036854775808",
                                         "-0",
                                         "0x",
                                         "true",
                                         "1979-05-27",
                                         "\xff",
                                         std::string(1, '\0'),
                                         "\xef\xbb\xbf",
                                         "type",
                                         "layer",
                                         "scene",
                                         "terrain",
                                         "voxel",
                                         "kind",
                                         "point",
                                         "sphere",
                                         ";",
                                         "\t",
                                         "/",
                                         ":",
                                         "4294967295",
                                         "65535",
                                         "\nv ",
                                         "\nf ",
                                         "element ",
                                         "property ",
                                         "list ",
                                         "vertex",
                                         "comment world origin ",
                                         "# world origin ",
                                         "world_origin",
                                         "children",
                                         "mesh"};

/// Overwrites a number of a binary file with one that its reader may not expect; often where there is one.
void overwrite_number(std::string& text, tafoni::Random& random) {
  if (text.empty()) return;
  std::size_t at = random.below(text.size());
  for (int i = 0; i < 20 && text[at] == 0 && random.below(8) != 0; ++i) at = random.below(text.size());
  constexpr std::int64_t ends[] = {-1, 0, 1, 0x7f, 0x7fff, 0x7fffffff, -0x80000000ll};
  const std::int64_t number = random.below(2)   ? ends[random.below(std::size(ends))]
                              : random.below(2) ? std::int64_t{1} << random.below(63)
                                                : static_cast<std::int64_t>(random.below(1000)) - 20;
  const std::size_t bytes = std::min(std::size_t{1} << random.below(4), text.size() - at);
  std::memcpy(text.data() + at, &number, bytes);
}

std::string mutated(std::string text, tafoni::Random& random, const std::vector<std::string>& seeds) {
  const auto at = [&] { return random.below(text.size() + 1); };
  for (std::uint64_t n = random.below(6) + 1; n > 0; --n) {
    switch (random.below(9)) {
      case 0:
        if (!text.empty()) text[random.below(text.size())] = static_cast<char>(random.below(256));
        break;
      case 1:
        text.insert(at(), tokens[random.below(tokens.size())]);
        break;
      case 2: {
        const auto from = at();
        text.erase(from, random.below(12));
        break;
      }
      case 3: {
        const auto from = at();
        text.insert(at(), text.substr(from, random.below(40)));
        break;
      }
      case 4:
        text.resize(at());
        break;
      case 5: {
        const std::string& other = seeds[random.below(seeds.size())];
        text.insert(at(), other.substr(random.below(other.size() + 1), random.below(60)));
        break;
      }
      case 6:
      case 7:
        overwrite_number(text, random);
        break;
      default:
        text.insert(at(), 1, static_cast<char>(random.below(128)));
    }
  }
  return text;
}

std::string input, input_file;

extern "C" void leave_input(int) {
  const int file = ::open(input_file.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
  const auto written = ::write(file, input.data(), input.size());
  ::close(file);
  ::_exit(written < 0 ? 2 : 1);
}

/// Sanitizers report what else may end a program, and abort then.
void leave_input_at_signals() {
  std::signal(SIGABRT, leave_input);
#ifndef TAFONI_SANITIZED
  static char stack[1 << 16];  // where the program's own is used up
  const stack_t other{.ss_sp = stack, .ss_flags = 0, .ss_size = sizeof stack};
  ::sigaltstack(&other, nullptr);
  struct sigaction leave {};
  leave.sa_handler = leave_input;
  leave.sa_flags = SA_ONSTACK;
  for (const int signal : {SIGSEGV, SIGBUS, SIGFPE, SIGILL}) ::sigaction(signal, &leave, nullptr);
#endif
}

}  // namespace

int main(int argc, char** argv) {
  const std::uint64_t count = argc > 1 ? std::strtoull(argv[1], nullptr, 10) : 100000;
  tafoni::Random random(argc > 2 ? std::strtoull(argv[2], nullptr, 10) : 1);
  const std::vector<std::string> seeds = fuzz_seeds();
  accepted_inputs = 0;
  input_file = std::filesystem::path(argv[0]).filename().string() + ".input";
  leave_input_at_signals();
  std::vector<std::string> pool = seeds;
  std::size_t longest = 2000;
  for (const std::string& seed : seeds) longest = std::max(longest, 2 * seed.size());
  for (std::uint64_t i = 0; i < count; ++i) {
    // The seeds come first. Of the others half begin at a seed: of a binary file little is understood once
    // its head is broken.
    input = i < seeds.size()  ? seeds[i]
            : random.below(2) ? mutated(pool[random.below(pool.size())], random, seeds)
                              : mutated(seeds[random.below(seeds.size())], random, seeds);
    LLVMFuzzerTestOneInput(reinterpret_cast<const std::uint8_t*>(input.data()), input.size());
    // Where nothing is ever read, a reader or a folder is missing.
    if (i + 1 == seeds.size()) require(accepted_inputs > 0 || !sound_seeds);
    // A pool that drifts away from the seeds reaches deeper than single mutations of them.
    if (input.size() < longest && random.below(4) == 0) {
      if (pool.size() < 500)
        pool.push_back(std::move(input));
      else
        pool[seeds.size() + random.below(pool.size() - seeds.size())] = std::move(input);
    }
  }
  std::printf("%llu inputs, nothing found\n", static_cast<unsigned long long>(count));
  return 0;
}
