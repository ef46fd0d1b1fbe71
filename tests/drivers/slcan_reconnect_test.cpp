// The adapter on a real pseudo-terminal, whose client comes and goes.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <boost/asio/io_context.hpp>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <string>

#include "drivers/descriptor.h"
#include "drivers/pty.h"
#include "drivers/slcan_adapter.h"
#include "sanitized.h"

namespace rigwire::drivers {
namespace {

std::ptrdiff_t open_descriptors() {
  return std::distance(std::filesystem::directory_iterator("/proc/self/fd"),
                       std::filesystem::directory_iterator{});
}

long resident_pages() {
  std::ifstream file("/proc/self/statm");
  long total = 0;
  long resident = 0;
  file >> total >> resident;
  return resident;
}

class Reconnecting : public testing::Test {
 protected:
  void SetUp() override {
    adapter_.on_client([this](const CanClient& client) { opened_ += client.open ? 1 : 0; });
    adapter_.start([this](const protocols::can::Frame&) { ++received_; });
  }
  /// Opens, says `text`, and leaves again.
  void visit(const std::string& text) {
    Descriptor client(::open(line_.slave_name().c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK));
    ASSERT_TRUE(client.open());
    // What the client before left in the line may still be on its way to the adapter.
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(10);
    std::size_t written = 0;
    while (written < text.size() && std::chrono::steady_clock::now() < end) {
      const ssize_t taken = ::write(client.get(), text.data() + written, text.size() - written);
      written += taken > 0 ? static_cast<std::size_t>(taken) : 0;
      if (written < text.size()) {
        context_.run_for(std::chrono::milliseconds(1));
      } else {
        context_.poll();
      }
      context_.restart();
    }
    ASSERT_EQ(written, text.size());
  }
  void run_until_received(int count) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(10);
    while (received_ < count && std::chrono::steady_clock::now() < end) {
      context_.run_for(std::chrono::milliseconds(1));
      context_.restart();
    }
  }
  boost::asio::io_context context_;
  Pty line_{context_, {}};
  SlcanAdapter adapter_{line_, 250'000};
  int opened_ = 0;
  int received_ = 0;
};

TEST_F(Reconnecting, TenThousandClientsThatNeitherReadNorCloseLeaveNothing) {
  constexpr int kVisits = 10'000;
  const protocols::can::Frame frame{0x0CF02980, true, false, 8, {1, 2, 3, 4, 5, 6, 7, 8}};
  const auto visit_often = [&](int visits) {
    for (int i = 0; i < visits; ++i) {
      visit("C\rS5\rO\rT18EAFFFE300EE00\rt12");
      adapter_.send(frame);
    }
  };
  constexpr int kFirst = 100;
  visit_often(kFirst);
  const auto descriptors = open_descriptors();
  const long pages = resident_pages();
  visit_often(kVisits);
  run_until_received(kFirst + kVisits);
  EXPECT_EQ(received_, kFirst + kVisits) << "every client's frame has arrived";
  EXPECT_EQ(open_descriptors(), descriptors);
  if (!kSanitized) {  // the address sanitizer keeps what was freed for a while
    EXPECT_LT(resident_pages() - pages, 256) << "1 MiB";
  }
}

TEST_F(Reconnecting, ClientThatSendsForEverAndNeverReadsIsHeardAndCosts) {
  Descriptor client(::open(line_.slave_name().c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK));
  ASSERT_TRUE(client.open());
  constexpr int kFrames = 25'000;
  std::string text = "S5\rO\r";
  for (int i = 0; i < kFrames; ++i) {
    text += "t1232ABCD\r";
  }
  for (std::size_t written = 0; written < text.size();) {
    const ssize_t size = ::write(client.get(), text.data() + written, text.size() - written);
    written += size > 0 ? static_cast<std::size_t>(size) : 0;
    context_.poll();
    context_.restart();
  }
  run_until_received(kFrames);
  EXPECT_EQ(received_, kFrames);
  EXPECT_GT(adapter_.counters().unanswered, 0U) << "counted, not kept";
}

}  // namespace
}  // namespace rigwire::drivers
