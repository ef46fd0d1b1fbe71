#include "emulators/iso_valve/iso_valves.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <stdexcept>

#include "protocols/j1939/message.h"
#include "protocols/vehicle/joystick.h"
#include "recorder.h"

namespace rigwire::emulators {
namespace {

namespace iso = protocols::iso11783;
namespace j1939 = protocols::j1939;
namespace vehicle = protocols::vehicle;
using namespace std::chrono_literals;
using protocols::can::Frame;
using ::testing::Each;

constexpr SimTime iso_valves_at(Duration since_start) {
  return kStart + since_start;
}
constexpr std::uint8_t kIsoController = 0x26;

class IsoValvesTest : public ::testing::Test {
 protected:
  explicit IsoValvesTest(const IsoValveSettings& settings = {}) : valves_(settings, output_) {
    valves_.advance(iso_valves_at(300ms));  // address claimed and kept quiet for 250 ms
    for (unsigned section = 0; section < 4; ++section) {
      command(300ms, section, 0.0);
    }
  }

  void command(Duration now, unsigned valve, double share) {
    iso::AuxiliaryValveCommand message;
    message.flow_share = std::abs(share);
    message.resolution = 0;
    message.state = static_cast<std::uint8_t>(share > 0.0   ? iso::ValveState::extend
                                              : share < 0.0 ? iso::ValveState::retract
                                                            : iso::ValveState::neutral);
    message.fail_safe = 0;
    valves_.receive(iso_valves_at(now), iso::encode(valve, message, kIsoController));
  }
  double opening(std::size_t section) const { return valves_.command().opening[section]; }
  iso::AuxiliaryValveEstimate estimate(unsigned valve) const {
    return *iso::decode<iso::AuxiliaryValveEstimate>(valve, output_.of(65040 + valve).back());
  }

  test::FrameRecorder output_;
  IsoValves valves_;
};

TEST_F(IsoValvesTest, ClaimsItsAddressBeforeItSaysAnything) {
  EXPECT_EQ(j1939::identify(output_.frames.front().second)->pgn, j1939::kAddressClaimedPgn);
  const auto flows = output_.times(65040);
  EXPECT_TRUE(flows.empty() || flows.front() >= iso_valves_at(250ms));
  EXPECT_TRUE(valves_.address_held());
}

TEST_F(IsoValvesTest, WithoutSupplySpoolsAreNeutralAndMoveAgainOnlyAfterNeutral) {
  command(400ms, 1, 0.5);
  EXPECT_GT(opening(1), 0.4);
  valves_.supply().begin({{450ms, 500ms}, NoSupplyFault{}});
  valves_.advance(iso_valves_at(460ms));
  EXPECT_EQ(opening(1), 0.0);
  output_.frames.clear();
  command(500ms, 1, 0.5);
  valves_.advance(iso_valves_at(949ms));
  EXPECT_TRUE(output_.frames.empty());
  EXPECT_EQ(opening(1), 0.0);
  valves_.advance(iso_valves_at(1300ms));
  ASSERT_FALSE(output_.frames.empty());
  EXPECT_EQ(j1939::identify(output_.frames.front().second)->pgn, j1939::kAddressClaimedPgn);
  EXPECT_TRUE(valves_.address_held());
  command(1310ms, 1, 0.5);
  EXPECT_EQ(opening(1), 0.0) << "it moves before it was told neutral";
  command(1320ms, 1, 0.0);
  command(1330ms, 1, 0.5);
  EXPECT_GT(opening(1), 0.4);
}

/// A client that asks the block alone and takes its answer by transport.
class AskedIsoValves : public IsoValvesTest {
 protected:
  static IsoValveSettings named() {
    IsoValveSettings settings;
    settings.serial = 4711;
    settings.identification.make = "Maker";
    settings.identification.model = "VB4";
    settings.identification.unit_number = "unit 7";
    settings.identification.software = "2.13";
    settings.identification.part_number = "1234-5";
    settings.identification.hardware = "C";
    return settings;
  }
  AskedIsoValves() : IsoValvesTest(named()) {}

  /// Empty when there was no answer but a negative acknowledgement.
  std::string asked(std::uint32_t pgn) {
    const std::uint8_t block = valves_.address();
    output_.frames.clear();
    now_ += 10ms;
    valves_.receive(iso_valves_at(now_), j1939::make_request(kIsoController, block, pgn));
    const auto single = output_.of(pgn);
    if (!single.empty()) {
      const auto payload = single[0].payload();
      return {payload.begin(), payload.end()};
    }
    const auto opened = output_.of(j1939::kTransportManagementPgn);
    if (opened.empty()) {
      EXPECT_EQ(output_.of(j1939::kAcknowledgementPgn).size(), 1U);
      return {};
    }
    EXPECT_EQ(j1939::identify(opened[0])->destination, kIsoController);
    const auto request = j1939::decode_transport_management(opened[0].payload());
    EXPECT_EQ(request->pgn, pgn);
    j1939::TransportManagement clear;
    clear.control = j1939::TransportControl::clear_to_send;
    clear.packets = request->packets;
    clear.next = 1;
    clear.pgn = pgn;
    now_ += 1ms;
    valves_.receive(iso_valves_at(now_),
                    j1939::make_transport_management(kIsoController, block, clear));
    now_ += 200ms;
    valves_.advance(iso_valves_at(now_));
    j1939::TransportManagement end = *request;
    end.control = j1939::TransportControl::end_of_message;
    valves_.receive(iso_valves_at(now_),
                    j1939::make_transport_management(kIsoController, block, end));
    std::string text;
    for (const Frame& packet : output_.of(j1939::kTransportDataPgn)) {
      text.append(packet.data.begin() + 1, packet.data.end());
    }
    EXPECT_GE(text.size(), request->size);
    return text.substr(0, request->size);
  }

  Duration now_ = 310ms;
};

TEST_F(AskedIsoValves, SaysWhoItIsAsIso11783Asks) {
  EXPECT_EQ(asked(65242),
            "\x01"
            "2.13*");
  EXPECT_EQ(asked(65259), "Maker*VB4*4711*unit 7*");
  EXPECT_EQ(asked(64965), "1234-5*4711**auxiliary valve control*Maker*C*");
  const std::string functionalities{'\xFF', 1, 0, 1, 1, 0, '\xFF', '\xFF'};
  EXPECT_EQ(asked(64654), functionalities);
  EXPECT_EQ(asked(65000), "") << "a group that it does not have is refused";
}

TEST_F(AskedIsoValves, TellsEverybodyWhoItIsByBroadcast) {
  output_.frames.clear();
  valves_.receive(iso_valves_at(310ms),
                  j1939::make_request(kIsoController, j1939::kGlobalAddress, 65259));
  valves_.advance(iso_valves_at(900ms));
  // Its trouble codes follow, as nobody commands the valves any more.
  const auto opened = output_.of(j1939::kTransportManagementPgn);
  ASSERT_EQ(opened.size(), 2U);
  EXPECT_EQ(j1939::identify(opened[0])->destination, j1939::kGlobalAddress);
  EXPECT_EQ(j1939::decode_transport_management(opened[0].payload())->pgn, 65259U);
  EXPECT_EQ(j1939::decode_transport_management(opened[0].payload())->packets, 4);
  EXPECT_EQ(j1939::decode_transport_management(opened[1].payload())->pgn, vehicle::kDm1Pgn);
}

TEST_F(IsoValvesTest, ACommandMovesItsSectionAtTheInstantOfItsFrame) {
  command(310ms, 1, 0.4);
  EXPECT_NEAR(opening(1), 0.4, 1e-12);
  EXPECT_EQ(valves_.command().time, iso_valves_at(310ms));
  command(320ms, 1, -1.0);
  EXPECT_DOUBLE_EQ(opening(1), -1.0);
}

TEST_F(IsoValvesTest, EveryValveReportsThreeMessagesEach100ms) {
  for (int i = 1; i <= 10; ++i) {
    for (unsigned valve = 0; valve < 4; ++valve) {
      command(300ms + i * 100ms, valve, 0.2);
    }
  }
  output_.frames.clear();
  valves_.advance(iso_valves_at(1300ms));
  valves_.advance(iso_valves_at(2300ms));
  for (unsigned valve = 0; valve < 4; ++valve) {
    for (const std::uint32_t first : {65040U, 65056U, 65312U}) {
      const auto sent = output_.times(first + valve);
      ASSERT_EQ(sent.size(), 10U) << first + valve;
      for (std::size_t i = 1; i < sent.size(); ++i) {
        EXPECT_EQ(sent[i] - sent[i - 1], 100ms);
      }
    }
  }
  EXPECT_EQ(output_.of(65044).size(), 0U) << "a valve that is not fitted";
  EXPECT_DOUBLE_EQ(valves_.nominal_rate_hz(), 121.0);
}

TEST_F(IsoValvesTest, SilenceIsNeutralAfterTheTimeOutAndTheReportSaysWhy) {
  command(400ms, 2, 0.7);
  valves_.advance(iso_valves_at(700ms) - 1ns);
  EXPECT_NEAR(opening(2), 0.7, 0.002);
  valves_.advance(iso_valves_at(900ms));
  EXPECT_DOUBLE_EQ(opening(2), 0.0);
  EXPECT_EQ(valves_.command().time, iso_valves_at(700ms));
  EXPECT_EQ(estimate(2).exit_reason, static_cast<std::uint8_t>(iso::ValveExit::command_timeout));
}

TEST_F(IsoValvesTest, WithoutItsAddressNothingMoves) {
  command(310ms, 0, 1.0);
  ASSERT_DOUBLE_EQ(opening(0), 1.0);
  for (unsigned address = 128; address < 248; ++address) {  // everybody else has a lower NAME
    valves_.receive(iso_valves_at(320ms),
                    j1939::make_address_claim(static_cast<std::uint8_t>(address), address - 127U));
  }
  EXPECT_FALSE(valves_.address_held());
  EXPECT_THAT(valves_.command().opening, Each(0.0));
}

TEST_F(IsoValvesTest, MeasuredFlowCarriesPressuresAndPosition) {
  ValveSample sample;
  sample.time = iso_valves_at(305ms);
  sample.spool_position[1] = -0.25;
  sample.port_a_pressure_pa[1] = 12.5e6;
  valves_.update(sample);
  valves_.advance(iso_valves_at(450ms));
  const auto flow = *iso::decode<iso::AuxiliaryValveMeasuredFlow>(1, output_.of(65057).back());
  EXPECT_NEAR(flow.extend_share, -0.25, 0.005);
  EXPECT_NEAR(flow.retract_share, 0.25, 0.005);
  EXPECT_NEAR(flow.extend_pressure_pa, 12.5e6, 2.5e3);
  EXPECT_TRUE(std::isnan(flow.return_pressure_pa));
  const auto position =
      *iso::decode<iso::AuxiliaryValveMeasuredPosition>(1, output_.of(65313).back());
  EXPECT_NEAR(position.position_share, -0.25, 0.0005);
  EXPECT_NEAR(position.position_m, -0.25 * 0.007, 0.5e-6);
}

TEST_F(IsoValvesTest, RequestsAreAnsweredAndUnknownOnesRefused) {
  output_.frames.clear();
  valves_.receive(iso_valves_at(301ms), j1939::make_request(kIsoController, 0x80, 65042));
  EXPECT_EQ(output_.of(65042).size(), 1U);
  valves_.receive(iso_valves_at(301ms),
                  j1939::make_request(kIsoController, 0x80, 65045));  // not fitted
  EXPECT_EQ(output_.of(j1939::kAcknowledgementPgn).size(), 1U);
}

class FaultyIsoValves : public IsoValvesTest {
 protected:
  static IsoValveSettings settings() {
    IsoValveSettings settings;
    settings.amplifier.defects = {{{1s, 1s}, OpenCoilDefect{1}}};
    return settings;
  }
  FaultyIsoValves() : IsoValvesTest(settings()) {}

  void keep(Duration from, Duration to, double boom) {
    for (Duration now = from; now < to; now += 100ms) {
      command(now, 0, 0.5);
      command(now, 1, boom);
      command(now, 2, 0.0);
      command(now, 3, 0.0);
    }
  }
};

TEST_F(FaultyIsoValves, AFaultStopsEverythingUntilItsValveIsCommandedNeutral) {
  keep(400ms, 2500ms, 0.5);
  EXPECT_EQ(valves_.amplifier().fault(), ValveFault::open_coil);
  EXPECT_EQ(valves_.amplifier().fault_section(), 1U);
  EXPECT_THAT(valves_.command().opening, Each(0.0));
  EXPECT_EQ(estimate(1).state, static_cast<std::uint8_t>(iso::ValveState::error));
  const auto dm1 = vehicle::decode_trouble_report(output_.of(vehicle::kDm1Pgn).back().payload());
  ASSERT_EQ(dm1->count, 1U);
  EXPECT_EQ(dm1->codes[0].spn, 520193U);
  EXPECT_EQ(dm1->codes[0].failure_mode, 5);
  command(2500ms, 1, 0.0);
  EXPECT_EQ(valves_.amplifier().fault(), ValveFault::none);
  EXPECT_DOUBLE_EQ(opening(0), 0.0) << "another valve went on by itself";
  command(2510ms, 0, 0.5);
  EXPECT_DOUBLE_EQ(opening(0), 0.0);
  command(2520ms, 0, 0.0);
  command(2530ms, 0, 0.5);
  EXPECT_NEAR(opening(0), 0.5, 1e-12);
}

TEST_F(FaultyIsoValves, WhatWasWrongIsToldOnRequestAndCleared) {
  const auto asked = [this](Duration now, std::uint32_t pgn) {
    output_.frames.clear();
    valves_.receive(iso_valves_at(now),
                    j1939::make_request(kIsoController, valves_.address(), pgn));
    const auto reports = output_.of(pgn);
    return reports.empty() ? vehicle::TroubleCodes{}
                           : *vehicle::decode_trouble_report(reports.back().payload());
  };
  EXPECT_EQ(asked(310ms, vehicle::kDm2Pgn).count, 0U);
  keep(400ms, 2500ms, 0.5);
  EXPECT_EQ(asked(2500ms, vehicle::kDm2Pgn).count, 0U) << "it is active";
  EXPECT_TRUE(asked(2500ms, vehicle::kDm1Pgn).lamps.red_stop);
  command(2510ms, 1, 0.0);
  const auto was = asked(2520ms, vehicle::kDm2Pgn);
  ASSERT_EQ(was.count, 1U);
  EXPECT_EQ(was.codes[0], (vehicle::TroubleCode{520193, 5, 1}));
  EXPECT_FALSE(was.lamps.amber_warning);
  (void)asked(2530ms, vehicle::kDm3Pgn);
  const auto acknowledged = output_.of(j1939::kAcknowledgementPgn);
  ASSERT_EQ(acknowledged.size(), 1U);
  EXPECT_EQ(acknowledged[0].data[0], static_cast<std::uint8_t>(j1939::Acknowledge::positive));
  EXPECT_EQ(asked(2540ms, vehicle::kDm2Pgn).count, 0U);
}

TEST_F(IsoValvesTest, EachSilenceIsAnOccurrenceUntilTheyAreCountedAnew) {
  const auto occurrences = [this](Duration now) {
    valves_.receive(iso_valves_at(now),
                    j1939::make_request(kIsoController, 0x80, vehicle::kDm1Pgn));
    const auto dm1 = vehicle::decode_trouble_report(output_.of(vehicle::kDm1Pgn).back().payload());
    for (const vehicle::TroubleCode& code : dm1->codes) {
      if (code.spn == 520224) {
        return int{code.occurrences};
      }
    }
    return 0;
  };
  const auto only_first_is_silent = [this](Duration from, Duration to) {
    for (Duration now = from; now <= to; now += 100ms) {
      for (unsigned section = 1; section < 4; ++section) {
        command(now, section, 0.0);
      }
    }
  };
  only_first_is_silent(400ms, 700ms);
  EXPECT_EQ(occurrences(710ms), 1);
  command(720ms, 0, 0.0);
  only_first_is_silent(800ms, 1200ms);
  EXPECT_EQ(occurrences(1210ms), 2);
  valves_.receive(iso_valves_at(1220ms),
                  j1939::make_request(kIsoController, 0x80, vehicle::kDm11Pgn));
  EXPECT_EQ(occurrences(1230ms), 1) << "it is still silent";
}

TEST_F(IsoValvesTest, TroubleCodesAreAmongItsMessages) {
  const auto messages = valves_.messages("valves");
  for (const std::uint32_t pgn : {vehicle::kDm1Pgn, vehicle::kDm2Pgn}) {
    EXPECT_TRUE(std::ranges::any_of(messages, [pgn](const auto& message) {
      return j1939::unpack(message.id).pgn == pgn && message.sender == "valves";
    })) << pgn;
  }
}

class LeverIsoValves : public IsoValvesTest {
 protected:
  static IsoValveSettings settings() {
    IsoValveSettings settings;
    settings.levers[static_cast<std::size_t>(JoystickAxis::x1)] = "swing";
    settings.levers[static_cast<std::size_t>(JoystickAxis::y2)] = "-boom";
    return settings;
  }
  LeverIsoValves() : IsoValvesTest(settings()) {}

  template <class Stick>
  void move(Duration now, double x, double y) {
    Stick stick;
    const auto xs = vehicle::axis_switches(x);
    const auto ys = vehicle::axis_switches(y);
    stick.x_neutral = xs.neutral;
    stick.x_negative = xs.negative;
    stick.x_positive = xs.positive;
    stick.x_share = std::abs(x);
    stick.y_neutral = ys.neutral;
    stick.y_negative = ys.negative;
    stick.y_positive = ys.positive;
    stick.y_share = std::abs(y);
    valves_.receive(iso_valves_at(now), vehicle::encode(stick, 0x13));
  }
};

TEST_F(LeverIsoValves, TheSticksMoveTheSectionsThatTheyAreMappedTo) {
  move<vehicle::Bjm1>(310ms, 0.0, 0.0);
  move<vehicle::Bjm2>(310ms, 0.0, 0.0);
  move<vehicle::Bjm1>(330ms, -0.6, 1.0);
  move<vehicle::Bjm2>(330ms, 1.0, 0.25);
  EXPECT_NEAR(opening(0), -0.6, 1e-12);
  EXPECT_NEAR(opening(1), -0.25, 1e-12);
  EXPECT_DOUBLE_EQ(opening(2), 0.0);
  valves_.advance(iso_valves_at(630ms));
  EXPECT_THAT(valves_.command().opening, Each(0.0)) << "silent levers";
}

TEST_F(LeverIsoValves, SwitchesThatContradictEachOtherAreNoLever) {
  move<vehicle::Bjm1>(310ms, 0.0, 0.0);
  vehicle::Bjm1 both;
  both.x_negative = vehicle::Switch::on;
  both.x_positive = vehicle::Switch::on;
  both.x_share = 1.0;
  valves_.receive(iso_valves_at(320ms), vehicle::encode(both, 0x13));
  EXPECT_DOUBLE_EQ(opening(0), 0.0);
}

TEST(IsoValveSettingsTest, OutOfRangeIsRefusedByName) {
  const auto expect_refused = [](auto change, const char* name) {
    IsoValveSettings settings;
    change(settings);
    try {
      validate(settings);
      ADD_FAILURE() << name << " was taken";
    } catch (const std::invalid_argument& error) {
      EXPECT_THAT(error.what(), ::testing::HasSubstr(name));
    }
  };
  using Settings = IsoValveSettings;
  expect_refused([](Settings& s) { s.source_address = 12; },
                 "source_address: found 12, allowed 128 .. 247");
  expect_refused([](Settings& s) { s.first_valve = 13; }, "first_valve");
  expect_refused([](Settings& s) { s.levers[0] = "arm"; }, "joysticks");
  expect_refused([](Settings& s) { s.command_timeout = 10ms; }, "command_timeout");
  expect_refused([](Settings& s) { s.general_purpose_section = 5; }, "general_purpose_section");
  expect_refused([](Settings& s) { s.spool_travel_m = std::nan(""); }, "spool_travel");
  validate(Settings{});
}

}  // namespace
}  // namespace rigwire::emulators
