// The pipe by which a run tells whoever started it that its wires are open.
#include "hil/control/ready.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <unistd.h>

#include <string>

#include "drivers/endpoints.h"

namespace rigwire::hil {
namespace {

/// The run's end as the run has it: with a number of its own, which the teller closes.
int run_s_end(ReadyPipe& pipe) {
  const int own = ::dup(pipe.written());
  pipe.handed_over();
  return own;
}

bool readable(const ReadyPipe& pipe) {
  pollfd watched{pipe.descriptor(), POLLIN, 0};
  return ::poll(&watched, 1, 0) > 0;
}

void write_some(int descriptor, const std::string& text) {
  ASSERT_EQ(::write(descriptor, text.data(), text.size()), static_cast<ssize_t>(text.size()));
}

TEST(ReadyPipe, HearsTheLineWithoutItsEnd) {
  ReadyPipe pipe;
  EXPECT_FALSE(readable(pipe));
  tell_ready(run_s_end(pipe), "{\"dashboard\":\"127.0.0.1:80\"}");
  EXPECT_TRUE(readable(pipe));
  EXPECT_EQ(pipe.hear(), "{\"dashboard\":\"127.0.0.1:80\"}");
}

TEST(ReadyPipe, WaitsForTheLineToBeWhole) {
  ReadyPipe pipe;
  const int run = run_s_end(pipe);
  write_some(run, "half");
  EXPECT_EQ(pipe.hear(), std::nullopt);
  EXPECT_FALSE(readable(pipe));
  write_some(run, " and half\nbehind it");
  EXPECT_EQ(pipe.hear(), "half and half");
  ::close(run);
}

TEST(ReadyPipe, ALineLongerThanOneReadIsWhole) {
  ReadyPipe pipe;
  const std::string line(10'000, 'x');
  tell_ready(run_s_end(pipe), line);
  std::optional<std::string> heard;
  for (int reads = 0; !heard && reads < 10; ++reads) {
    heard = pipe.hear();
  }
  EXPECT_EQ(heard, line);
}

TEST(ReadyPipe, ARunThatEndsBeforeIsAnError) {
  ReadyPipe pipe;
  const int run = run_s_end(pipe);
  write_some(run, "half");
  EXPECT_EQ(pipe.hear(), std::nullopt);
  ::close(run);
  EXPECT_TRUE(readable(pipe));
  EXPECT_THROW(static_cast<void>(pipe.hear()), drivers::EndpointError);
}

TEST(ReadyPipe, ProgramsThatAreStartedDoNotInheritItsEnds) {
  const ReadyPipe pipe;
  EXPECT_NE(::fcntl(pipe.written(), F_GETFD) & FD_CLOEXEC, 0);
  EXPECT_NE(::fcntl(pipe.descriptor(), F_GETFD) & FD_CLOEXEC, 0);
}

TEST(ReadyPipe, OneEndCanBeWrittenAndTheOtherCannot) {
  ReadyPipe pipe;
  const int run = run_s_end(pipe);
  EXPECT_TRUE(can_be_written(run));
  EXPECT_FALSE(can_be_written(pipe.descriptor()));
  ::close(run);
  EXPECT_FALSE(can_be_written(run));
}

}  // namespace
}  // namespace rigwire::hil
