// Any bytes as the journal of a terrain's edits. Checksums are mended, so that what stands behind them is
// reached; what reads whole reads as far when it is cut off anywhere.

#include <algorithm>
#include <bit>
#include <iterator>

#include "fuzz.h"

#include "tafoni/runtime/journal.h"

using namespace tafoni;
using runtime::JournalContents;

std::vector<std::string> fuzz_seeds() {
  using volume::Edit;
  using volume::Tool;
  const FuzzFolder folder;
  const auto written = [&](const std::vector<runtime::Operation>& operations) {
    std::vector<runtime::Message> edits;
    for (const auto& operation : operations) edits.push_back(runtime::encode(operation));
    runtime::write_journal(folder / "a", 0x1234567890abcdef, edits);
    std::ifstream in(folder / "a", std::ios::binary);
    return std::string{std::istreambuf_iterator<char>(in), {}};
  };
  const std::string three = written({runtime::ToolUse{Tool::sphere({1, 2, 0}, 1.5), Edit::remove},
                                     runtime::Rewind{1}, runtime::Radial{{0, 0, 0}, 4, {-3, 1, 0}}});
  return {three, written({}), written({runtime::Explosion{{0, 1, 0}, 3, 5}}) + std::string(40, '\0'),
          three.substr(0, three.size() - 20)};
}

namespace {

constexpr std::size_t header_bytes = 32, head_bytes = 16, tail_bytes = 9;

template <class T>
T number_in(std::span<const std::byte> bytes, std::size_t at) {
  T out;
  std::memcpy(&out, bytes.data() + at, sizeof out);
  return out;
}

/// As runtime/impl/bytes.h has it, which is the runtime's alone.
std::uint64_t checksum(std::span<const std::byte> bytes, std::uint64_t seed = 0) {
  constexpr std::uint64_t odd = 0x9e3779b97f4a7c15ull;
  std::uint64_t lane[4] = {seed + odd, seed ^ 0x6a09e667f3bcc909ull, seed + 0x3c6ef372fe94f82bull, ~seed};
  const auto step = [](std::uint64_t& l, std::uint64_t word) {
    l = (l ^ word) * odd;
    l ^= l >> 32;
  };
  std::size_t at = 0;
  for (; at < bytes.size() / 32 * 32; at += 8) step(lane[at / 8 % 4], number_in<std::uint64_t>(bytes, at));
  for (; at < bytes.size(); ++at) step(lane[0], std::to_integer<std::uint64_t>(bytes[at]));
  for (int i = 1; i < 4; ++i) step(lane[0], std::rotl(lane[i], 16 * i));
  step(lane[0], bytes.size());
  return lane[0];
}

/// The layout stands at the head of runtime/journal.h.
void mend_checksums(std::span<std::byte> file) {
  const auto put = [&](std::size_t at, std::uint64_t check) {
    std::memcpy(file.data() + at, &check, sizeof check);
  };
  if (file.size() < header_bytes) return;
  put(24, checksum(file.first(24)));
  const auto base = number_in<std::uint64_t>(file, 16);
  for (std::size_t at = header_bytes; file.size() - at >= head_bytes + tail_bytes;) {
    const std::size_t length = number_in<std::uint32_t>(file, at);
    const std::uint64_t check = checksum(file.subspan(at, 8), base);
    put(at + 8, check);
    if (file.size() - at < head_bytes + length + tail_bytes) return;
    put(at + head_bytes + length, checksum(file.subspan(at + head_bytes, length), check));
    at += head_bytes + length + tail_bytes;
  }
}

void check_journal(std::span<const std::byte> bytes) {
  JournalContents all;
  if (!accepts([&] { all = runtime::parse_journal(bytes, "fuzz.dig"); })) return;
  require(all.bytes + all.torn == bytes.size() && all.bytes >= header_bytes && all.damage.empty());
  std::size_t sum = header_bytes;
  for (const runtime::Message& edit : all.edits) {
    sum += head_bytes + edit.size() + tail_bytes;
    accepts([&] { runtime::decode(edit); });
  }
  require(sum == all.bytes);
  // Cut where a crash might, at some places of a long file.
  const std::size_t step = std::max<std::size_t>(1, (bytes.size() - header_bytes) / 16);
  for (std::size_t size = header_bytes; size < bytes.size(); size += step) {
    const JournalContents part = runtime::parse_journal(bytes.first(size), "fuzz.dig");
    require(part.base == all.base && part.edits.size() <= all.edits.size());
    require(std::equal(part.edits.begin(), part.edits.end(), all.edits.begin()));
    require(part.edits.size() == all.edits.size() || size < all.bytes);
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::vector<std::byte> file(size);
  if (size > 0) std::memcpy(file.data(), data, size);
  accepts([&] { runtime::parse_journal(file, "fuzz.dig"); });
  mend_checksums(file);
  check_journal(file);
  return 0;
}
