#include "drivers/output.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <pty.h>
#include <sys/stat.h>
#include <termios.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <filesystem>
#include <string>
#include <thread>

namespace rigwire::drivers {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

class OutputToPipe : public testing::Test {
 protected:
  OutputToPipe() {
    std::signal(SIGPIPE, SIG_IGN);
    if (::pipe(ends_.data()) != 0) {
      throw std::runtime_error("no pipe");
    }
  }
  ~OutputToPipe() override {
    for (const int end : ends_) {
      ::close(end);
    }
    std::signal(SIGPIPE, SIG_DFL);
  }
  [[nodiscard]] int reader() const { return ends_[0]; }
  [[nodiscard]] int writer() const { return ends_[1]; }
  void close_reader() {
    ::close(ends_[0]);
    ends_[0] = -1;
  }

 private:
  std::array<int, 2> ends_{};
};

const std::string kMoreThanAPipeHolds(1 << 20, 'x');

TEST_F(OutputToPipe, what_is_read_arrives_whole) {
  std::string read;
  std::thread thread([&] {
    std::array<char, 4096> buffer{};
    while (read.size() < kMoreThanAPipeHolds.size()) {
      read.append(buffer.data(),
                  static_cast<std::size_t>(::read(reader(), buffer.data(), buffer.size())));
    }
  });
  const Written written = Output(writer()).write(kMoreThanAPipeHolds, Clock::now() + 60s);
  thread.join();
  EXPECT_EQ(written.end, WriteEnd::whole);
  EXPECT_EQ(read, kMoreThanAPipeHolds);
}

TEST_F(OutputToPipe, a_reader_that_stalls_is_left_at_the_deadline) {
  const Output output(writer());
  const Written first = output.write(kMoreThanAPipeHolds, Clock::now() + 10ms);
  EXPECT_EQ(first.end, WriteEnd::late);
  EXPECT_GT(first.bytes, 0U);
  const Written second = output.write("more", Clock::now());
  EXPECT_EQ(second.end, WriteEnd::late);
  EXPECT_EQ(second.bytes, 0U);
}

TEST_F(OutputToPipe, the_description_that_others_share_stays_as_it_was) {
  const int before = ::fcntl(writer(), F_GETFL);
  const Output output(writer());
  (void)output.write(kMoreThanAPipeHolds, Clock::now());
  EXPECT_EQ(::fcntl(writer(), F_GETFL), before);
}

TEST_F(OutputToPipe, an_interrupt_ends_a_wait_that_has_no_deadline) {
  const Output output(writer());
  const Interrupt interrupt;
  Written written;
  std::thread thread(
      [&] { written = output.write(kMoreThanAPipeHolds, Output::Deadline::max(), &interrupt); });
  interrupt.raise();
  thread.join();
  EXPECT_EQ(written.end, WriteEnd::interrupted);
}

TEST_F(OutputToPipe, a_reader_that_closed_is_told_as_such) {
  const Output opened_before(writer());
  close_reader();
  EXPECT_EQ(opened_before.write("x", Clock::now() + 1s).end, WriteEnd::closed);
  EXPECT_EQ(Output(writer()).write("x", Clock::now() + 1s).end, WriteEnd::closed);
}

TEST(Output, a_full_device_and_a_closed_descriptor_fail_with_their_reasons) {
  const Descriptor full(::open("/dev/full", O_WRONLY | O_CLOEXEC));
  ASSERT_TRUE(full.open());
  const Written written = Output(full.get()).write("x", Clock::now());
  EXPECT_EQ(written.end, WriteEnd::failed);
  EXPECT_EQ(written.error, ENOSPC);
  EXPECT_EQ(Output(-1).write("x", Clock::now()).error, EBADF);
}

TEST(Output, a_terminal_that_is_stopped_is_left_at_the_deadline) {
  int master = -1;
  int slave = -1;
  ASSERT_EQ(::openpty(&master, &slave, nullptr, nullptr, nullptr), 0);
  const Descriptor user(master);
  const Descriptor program(slave);
  const Output output(slave);
  ASSERT_EQ(::tcflow(slave, TCOOFF), 0);  // what Ctrl-S does
  EXPECT_EQ(output.write("picture\n", Clock::now() + 10ms).end, WriteEnd::late);
  ASSERT_EQ(::tcflow(slave, TCOON), 0);
  EXPECT_EQ(output.write("picture\n", Clock::now() + 10s).end, WriteEnd::whole);
}

TEST(Output, a_fifo_without_a_reader_is_not_waited_for_beyond_the_deadline) {
  const std::filesystem::path fifo =
      std::filesystem::temp_directory_path() / ("rigwire-fifo-" + std::to_string(::getpid()));
  ASSERT_EQ(::mkfifo(fifo.c_str(), 0600), 0);
  EXPECT_LT(open_for_reader(fifo, Clock::now()), 0);
  EXPECT_EQ(errno, ENXIO);
  const Descriptor reader(::open(fifo.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC));
  const Descriptor writer(open_for_reader(fifo, Clock::now()));
  EXPECT_TRUE(writer.open());
  std::filesystem::remove(fifo);
}

}  // namespace
}  // namespace rigwire::drivers
