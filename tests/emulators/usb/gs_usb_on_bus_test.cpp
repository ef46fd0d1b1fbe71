// The adapter's controller is the outside node of the bus model: what the bus does reaches the host
// bit by bit.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <utility>
#include <vector>

#include "emulators/can/can_bus.h"
#include "gs_usb_workbench.h"
#include "protocols/can/bits.h"

namespace rigwire::emulators {
namespace {

class Joined final : public GsUsbWire, public CanOutside, public FrameOutput {
 public:
  explicit Joined(CanBusModel& bus) : bus_(bus) {
    bus_.set_outside(*this);
    bus_.set_client(kStart, {.present = false, .restart_after = std::nullopt});
  }
  void connect(GsUsbAdapter& adapter) { adapter_ = &adapter; }
  void set_controller(SimTime now, const OutsideController& controller) override {
    bus_.set_client(now, controller);
  }
  // Both interfaces have a send() of this form: from the host, and from a node to the host.
  void send(SimTime now, const Frame& frame) override {
    from_node_ ? static_cast<void>(adapter_->received(now, frame)) : bus_.receive(now, frame);
  }
  void confirm(SimTime now, bool sent) override {
    const bool was = std::exchange(from_node_, false);
    adapter_->confirmed(now, sent);
    from_node_ = was;
  }
  void report(SimTime now, const protocols::can::ControllerReport& report) override {
    const bool was = std::exchange(from_node_, false);
    adapter_->reported(now, report);
    from_node_ = was;
  }
  void advance(SimTime now) {
    while (std::min(bus_.next_event(), adapter_->next_event()) <= now) {
      const SimTime next = std::min(bus_.next_event(), adapter_->next_event());
      adapter_->advance(next);
      from_node_ = true;
      bus_.advance(next);
      from_node_ = false;
    }
  }

 private:
  CanBusModel& bus_;
  GsUsbAdapter* adapter_ = nullptr;
  bool from_node_ = false;
};

class GsUsbOnBus : public testing::Test {
 protected:
  GsUsbOnBus() {
    joined_.connect(adapter_);
    adapter_.plugged(kStart, host_);
  }
  void start(const BitTiming& timing, std::uint32_t flags = Feature::kTimeStamp) {
    control(Request::bit_timing, timing);
    control(Request::mode, Mode{Mode::kStart, flags});
  }
  template <class Structure>
  void control(Request number, const Structure& structure) {
    const auto bytes = protocols::gs_usb::encode(structure);
    adapter_.control(
        now_, ++transfers_,
        {0x41, static_cast<std::uint8_t>(number), 0, 0, static_cast<std::uint16_t>(bytes.size())},
        bytes);
  }
  void read(int count = 30) {
    for (int i = 0; i < count; ++i) {
      adapter_.read(now_, ++transfers_, 0x81, 24);
    }
  }
  void transmit(std::uint32_t echo, const Frame& frame) {
    HostFrame host_frame = protocols::gs_usb::from_can(frame);
    host_frame.echo = echo;
    adapter_.write(now_, ++transfers_, 0x02, protocols::gs_usb::encode_frame(host_frame).span());
  }
  void advance(SimTime until) {
    joined_.advance(until);
    now_ = until;
  }
  /// What the host read so far.
  [[nodiscard]] std::vector<HostFrame> heard() const {
    std::vector<HostFrame> frames;
    for (const auto& completion : host_.completions) {
      if (completion.data.size() == 24) {
        frames.push_back(*protocols::gs_usb::decode_frame(completion.data, true));
      }
    }
    return frames;
  }

  CanBusModel bus_{{.bit_rate_bps = 250'000}};
  Joined joined_{bus_};
  FrameOutput& node_ = bus_.add_node(joined_);  ///< It acknowledges.
  RecordingHost host_;
  GsUsbAdapter adapter_{{}, joined_};
  SimTime now_ = kStart;
  UsbTransfer transfers_ = 0;
};

constexpr BitTiming k500kbps{6, 7, 2, 1, 6};
constexpr std::int64_t kBit_us = 4;

std::int64_t end_of_frame_us(const Frame& frame) {
  return (protocols::can::exact_bits(frame) - protocols::can::kInterframeBits) * kBit_us;
}

TEST_F(GsUsbOnBus, EchoHasTheEndOfFrame) {
  start(k250kbps);
  read();
  transmit(3, kFrame);
  advance(at_us(end_of_frame_us(kFrame) - 1));
  EXPECT_TRUE(heard().empty());
  advance(at_us(end_of_frame_us(kFrame)));
  ASSERT_EQ(heard().size(), 1U);
  EXPECT_EQ(heard()[0].echo, 3U);
  EXPECT_EQ(heard()[0].time_stamp_us, 141U * kBit_us);
}

TEST_F(GsUsbOnBus, TheLessUrgentFrameWaitsForItsTurn) {
  start(k250kbps);
  read();
  const Frame urgent{0x100, false, false, 0, {}};
  const Frame other{0x200, false, false, 0, {}};
  transmit(0, other);
  node_.send(kStart, urgent);
  advance(at_us(1'000'000));
  const auto frames = heard();
  ASSERT_EQ(frames.size(), 2U);
  EXPECT_EQ(frames[0].identifier, 0x100U);
  EXPECT_EQ(frames[0].time_stamp_us, end_of_frame_us(urgent));
  EXPECT_EQ(frames[1].echo, 0U);
  EXPECT_EQ(frames[1].time_stamp_us,
            protocols::can::exact_bits(urgent) * kBit_us + end_of_frame_us(other));
}

// Ten frames of the kernel's take the time of ten frames on the wire, to the bit.
TEST_F(GsUsbOnBus, TenFramesBackToBack) {
  start(k250kbps);
  read();
  std::int64_t end_us = 0;
  for (std::uint32_t echo = 0; echo < 10; ++echo) {
    const Frame frame{0x300 + echo, false, false, 2, {static_cast<std::uint8_t>(echo), 0x55}};
    transmit(echo, frame);
    end_us += protocols::can::exact_bits(frame) * kBit_us;
  }
  advance(at_us(1'000'000));
  const auto frames = heard();
  ASSERT_EQ(frames.size(), 10U);
  for (std::uint32_t echo = 0; echo < 10; ++echo) {
    EXPECT_EQ(frames[echo].echo, echo);
  }
  EXPECT_EQ(frames.back().time_stamp_us, end_us - protocols::can::kInterframeBits * kBit_us);
}

// Whatever is sent during a short circuit reads recessive: the sender is off the bus after 32
// attempts. The mailboxes' frames are lost then, those behind them go out after the restart.
TEST_F(GsUsbOnBus, AShortCircuitEndsInBusOffAndComesBack) {
  const FaultPeriod when{Duration{0}, std::chrono::milliseconds{50}};
  bus_.set_faults({.list = {{when, ShortCircuitFault{}}}}, joined_);
  start(k250kbps);
  read(200);
  for (std::uint32_t echo = 0; echo < 5; ++echo) {
    transmit(echo, kFrame);
  }
  advance(at_us(60'000));
  EXPECT_EQ(adapter_.counters().abandoned, 3U);
  advance(at_us(400'000));
  std::vector<std::uint32_t> story;  // what happened, in order; repeated error frames once
  for (const HostFrame& frame : heard()) {
    const bool off = (frame.identifier & 0x20000040U) == 0x20000040U;
    const bool restarted = (frame.identifier & 0x20000100U) == 0x20000100U;
    if (off || restarted || frame.echo != protocols::gs_usb::kReceived) {
      story.push_back(off ? 0x40U : restarted ? 0x100U : frame.echo);
    }
  }
  EXPECT_THAT(story, testing::UnorderedElementsAre(0x40U, 0U, 1U, 2U, 0x100U, 3U, 4U));
  ASSERT_GE(story.size(), 3U);
  EXPECT_THAT(std::vector(story.end() - 3, story.end()), testing::ElementsAre(0x100U, 3U, 4U));
  EXPECT_EQ(adapter_.counters().abandoned, 3U);
  EXPECT_EQ(adapter_.counters().restarts, 1U);
}

// At another rate nothing is understood, in either direction.
TEST_F(GsUsbOnBus, NothingPassesAtTheWrongRate) {
  start(k500kbps);
  read(200);
  node_.send(at_us(1000), kFrame);
  transmit(0, kFrame);
  advance(at_us(300'000));
  for (const HostFrame& frame : heard()) {
    EXPECT_TRUE((frame.identifier & HostFrame::kError) != 0 || frame.echo == 0);
  }
  EXPECT_EQ(adapter_.counters().echoed, adapter_.counters().abandoned);
}

TEST_F(GsUsbOnBus, AListenerIsNotNeededAndSendsNothing) {
  start(k250kbps, Feature::kListenOnly | Feature::kTimeStamp);
  read();
  transmit(0, kFrame);
  node_.send(kStart, kFrame);
  advance(at_us(50'000));
  for (const HostFrame& frame : heard()) {
    EXPECT_EQ(frame.echo, protocols::gs_usb::kReceived);
  }
}

TEST_F(GsUsbOnBus, UnpluggedInTheMiddleOfAFrame) {
  start(k250kbps);
  read();
  transmit(0, kFrame);
  transmit(1, kFrame);
  advance(at_us(100));
  adapter_.unplugged(now_);
  advance(at_us(10'000));
  adapter_.plugged(now_, host_);
  start(k250kbps);
  read();
  transmit(2, kFrame);
  advance(at_us(200'000));
  const auto frames = heard();
  ASSERT_EQ(frames.size(), 1U);
  EXPECT_EQ(frames[0].echo, 2U);
}

}  // namespace
}  // namespace rigwire::emulators
