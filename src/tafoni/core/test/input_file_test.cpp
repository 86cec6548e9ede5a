#include "tafoni/core/input_file.h"

#include <fstream>

#include <gmock/gmock.h>
#include <sys/stat.h>

#include "tafoni/core/error.h"
#include "tafoni/core/test/test_folder.h"

namespace tafoni {
namespace {

using testing::HasSubstr;

class InputFileTest : public testing::Test {
 protected:
  static std::string error(const std::filesystem::path& path) {
    try {
      const InputFile file(path);
    } catch (const Error& e) {
      EXPECT_EQ(e.kind(), ErrorKind::input);
      return e.what();
    }
    return "";
  }
  const TestFolder folder_;
};

TEST_F(InputFileTest, GivesWhatARegularFileHolds) {
  const auto path = folder_.path / "a";
  std::ofstream(path) << "0123456789";
  const InputFile file(path);
  EXPECT_EQ(file.size(), 10u);
  EXPECT_EQ(file.first(4), "0123");
  EXPECT_EQ(file.first(400), "0123456789");
  EXPECT_EQ(file.whole(), "0123456789");
}

// The test ends at once, or its time limit ends it.
TEST_F(InputFileTest, RefusesWhatMayNeverEndWithoutWaiting) {
  const auto pipe = folder_.path / "pipe";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  std::filesystem::create_symlink(pipe, folder_.path / "link");
  for (const auto& path :
       {pipe, folder_.path / "link", std::filesystem::path("/dev/zero"), std::filesystem::path("/dev/null")})
    EXPECT_THAT(error(path), HasSubstr("is a pipe or a device"));
  EXPECT_THAT(error(folder_.path), HasSubstr("is a folder"));
  EXPECT_THAT(error(folder_.path / "none"), HasSubstr("does not exist"));
  EXPECT_THAT(error(folder_.path / "none" / "deep"), HasSubstr("none/deep"));
}

}  // namespace
}  // namespace tafoni
