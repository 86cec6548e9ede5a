// Every bit of a volume comes back; a damaged file gives one sentence.

#include <cstring>
#include <functional>
#include <limits>

#include <gmock/gmock.h>
#include <zstd.h>

#include "tafoni/core/error.h"
#include "tafoni/core/test/errors.h"
#include "tafoni/io/test/volumes.h"

namespace tafoni::io {
namespace {

using testing::HasSubstr;
using volume::Precision;

using Tvol = VolumeFiles;

std::string sentence(std::string_view bytes) {
  try {
    read_volume(std::as_bytes(std::span(bytes.data(), bytes.size())), "test.tvol");
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::input);
    return error.what();
  }
  return {};
}

TEST_F(Tvol, EveryBitComesBack) {
  for (const Precision precision : {Precision::single, Precision::half}) {
    Volume volume = hollow_ball(precision);
    // What no field gives, but a grid can hold.
    volume.grid.edit({{40, 40, 20}, {60, 60, 40}}, [](Vec3i first, std::span<float> row) {
      constexpr float odd[] = {0.0f, -0.0f, 1e-42f, -6e-8f, 65504, -1e-3f, 6e4f};
      for (std::size_t i = 0; i < row.size(); ++i)
        row[i] = odd[(i + std::int64_t{first.y} * 3 + first.z) % 7];
    });
    write_volume(path("a.tvol"), volume);
    const Volume back = read_volume(path("a.tvol"));
    expect_same(volume, back);
    EXPECT_EQ(back.grid.precision(), precision);
    EXPECT_EQ(back.grid.full_chunks(), volume.grid.full_chunks());
    // Writing again gives the same bytes.
    write_volume(path("b.tvol"), back);
    EXPECT_EQ(bytes("a.tvol"), bytes("b.tvol"));
  }
}

TEST_F(Tvol, IsSmallerThanWhatItHolds) {
  const Volume volume = hollow_ball(Precision::single, {200, 200, 160});
  write_volume(path("a.tvol"), volume);
  EXPECT_LT(bytes("a.tvol").size(), volume.grid.bytes() / 3);
}

TEST_F(Tvol, HugeAndUniformTakesNothing) {
  const Volume volume{volume::ScalarGrid({{0, 0, 0}, 1, {1 << 13, 1 << 13, 1 << 10}}, -1), {}, {}};
  write_volume(path("a.tvol"), volume);
  EXPECT_LT(bytes("a.tvol").size(), 10000u);
  const Volume back = read_volume(path("a.tvol"));
  EXPECT_EQ(back.grid.frame(), volume.grid.frame());
  EXPECT_EQ(back.grid.full_chunks(), 0u);
  EXPECT_EQ(back.grid.at({5, 5, 5}), -1);
}

TEST_F(Tvol, DamageIsNoticed) {
  const Volume volume = hollow_ball(Precision::half, {70, 40, 66});
  write_volume(path("a.tvol"), volume);
  const std::string good = bytes("a.tvol");
  Random random(1);
  int changed = 0;
  constexpr int trials = 1500;
  for (int i = 0; i < trials; ++i) {
    std::string bad = good;
    const int flips = 1 + i % 3;
    for (int k = 0; k < flips; ++k) {
      // Half of them in the header, which says what is allocated.
      const double end = i % 2 ? 200.0 : static_cast<double>(bad.size());
      const auto at = static_cast<std::size_t>(random.uniform(0, end));
      bad[at] = static_cast<char>(bad[at] ^ (1 << (i + k) % 8));
    }
    if (bad == good) continue;  // a bit flipped there and back
    ++changed;
    EXPECT_THAT(sentence(bad), HasSubstr("test.tvol: ")) << i;
  }
  EXPECT_GT(changed, trials * 9 / 10);
}

TEST_F(Tvol, EveryFlippedBitIsNoticed) {
  // Header, text, table, a chunk of one value and two of many.
  Volume volume{volume::ScalarGrid({{1, 2, 3}, 0.5, {70, 5, 4}}, -1, Precision::half), {10, 20, 30}, {}};
  volume.metadata.name = "small";
  volume.grid.edit({{40, 0, 0}, {69, 4, 3}}, [](Vec3i first, std::span<float> row) {
    for (std::size_t i = 0; i < row.size(); ++i)
      row[i] = static_cast<float>((static_cast<int>(i) + first.x * 7 + first.y * 5 + first.z) % 11) - 5;
  });
  write_volume(path("a.tvol"), volume);
  const std::string good = bytes("a.tvol");
  EXPECT_TRUE(parse("tvol", good).grid == volume.grid);
  for (std::size_t bit = 0; bit < 8 * good.size(); ++bit) {
    std::string bad = good;
    bad[bit / 8] = static_cast<char>(bad[bit / 8] ^ (1 << (bit % 8)));
    EXPECT_THAT(sentence(bad), HasSubstr("test.tvol: ")) << "bit " << bit % 8 << " of byte " << bit / 8;
  }
}

TEST_F(Tvol, TruncationIsNoticed) {
  write_volume(path("a.tvol"), hollow_ball(Precision::single, {40, 40, 40}));
  const std::string good = bytes("a.tvol");
  for (std::size_t n = 0; n < good.size(); n += n < 400 ? 1 : 97)
    EXPECT_NE(sentence(std::string_view(good).substr(0, n)), "") << n;
  EXPECT_NE(sentence(good + "x"), "");
}

/// A file with another text, and what `change` makes of its header, whose checksum is right.
std::string with_text(const std::string& file, const std::string& text,
                      const std::function<void(std::string& header)>& change = {}) {
  const auto number = [&](std::size_t at) {
    std::uint64_t v = 0;
    std::memcpy(&v, file.data() + at, 8);
    return static_cast<std::size_t>(v);
  };
  std::string out = file.substr(0, 104);
  const std::uint64_t size = text.size();
  std::memcpy(out.data() + 88, &size, 8);
  if (change) change(out);
  const std::string rest = text + file.substr(112 + number(88));
  std::uint64_t hash = 0xcbf29ce484222325ull;
  for (const char c : out + rest.substr(0, text.size() + number(96)))
    hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3ull;
  out.append(reinterpret_cast<const char*>(&hash), 8);
  return out + rest;
}

TEST_F(Tvol, TextNestedAsDeeplyAsAnyoneLikesIsRead) {
  const Volume volume = hollow_ball(Precision::single, {40, 40, 40});
  write_volume(path("a.tvol"), volume);
  constexpr std::size_t depth = 1000000;
  const std::string deep = std::string(depth, '[') + std::string(depth, ']');
  const std::string bad = with_text(bytes("a.tvol"), R"({"name": "a", "generator": )" + deep + "}");
  EXPECT_TRUE(parse("tvol", bad).grid == volume.grid);
}

TEST_F(Tvol, SmallFilesTakeNoMemoryForHugeSizes) {
  write_volume(path("a.tvol"), hollow_ball(Precision::single, {40, 40, 40}));
  const std::string good = bytes("a.tvol");
  const auto with_size = [&](Vec3i size) {
    return sentence(with_text(
        good, "{}", [&](std::string& header) { std::memcpy(header.data() + 72, &size, sizeof size); }));
  };
  for (const Vec3i size : {Vec3i{2, 700000, 700000}, {40, 40, 80}})
    EXPECT_THAT(with_size(size), HasSubstr("is not that of its size"));
  EXPECT_THAT(with_size({-40, -40, 40}), HasSubstr("no cells"));
}

/// A file of chunks that are all of one value, or all hold the same few bytes.
std::string file_of(Vec3i size, std::string_view chunk) {
  std::int64_t chunks = 1;
  for (const int n : {size.x, size.y, size.z}) chunks *= (n + 31) / 32;
  std::uint32_t hash = 0x811c9dc5u;
  for (const char c : chunk) hash = (hash ^ static_cast<unsigned char>(c)) * 0x01000193u;
  std::string table;
  for (std::int64_t i = 0; i < chunks; ++i) {
    const std::uint32_t entry[] = {static_cast<std::uint32_t>(chunk.size()),
                                   chunk.empty() ? 0x3f800000u : hash};
    table.append(reinterpret_cast<const char*>(entry), sizeof entry);
  }
  std::string packed(ZSTD_compressBound(table.size()), '\0');
  packed.resize(ZSTD_compress(packed.data(), packed.size(), table.data(), table.size(), 3));
  std::string out = "TAFONVOL";
  const auto put = [&](const auto& v) { out.append(reinterpret_cast<const char*>(&v), sizeof v); };
  put(std::uint32_t{2}), put(std::uint32_t{4});
  for (const double v : {0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0}) put(v);
  put(size), put(std::uint32_t{32}), put(std::uint64_t{0}), put(std::uint64_t{packed.size()});
  out = with_text(out + std::string(8, '\0') + packed, "{}");
  for (std::int64_t i = 0; i < chunks; ++i) out += chunk;
  return out;
}

TEST_F(Tvol, MemoryIsBoundedByWhatTheFileCanMean) {
  // Four million chunks of one value each, from a table that packs to some kilobytes.
  EXPECT_THAT(sentence(file_of({2, 64000, 64000}, "")), HasSubstr("made to fill the memory"));
  EXPECT_EQ(sentence(file_of({3200, 3200, 320}, "")), "");
}

TEST_F(Tvol, WhatRepeatsIsHeldOnce) {
  Volume slope{volume::ScalarGrid({{0, 0, 0}, 1, {2048, 2048, 32}}, 0), {}, {}};
  slope.grid.edit(slope.grid.samples(), [](Vec3i first, std::span<float> row) {
    for (float& v : row) v = 10.0f - static_cast<float>(first.z);
  });
  write_volume(path("a.tvol"), slope);
  EXPECT_LT(bytes("a.tvol").size(), 1000000u);
  const VolumeInfo info = inspect_volume(path("a.tvol"));
  EXPECT_EQ(info.full_chunks, 64 * 64);
  EXPECT_EQ(info.distinct_chunks, 1);
  EXPECT_LT(info.bytes, 1u << 20);
  EXPECT_EQ(info.values.lo, -21);
  EXPECT_EQ(info.values.hi, 10);
  Volume back = read_volume(path("a.tvol"));
  EXPECT_TRUE(back.grid == slope.grid);
  // An edit changes the one chunk only.
  back.grid.fill({{0, 0, 0}, {3, 3, 3}}, 5);
  EXPECT_EQ(back.grid.at({40, 0, 0}), 10);
}

TEST_F(Tvol, InfoTellsWhatTheVolumeHolds) {
  const Volume volume = hollow_ball(Precision::half);
  write_volume(path("a.tvol"), volume);
  const VolumeInfo info = inspect_volume(path("a.tvol"));
  EXPECT_EQ(info.frame, volume.grid.frame());
  EXPECT_EQ(info.origin, volume.origin);
  EXPECT_EQ(info.precision, Precision::half);
  EXPECT_EQ(info.metadata.crs, "EPSG:25832");
  EXPECT_EQ(info.full_chunks, static_cast<std::int64_t>(volume.grid.full_chunks()));
  const Interval range = volume.grid.range(volume.grid.frame().box());
  EXPECT_EQ(info.values.lo, range.lo);
  EXPECT_EQ(info.values.hi, range.hi);
  EXPECT_LE(info.bytes, volume.grid.bytes());
}

TEST_F(Tvol, PlacesAndSpacingsThatAreNoNumbersAreRefused) {
  write_volume(path("a.tvol"), hollow_ball(Precision::single, {40, 40, 40}));
  const std::string good = bytes("a.tvol");
  constexpr double infinite = std::numeric_limits<double>::infinity();
  for (const std::size_t at : {16u, 24u, 32u, 40u, 48u, 56u, 64u})
    for (const double v : {std::numeric_limits<double>::quiet_NaN(), infinite, -infinite})
      EXPECT_THAT(
          sentence(with_text(good, "{}",
                             [&](std::string& header) { std::memcpy(header.data() + at, &v, sizeof v); })),
          HasSubstr("finite"))
          << at << " " << v;
}

TEST_F(Tvol, RefusesOtherVersionsFormatsAndValues) {
  Volume volume = hollow_ball(Precision::single, {40, 40, 40});
  write_volume(path("a.tvol"), volume);
  std::string bytes_of_file = bytes("a.tvol");
  bytes_of_file[8] = 9;
  EXPECT_THAT(sentence(bytes_of_file), HasSubstr("version 9"));
  EXPECT_THAT(sentence("solid ball\nendsolid\n"), HasSubstr("another format"));
  volume.grid.edit({{3, 3, 3}, {3, 3, 3}},
                   [](Vec3i, std::span<float> row) { row[0] = std::numeric_limits<float>::quiet_NaN(); });
  write_volume(path("b.tvol"), volume);
  EXPECT_THAT(sentence(bytes("b.tvol")), HasSubstr("not finite"));
  EXPECT_THAT(error_of([&] { read_volume(path("none.tvol")); }), HasSubstr("none.tvol: does not exist"));
  EXPECT_THAT(error_of([&] { read_volume(path("a.ply")); }), HasSubstr("cannot be read as a volume"));
}

}  // namespace
}  // namespace tafoni::io
