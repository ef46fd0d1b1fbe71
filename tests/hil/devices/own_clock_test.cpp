// Devices of a rig's bus live by clocks of their own: their keys, their rates on the wire, and what
// comes from outside at the run's instants.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <fstream>
#include <string>

#include "hil/configuration/problems.h"
#include "hil/rig/rig.h"
#include "private_wires.h"

namespace rigwire::hil {
namespace {

using testing::HasSubstr;
using namespace std::chrono_literals;

/// Reads the bus all the time.
class Listener final : public EventSource {
 public:
  explicit Listener(const std::string& path)
      : line_(::open(path.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK)) {
    EXPECT_EQ(::write(line_, "O\r", 2), 2);
  }
  ~Listener() override { ::close(line_); }
  Listener(const Listener&) = delete;
  Listener& operator=(const Listener&) = delete;

  [[nodiscard]] SimTime next_event() const override { return next_; }
  [[nodiscard]] SimTime next_wakeup() const override { return next_; }
  void advance(SimTime now) override {
    while (next_ <= now) {
      next_ += 10ms;
    }
    std::array<char, 4096> bytes{};
    for (ssize_t count = ::read(line_, bytes.data(), bytes.size()); count > 0;
         count = ::read(line_, bytes.data(), bytes.size())) {
      text_.append(bytes.data(), static_cast<std::size_t>(count));
    }
  }
  [[nodiscard]] int count(const std::string& start) const {
    int found = 0;
    for (std::size_t at = text_.find(start); at != std::string::npos;
         at = text_.find(start, at + 1)) {
      ++found;
    }
    return found;
  }

 private:
  int line_;
  SimTime next_ = kStart + 10ms;
  std::string text_;
};

class OwnClockRig : public testing::Test {
 protected:
  /// Two inclinometers that send every 10 ms, with these keys.
  LoadedRig load(const std::string& first, const std::string& second) const {
    const std::string file = (wires_.folder / "rig.yaml").string();
    const auto node = [](int id, const std::string& keys) {
      return "{type: cia410-inclinometer, mount: {link: body}, node_id: " + std::to_string(id) +
             ", starts_itself: true, transmission_type: 255, event_timer: 10 ms, " + keys + "}\n";
    };
    std::ofstream(file) << "scene:\n  terrain: {type: level, size: 60 m, cell: 1 m}\n"
                        << "machine: {include: " << RIGWIRE_SOURCE_DIR
                        << "/configs/machines/gator_855d.yaml}\n"
                        << "buses:\n  can: {wire: slcan, path: " << wires_.can() << "}\n"
                        << "devices:\n  first: " << node(10, first)
                        << "  second: " << node(11, second);
    return load_rig(file, {});
  }

  test::PrivateWires wires_;
};

TEST_F(OwnClockRig, RatesOnTheWireAreThoseOfEachNodesClock) {
  const LoadedRig loaded = load("clock: {tolerance: 0 ppm, error: 1000 ppm}",
                                "clock: {tolerance: 0 ppm, error: -1000 ppm}");
  boost::asio::io_context io;
  Rig rig(loaded.configuration, io, {});
  Listener listener(wires_.can());
  rig.executive().add(listener);
  const RunOutcome outcome = rig.executive().run_free(kStart + 10'205ms);
  ASSERT_FALSE(outcome.fault.has_value()) << *outcome.fault;
  // 10 s after the boot-up at 200 ms: 1000 periods of 10 ms, one more and one less.
  EXPECT_EQ(listener.count("t18A4"), 1002);
  EXPECT_EQ(listener.count("t18B4"), 1000);
}

TEST_F(OwnClockRig, SupplyFailsAtTheRunsInstant) {
  const LoadedRig loaded =
      load("clock: {tolerance: 0 ppm, error: 1000 ppm}, power_cycles: [5.009 s]",
           "clock: {tolerance: 0 ppm, jitter: 0 s}, power_cycles: [5.009 s]");
  boost::asio::io_context io;
  Rig rig(loaded.configuration, io, {});
  Listener listener(wires_.can());
  rig.executive().add(listener);
  const RunOutcome outcome = rig.executive().run_free(kStart + 5'400ms);
  ASSERT_FALSE(outcome.fault.has_value()) << *outcome.fault;
  // From the boot-up at 200 ms each 10 ms; the fast clock shows 5.014 s when the supply fails.
  EXPECT_EQ(listener.count("t18B4"), 481);
  EXPECT_EQ(listener.count("t18A4"), 482);
}

TEST_F(OwnClockRig, KeysOfAClockAreChecked) {
  const auto complaint = [&](const std::string& clock) -> std::string {
    try {
      (void)load("clock: " + clock, "serial: 1");
      return "";
    } catch (const ConfigurationError& error) {
      return error.what();
    }
  };
  EXPECT_EQ(complaint("{tolerance: 20 ppm, error: -3 ppm, jitter: 1 ms}"), "");
  EXPECT_THAT(complaint("{tolerance: 1100 ppm}"), HasSubstr("devices.first.clock.tolerance"));
  EXPECT_THAT(complaint("{error: -1100 ppm}"), HasSubstr("devices.first.clock.error"));
  EXPECT_THAT(complaint("{jitter: 11 ms}"), HasSubstr("devices.first.clock.jitter"));
  EXPECT_THAT(complaint("{ppm: 1}"), HasSubstr("ppm"));
}

}  // namespace
}  // namespace rigwire::hil
