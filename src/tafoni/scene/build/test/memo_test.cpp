#include "tafoni/scene/build/impl/memo.h"

#include <gtest/gtest.h>

namespace tafoni::scene::impl {
namespace {

struct Size {
  double width = 1;
  std::vector<double> depths = {};
  std::optional<File> file = {};
  std::map<std::string, std::uint64_t> named = {};
};
auto parts(const Size& size) {
  const auto& [width, depths, file, named] = size;
  return std::tie(width, depths, file, named);
}

struct Calls {
  int number = 0;
};

double area(const Size& size, const double& height, Calls& calls) {
  ++calls.number;
  return size.width * height;
}
double half(const Keyed<double>& whole) {
  return whole.value / 2;
}

TEST(Memo, MakesAgainWhatAnyPartChangesAndNothingElse) {
  Memo<double, Calls, Size, double> memo(100, &area);
  Calls calls;
  const Size all[] = {
      {},
      {2},
      {1, {0}},
      {1, {0, 0}},
      {1, {}, File{"a", Digest()}},
      {1, {}, File{"b", Digest()}},
      {1, {}, File{"a", Digest().add(1.0)}},
      {1, {}, {}, {{"x", 1}}},
      {1, {}, {}, {{"y", 1}}},
      {1, {}, {}, {{"x", 2}}},
  };
  std::vector<Digest> keys;
  for (const Size& size : all)
    for (const double height : {3.0, 4.0}) {
      const Keyed<double> made = memo(size, height, calls);
      EXPECT_EQ(made.value, size.width * height);
      for (const Digest& other : keys) EXPECT_NE(made.key, other);
      keys.push_back(made.key);
      EXPECT_EQ(calls.number, std::ssize(keys));
    }
  for (const Size& size : all) memo(size, 3, calls);
  EXPECT_EQ(calls.number, std::ssize(keys));
  EXPECT_EQ(memo.made(), keys.size());
}

TEST(Memo, ForgetsTheOldest) {
  Memo<double, Calls, Size, double> memo(2, &area);
  Calls calls;
  for (const double height : {1.0, 2.0, 3.0, 3.0, 2.0}) memo({}, height, calls);
  EXPECT_EQ(calls.number, 3);
  memo({}, 1, calls);
  EXPECT_EQ(calls.number, 4);
}

TEST(Memo, WhatIsMadeOfKeyedValuesHasTheirKeysInItsOwn) {
  const Keyed<double> a{4, digest_of(1.0)}, same{4, digest_of(2.0)};
  EXPECT_EQ(make_keyed(&half, a).value, 2);
  EXPECT_EQ(make_keyed(&half, a).key, make_keyed(&half, a).key);
  EXPECT_NE(make_keyed(&half, a).key, make_keyed(&half, same).key);
}

}  // namespace
}  // namespace tafoni::scene::impl
