#include "drivers/temporary_folder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <stdlib.h>

#include <filesystem>
#include <string>

#include "drivers/endpoints.h"

namespace rigwire::drivers {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::HasSubstr;

class TemporaryFolder : public ::testing::Test {
 protected:
  TemporaryFolder() {
    const char* const now = ::getenv("TMPDIR");
    before_ = now == nullptr ? "" : now;
  }
  ~TemporaryFolder() override {
    before_.empty() ? ::unsetenv("TMPDIR") : ::setenv("TMPDIR", before_.c_str(), 1);
  }

 private:
  std::string before_;
};

TEST_F(TemporaryFolder, IsNewAndItsOwnersAlone) {
  const fs::path one = make_temporary_folder("a folder for a test", "test");
  const fs::path two = make_temporary_folder("a folder for a test", "test");
  EXPECT_NE(one, two);
  EXPECT_EQ(fs::status(one).permissions() & (fs::perms::group_all | fs::perms::others_all),
            fs::perms::none);
  fs::remove(one);
  fs::remove(two);
}

TEST_F(TemporaryFolder, WithoutAPlaceItSaysWhatWasMadeAndWhatToDo) {
  ::setenv("TMPDIR", "/nowhere/at/all", 1);
  try {
    static_cast<void>(make_temporary_folder("a folder for a test", "test"));
    ADD_FAILURE() << "made below a folder that there is not";
  } catch (const EndpointError& error) {
    EXPECT_THAT(error.what(), AllOf(HasSubstr("a folder for a test"), HasSubstr("/nowhere/at/all"),
                                    HasSubstr("set TMPDIR")));
  }
}

}  // namespace
}  // namespace rigwire::drivers
