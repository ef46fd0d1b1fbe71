#include "hil/record/output_file.h"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <fstream>
#include <iterator>
#include <vector>

#include "drivers/endpoints.h"
#include "file_text.h"

namespace rigwire::hil {
namespace {

namespace fs = std::filesystem;
using drivers::Descriptor;
using test::text_of;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

class OutputFile : public testing::Test {
 protected:
  OutputFile() {
    std::string pattern = "/tmp/rigwire-test-XXXXXX";
    if (::mkdtemp(pattern.data()) == nullptr) {
      throw std::runtime_error("no folder");
    }
    folder_ = pattern;
    std::signal(SIGPIPE, SIG_IGN);
    std::signal(SIGXFSZ, SIG_IGN);
  }
  ~OutputFile() override {
    std::signal(SIGPIPE, SIG_DFL);
    std::signal(SIGXFSZ, SIG_DFL);
    fs::remove_all(folder_);
  }
  [[nodiscard]] fs::path at(const std::string& name) const { return folder_ / name; }
  [[nodiscard]] std::vector<std::string> files() const {
    std::vector<std::string> names;
    for (const auto& entry : fs::directory_iterator(folder_)) {
      names.push_back(entry.path().filename());
    }
    return names;
  }
  static void write(const fs::path& path, std::string_view text) {
    WholeFile("the report", path.string()).write(text);
  }

 private:
  fs::path folder_;
};

/// A disk that is full for as long as the object lives: no file grows.
class FullDisk {
 public:
  FullDisk() {
    ::getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit none{0, before_.rlim_max};
    ::setrlimit(RLIMIT_FSIZE, &none);
  }
  ~FullDisk() { ::setrlimit(RLIMIT_FSIZE, &before_); }
  FullDisk(const FullDisk&) = delete;
  FullDisk& operator=(const FullDisk&) = delete;

 private:
  rlimit before_{};
};

TEST_F(OutputFile, an_older_report_is_replaced_whole_and_keeps_its_permissions) {
  std::ofstream(at("report")) << std::string(100'000, 'x');
  ASSERT_EQ(::chmod(at("report").c_str(), 0640), 0);
  write(at("report"), "new");
  EXPECT_EQ(text_of(at("report")), "new");
  EXPECT_EQ(fs::status(at("report")).permissions(), fs::perms(0640));
  EXPECT_THAT(files(), ElementsAre("report"));
}

TEST_F(OutputFile, a_link_stays_and_what_it_leads_to_is_replaced) {
  std::ofstream(at("target")) << "old";
  fs::create_symlink("target", at("link"));
  fs::create_symlink(at("not_yet_there"), at("dangling"));
  write(at("link"), "new");
  write(at("dangling"), "new");
  EXPECT_TRUE(fs::is_symlink(at("link")));
  EXPECT_TRUE(fs::is_symlink(at("dangling")));
  EXPECT_EQ(text_of(at("target")), "new");
  EXPECT_EQ(text_of(at("not_yet_there")), "new");
}

TEST_F(OutputFile, a_device_is_written_through_and_stays_a_device) {
  fs::create_symlink("/dev/null", at("link"));
  write(at("link"), "nobody reads this");
  EXPECT_TRUE(fs::is_symlink(at("link")));
  EXPECT_TRUE(fs::is_character_file("/dev/null"));
}

TEST_F(OutputFile, a_fifo_is_written_through_to_its_reader) {
  ASSERT_EQ(::mkfifo(at("fifo").c_str(), 0600), 0);
  const Descriptor reader(::open(at("fifo").c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC));
  write(at("fifo"), "report");
  std::array<char, 16> buffer{};
  EXPECT_EQ(::read(reader.get(), buffer.data(), buffer.size()), 6);
  EXPECT_TRUE(fs::is_fifo(at("fifo")));
}

TEST_F(OutputFile, a_reader_that_stalls_is_given_up_and_said) {
  ASSERT_EQ(::mkfifo(at("fifo").c_str(), 0600), 0);
  const Descriptor reader(::open(at("fifo").c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC));
  try {
    write(at("fifo"), std::string(1 << 20, 'x'));
    FAIL() << "was written";
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), HasSubstr("its reader does not read"));
  }
}

TEST_F(OutputFile, what_cannot_be_written_is_said_before_the_run_and_leaves_no_file) {
  for (const auto& [path, why] : std::vector<std::pair<fs::path, std::string>>{
           {at("missing/report"), "No such file or directory"},
           {at(""), "a directory is there"},
           {"/proc/report", ""}}) {
    try {
      const WholeFile file("the report", path.string());
      FAIL() << path << " was taken";
    } catch (const drivers::EndpointError& error) {
      EXPECT_THAT(error.what(), HasSubstr("the report " + path.string()));
      EXPECT_THAT(error.what(), HasSubstr(why));
    }
  }
  EXPECT_THAT(files(), IsEmpty());
}

TEST_F(OutputFile, the_trial_changes_nothing) {
  std::ofstream(at("old")) << "old";
  const WholeFile old("the report", at("old").string());
  const WholeFile fresh("the report", at("fresh").string());
  EXPECT_EQ(text_of(at("old")), "old");
  EXPECT_THAT(files(), ElementsAre("old"));
}

TEST_F(OutputFile, a_full_disk_is_said_and_leaves_the_old_report_and_no_temporary_file) {
  std::ofstream(at("report")) << "old";
  const WholeFile file("the report", at("report").string());
  try {
    const FullDisk full;
    file.write("new");
    FAIL() << "was written";
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), HasSubstr(at("report").string()));
  }
  EXPECT_EQ(text_of(at("report")), "old");
  EXPECT_THAT(files(), ElementsAre("report"));
}

TEST_F(OutputFile, a_truth_that_cannot_be_written_is_said_once_and_names_its_file) {
  std::vector<std::string> said;
  OutputFailures failures([&](const std::string& what) { said.push_back(what); });
  {
    GrowingFile file("the truth", "/dev/full", &failures, kReaderPatience);
    for (int i = 0; i < 10; ++i) {
      file.write(std::string(GrowingFile::kPieceBytes, 'x'));
    }
  }
  EXPECT_THAT(said, ElementsAre("the truth /dev/full is not complete: No space left on device"));
  EXPECT_TRUE(failures.any());
}

TEST_F(OutputFile, the_last_bytes_of_a_truth_that_find_the_disk_full_are_said_too) {
  std::vector<std::string> said;
  OutputFailures failures([&](const std::string& what) { said.push_back(what); });
  {
    GrowingFile file("the truth", "/dev/full", &failures, kReaderPatience);
    file.write("x");
    EXPECT_THAT(said, IsEmpty());
  }
  EXPECT_EQ(said.size(), 1U);
}

TEST_F(OutputFile, a_reader_of_the_truth_that_stalls_loses_it_and_holds_nobody_up) {
  ASSERT_EQ(::mkfifo(at("fifo").c_str(), 0600), 0);
  const Descriptor reader(::open(at("fifo").c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC));
  std::vector<std::string> said;
  OutputFailures failures([&](const std::string& what) { said.push_back(what); });
  GrowingFile file("the truth", at("fifo").string(), &failures, std::chrono::milliseconds{0});
  const std::string piece(1 << 20, 'x');
  for (std::size_t i = 0; i <= GrowingFile::kBacklogBytes; i += piece.size()) {
    file.write(piece);
  }
  EXPECT_THAT(said, testing::SizeIs(testing::Le(1)));
  file.write(piece);
  EXPECT_THAT(said, ElementsAre(HasSubstr("its reader does not read")));
}

TEST_F(OutputFile, a_fifo_that_nobody_reads_is_refused_for_the_truth) {
  ASSERT_EQ(::mkfifo(at("fifo").c_str(), 0600), 0);
  EXPECT_THROW(GrowingFile("the truth", at("fifo").string(), nullptr, kReaderPatience),
               drivers::EndpointError);
}

}  // namespace
}  // namespace rigwire::hil
