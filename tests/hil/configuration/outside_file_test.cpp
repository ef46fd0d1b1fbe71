// The one place that opens files of others: what it refuses, and that it waits for nothing.
#include "hil/configuration/outside_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/mman.h>
#include <unistd.h>

#include <array>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "hostile_files.h"
#include "private_wires.h"

namespace rigwire::hil {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::EndsWith;
using testing::HasSubstr;

constexpr FileLimit kShort{"of the test", 16};

class OutsideFiles : public testing::Test {
 protected:
  std::string write(const std::string& name, const std::string& content) const {
    std::ofstream(wires_.folder / name, std::ios::binary) << content;
    return (wires_.folder / name).string();
  }
  static std::string refusal(const std::string& file, FileLimit limit = kOtherFile) {
    try {
      (void)read_outside_file(file, limit);
    } catch (const FileRefused& refused) {
      return refused.what();
    }
    return "read";
  }

  test::PrivateWires wires_;
};

TEST_F(OutsideFiles, a_pipe_a_device_a_socket_or_a_directory_is_refused_without_waiting) {
  for (const test::HostileFile& file : test::make_hostile_files(wires_.folder)) {
    EXPECT_EQ(refusal(file.path), file.path + file.refusal);
  }
}

TEST_F(OutsideFiles, a_regular_file_is_read_whatever_links_lead_to_it) {
  const std::string file = write("file", "some");
  fs::create_symlink("file", wires_.folder / "link");
  fs::create_symlink("link", wires_.folder / "link_to_link");
  EXPECT_EQ(read_outside_file(wires_.folder / "link_to_link", kShort), "some");
  EXPECT_EQ(resolved_path(wires_.folder / "link_to_link"), resolved_path(file));
  EXPECT_EQ(read_outside_file(write("empty", ""), kShort), "");
}

TEST_F(OutsideFiles, a_missing_file_is_told_from_one_that_is_refused) {
  for (const fs::path& file : {wires_.folder / "none", fs::path(write("file", "")) / "none"}) {
    try {
      (void)read_outside_file(file, kShort);
      ADD_FAILURE() << file;
    } catch (const FileRefused& refused) {
      EXPECT_TRUE(refused.missing()) << refused.what();
    }
  }
  try {
    (void)read_outside_file(wires_.folder, kShort);
    ADD_FAILURE();
  } catch (const FileRefused& refused) {
    EXPECT_FALSE(refused.missing());
  }
}

TEST_F(OutsideFiles, a_sparse_file_is_refused_from_its_size) {
  const std::string large = test::make_sparse(wires_.folder / "1", kGibibyte);
  EXPECT_THAT(refusal(large, kConfigurationFile),
              EndsWith(": too large, found 1073741824 bytes, allowed at most 16 MiB"));
  const std::string huge = test::make_sparse(wires_.folder / "200", 200 * kGibibyte);
  EXPECT_THAT(refusal(huge, kReplayFile),
              EndsWith(": too large, found 214748364800 bytes, allowed at most 64 GiB"));
  EXPECT_EQ(refusal(write("most", std::string(16, 'x')), kShort), "read");
  EXPECT_THAT(refusal(write("more", std::string(17, 'x')), kShort),
              EndsWith(": too large, found 17 bytes, allowed at most 16 bytes"));
}

TEST_F(OutsideFiles, a_file_whose_size_is_wrong_is_read_up_to_the_limit) {
  EXPECT_THAT(refusal("/proc/self/status", kShort),
              EndsWith(": too large, found more than 16 bytes, allowed at most 16 bytes"));
  EXPECT_THAT(read_outside_file("/proc/self/status", kOtherFile), HasSubstr("Name:"));
}

TEST_F(OutsideFiles, a_file_that_grows_is_read_up_to_the_limit) {
  const std::string file = write("file", "0123456789");
  OutsideFile opened(file, kShort);
  std::ofstream(file, std::ios::app) << "0123456789";
  EXPECT_THROW((void)opened.read_rest(), FileRefused);
}

TEST_F(OutsideFiles, a_file_that_cannot_be_read_on_is_named) {
  EXPECT_THAT(refusal("/proc/self/mem"), HasSubstr("/proc/self/mem: Input/output error"));
}

TEST_F(OutsideFiles, a_file_in_memory_is_read_by_its_descriptor) {
  const int descriptor = ::memfd_create("content", MFD_CLOEXEC);
  ASSERT_GE(descriptor, 0);
  ASSERT_EQ(::write(descriptor, "text", 4), 4);
  const std::string file = "/proc/self/fd/" + std::to_string(descriptor);
  EXPECT_EQ(read_outside_file(file, kShort), "text");
  EXPECT_EQ(resolved_path(file), file) << "its link leads nowhere";
  ::close(descriptor);
}

TEST_F(OutsideFiles, reading_begins_where_it_is_told) {
  OutsideFile opened(write("file", "0123456789"), kShort);
  std::array<std::uint8_t, 4> bytes{};
  opened.seek(8);
  EXPECT_EQ(opened.read(bytes), 2U);
  EXPECT_THAT(bytes, ElementsAre('8', '9', 0, 0));
  opened.seek(1);
  EXPECT_EQ(opened.read_rest(), "123456789");
  opened.seek(~std::uint64_t{0});
  EXPECT_EQ(opened.read(bytes), 0U);
}

TEST_F(OutsideFiles, lines_are_those_of_the_file) {
  const std::string longer(200'000, 'x');
  LineReader reader(write("lines", "a\n\n" + longer + "\nlast"), kOtherFile);
  std::vector<std::string> lines;
  std::vector<bool> whole;
  for (std::string line; reader.next(line);) {
    lines.push_back(line);
    whole.push_back(reader.whole());
  }
  EXPECT_THAT(lines, ElementsAre("a", "", longer, "last"));
  EXPECT_THAT(whole, ElementsAre(true, true, true, false));
}

TEST_F(OutsideFiles, a_line_without_end_is_refused_with_its_number) {
  const std::string file = write("lines", "a\n");
  ASSERT_EQ(::truncate(file.c_str(), static_cast<off_t>(kGibibyte)), 0);
  LineReader reader(file, kReplayFile);
  std::string line;
  ASSERT_TRUE(reader.next(line));
  try {
    (void)reader.next(line);
    ADD_FAILURE();
  } catch (const FileRefused& refused) {
    EXPECT_EQ(refused.what(), file +
                                  ": line 2 is too long, found more than 4194304 bytes, "
                                  "allowed at most 4 MiB");
  }
}

TEST_F(OutsideFiles, every_limit_stands_in_the_documents) {
  std::ifstream stream(RIGWIRE_SOURCE_DIR "/docs/configuration.md");
  const std::string document(std::istreambuf_iterator<char>(stream), {});
  for (const FileLimit& limit : kFileLimits) {
    const std::string row = "| " + std::string(limit.what) + " | " + size_text(limit.bytes) + " |";
    EXPECT_NE(document.find(row), std::string::npos) << row;
  }
  const std::string line = "a line has " + size_text(kMaxLineBytes) + " at most";
  EXPECT_NE(document.find(line), std::string::npos) << line;
}

}  // namespace
}  // namespace rigwire::hil
