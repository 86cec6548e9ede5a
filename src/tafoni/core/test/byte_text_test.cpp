#include "tafoni/core/byte_text.h"

#include <gmock/gmock.h>

#include "tafoni/core/random.h"

namespace tafoni {
namespace {

TEST(ByteText, LeavesUtf8Alone) {
  for (const char* text : {"", "dem.tif", "d\u00e9nivel\u00e9", "\u65e5\u672c \U0001F5FB", "a\\b\\xyz"}) {
    EXPECT_EQ(to_utf8(text), text);
    EXPECT_EQ(from_utf8(text), text);
  }
}

TEST(ByteText, EscapesWhatIsNotUtf8) {
  EXPECT_EQ(to_utf8("d\xe9nivel\xe9.tif"), "d\\xE9nivel\\xE9.tif");
  EXPECT_EQ(to_utf8("\xc3"), "\\xC3");
  EXPECT_EQ(first_not_utf8("d\u00e9\xe9"), 3u);
  EXPECT_EQ(first_not_utf8("d\u00e9"), std::string_view::npos);
  EXPECT_EQ(to_utf8("\xc0\xaf"), "\\xC0\\xAF");           // overlong
  EXPECT_EQ(to_utf8("\xed\xa0\x80"), "\\xED\\xA0\\x80");  // a surrogate
  EXPECT_EQ(to_utf8("\xf5\x80\x80\x80"), "\\xF5\\x80\\x80\\x80");
}

TEST(ByteText, ReadsBackWhatIsWritten) {
  EXPECT_EQ(to_utf8("a\\xE9"), "a\\x5CxE9");
  Random random(7, 1);
  // Letters from which escapes, broken and whole characters come about often.
  const std::string letters = "\\\\xxE9e5C\xc3\xa9\xe2\x82\xac\xf0\x9f\xff";
  for (int i = 0; i < 20'000; ++i) {
    std::string bytes;
    for (int n = 0; n < 12; ++n) bytes += letters[random.below(letters.size())];
    ASSERT_EQ(from_utf8(to_utf8(bytes)), bytes);
    ASSERT_EQ(to_utf8(from_utf8(to_utf8(bytes))), to_utf8(bytes));
  }
}

}  // namespace
}  // namespace tafoni
