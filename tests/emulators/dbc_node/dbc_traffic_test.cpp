// What a node that a DBC file describes does on its bus: when, with which bytes, and what comes in.
#include "emulators/dbc_node/dbc_traffic.h"

#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "emulators/dbc_node/dbc_node.h"
#include "protocols/j1939/message.h"
#include "supply_cuts.h"

namespace rigwire::emulators {
namespace {

using namespace std::chrono_literals;
using protocols::can::Frame;
using protocols::can::OwnedMessage;
using protocols::can::OwnedSignal;
namespace j1939 = protocols::j1939;

struct Bus final : FrameOutput {
  void send(SimTime due, const Frame& frame) override {
    EXPECT_TRUE(times.empty() || due >= times.back()) << "due times went back";
    times.push_back(due);
    frames.push_back(frame);
  }
  std::vector<SimTime> times;
  std::vector<Frame> frames;
};

OwnedSignal row(const std::string& name, std::uint16_t bit, std::uint16_t width,
                double scale = 1.0) {
  OwnedSignal signal;
  signal.name = name;
  signal.bit = bit;
  signal.width = width;
  signal.scale = scale;
  return protocols::can::unlimited(std::move(signal));
}
OwnedMessage message(const std::string& name, std::uint32_t id, std::vector<OwnedSignal> rows) {
  OwnedMessage layout;
  layout.name = name;
  layout.id = id;
  layout.signals = std::move(rows);
  return layout;
}
DbcSentMessage sent(OwnedMessage layout, std::vector<DbcShown> shows) {
  DbcSentMessage result;
  result.layout = std::move(layout);
  result.shows = std::move(shows);
  return result;
}

/// An angle in hundredths from the first quantity, a counter of four bits and a checksum.
DbcNodeSettings sensor() {
  DbcNodeSettings settings;
  settings.measured = {0};
  settings.sent = {sent(message("Angle", 0x185,
                                {row("Angle", 0, 16, 0.01), row("Count", 16, 4),
                                 row("State", 20, 4), row("Sum", 56, 8)}),
                        {{7, DbcMeasured{0, 10.0, 1.0}},
                         {0, DbcCounter{}},
                         {2, DbcHeld{}},
                         {0, DbcSum{DbcChecksum::xor8}}})};
  settings.sent[0].period = 20ms;
  return settings;
}

std::uint64_t raw(const OwnedSignal& signal, const Frame& frame) {
  return protocols::can::get_raw(signal, frame.payload());
}

TEST(DbcTraffic, SendsByTimeWhatItMeasuredWithCounterAndChecksum) {
  Bus bus;
  const DbcNodeSettings settings = sensor();
  DbcTraffic node(settings, bus);
  const auto& rows = settings.sent[0].layout.signals;
  node.advance(kStart + 10ms);
  ASSERT_EQ(bus.frames.size(), 1U);
  EXPECT_EQ(bus.times[0], kStart + 200us);
  EXPECT_EQ(raw(rows[0], bus.frames[0]), 7U) << "the start value before the first measurement";
  node.measure(kStart + 10ms, std::array{2.5});  // 2.5 * 10 + 1 = 26
  node.advance(kStart + 400ms);
  ASSERT_EQ(bus.frames.size(), 20U);
  for (std::size_t i = 0; i < bus.frames.size(); ++i) {
    EXPECT_EQ(bus.times[i], kStart + 200us + i * 20ms);
    EXPECT_EQ(raw(rows[1], bus.frames[i]), i % 16);
    EXPECT_EQ(raw(rows[2], bus.frames[i]), 2U);
    std::uint8_t all = 0;
    for (const std::uint8_t byte : bus.frames[i].data) {
      all ^= byte;
    }
    EXPECT_EQ(all, 0) << "exclusive or over everything, the checksum included";
  }
  EXPECT_EQ(raw(rows[0], bus.frames[1]), 2600U);
  EXPECT_EQ(node.nominal_rate_hz(), 50.0);
}

TEST(DbcTraffic, Crc8OfSaeJ1850IsThatOfItsCheckValue) {
  // "123456789" gives 0x4B: the check value of the published catalogues of CRC parameters.
  const std::string text = "123456789";
  std::vector<std::uint8_t> data(text.begin(), text.end());
  data.push_back(0xEE);
  EXPECT_EQ(checksum(DbcChecksum::crc8_j1850, data, 9), 0x4B);
  EXPECT_EQ(checksum(DbcChecksum::sum8, data, 9), 0xDD);
}

TEST(DbcTraffic, ALowPassReachesTheStepAfterItsTimeConstant) {
  Bus bus;
  DbcNodeSettings settings = sensor();
  settings.sent[0].shows[0].source = DbcMeasured{0, 1.0, 0.0, 100ms};
  DbcTraffic node(settings, bus);
  node.measure(kStart, std::array{0.0});
  for (int i = 1; i <= 10; ++i) {
    node.measure(kStart + i * 10ms, std::array{100.0});
  }
  node.advance(kStart + 101ms);
  EXPECT_NEAR(
      0.01 * static_cast<double>(raw(settings.sent[0].layout.signals[0], bus.frames.back())),
      100.0 * (1.0 - std::exp(-1.0)), 0.01);
}

TEST(DbcTraffic, WhatIsNotAvailableKeepsTheStartValueOrSaysSo) {
  Bus bus;
  DbcNodeSettings settings = sensor();
  DbcTraffic plain(settings, bus);
  plain.measure(kStart, std::array{std::numeric_limits<double>::quiet_NaN()});
  plain.advance(kStart + 1ms);
  EXPECT_EQ(raw(settings.sent[0].layout.signals[0], bus.frames.back()), 7U);
  settings.sent[0].layout.signals[0].reserved = protocols::can::Reserved::j1939;
  DbcTraffic node(settings, bus);
  bus.times.clear();
  node.measure(kStart, std::array{std::numeric_limits<double>::quiet_NaN()});
  node.advance(kStart + 1ms);
  EXPECT_EQ(raw(settings.sent[0].layout.signals[0], bus.frames.back()), 0xFFFFU);
}

TEST(DbcTraffic, SendsOnChangeNoCloserThanItsDistance) {
  Bus bus;
  DbcNodeSettings settings = sensor();
  settings.sent[0].period = Duration{0};
  settings.sent[0].on_change = true;
  settings.sent[0].least_distance = 50ms;
  DbcTraffic node(settings, bus);
  node.measure(kStart, std::array{1.0});
  node.advance(kStart + 100ms);
  EXPECT_EQ(bus.frames.size(), 1U) << "once at power-up";
  for (int i = 0; i < 10; ++i) {
    node.measure(kStart + 100ms + i * 10ms, std::array{2.0 + i});
  }
  node.advance(kStart + 400ms);
  ASSERT_EQ(bus.frames.size(), 4U);
  EXPECT_EQ(bus.times[2] - bus.times[1], 50ms);
  node.measure(kStart + 400ms, std::array{11.0});
  node.advance(kStart + 1s);
  EXPECT_EQ(bus.frames.size(), 4U) << "nothing changed";
}

TEST(DbcTraffic, ATurnedPageIsNoChange) {
  Bus bus;
  DbcNodeSettings settings;
  OwnedMessage layout =
      message("Pages", 0x285, {row("Page", 0, 8), row("A", 8, 8), row("B", 8, 8)});
  for (const std::size_t s : {1U, 2U}) {
    layout.signals[s].multiplexor = 0;
    layout.signals[s].present_at = {{s - 1, s - 1}};
  }
  settings.measured = {0};
  settings.sent = {sent(layout, {{0, DbcHeld{}}, {0x11, DbcHeld{}}, {0, DbcMeasured{0}}})};
  settings.sent[0].on_change = true;
  DbcTraffic node(settings, bus);
  for (int i = 0; i < 20; ++i) {
    node.measure(kStart + i * 10ms, std::array{5.0});
  }
  EXPECT_LE(bus.frames.size(), 2U);
}

TEST(DbcTraffic, ALongMessageWithoutAnAddressStaysAway) {
  Bus bus;
  DbcNodeSettings settings;
  OwnedMessage layout = message("Long", 0x18FEEC00, {row("A", 8, 8)});
  layout.length = 1785;
  layout.j1939 = layout.extended = true;
  settings.sent = {sent(layout, {{1, DbcHeld{}}})};
  settings.sent[0].period = 10ms;
  DbcTraffic node(settings, bus);
  node.advance(kStart + 100ms);
  EXPECT_TRUE(bus.frames.empty());
}

TEST(DbcTraffic, ARemoteFrameIsAnsweredWithTheNextPage) {
  Bus bus;
  DbcNodeSettings settings;
  OwnedMessage layout =
      message("Identity", 0x285, {row("Page", 0, 8), row("A", 8, 8), row("B", 8, 8)});
  for (const std::size_t s : {1U, 2U}) {
    layout.signals[s].multiplexor = 0;
    layout.signals[s].present_at = {{s - 1, s - 1}};
  }
  settings.sent = {sent(layout, {{0, DbcHeld{}}, {0x11, DbcHeld{}}, {0x22, DbcHeld{}}})};
  settings.sent[0].on_request = true;
  DbcTraffic node(settings, bus);
  Frame ask;
  ask.id = 0x285;
  ask.remote = true;
  ask.length = 8;
  for (int i = 0; i < 3; ++i) {
    node.receive(kStart + 1ms + i * 10ms, ask);
  }
  node.advance(kStart + 1s);
  ASSERT_EQ(bus.frames.size(), 3U);
  EXPECT_EQ(bus.frames[0].data[0], 0);
  EXPECT_EQ(bus.frames[0].data[1], 0x11);
  EXPECT_EQ(bus.frames[1].data[0], 1);
  EXPECT_EQ(bus.frames[1].data[1], 0x22);
  EXPECT_EQ(bus.frames[2].data[0], 0);
  EXPECT_EQ(node.received().accepted, 3U);
}

/// A set point in per mille, -1000 .. 1000, with counter and checksum; it moves quantity 0.
DbcNodeSettings actuator() {
  DbcNodeSettings settings;
  settings.moved = {0};
  OwnedSignal set_point = row("Opening", 0, 16);
  set_point.is_signed = true;
  set_point.lower = -1000.0;
  set_point.upper = 1000.0;
  DbcTakenMessage taken;
  taken.layout = message("Set", 0x200, {set_point, row("Count", 16, 8), row("Sum", 56, 8)});
  taken.uses = {DbcMove{0, 1e-3, 0.0, 0.25}, DbcCounter{}, DbcSum{DbcChecksum::xor8}};
  taken.timeout = 100ms;
  settings.taken = {taken};
  return settings;
}
Frame set_point(int value, int count) {
  Frame frame;
  frame.id = 0x200;
  frame.length = 8;
  frame.data[0] = static_cast<std::uint8_t>(value);
  frame.data[1] = static_cast<std::uint8_t>(value >> 8);
  frame.data[2] = static_cast<std::uint8_t>(count);
  frame.data[7] = checksum(DbcChecksum::xor8, frame.data, 7);
  return frame;
}

TEST(DbcTraffic, ASetPointHoldsUntilItsTimeOut) {
  Bus bus;
  DbcTraffic node(actuator(), bus);
  node.advance(kStart);
  EXPECT_EQ(node.moved()[0], 0.25) << "safe before the first";
  node.receive(kStart + 10ms, set_point(-500, 0));
  EXPECT_EQ(node.moved()[0], -0.5);
  node.advance(kStart + 109ms);
  EXPECT_EQ(node.moved()[0], -0.5);
  node.advance(kStart + 110ms);
  EXPECT_EQ(node.moved()[0], 0.25);
}

TEST(DbcTraffic, AWrongCounterOrChecksumIsRefusedAndDoesNotFeedTheTimeOut) {
  Bus bus;
  DbcTraffic node(actuator(), bus);
  node.receive(kStart + 1ms, set_point(100, 255));
  node.receive(kStart + 2ms, set_point(200, 0));  // wraps
  EXPECT_EQ(node.moved()[0], 0.2);
  node.receive(kStart + 3ms, set_point(300, 0));  // repeated
  EXPECT_EQ(node.moved()[0], 0.2);
  node.receive(kStart + 4ms, set_point(400, 5));  // lost ones
  EXPECT_EQ(node.moved()[0], 0.2);
  node.receive(kStart + 5ms, set_point(500, 6));  // and on from there
  EXPECT_EQ(node.moved()[0], 0.5);
  Frame broken = set_point(600, 7);
  broken.data[7] ^= 1U;
  node.receive(kStart + 6ms, broken);
  Frame cut = set_point(600, 7);
  cut.length = 7;
  node.receive(kStart + 7ms, cut);
  EXPECT_EQ(node.moved()[0], 0.5);
  EXPECT_EQ(node.received().malformed, 4U);
  EXPECT_EQ(node.received().accepted, 3U);
}

TEST(DbcTraffic, ValuesBeyondTheLimitsAreClippedOrNotTaken) {
  Bus bus;
  DbcNodeSettings settings = actuator();
  DbcTraffic clips(settings, bus);
  clips.receive(kStart + 1ms, set_point(32000, 0));
  EXPECT_EQ(clips.moved()[0], 1.0);
  std::get<DbcMove>(settings.taken[0].uses[0]).clip = false;
  DbcTraffic keeps(settings, bus);
  keeps.receive(kStart + 1ms, set_point(100, 0));
  keeps.receive(kStart + 2ms, set_point(32000, 1));
  EXPECT_EQ(keeps.moved()[0], 0.1);
}

TEST(DbcTraffic, AnErrorInAFloatingPointSetPointIsSafeAndNotANumberChangesNothing) {
  Bus bus;
  DbcNodeSettings settings = actuator();
  settings.taken[0].uses = {DbcMove{0, 1.0, 0.0, 0.25}};
  OwnedSignal real = row("Opening", 0, 32);
  real.is_float = true;
  settings.taken[0].layout.signals = {protocols::can::unlimited(real)};
  DbcTraffic node(settings, bus);
  const auto send = [&](Duration at, float value) {
    Frame frame;
    frame.id = 0x200;
    frame.length = 8;
    protocols::can::put_raw(real, frame.data, std::bit_cast<std::uint32_t>(value));
    node.receive(kStart + at, frame);
  };
  send(1ms, 0.75F);
  EXPECT_EQ(node.moved()[0], 0.75);
  send(2ms, std::numeric_limits<float>::quiet_NaN());
  EXPECT_EQ(node.moved()[0], 0.75);
  send(3ms, std::numeric_limits<float>::infinity());
  EXPECT_EQ(node.moved()[0], 0.25);
}

TEST(DbcTraffic, WithoutSupplyItIsSilentAndDeafAndBeginsAnew) {
  Bus bus;
  DbcNodeSettings settings = sensor();
  settings.taken = actuator().taken;
  settings.moved = {0};
  settings.supply.faults = rigwire::test::cuts({100ms});
  DbcTraffic node(settings, bus);
  node.receive(kStart + 90ms, set_point(500, 0));
  node.receive(kStart + 150ms, set_point(500, 1));
  EXPECT_EQ(node.moved()[0], 0.25);
  node.advance(kStart + 590ms);
  EXPECT_EQ(bus.frames.size(), 5U);
  node.advance(kStart + 601ms);
  ASSERT_EQ(bus.frames.size(), 6U);
  EXPECT_EQ(raw(settings.sent[0].layout.signals[1], bus.frames[5]), 0U) << "counts from 0";
}

TEST(DbcTraffic, FaultsDoWhatTheySayAndNothingBeforeAndAfter) {
  const auto frames_with = [](decltype(DbcNodeFault::what) what) {
    Bus bus;
    DbcNodeSettings settings = sensor();
    settings.faults = {{{100ms, 100ms}, std::move(what)}};
    DbcTraffic node(settings, bus);
    for (int i = 0; i < 40; ++i) {
      node.measure(kStart + i * 10ms, std::array{0.1 * i});
    }
    return bus.frames;
  };
  Bus bus;
  DbcTraffic well(sensor(), bus);
  for (int i = 0; i < 40; ++i) {
    well.measure(kStart + i * 10ms, std::array{0.1 * i});
  }
  const auto& good = bus.frames;
  ASSERT_EQ(good.size(), 20U);
  const auto rows = sensor().sent[0].layout.signals;

  EXPECT_EQ(frames_with(SilentNodeFault{}).size(), 15U);
  const auto frozen = frames_with(FrozenSignalFault{"Angle", "Angle"});
  EXPECT_EQ(raw(rows[0], frozen[9]), raw(rows[0], good[4]));
  EXPECT_EQ(frozen[10], good[10]) << "as if nothing had been";
  const auto lied = frames_with(FalseSignalFault{"Angle", "Angle", 123.0});
  EXPECT_EQ(raw(rows[0], lied[7]), 12300U);
  EXPECT_EQ(lied[12], good[12]);
  EXPECT_EQ(raw(rows[2], frames_with(RawSignalFault{"Angle", "State", 0xE})[5]), 0xEU);
  const auto stopped = frames_with(StoppedCounterFault{"Angle"});
  EXPECT_EQ(raw(rows[1], stopped[5]), raw(rows[1], stopped[9]));
  EXPECT_NE(frames_with(WrongChecksumFault{"Angle"})[6].data[7], good[6].data[7]);
  EXPECT_EQ(frames_with(ShortFrameFault{"Angle"})[6].length, 7);
}

TEST(DbcTraffic, AFaultOfNoMessageOrSignalIsRefused) {
  Bus bus;
  DbcNodeSettings settings = sensor();
  settings.faults = {{{}, FrozenSignalFault{"Angel", "Angle"}}};
  EXPECT_THROW(DbcTraffic(settings, bus), std::invalid_argument);
  settings.faults = {{{}, FrozenSignalFault{"Angle", "Angel"}}};
  EXPECT_THROW(DbcTraffic(settings, bus), std::invalid_argument);
}

TEST(DbcTraffic, ClaimsAnAddressSendsWithItAndAnswersRequestsForItsGroups) {
  Bus bus;
  DbcNodeSettings settings = sensor();
  OwnedMessage& layout = settings.sent[0].layout;
  layout.j1939 = true;
  layout.extended = true;
  layout.fill = 0xFF;
  layout.id = j1939::pack(j1939::Identifier{3, 61459, j1939::kGlobalAddress, j1939::kNullAddress});
  settings.sent[0].period = Duration{0};
  settings.sent[0].on_request = true;
  settings.claim = DbcClaim{0x42, 0x8000000000000001U, true};
  DbcTraffic node(settings, bus);
  node.advance(kStart + 300ms);
  ASSERT_EQ(bus.frames.size(), 1U);
  EXPECT_EQ(bus.frames[0].id, 0x18EEFF42U);
  EXPECT_EQ(node.address(), 0x42);
  node.receive(kStart + 400ms, j1939::make_request(0x10, 0x42, 61459));
  node.advance(kStart + 401ms);
  ASSERT_EQ(bus.frames.size(), 2U);
  EXPECT_EQ(bus.frames[1].id, 0x0CF01342U);
  EXPECT_EQ(bus.frames[1].data[3], 0xFF) << "bits of no signal";
  node.receive(kStart + 500ms, j1939::make_request(0x10, 0x42, 65262));
  node.advance(kStart + 501ms);
  ASSERT_EQ(bus.frames.size(), 3U);
  EXPECT_TRUE(j1939::decode_acknowledgement(bus.frames[2]).ok()) << "a group it does not know";
}

TEST(DbcNode, CommandsTheBackendByTheTablesRows) {
  Bus bus;
  DbcNodeSettings settings = actuator();
  const NamedQuantity* const second = find_quantity(moved_quantities(), "valves.opening_2");
  ASSERT_NE(second, nullptr);
  settings.moved = {second->index};
  std::get<DbcMove>(settings.taken[0].uses[0]).safe = 0.0;
  DbcNode<ValveBackend> node(settings, bus);
  node.receive(kStart + 5ms, set_point(400, 0));
  EXPECT_EQ(node.command().opening[1], 0.4);
  EXPECT_EQ(node.command().time, kStart + 5ms);
  node.advance(kStart + 105ms);
  EXPECT_EQ(node.command().opening[1], 0.0);
}

TEST(DbcNode, EveryQuantityHasOneNameAndIsFoundByIt) {
  for (const auto list : {measured_quantities(), moved_quantities()}) {
    for (const NamedQuantity& quantity : list) {
      const std::string name = std::string(quantity.attachment) + "." + std::string(quantity.name);
      EXPECT_EQ(find_quantity(list, name), &quantity) << name;
    }
    EXPECT_EQ(find_quantity(list, "joint"), nullptr);
    EXPECT_EQ(find_quantity(list, "joint.angles"), nullptr);
    EXPECT_EQ(find_quantity(list, ""), nullptr);
  }
}

TEST(DbcNode, AnglesOfAnInertialSensorAreNoseUpAndLeftSideUp) {
  const auto of = [](std::string_view name, const ImuSample& sample) {
    return Attachment<ImuBackend>::measured()[find_quantity(measured_quantities(), name)->index].of(
        sample);
  };
  ImuSample sample;
  sample.specific_force_mps2 = {9.80665 * std::sin(0.1), 0.0, 9.80665 * std::cos(0.1)};
  EXPECT_NEAR(of("inertial.pitch", sample), 0.1, 1e-12);
  sample.specific_force_mps2 = {0.0, 9.80665 * std::sin(0.1), 9.80665 * std::cos(0.1)};
  EXPECT_NEAR(of("inertial.roll", sample), 0.1, 1e-12);
}

}  // namespace
}  // namespace rigwire::emulators
