#include "hil/files/settings_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>

namespace rigwire::hil {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

class SettingsFileTest : public testing::Test {
 protected:
  void TearDown() override { std::filesystem::remove_all(folder_); }
  std::filesystem::path folder_ = [] {
    auto path =
        std::filesystem::temp_directory_path() / ("rigwire_settings_" + std::to_string(getpid()));
    std::filesystem::create_directories(path);
    return path;
  }();
};

TEST_F(SettingsFileTest, WhatIsStoredIsThereInTheNextRun) {
  const std::string path = folder_ / "imu";
  const std::array<std::uint8_t, 3> first{1, 2, 3};
  const std::array<std::uint8_t, 2> second{4, 0};
  {
    SettingsFile file(path);
    EXPECT_THAT(file.content(), IsEmpty());
    EXPECT_TRUE(file.store(first));
    EXPECT_TRUE(file.store(second));
    EXPECT_THAT(file.content(), ElementsAre(4, 0));
  }
  EXPECT_THAT(SettingsFile(path).content(), ElementsAre(4, 0));
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder_), {}), 1);  // no draft left
}

TEST_F(SettingsFileTest, WhatCannotBeWrittenLeavesTheOldContent) {
  SettingsFile file(folder_ / "missing" / "imu");
  const std::array<std::uint8_t, 1> block{7};
  EXPECT_FALSE(file.store(block));
  EXPECT_THAT(file.content(), IsEmpty());
}

TEST_F(SettingsFileTest, FolderOrTooMuchIsRefused) {
  EXPECT_THROW(SettingsFile{folder_}, std::runtime_error);
  std::ofstream(folder_ / "large") << std::string(70000, 'x');
  EXPECT_THROW(SettingsFile{folder_ / "large"}, std::runtime_error);
}

TEST_F(SettingsFileTest, WithoutANameItLastsAsLongAsTheRun) {
  const auto memory = open_settings("");
  const std::array<std::uint8_t, 1> block{7};
  EXPECT_TRUE(memory->store(block));
  EXPECT_THAT(memory->content(), ElementsAre(7));
}

}  // namespace
}  // namespace rigwire::hil
