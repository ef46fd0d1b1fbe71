#include "drivers/line_watch.h"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "drivers/descriptor.h"
#include "drivers/pty.h"
#include "run_until.h"

namespace rigwire::drivers {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

/// A process that has the terminal open, and a child of its own that has inherited it.
class Reader {
 public:
  explicit Reader(const fs::path& line, bool with_child = false) {
    int ready[2];
    if (::pipe(ready) != 0) {
      return;
    }
    process_ = ::fork();
    if (process_ == 0) {
      const int terminal = ::open(line.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK);
      if (with_child && ::fork() == 0) {
        ::alarm(60);
        (void)!::write(ready[1], "y", 1);
        ::close(ready[1]);
        while (::getppid() != 1) {  // ends with its parent
          ::usleep(10'000);
        }
        ::_exit(0);
      }
      (void)!::write(ready[1], terminal >= 0 ? "x" : "-", 1);
      ::pause();
      ::_exit(0);
    }
    char byte = 0;
    for (int i = with_child ? 2 : 1; i > 0; --i) {
      (void)!::read(ready[0], &byte, 1);
    }
    ::close(ready[0]);
    ::close(ready[1]);
  }
  ~Reader() {
    ::kill(process_, SIGKILL);
    ::waitpid(process_, nullptr, 0);
  }
  Reader(const Reader&) = delete;
  Reader& operator=(const Reader&) = delete;
  [[nodiscard]] pid_t process() const { return process_; }

 private:
  pid_t process_ = -1;
};

class LineWatchTest : public ::testing::Test {
 protected:
  ~LineWatchTest() override { fs::remove_all(folder_); }

  [[nodiscard]] std::vector<LineReader> readers() const {
    const std::vector<std::string> lines{pty_.slave_name()};
    return readers_of(lines).at(0);
  }
  /// What the watch tells when the line has seen who is there.
  std::vector<std::string> look_with_somebody_there() {
    EXPECT_TRUE(run_until(context_, [this] {
      run_for(context_, 2 * Pty::kPresencePeriod);
      return pty_.status().client_present;
    }));
    return line_watch(context_).look();
  }

  fs::path folder_ =
      fs::temp_directory_path() / ("rigwire-watch-test-" + std::to_string(::getpid()));
  boost::asio::io_context context_;
  Pty pty_{context_, folder_ / "gnss"};
};

TEST_F(LineWatchTest, KnowsWhoReadsALine) {
  EXPECT_THAT(readers(), IsEmpty()) << "this process does not count";
  const Reader one(folder_ / "gnss");
  ASSERT_THAT(readers(), SizeIs(1));
  EXPECT_EQ(readers()[0].process, one.process());
  EXPECT_FALSE(readers()[0].program.empty());
  const Reader other(folder_ / "gnss");
  EXPECT_THAT(readers(), SizeIs(2));
}

TEST_F(LineWatchTest, AChildThatInheritedTheLineIsNoSecondReader) {
  const Reader family(folder_ / "gnss", true);
  EXPECT_THAT(readers(), SizeIs(1));
}

TEST_F(LineWatchTest, TerminalsThatNobodyReadsHaveNone) {
  const Reader one(folder_ / "gnss");
  const std::vector<std::string> lines{"/dev/pts/99999", pty_.slave_name()};
  const auto found = readers_of(lines);
  EXPECT_THAT(found.at(0), IsEmpty());
  EXPECT_THAT(found.at(1), SizeIs(1));
}

TEST_F(LineWatchTest, ASecondProgramOnALineIsToldOnceAndCounted) {
  pty_.start([](std::span<const std::uint8_t>) {});
  const Reader one(folder_ / "gnss");
  EXPECT_THAT(look_with_somebody_there(), IsEmpty());
  EXPECT_EQ(pty_.status().readers, 1U);
  {
    const Reader other(folder_ / "gnss");
    EXPECT_THAT(line_watch(context_).look(), ElementsAre(HasSubstr("2 programs have it open: ")));
    EXPECT_EQ(pty_.status().readers, 2U);
    EXPECT_THAT(line_watch(context_).look(), IsEmpty());
  }
  EXPECT_THAT(line_watch(context_).look(), IsEmpty());
  EXPECT_EQ(pty_.status().readers, 1U);
}

TEST_F(LineWatchTest, ALinkThatSomebodyRemovedIsPutBack) {
  fs::remove(folder_ / "gnss");
  EXPECT_THAT(line_watch(context_).look(), ElementsAre(HasSubstr("it is there again")));
  EXPECT_EQ(fs::read_symlink(folder_ / "gnss"), pty_.slave_name());
}

TEST_F(LineWatchTest, LooksByItselfOnceStarted) {
  std::mutex mutex;
  std::vector<std::string> told;
  line_watch(context_).start([&](const std::string& news) {
    const std::lock_guard guard(mutex);
    told.push_back(news);
  });
  fs::remove(folder_ / "gnss");
  EXPECT_TRUE(run_until(context_, [&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
    const std::lock_guard guard(mutex);
    return !told.empty();
  }));
  line_watch(context_).stop();
  EXPECT_TRUE(fs::is_symlink(folder_ / "gnss"));
}

TEST_F(LineWatchTest, ALineThatHasGoneIsLookedAtNoMore) {
  { const Pty other(context_, folder_ / "other"); }
  EXPECT_THAT(line_watch(context_).look(), IsEmpty());
  EXPECT_FALSE(fs::exists(fs::symlink_status(folder_ / "other")));
}

}  // namespace
}  // namespace rigwire::drivers
