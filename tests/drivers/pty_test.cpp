#include "drivers/pty.h"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/ioctl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <termios.h>
#include <unistd.h>

#include <exception>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <vector>

#include "drivers/serial_port.h"
#include "run_until.h"

namespace rigwire::drivers {
namespace {

namespace fs = std::filesystem;
using Bytes = std::vector<std::uint8_t>;
using ::testing::HasSubstr;

class PtyTest : public ::testing::Test {
 protected:
  void SetUp() override {
    directory = fs::temp_directory_path() / ("rigwire-pty-test-" + std::to_string(::getpid()));
    fs::remove_all(directory);
    link = directory / "nested" / "gnss";
  }
  void TearDown() override { fs::remove_all(directory); }

  std::string refusal() {
    try {
      const Pty pty(context, link);
    } catch (const EndpointError&) {
      return told(std::current_exception());
    }
    return "no EndpointError";
  }
  static std::string told(const std::exception_ptr& refused) {
    if (refused == nullptr) {
      return "no EndpointError";
    }
    try {
      std::rethrow_exception(refused);
    } catch (const EndpointError& error) {
      return error.what();
    }
  }

  boost::asio::io_context context;
  fs::path directory;
  fs::path link;
};

TEST_F(PtyTest, a_line_for_which_no_file_may_be_opened_names_the_limit_of_open_files) {
  {
    const Pty first(context, directory / "first");  // what the event loop needs is open from now on
  }
  rlimit before{};
  ASSERT_EQ(::getrlimit(RLIMIT_NOFILE, &before), 0);
  // One descriptor more than there are, for the lock that owns the name, then none.
  const int next = ::dup(STDERR_FILENO);
  ASSERT_GE(next, 0);
  ::close(next);
  for (const int more : {0, 1}) {
    const rlimit few{static_cast<rlim_t>(next + more), before.rlim_max};
    ASSERT_EQ(::setrlimit(RLIMIT_NOFILE, &few), 0);
    // Looked at later: what a sanitizer does with an exception may need a file.
    std::exception_ptr refused;
    try {
      const Pty pty(context, link);
    } catch (...) {
      refused = std::current_exception();
    }
    ASSERT_EQ(::setrlimit(RLIMIT_NOFILE, &before), 0);
    const std::string said = told(refused);
    EXPECT_THAT(said, HasSubstr("raise the limit of open files (ulimit -n)")) << said;
    EXPECT_THAT(said, testing::Not(HasSubstr("devpts")));
  }
}

TEST_F(PtyTest, a_relative_path_in_a_working_folder_that_is_deleted_is_told_in_words) {
  const fs::path before = fs::current_path();
  fs::create_directories(directory);
  fs::current_path(directory);
  fs::remove(directory);
  link = "gnss";
  const std::string said = refusal();
  fs::current_path(before);
  EXPECT_THAT(said, HasSubstr("the working folder is unknown"));
}

TEST_F(PtyTest, PublishesALinkInANewDirectoryAndRemovesIt) {
  {
    const Pty pty(context, link);
    EXPECT_TRUE(fs::is_symlink(fs::symlink_status(link)));
    EXPECT_EQ(fs::read_symlink(link), pty.slave_name());
    EXPECT_EQ(pty.status().address, link.string());
  }
  EXPECT_FALSE(fs::exists(fs::symlink_status(link)));
  EXPECT_TRUE(fs::is_empty(link.parent_path())) << "a temporary link stayed behind";
}

TEST_F(PtyTest, SlaveIsRawBeforeAnyClientConfiguresIt) {
  Pty pty(context, link);
  const int slave = ::open(link.c_str(), O_RDWR | O_NOCTTY);
  ASSERT_GE(slave, 0);
  termios settings{};
  ASSERT_EQ(::tcgetattr(slave, &settings), 0);
  EXPECT_EQ(settings.c_lflag & static_cast<tcflag_t>(ECHO | ICANON | ISIG), 0U);
  EXPECT_EQ(settings.c_oflag & static_cast<tcflag_t>(OPOST), 0U);
  ::close(slave);
}

TEST_F(PtyTest, BecomesRawAgainWhenAClientThatSetEchoHasLeft) {
  Pty pty(context, link);
  pty.start([](std::span<const std::uint8_t>) {});
  const int cooked = ::open(link.c_str(), O_RDWR | O_NOCTTY);
  ASSERT_GE(cooked, 0);
  ASSERT_TRUE(
      run_until(context, [&] { return pty.write({}) == 0 && pty.status().client_present; }));
  termios settings{};
  ASSERT_EQ(::tcgetattr(cooked, &settings), 0);
  settings.c_lflag |= static_cast<tcflag_t>(ECHO | ICANON);
  ASSERT_EQ(::tcsetattr(cooked, TCSANOW, &settings), 0);
  ::close(cooked);
  run_for(context, std::chrono::milliseconds(50));
  const int next = ::open(link.c_str(), O_RDWR | O_NOCTTY);
  ASSERT_EQ(::tcgetattr(next, &settings), 0);
  EXPECT_EQ(settings.c_lflag & static_cast<tcflag_t>(ECHO | ICANON), 0U);
  ::close(next);
}

TEST_F(PtyTest, TellsTheSpeedThatTheClientSet) {
  Pty pty(context, link);
  EXPECT_EQ(pty.client_baud(), 38400U);
  {
    const SerialPort client(context, {.path = link.string(), .baud = 115200});
    EXPECT_EQ(pty.client_baud(), 115200U);
  }
  // 250000 is none of POSIX's speeds.
  const SerialPort odd(context, {.path = link.string(), .baud = 250000});
  EXPECT_EQ(pty.client_baud(), 250000U);
}

TEST_F(PtyTest, StartsAtTheDevicesSpeed) {
  const Pty pty(context, link, 230400);
  EXPECT_EQ(pty.client_baud(), 230400U);
}

TEST_F(PtyTest, SpeedSurvivesTheCleaningAfterTheLastClient) {
  Pty pty(context, link, 9600);
  pty.start([](std::span<const std::uint8_t>) {});
  {
    const SerialPort client(context, {.path = link.string(), .baud = 57600});
    ASSERT_TRUE(run_until(context, [&] { return pty.status().client_present; }));
    run_for(context, std::chrono::milliseconds(30));
  }
  run_for(context, std::chrono::milliseconds(30));
  EXPECT_EQ(pty.client_baud(), 57600U);
}

// gpsd, minicom and pySerial mark the terminal exclusive; the kernel keeps the mark of a
// pseudo-terminal after the last close, and only an administrator could open it again.
TEST_F(PtyTest, OrdinaryUserOpensItAgainAfterAClientThatWantedItForItself) {
  fs::create_directories(directory);
  ASSERT_EQ(::chmod(directory.c_str(), 01777), 0);
  const pid_t child = ::fork();
  if (child == 0) {
    constexpr uid_t kNobody = 65534;
    if (::geteuid() == 0 && (::setgid(kNobody) != 0 || ::setuid(kNobody) != 0)) {
      ::_exit(10);
    }
    boost::asio::io_context own;
    Pty pty(own, link, 19200);
    pty.start([](std::span<const std::uint8_t>) {});
    LineClient client;
    pty.on_client([&](const LineClient& now) { client = now; });
    for (int round = 0; round < 3; ++round) {
      const int slave = ::open(link.c_str(), O_RDWR | O_NOCTTY);
      if (slave < 0) {
        ::_exit(11);
      }
      ::ioctl(slave, TIOCEXCL);
      if (::open(link.c_str(), O_RDWR | O_NOCTTY) >= 0) {
        ::_exit(12);  // it is exclusive while it is open
      }
      if (!run_until(own, [&] { return client == LineClient{true, 19200}; })) {
        ::_exit(13);
      }
      ::close(slave);
      if (!run_until(own, [&] { return !client.present; })) {
        ::_exit(14);
      }
    }
    ::_exit(fs::read_symlink(link) == pty.slave_name() ? 0 : 15);
  }
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 0);
}

TEST_F(PtyTest, EchoThatAClientAsksForIsItsOwnAndEndsWithIt) {
  Pty pty(context, link);
  Bytes heard;
  pty.start([&](std::span<const std::uint8_t> bytes) {
    heard.insert(heard.end(), bytes.begin(), bytes.end());
  });
  const Bytes sentence{'$', 'G', 'P', '\r', '\n'};
  for (int round = 0; round < 3; ++round) {
    const int slave = ::open(link.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK);
    ASSERT_TRUE(run_until(context, [&] { return pty.status().client_present; }));
    pty.write(sentence);
    run_for(context, std::chrono::milliseconds(30));
    EXPECT_TRUE(heard.empty());
    termios settings{};
    ::tcgetattr(slave, &settings);
    settings.c_lflag |= static_cast<tcflag_t>(ECHO | ICANON);
    ::tcsetattr(slave, TCSANOW, &settings);
    ::close(slave);
    ASSERT_TRUE(run_until(context, [&] { return !pty.status().client_present; }));
    run_for(context, std::chrono::milliseconds(30));
  }
}

TEST_F(PtyTest, ReplacesADanglingLink) {
  fs::create_directories(link.parent_path());
  fs::create_symlink("/dev/pts/99999", link);
  const Pty pty(context, link);
  EXPECT_EQ(fs::read_symlink(link), pty.slave_name());
}

TEST_F(PtyTest, ReplacesALinkToATerminalThatGotItsNumberLater) {
  // What a killed run leaves when its number was given to a new terminal: the link is older.
  fs::create_directories(link.parent_path());
  std::string number;
  {
    const Pty probe(context, {});
    number = probe.slave_name();
  }
  fs::create_symlink(number, link);
  ASSERT_TRUE(run_until(
                  context, [] { return false; }, std::chrono::milliseconds(50)) == false);
  const Pty stranger(context, {});
  if (stranger.slave_name() != number) {
    GTEST_SKIP() << "another program took " << number;
  }
  const Pty pty(context, link);
  EXPECT_EQ(fs::read_symlink(link), pty.slave_name());
}

TEST_F(PtyTest, RefusesALinkThatAnotherProgramKeeps) {
  const Pty foreign(context, {});  // stands for socat: a terminal, then a link to it
  fs::create_directories(link.parent_path());
  fs::create_symlink(foreign.slave_name(), link);
  EXPECT_THAT(refusal(), HasSubstr("a running program publishes " + foreign.slave_name()));
  EXPECT_EQ(fs::read_symlink(link), foreign.slave_name());
}

TEST_F(PtyTest, RefusesARegularFileAndLeavesItAlone) {
  fs::create_directories(link.parent_path());
  std::ofstream(link) << "precious";
  EXPECT_THAT(refusal(), HasSubstr(link.string() + ": a file is there; remove it"));
  std::string content;
  std::ifstream(link) >> content;
  EXPECT_EQ(content, "precious");
}

TEST_F(PtyTest, RefusesALinkToAFile) {
  fs::create_directories(link.parent_path());
  std::ofstream(directory / "file") << "precious";
  fs::create_symlink(directory / "file", link);
  EXPECT_THAT(refusal(), HasSubstr("which is no pseudo-terminal"));
}

TEST_F(PtyTest, RefusesADirectory) {
  fs::create_directories(link);
  EXPECT_THAT(refusal(), HasSubstr("a directory is there"));
}

TEST_F(PtyTest, RefusesADirectoryThatCannotBeMadeAndSaysWhatHelps) {
  fs::create_directories(directory);
  std::ofstream(directory / "nested") << "a file where a directory should be";
  EXPECT_THAT(refusal(), HasSubstr("such as "));
}

TEST_F(PtyTest, RefusesADirectoryWithoutWritePermission) {
  link = "/proc/rigwire/gnss";  // not even root may create there
  EXPECT_THAT(refusal(), HasSubstr("cannot create the directory /proc/rigwire"));
}

TEST_F(PtyTest, RefusesADirectoryInWhichOthersCouldPutTheirTerminal) {
  fs::create_directories(link.parent_path());
  fs::permissions(link.parent_path(), fs::perms::all);
  EXPECT_THAT(refusal(), HasSubstr("can be written by other users"));
  ASSERT_EQ(::chmod(link.parent_path().c_str(), 01777), 0);
  EXPECT_EQ(refusal(), "no EndpointError") << "names in a sticky directory are their makers'";
}

TEST_F(PtyTest, RefusesADirectoryAndALinkOnTheWayOfAnotherUser) {
  if (::geteuid() != 0) {
    GTEST_SKIP() << "only root can give a directory away";
  }
  constexpr uid_t kNobody = 65534;
  fs::create_directories(link.parent_path());
  ASSERT_EQ(::chown(link.parent_path().c_str(), kNobody, kNobody), 0);
  EXPECT_THAT(refusal(), HasSubstr("belongs to user 65534"));
  ASSERT_EQ(::chown(link.parent_path().c_str(), 0, 0), 0);
  fs::create_directory_symlink(link.parent_path(), directory / "way");
  ASSERT_EQ(::lchown((directory / "way").c_str(), kNobody, kNobody), 0);
  link = directory / "way" / "gnss";
  EXPECT_THAT(refusal(), HasSubstr("the link " + (directory / "way").string()));
}

TEST_F(PtyTest, RefusesAPathAmongDevicesAndADevice) {
  link = "/dev/rigwire-test/gnss";
  EXPECT_THAT(refusal(), HasSubstr("below /dev"));
  EXPECT_FALSE(fs::exists("/dev/rigwire-test"));
  link = "/dev/ttyUSB77";
  EXPECT_THAT(refusal(), HasSubstr("socat"));
  link = "/dev/null";
  EXPECT_THAT(refusal(), HasSubstr("below /dev"));
}

TEST_F(PtyTest, RefusesASecondOwnerOfThePath) {
  const Pty first(context, link);
  EXPECT_THAT(refusal(), HasSubstr("another running rigwire publishes this path"));
  EXPECT_EQ(fs::read_symlink(link), first.slave_name());
}

TEST_F(PtyTest, RefusalLeavesThePathFreeForAnother) {
  fs::create_directories(link.parent_path());
  std::ofstream(link) << "in the way";
  EXPECT_THAT(refusal(), HasSubstr("a file is there"));
  fs::remove(link);
  EXPECT_EQ(refusal(), "no EndpointError");
}

TEST_F(PtyTest, LeavesALinkAloneThatSomebodyElsePutInItsPlace) {
  {
    const Pty pty(context, link);
    fs::remove(link);
    fs::create_symlink("/dev/null", link);
  }
  EXPECT_EQ(fs::read_symlink(link), "/dev/null");
}

TEST_F(PtyTest, KilledOwnerDoesNotBlockARestart) {
  int ready[2];
  ASSERT_EQ(::pipe(ready), 0);
  const pid_t child = ::fork();
  if (child == 0) {
    boost::asio::io_context own;
    const Pty pty(own, link);
    (void)!::write(ready[1], "x", 1);
    ::pause();
    ::_exit(0);
  }
  char byte = 0;
  ASSERT_EQ(::read(ready[0], &byte, 1), 1);
  EXPECT_THAT(refusal(), HasSubstr("another running rigwire"));
  ::kill(child, SIGKILL);
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  EXPECT_TRUE(fs::is_symlink(fs::symlink_status(link))) << "the kill should leave the link";
  EXPECT_EQ(refusal(), "no EndpointError");
  ::close(ready[0]);
  ::close(ready[1]);
}

TEST_F(PtyTest, KilledClientIsNoticed) {
  Pty pty(context, link);
  pty.start([](std::span<const std::uint8_t>) {});
  const pid_t child = ::fork();
  if (child == 0) {
    const int slave = ::open(link.c_str(), O_RDWR | O_NOCTTY);
    (void)slave;
    ::pause();
    ::_exit(0);
  }
  EXPECT_TRUE(run_until(context, [&] { return pty.status().client_present; }));
  ::kill(child, SIGKILL);
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  EXPECT_TRUE(run_until(context, [&] { return !pty.status().client_present; }));
}

TEST_F(PtyTest, MayBeDestroyedByItsOwnReceiver) {
  auto pty = std::make_unique<Pty>(context, link);
  pty->start([&pty](std::span<const std::uint8_t>) { pty.reset(); });
  SerialPort client(context, {.path = link.string()});
  const Bytes bytes{1, 2, 3};
  client.write(bytes);
  EXPECT_TRUE(run_until(context, [&] { return pty == nullptr; }));
  run_for(context, std::chrono::milliseconds(20));
}

TEST_F(PtyTest, UnusedLineCostsAboutAHundredLooksPerSecond) {
  Pty pty(context, link);
  pty.start([](std::span<const std::uint8_t>) {});
  std::size_t handlers = 0;
  const auto end = std::chrono::steady_clock::now() + std::chrono::milliseconds(200);
  while (std::chrono::steady_clock::now() < end) {
    handlers += context.run_one_until(end);
  }
  EXPECT_LE(handlers, 45U);  // a loop that spins on the hang-up runs thousands
}

}  // namespace
}  // namespace rigwire::drivers
