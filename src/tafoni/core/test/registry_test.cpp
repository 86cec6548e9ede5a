#include "tafoni/core/registry.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tafoni/core/error.h"

namespace tafoni {
namespace {

struct Dish {
  Declaration about;
};

const Dish soup{.about = {.name = "soup", .doc = "Water with something in it"}};
const Dish stew{.about = {.name = "stew", .doc = "Something with water in it"}};
const Dish* const table[] = {&soup, &stew};

std::string message(std::string_view name) {
  try {
    find<Dish>(table, name, "dish");
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::usage);
    return error.what();
  }
  return {};
}

TEST(Registry, FindsByName) {
  EXPECT_EQ(&find<Dish>(table, "stew", "dish"), &stew);
}

TEST(Registry, AnUnknownNameIsToldTheNearestOrAll) {
  EXPECT_EQ(message("sop"), "there is no dish \"sop\"; did you mean \"soup\"?");
  EXPECT_EQ(message("cake"), "there is no dish \"cake\"; known are soup, stew");
}

TEST(Registry, AVeryLongNameIsCutShort) {
  EXPECT_LT(message(std::string(100'000, 'x')).size(), 200u);
}

}  // namespace
}  // namespace tafoni
