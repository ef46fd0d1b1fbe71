// Nodes whose program is slow, or refuses what it is told: what each does on its bus.
#include "emulators/firmware_fault.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "canopen/encoder_rig.h"
#include "emulators/dbc_node/dbc_traffic.h"
#include "emulators/engine_controller/engine_controller.h"
#include "emulators/iso_valve/iso_valves.h"
#include "emulators/xsens/mti_600.h"
#include "openimu/rig.h"
#include "protocols/canopen/lss.h"
#include "vehicle_gateway/requests.h"

namespace rigwire::emulators {
namespace {

namespace canopen = protocols::canopen;
namespace iso = protocols::iso11783;
namespace j1939 = protocols::j1939;
namespace openimu = protocols::openimu;
namespace vehicle = protocols::vehicle;
using protocols::can::Frame;
using testing::ElementsAre;

PaceFault slow(double share, SimTime from, Duration length, Duration ramp = 0s) {
  return {{.at = from - kStart, .length = length}, SlowNodeFault{share, ramp}};
}
RefusalFault refuses(SimTime from, Duration length) {
  return {{.at = from - kStart, .length = length}, RefusingNodeFault{}};
}

TEST(Pace, EachMessageIsThinnedByItselfAndEvenly) {
  Pace pace;
  pace.begin(slow(0.4, kStart + 1s, 1s));
  const auto sent = [&](std::uint32_t message, SimTime from) {
    std::string all;
    for (int i = 0; i < 10; ++i) {
      all += pace.has_time(from + i * 1ms, message) ? '1' : '0';
    }
    return all;
  };
  EXPECT_EQ(sent(7, kStart + 980ms), "1111111111");
  EXPECT_EQ(sent(7, kStart + 1s), "0010100101");
  EXPECT_EQ(sent(8, kStart + 1s), "0010100101") << "counted by itself";
  EXPECT_EQ(sent(7, kStart + 2s), "1111111111");
}

TEST(Pace, GrowsFromAllToItsShare) {
  Pace pace;
  pace.begin(slow(0.1, kStart, 20s, 10s));
  const auto sent = [&](SimTime from) {
    int count = 0;
    for (SimTime now = from; now < from + 2s; now += 1ms) {
      count += pace.has_time(now, 1) ? 1 : 0;
    }
    return count;
  };
  EXPECT_NEAR(sent(kStart), 2000 * 0.91, 2);  // the mean of 1 and 0.82
  EXPECT_NEAR(sent(kStart + 8s), 2000 * 0.19, 2);
  EXPECT_NEAR(sent(kStart + 12s), 2000 * 0.1, 2);
}

// CANopen.

std::size_t count(const test::FrameRecorder& output, std::uint32_t id) {
  return output.with_id(id).size();
}

TEST(SlowNode, EncoderSendsAShareOfItsPdosAndEveryHeartbeat) {
  RotaryEncoderSettings settings = EncoderRig::settings();
  settings.event_timer_ms = 10;
  settings.heartbeat_ms = 100;
  EncoderRig rig(settings);
  rig.start();
  const auto over_a_second = [&] {
    rig.output.frames.clear();
    rig.run(1s);
    return std::pair(count(rig.output, 0x180 + EncoderRig::kNode),
                     count(rig.output, 0x700 + EncoderRig::kNode));
  };
  rig.device.pace().begin(slow(0.25, rig.now, 1s));
  EXPECT_EQ(over_a_second(), (std::pair<std::size_t, std::size_t>(25, 10)));
  EXPECT_EQ(over_a_second(), (std::pair<std::size_t, std::size_t>(100, 10)));
}

TEST(SlowNode, EncoderTellsAChangeLater) {
  RotaryEncoderSettings settings = EncoderRig::settings();
  settings.event_timer_ms = 0;
  settings.transmission_type = canopen::kOnChange;
  EncoderRig rig(settings);
  rig.start();
  rig.device.pace().begin(slow(0.1, rig.now, 1s));
  rig.output.frames.clear();
  rig.angle_rad = 1.0;
  rig.run(18ms);  // nine looks
  EXPECT_EQ(count(rig.output, 0x180 + EncoderRig::kNode), 0U);
  rig.run(2ms);
  EXPECT_EQ(count(rig.output, 0x180 + EncoderRig::kNode), 1U);
}

TEST(RefusingNode, EncoderAbortsWhatIsWrittenAndIsReadAndManaged) {
  EncoderRig rig;
  rig.start();
  rig.device.refusal().begin(refuses(rig.now, 1s));
  constexpr auto kState = static_cast<std::uint32_t>(canopen::SdoAbort::not_in_this_state);
  static_assert(kState == 0x08000022);
  EXPECT_EQ(rig.write(0x1017, 0, 250, 2), kState);
  EXPECT_EQ(rig.write(0x1010, 1, canopen::kSaveSignature, 4), kState);
  EXPECT_TRUE(rig.memory.content().empty()) << "it has been saved";
  EXPECT_EQ(rig.read(0x1017) & 0xFFFFU, 0U);
  // What is wrong whatever the state is said first.
  EXPECT_EQ(rig.write(0x1000, 0, 0, 4), 0x06010002U);
  EXPECT_EQ(rig.write(0x3FFF, 0, 0, 4), 0x06020000U);
  EXPECT_FALSE(rig.device.configure(rig.now, {0x1017, 0}, 250).empty());
  rig.command(canopen::NetworkCommand::enter_pre_operational);
  EXPECT_EQ(rig.device.node().state(), canopen::NodeState::pre_operational);
  rig.run(1s);
  EXPECT_EQ(rig.write(0x1017, 0, 250, 2), 0U);
  EXPECT_EQ(rig.read(0x1017) & 0xFFFFU, 250U);
}

TEST(RefusingNode, EncoderTakesNoNodeIdByLayerSetting) {
  EncoderRig rig;
  rig.boot();
  const auto ask = [&](canopen::LssCommand command, std::uint8_t value) {
    canopen::LssPayload payload{static_cast<std::uint8_t>(command), value};
    rig.receive(canopen::kLssRequestId, payload);
    return rig.output.frames.back().second.data[1];
  };
  canopen::LssPayload all{static_cast<std::uint8_t>(canopen::LssCommand::switch_state_global), 1};
  rig.receive(canopen::kLssRequestId, all);
  rig.device.refusal().begin(refuses(rig.now, 1s));
  EXPECT_EQ(ask(canopen::LssCommand::configure_node_id, 5), 255);
  EXPECT_EQ(ask(canopen::LssCommand::store_configuration, 0), 255);
  EXPECT_TRUE(rig.memory.content().empty());
  EXPECT_EQ(ask(canopen::LssCommand::inquire_node_id, 0), EncoderRig::kNode);
  rig.run(1s);
  EXPECT_EQ(ask(canopen::LssCommand::configure_node_id, 5), 0);
}

// OpenIMU.

constexpr std::uint8_t kTester = 0x55;

TEST(SlowNode, OpenImuSendsAShareOfEachPacketAndAnswersAtOnce) {
  OpenImuRig rig;
  rig.run(1s);
  rig.imu.pace().begin(slow(0.5, rig.now, 1s));
  rig.output.frames.clear();
  rig.run(1s);
  for (const std::uint32_t pgn :
       {openimu::kSlopePgn, openimu::kAngularRatePgn, openimu::kAccelerationPgn}) {
    EXPECT_EQ(rig.output.of(pgn).size(), 50U) << pgn;
  }
  rig.output.frames.clear();
  rig.run(1s);
  EXPECT_EQ(rig.output.of(openimu::kSlopePgn).size(), 100U);
  rig.imu.pace().begin(slow(0.01, rig.now, 1s));
  rig.output.frames.clear();
  rig.receive(j1939::make_request(kTester, 0x80, openimu::kSlopePgn));
  EXPECT_EQ(rig.output.of(openimu::kSlopePgn).size(), 1U) << "a request waits for nothing";
}

TEST(RefusingNode, OpenImuKeepsItsSettingsAndSaysThatSavingFailed) {
  for (const OpenImuVariant variant :
       {OpenImuVariant::openimu335ri, OpenImuVariant::openimu300ri}) {
    OpenImuRig rig(settings_with(0x12341, variant));
    rig.run(1100ms);  // the 300RI claims every second
    rig.imu.refusal().begin(refuses(rig.now, 1s));
    const OpenImuConfiguration before = rig.imu.configuration();
    const auto set = [&](openimu::SettingKind kind, std::uint8_t first) {
      rig.receive(openimu::make_setting({kind, rig.imu.address(), first, 10, 0}, kTester));
    };
    rig.output.frames.clear();
    set(openimu::SettingKind::packet_rate, 2);
    set(openimu::SettingKind::filters, 5);
    EXPECT_TRUE(rig.output.frames.empty()) << "as for a value that it does not take";
    EXPECT_EQ(rig.imu.configuration(), before);
    set(openimu::SettingKind::save_configuration, 0);
    ASSERT_EQ(rig.output.frames.size(), 1U);
    EXPECT_THAT(rig.output.frames[0].second.payload().first(3), ElementsAre(1, kTester, 0));
    rig.run(1s);
    set(openimu::SettingKind::packet_rate, 2);
    EXPECT_EQ(rig.imu.configuration().rate_divider, 2);
  }
}

TEST(RefusingNode, OpenImuKeepsItsTroublesAndItsBanks) {
  OpenImuRig rig;
  rig.run(1s);
  rig.imu.refusal().begin(refuses(rig.now, 1s));
  rig.output.frames.clear();
  Frame clear;
  clear.extended = true;
  clear.id = j1939::pack(j1939::Identifier{6, openimu::kClearTroublePgn, 0xFF, kTester});
  rig.receive(clear);
  ASSERT_EQ(rig.output.frames.size(), 1U);
  EXPECT_EQ(rig.output.frames[0].second.data[0], 1) << "negative acknowledgement";
  const openimu::CommandMap before = rig.imu.configuration().commands;
  const std::array<std::uint8_t, 8> bank{rig.imu.address(), 0x60, 0x61, 0x62, 0x63, 0, 0, 0};
  rig.receive(j1939::make_frame({6, openimu::kBank0Pgn, 0xFF, kTester}, bank));
  EXPECT_EQ(rig.imu.configuration().commands, before);
}

// J1939 devices.

/// The control byte of the acknowledgement of group `pgn`; nothing without exactly one.
std::optional<std::uint8_t> acknowledged(const test::FrameRecorder& output, std::uint32_t pgn) {
  std::optional<std::uint8_t> control;
  for (const Frame& frame : output.of(j1939::kAcknowledgementPgn)) {
    const std::uint32_t of = frame.data[5] | static_cast<std::uint32_t>(frame.data[6]) << 8U |
                             static_cast<std::uint32_t>(frame.data[7]) << 16U;
    if (of == pgn) {
      EXPECT_FALSE(control) << "acknowledged twice";
      control = frame.data[0];
    }
  }
  return control;
}
constexpr std::uint8_t kNegative = 1;
constexpr std::uint8_t kPositive = 0;

TEST(RefusingNode, GatewayRefusesCommandsAndTheirTimeOutsFollow) {
  VehicleRig rig;
  rig.run(500ms);
  rig.ask(parking(false));
  rig.ask(gear(1));
  ASSERT_FALSE(rig.command().parking_brake);
  rig.gateway.refusal().begin(refuses(rig.now, 3s));
  rig.output.frames.clear();
  rig.ask(gear(2));
  rig.ask(torque(0.5));
  rig.ask(parking(true));
  EXPECT_EQ(rig.command().gear, 1);
  EXPECT_EQ(rig.command().engine_torque_share, 0.0);
  EXPECT_FALSE(rig.command().parking_brake);
  EXPECT_EQ(acknowledged(rig.output, vehicle::Tsc1::kGroup.pgn), kNegative);
  EXPECT_EQ(acknowledged(rig.output, vehicle::Tc1::kGroup.pgn), kNegative);
  EXPECT_EQ(acknowledged(rig.output, vehicle::MachineFunctionCommand::kGroup.pgn), kNegative);
  // To everybody nobody says no.
  rig.output.frames.clear();
  rig.receive(vehicle::encode(gear(2), kController, j1939::kGlobalAddress));
  EXPECT_EQ(acknowledged(rig.output, vehicle::Tc1::kGroup.pgn), std::nullopt);
  EXPECT_EQ(rig.command().gear, 1);
  for (int i = 0; i < 100; ++i) {
    rig.ask(gear(2));
    rig.run(10ms);
  }
  EXPECT_TRUE(rig.gateway.control().troubles().is_active(1)) << "nobody has asked for a gear";
  rig.run(3s);
  rig.ask(gear(2));
  EXPECT_EQ(rig.command().gear, 2);
}

TEST(RefusingNode, GatewayKeepsItsTroubleCodesAndItsAddress) {
  VehicleRig rig;
  rig.run(500ms);
  rig.gateway.refusal().begin(refuses(rig.now, 1s));
  const auto clear = [&] {
    rig.output.frames.clear();
    rig.receive(j1939::make_request(kController, rig.gateway.address(), vehicle::kDm3Pgn));
    return acknowledged(rig.output, vehicle::kDm3Pgn);
  };
  EXPECT_EQ(clear(), kNegative);
  EXPECT_FALSE(rig.gateway.command_address(rig.now, 0x55).empty());
  const auto command = [&] {
    const auto bytes = j1939::encode_commanded_address({rig.gateway.name(), 0x55});
    j1939::TransportManagement announce;
    announce.control = j1939::TransportControl::broadcast;
    announce.size = static_cast<std::uint16_t>(bytes.size());
    announce.packets = 2;
    announce.pgn = j1939::kCommandedAddressPgn;
    rig.receive(j1939::make_transport_management(kController, j1939::kGlobalAddress, announce));
    for (std::uint8_t packet = 1; packet <= 2; ++packet) {
      rig.receive(j1939::make_transport_data(kController, j1939::kGlobalAddress, bytes, packet));
    }
    rig.run(500ms);
    return rig.gateway.address();
  };
  EXPECT_EQ(command(), 0x00);
  rig.run(1s);
  EXPECT_EQ(command(), 0x55) << "the same command, later";
  EXPECT_EQ(clear(), kPositive);
}

TEST(SlowNode, GatewaySendsAShareOfItsSchedule) {
  VehicleRig rig;
  rig.run(1s);
  const auto over_two_seconds = [&] {
    rig.output.frames.clear();
    rig.run(2s);
    return std::pair(rig.output.of(vehicle::Eec1::kGroup.pgn).size(),
                     rig.output.of(vehicle::Et1::kGroup.pgn).size());
  };
  const auto usual = over_two_seconds();
  EXPECT_GT(usual.second, 1U);
  rig.gateway.pace().begin(slow(0.5, rig.now, 2s));
  const auto thinned = over_two_seconds();
  EXPECT_EQ(thinned.first, usual.first / 2);
  EXPECT_EQ(thinned.second, usual.second / 2);
  EXPECT_EQ(rig.output.of(vehicle::kDm1Pgn).size(), 2U) << "every second, whatever else it does";
  EXPECT_EQ(over_two_seconds(), usual);
}

TEST(EngineControllerProgram, IsSlowAndRefusesTorqueAndSpeedRequests) {
  test::FrameRecorder output;
  EngineController engine({}, output);
  SimTime now = kStart;
  const auto run = [&](Duration span) {
    for (const SimTime end = now + span; now < end; now += 10ms) {
      PowerUnitSample sample;
      sample.time = now;
      engine.update(sample);
    }
    engine.advance(now - 1ns);
  };
  run(500ms);
  vehicle::Tsc1 request = engine_speed(1200 * kRpm);
  request.priority = 2;
  engine.refusal().begin(refuses(now, 1s));
  engine.pace().begin(slow(0.2, now, 1s));
  output.frames.clear();
  engine.receive(now, vehicle::encode(request, kController, engine.address()));
  EXPECT_EQ(engine.command(), PowerUnitCommand{});
  EXPECT_EQ(acknowledged(output, vehicle::Tsc1::kGroup.pgn), kNegative);
  run(1s);
  EXPECT_EQ(output.of(vehicle::Eec1::kGroup.pgn).size(), 10U);
  output.frames.clear();
  run(1s);
  EXPECT_EQ(output.of(vehicle::Eec1::kGroup.pgn).size(), 50U);
  engine.receive(now, vehicle::encode(request, kController, engine.address()));
  EXPECT_NEAR(engine.command().speed_radps.value_or(0.0), 1200 * kRpm, 0.1);
}

// Valves.

struct ValveBlock : testing::Test {
  ValveBlock() {
    block.advance(now);
    command(0.0);
  }
  void command(double share, std::uint8_t source = kController) {
    iso::AuxiliaryValveCommand message;
    message.flow_share = std::abs(share);
    message.resolution = 0;
    message.state =
        static_cast<std::uint8_t>(share > 0.0 ? iso::ValveState::extend : iso::ValveState::neutral);
    message.fail_safe = 0;
    block.receive(now, iso::encode(1, message, source));
  }
  void run(Duration span) { block.advance(now += span); }
  iso::AuxiliaryValveEstimate estimate() const {
    return *iso::decode<iso::AuxiliaryValveEstimate>(1, output.of(65041).back());
  }

  test::FrameRecorder output;
  IsoValves block{{}, output};
  SimTime now = kStart + 300ms;
};

TEST_F(ValveBlock, ThatRefusesGoesToNeutralSaysSoAndWantsNeutralAfterwards) {
  command(0.5);
  run(50ms);
  ASSERT_GT(block.command().opening[1], 0.4);
  block.refusal().begin(refuses(now, 1s));
  for (int i = 0; i < 8; ++i) {
    command(0.5);
    run(100ms);
    EXPECT_EQ(block.command().opening[1], 0.0) << i;
    EXPECT_EQ(estimate().state, static_cast<std::uint8_t>(iso::ValveState::neutral));
    EXPECT_EQ(estimate().exit_reason, static_cast<std::uint8_t>(iso::ValveExit::error));
  }
  run(250ms);
  command(0.5);
  run(50ms);
  EXPECT_EQ(block.command().opening[1], 0.0) << "it has not seen neutral";
  command(0.0);
  command(0.5);
  run(100ms);
  EXPECT_GT(block.command().opening[1], 0.4);
  EXPECT_EQ(estimate().exit_reason, static_cast<std::uint8_t>(iso::ValveExit::none));
}

TEST_F(ValveBlock, ThatIsSlowReportsAShareAndObeys) {
  block.pace().begin(slow(0.5, now, 2s));
  output.frames.clear();
  run(2s);
  EXPECT_EQ(output.of(65040).size(), 10U);
  EXPECT_EQ(output.of(65041).size(), 10U);
  command(0.0);
  command(0.5);
  EXPECT_GT(block.command().opening[1], 0.4);
  output.frames.clear();
  run(2s);
  EXPECT_EQ(output.of(65040).size(), 20U);
}

// Xsens.

TEST(SlowNode, MtiSendsAShareOfEachMessageAndItsIncrementsAreOverTheLongerTime) {
  MtiSettings settings;
  for (MtiOutput& row : settings.outputs) {
    row.divider = row.id == protocols::xsens::MessageId::velocity_increment ? 4 : row.divider;
  }
  const Calendar calendar{UtcTime{2026, 6, 1, 8, 30, 59, 0}};
  test::FrameRecorder output;
  Mti600 mti(settings, calendar, output);
  SimTime now = kStart;
  const auto run = [&](Duration span) {
    output.frames.clear();
    for (const SimTime end = now + span; now < end; now += Mti600::kTick) {
      mti.update({now, {0.0, 0.0, kGravity}, {0.0, 0.0, 0.0}, 31.5});
    }
  };
  const auto id = [](protocols::xsens::MessageId of) { return static_cast<std::uint32_t>(of); };
  const auto increment_mps = [&] {
    const auto reading = protocols::xsens::decode(
        output.with_id(id(protocols::xsens::MessageId::velocity_increment)).back().second);
    return std::ldexp(reading->values[2], -static_cast<int>(reading->values[3]));
  };
  run(1s);
  EXPECT_NEAR(increment_mps(), kGravity * 0.01, 1e-3);
  mti.pace().begin(slow(0.25, now, 1s));
  run(1s);
  EXPECT_EQ(count(output, id(protocols::xsens::MessageId::acceleration)), 25U);
  EXPECT_EQ(count(output, id(protocols::xsens::MessageId::status_word)), 25U);
  EXPECT_NEAR(increment_mps(), kGravity * 0.04, 1e-3);
  run(1s);
  EXPECT_EQ(count(output, id(protocols::xsens::MessageId::acceleration)), 100U);
}

// A node of a DBC file.

TEST(SlowNode, DbcNodeSendsAShareOfItsCycles) {
  DbcNodeSettings settings;
  DbcSentMessage message;
  message.layout.name = "state";
  message.layout.id = 0x123;
  message.layout.length = 1;
  message.period = 10ms;
  settings.sent.push_back(message);
  test::FrameRecorder output;
  DbcTraffic traffic(settings, output);
  traffic.pace().begin(slow(0.3, kStart + 1s, 1s));
  const auto sent = [&](SimTime until) {
    output.frames.clear();
    traffic.advance(until - 1ns);
    return output.frames.size();
  };
  (void)sent(kStart + 1s);
  EXPECT_EQ(sent(kStart + 2s), 30U);
  EXPECT_EQ(sent(kStart + 3s), 100U);
}

}  // namespace
}  // namespace rigwire::emulators
