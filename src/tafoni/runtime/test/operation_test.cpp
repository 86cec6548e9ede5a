#include "tafoni/runtime/operation.h"

#include <cmath>
#include <cstring>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tafoni/core/error.h"
#include "tafoni/core/test/errors.h"
#include "tafoni/runtime/test/operations.h"

namespace tafoni::runtime {
namespace {

TEST(Operation, MessagesAreCanonical) {
  for (std::uint64_t i = 0; i < 2000; ++i) {
    const Operation operation = random_operation(i, {{500000, 4000000, -50}, {500100, 4000100, 50}}, 5);
    const Message message = encode(operation);
    EXPECT_EQ(encode(decode(message)), message) << i;
  }
}

TEST(Operation, MessagesKeepEveryNumber) {
  const auto explosion = std::get<Explosion>(decode(encode(Explosion{{1.1, -2.2, 3e6 + 0.1}, 2.5, -7.25})));
  EXPECT_EQ(explosion.center, (Vec3d{1.1, -2.2, 3e6 + 0.1}));
  EXPECT_EQ(explosion.radius, 2.5);
  EXPECT_EQ(explosion.energy, -7.25);
  const auto use = std::get<ToolUse>(
      decode(encode(ToolUse{volume::Tool::box({1, 2, 3}, {4, 5, 6}, 0.3), volume::Edit::add})));
  EXPECT_EQ(use.edit, volume::Edit::add);
  EXPECT_EQ(use.tool.data(), volume::Tool::box({1, 2, 3}, {4, 5, 6}, 0.3).data());
  const auto radial = std::get<Radial>(decode(encode(Radial{{1, 2, 3}, 4, {-3, 1, 0}})));
  EXPECT_THAT(radial.change, testing::ElementsAre(-3, 1, 0));
  EXPECT_EQ(std::get<Rewind>(decode(encode(Rewind{1ull << 40}))).version, 1ull << 40);
}

TEST(Operation, BytesFromStrangersAreChecked) {
  Random r(3);
  int refused = 0;
  for (std::uint64_t i = 0; i < 4000; ++i) {
    Message message = encode(random_operation(i, {{-9, -9, -9}, {9, 9, 9}}, 5));
    if (i % 2 == 0)
      message.resize(r.below(message.size()));
    else
      for (std::uint64_t flips = 1 + r.below(8); flips > 0; --flips)
        message[r.below(message.size())] ^= static_cast<std::byte>(1u << r.below(8));
    try {
      (void)encode(decode(message));  // other numbers may make an edit, too
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::input);
      ++refused;
    }
  }
  EXPECT_GT(refused, 2000);
  EXPECT_THAT(error_of([&] { decode({}); }), ::testing::HasSubstr("a message of 0 bytes is no edit"));
  Message long_one = encode(Explosion{{0, 0, 0}, 1, 1});
  long_one.push_back(std::byte{0});
  EXPECT_THAT(error_of([&] { decode(long_one); }), ::testing::HasSubstr("its length is wrong"));
}

/// Corners of a hull: points of a ball, all on the surface.
std::vector<Vec3d> round_hull(std::size_t corners, double radius) {
  std::vector<Vec3d> points;
  for (std::size_t i = 0; i < corners; ++i) {
    const double z = 1 - (2 * static_cast<double>(i) + 1) / static_cast<double>(corners);
    const double turn = 2.399963229728653 * static_cast<double>(i), flat = std::sqrt(1 - z * z);
    points.push_back(Vec3d{flat * std::cos(turn), flat * std::sin(turn), z} * radius);
  }
  return points;
}

TEST(Operation, HullsOfMoreCornersThanAMessageTakesAreRefusedBeforeTheyAreMade) {
  const auto hull = [](std::size_t corners) {
    return ToolUse{volume::Tool::hull(round_hull(corners, 5)), volume::Edit::remove};
  };
  const Message message = encode(hull(256));
  EXPECT_EQ(encode(decode(message)), message);
  EXPECT_THAT(error_of([&] { encode(hull(257)); }),
              ::testing::HasSubstr("a hull of 257 corners is too large"));

  Message large = message;  // of one corner more than it may have
  const std::uint32_t count = 257;
  std::memcpy(large.data() + 4, &count, sizeof(count));
  large.insert(large.end() - 4, sizeof(Vec3d), std::byte{0});
  try {
    (void)decode(large);
    ADD_FAILURE() << "a hull of 257 corners was made";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::input);
    EXPECT_THAT(error.what(), testing::HasSubstr("257 corners"));
  }
}

/// The message of a hull of just these corners, whatever encode() would make of them.
Message hull_message(const std::vector<Vec3d>& corners) {
  const std::vector<Vec3d> simplex{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  Message message = encode(ToolUse{volume::Tool::hull(simplex), volume::Edit::remove});
  const auto count = static_cast<std::uint32_t>(corners.size());
  std::memcpy(message.data() + 4, &count, sizeof(count));
  message.resize(8 + corners.size() * sizeof(Vec3d) + 4);
  std::memcpy(message.data() + 8, corners.data(), corners.size() * sizeof(Vec3d));
  std::memset(message.data() + message.size() - 4, 0, 4);
  return message;
}

TEST(Operation, OnlyWhatEncodeGivesIsTaken) {
  std::vector<Vec3d> corners{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {0, 0, 4}};
  const Message message = hull_message(corners);
  EXPECT_EQ(encode(decode(message)), message);
  for (Vec3d more : {Vec3d{1, 1, 1}, Vec3d{4, 0, 0}, Vec3d{0, 0, 0}}) {
    std::vector<Vec3d> longer = corners;
    longer.push_back(more);
    EXPECT_THAT(error_of([&] { decode(hull_message(longer)); }),
                ::testing::HasSubstr("the same edit has a shorter message"));
  }
  // Points in the faces and edges of a block may or may not be taken for corners, but what is sent is
  // received.
  Random random(2);
  for (int i = 0; i < 300; ++i) {
    std::vector<Vec3d> points;
    const std::uint64_t n = 5 + random.below(50);
    const auto tenth = [&] { return 0.1 * static_cast<double>(random.below(4)); };
    while (points.size() < n) {
      const double x = tenth(), y = tenth();
      points.push_back({x, y, tenth()});
    }
    Message sent;
    try {
      sent = encode(ToolUse{volume::Tool::hull(points), volume::Edit::add});
    } catch (const Error&) {
      continue;  // they lie in a plane
    }
    EXPECT_EQ(encode(decode(sent)), sent) << i;
  }
}

TEST(Operation, WhatMakesNoEditIsRefused) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(error_of([&] {
                encode(Explosion{{0, 0, nan}, 1, 1});
              }),
              ::testing::HasSubstr("a finite centre"));
  EXPECT_THAT(error_of([&] {
                encode(Explosion{{0, 0, 0}, 0, 1});
              }),
              ::testing::HasSubstr("a radius above 0, not 0"));
  EXPECT_THAT(error_of([&] {
                encode(Explosion{{0, 0, 0}, 1, nan});
              }),
              ::testing::HasSubstr("the energy of an explosion is not finite"));
  EXPECT_THAT(error_of([&] { encode(Rewind{0}); }), ::testing::HasSubstr("none rewinds to 0"));
  EXPECT_THAT(error_of([&] {
                encode(Radial{{0, 0, 0}, 1, {1}});
              }),
              ::testing::HasSubstr("takes 2 to 4096 values, not 1"));
  EXPECT_THAT(error_of([&] {
                encode(Radial{{0, 0, 0}, 1, {1, nan}});
              }),
              ::testing::HasSubstr("a value of a radial edit is not finite"));
}

}  // namespace
}  // namespace tafoni::runtime
