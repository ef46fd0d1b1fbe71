// The suite ubx on our receivers, in their own time: right, with each of their faults, and with one
// thing wrong in what they say or take.
#include "conform/ubx/ubx_suite.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <memory>
#include <string>

#include "emulated_receiver.h"
#include "suite_verdicts.h"

namespace rigwire::conform {
namespace {

using emulators::UbloxSettings;
using testing::Contains;
using testing::IsEmpty;
using testing::StartsWith;

UbloxSettings settings_of(const emulators::UbloxProfile& profile) {
  UbloxSettings settings;
  settings.profile = &profile;
  settings.baud = 115'200;
  return settings;
}

struct Device {
  UbxDevice device;

  explicit Device(UbloxSettings settings, EmulatedReceiver::Saying saying = {},
                  EmulatedReceiver::Hearing hearing = {}) {
    device.open = [=] { return std::make_unique<EmulatedReceiver>(settings, saying, hearing); };
  }
};

SuiteResult judge(Device& device, const UbxClaims& claims,
                  const std::vector<std::string>& wanted = {}) {
  device.device.claims = claims;
  return run_ubx_suite(device.device, {wanted, true, true});
}

struct Receiver {
  const char* name;
  const emulators::UbloxProfile& (*profile)();
  std::size_t least;  ///< Cases that pass.
};
void PrintTo(const Receiver& receiver, std::ostream* out) {
  *out << receiver.name;
}

class UbxSuite : public testing::TestWithParam<Receiver> {};

TEST_P(UbxSuite, OurReceiverIsRight) {
  Device device(settings_of(GetParam().profile()));
  const UbxClaims claims = survey_ubx(device.device);
  EXPECT_EQ(claims.rate_hz, 1.0);
  EXPECT_THAT(claims.messages, testing::IsSupersetOf({"MON-VER", "NAV-PVT", "CFG-RATE"}));
  const SuiteResult result = judge(device, claims);
  EXPECT_THAT(wrong_in(result), IsEmpty());
  EXPECT_GE(result.count(Verdict::pass), GetParam().least);
  EXPECT_EQ(result.count(Verdict::skipped), 0U);
}

INSTANTIATE_TEST_SUITE_P(, UbxSuite,
                         testing::Values(Receiver{"neo_7p", emulators::ublox_neo_7p, 180},
                                         Receiver{"neo_m8", emulators::ublox_neo_m8, 200},
                                         Receiver{"neo_m8t", emulators::ublox_neo_m8t, 200},
                                         Receiver{"zed_f9p", emulators::ublox_zed_f9p, 230}),
                         [](const auto& receiver) { return std::string(receiver.param.name); });

TEST(UbxCases, HaveIdentitiesOfTheirOwn) {
  expect_identities(ubx_cases(), 250);
  for (const UbxCase& each : ubx_cases()) {
    for (const std::string_view needed : each.needs) {
      EXPECT_NE(ubx_message(needed), nullptr) << needed;
    }
  }
}

TEST(UbxCases, NothingIsWrittenWithoutTheOption) {
  int settings = 0;
  const auto hearing = [&](const Bytes& frame) {
    // CFG-MSG, CFG-INF, CFG-PRT, CFG-TP5 and VALGET are polled with a payload.
    const std::size_t payload = frame.size() - protocols::ubx::kOverheadBytes;
    settings += frame.at(2) == 0x06 && frame.at(3) != 0x8B && frame.at(3) != 0xFE && payload > 2;
    return std::pair(frame, Bytes());
  };
  Device device(settings_of(emulators::ublox_zed_f9p()), {}, hearing);
  device.device.claims = survey_ubx(device.device);
  const SuiteResult result = run_ubx_suite(device.device, {});
  EXPECT_GT(result.count(Verdict::skipped), 50U);
  EXPECT_EQ(settings, 0);
}

// --- what is broken is noticed ---

Bytes payload_of(const Bytes& frame) {
  return {frame.begin() + protocols::ubx::kHeaderBytes,
          frame.end() - static_cast<std::ptrdiff_t>(protocols::ubx::kChecksumBytes)};
}

/// Changes the payload of that message whenever it comes.
EmulatedReceiver::Saying changing(std::string_view name,
                                  const std::function<void(Bytes&)>& change) {
  return [id = ubx_message(name)->id, change](const Bytes& frame) {
    if (UbxId{frame.at(2), frame.at(3)} != id) {
      return frame;
    }
    Bytes payload = payload_of(frame);
    change(payload);
    return resealed(frame, payload);
  };
}
/// Adds to the byte of the payload there.
EmulatedReceiver::Saying adding(std::string_view name, std::size_t at, int value) {
  return changing(name, [=](Bytes& payload) {
    payload.at(at) = static_cast<std::uint8_t>(payload.at(at) + value);
  });
}
/// Writes the byte of the payload there.
EmulatedReceiver::Saying writing(std::string_view name, std::size_t at, std::uint8_t value) {
  return changing(name, [=](Bytes& payload) { payload.at(at) = value; });
}

struct Mutant {
  const char* name;
  const char* found_by;  ///< The begin of an identity of those that find it.
  EmulatedReceiver::Saying saying;
  EmulatedReceiver::Hearing hearing = {};
  const emulators::UbloxProfile& (*profile)() = emulators::ublox_neo_m8;
};
void PrintTo(const Mutant& mutant, std::ostream* out) {
  *out << mutant.name;
}

bool is(const Bytes& frame, std::string_view name) {
  return UbxId{frame.at(2), frame.at(3)} == ubx_message(name)->id;
}

Bytes twice(const Bytes& frame) {
  Bytes both = frame;
  both.insert(both.end(), frame.begin(), frame.end());
  return both;
}

/// The data of a setting come behind their acknowledgement.
EmulatedReceiver::Saying late_data() {
  auto held = std::make_shared<Bytes>();
  return [held](const Bytes& frame) {
    if (is(frame, "CFG-RATE")) {
      *held = frame;
      return Bytes();
    }
    Bytes all = frame;
    all.insert(all.end(), held->begin(), held->end());
    held->clear();
    return all;
  };
}

/// A setting of that message is acknowledged and does not arrive.
EmulatedReceiver::Hearing swallowing(std::string_view name, std::size_t longer_than) {
  return [id = ubx_message(name)->id, longer_than](const Bytes& frame) {
    const bool setting = UbxId{frame.at(2), frame.at(3)} == id &&
                         frame.size() > protocols::ubx::kOverheadBytes + longer_than;
    if (!setting) {
      return std::pair(frame, Bytes());
    }
    const Bytes ack{0xB5, 0x62, 0x05, 0x01, 0, 0, 0, 0, 0, 0};
    return std::pair(Bytes(), resealed(ack, {id.message_class, id.message_id}));
  };
}

class UbxMutant : public testing::TestWithParam<Mutant> {};

TEST_P(UbxMutant, IsNoticed) {
  const Mutant& mutant = GetParam();
  Device sound(settings_of(mutant.profile()));
  const UbxClaims claims = survey_ubx(sound.device);
  Device broken(settings_of(mutant.profile()), mutant.saying, mutant.hearing);
  EXPECT_THAT(wrong_in(judge(broken, claims, {mutant.found_by})), testing::Not(IsEmpty()));
}

INSTANTIATE_TEST_SUITE_P(
    , UbxMutant,
    testing::Values(
        Mutant{"wrong_check", "ubx/32.17.6",
               [](const Bytes& frame) {
                 Bytes other = frame;
                 other.back() = static_cast<std::uint8_t>(other.back() ^ 1U);
                 return is(frame, "NAV-DOP") ? other : frame;
               }},
        Mutant{"garbage_between", "ubx/32.2",
               [](const Bytes& frame) {
                 Bytes other{0x00};
                 other.insert(other.end(), frame.begin(), frame.end());
                 return is(frame, "MON-VER") ? other : frame;
               }},
        Mutant{"silent", "ubx/32.2", [](const Bytes&) { return Bytes(); }},
        Mutant{"answers_twice", "ubx/32.2/1",
               [](const Bytes& frame) { return is(frame, "MON-VER") ? twice(frame) : frame; }},
        Mutant{"no_acknowledgement", "ubx/32.5.1",
               [](const Bytes& frame) { return is(frame, "ACK-ACK") ? Bytes() : frame; }},
        Mutant{"acknowledges_twice", "ubx/32.5.1/1",
               [](const Bytes& frame) { return is(frame, "ACK-ACK") ? twice(frame) : frame; }},
        Mutant{"acknowledges_another", "ubx/32.5.1", adding("ACK-ACK", 1, 1)},
        Mutant{"refuses_polls", "ubx/32.5.1",
               [](const Bytes& frame) {
                 Bytes other = frame;
                 other.at(3) = 0x00;
                 return is(frame, "ACK-ACK") ? resealed(other, payload_of(frame)) : frame;
               }},
        Mutant{"accepts_everything", "ubx/32.5.1/3",
               [](const Bytes& frame) {
                 Bytes other = frame;
                 other.at(3) = 0x01;
                 return is(frame, "ACK-NAK") ? resealed(other, payload_of(frame)) : frame;
               }},
        Mutant{"acknowledges_before_data", "ubx/32.10.27/1", late_data()},
        Mutant{"version_too_short", "ubx/32.16.13/1",
               changing("MON-VER", [](Bytes& payload) { payload.pop_back(); })},
        Mutant{"version_without_zeros", "ubx/32.16.13", writing("MON-VER", 39, 'x')},
        Mutant{"no_protocol_version", "ubx/32.16.13",
               changing("MON-VER",
                        [](Bytes& payload) {
                          for (std::size_t at = 40; at < payload.size(); at += 30) {
                            payload[at] = payload[at] == 'P' ? 'Q' : payload[at];
                          }
                        })},
        Mutant{"fix_shortened", "ubx/32.17.17/1",
               changing("NAV-PVT", [](Bytes& payload) { payload.resize(88); })},
        Mutant{"month_13", "ubx/32.17.17", writing("NAV-PVT", 6, 13)},
        Mutant{"fix_of_kind_9", "ubx/32.17.17", writing("NAV-PVT", 20, 9)},
        Mutant{"latitude_by_one", "ubx/epoch/1", adding("NAV-PVT", 28, 1)},
        Mutant{"north_is_south", "ubx/32.17.17",
               changing("NAV-PVT",
                        [](Bytes& payload) {
                          for (std::size_t i = 48; i < 52; ++i) {
                            payload[i] = static_cast<std::uint8_t>(~payload[i]);
                          }
                        })},
        Mutant{"one_satellite_more", "ubx/epoch", adding("NAV-PVT", 23, 1)},
        Mutant{"another_dilution", "ubx/32.17.6", adding("NAV-DOP", 6, 20)},
        Mutant{"another_place_of_the_earth", "ubx/epoch/13", adding("NAV-POSECEF", 4, 100)},
        Mutant{"another_speed_of_the_earth", "ubx/epoch/15", adding("NAV-VELECEF", 4, 60)},
        Mutant{"next_week", "ubx/epoch/8", adding("NAV-TIMEGPS", 8, 1)},
        Mutant{"one_leap_second_less", "ubx/32.17.30", adding("NAV-TIMEGPS", 10, -1)},
        Mutant{"utc_a_microsecond_off", "ubx/epoch/6", adding("NAV-TIMEUTC", 9, 4)},
        Mutant{"status_without_fix", "ubx/epoch/3", writing("NAV-STATUS", 4, 0)},
        Mutant{"fix_before_the_start", "ubx/32.17.24", writing("NAV-STATUS", 11, 0x7F)},
        Mutant{"solution_elsewhere", "ubx/epoch/9", adding("NAV-SOL", 12, 1)},
        Mutant{"speed_without_velocity", "ubx/32.17.34", writing("NAV-VELNED", 21, 0x7F)},
        Mutant{"satellites_uncounted", "ubx/32.17.20/1", adding("NAV-SAT", 5, 1)},
        Mutant{"satellite_twice", "ubx/32.17.20", writing("NAV-SAT", 8 + 12 + 1, 1)},
        Mutant{"used_and_not_tracked", "ubx/32.17.20",
               changing("NAV-SAT",
                        [](Bytes& p) { p.at(16) = static_cast<std::uint8_t>(p.at(16) & 0xF8U); })},
        Mutant{"elevation_of_100", "ubx/32.17.20", writing("NAV-SAT", 8 + 3, 100)},
        Mutant{"usage_of_101", "ubx/32.16.8", writing("MON-RXBUF", 12, 101)},
        Mutant{"period_read_wrongly", "ubx/32.10.27", adding("CFG-RATE", 0, 30)},
        Mutant{"rates_of_another", "ubx/32.10.18", adding("CFG-MSG", 1, 1)},
        Mutant{"port_of_another", "ubx/32.10.25", adding("CFG-PRT", 0, 1)},
        Mutant{"blocks_uncounted", "ubx/32.10.13", adding("CFG-GNSS", 3, 1)},
        Mutant{"pulse_of_another", "ubx/32.10.38", adding("CFG-TP5", 0, 1)},
        Mutant{"information_of_another", "ubx/32.10.15", adding("CFG-INF", 0, 1)},
        Mutant{"epochs_that_tremble", "ubx/32.10.18",
               changing("NAV-CLOCK",
                        [odd = std::make_shared<bool>(false)](Bytes& payload) {
                          *odd = !*odd;
                          payload[0] = static_cast<std::uint8_t>(payload[0] + (*odd ? 10 : 0));
                        })},
        Mutant{"rate_not_set", "ubx/32.10.27", {}, swallowing("CFG-RATE", 0)},
        Mutant{"message_not_set", "ubx/32.10.18", {}, swallowing("CFG-MSG", 2)},
        Mutant{"navigation_not_set", "ubx/32.10.19", {}, swallowing("CFG-NAV5", 0)},
        Mutant{"sbas_not_set", "ubx/32.10.31", {}, swallowing("CFG-SBAS", 0)},
        Mutant{"pulse_not_set", "ubx/32.10.38", {}, swallowing("CFG-TP5", 1)},
        Mutant{"items_not_set",
               "ubx/3.10.25",
               {},
               swallowing("CFG-VALSET", 0),
               emulators::ublox_zed_f9p},
        Mutant{"items_of_another_layer",
               "ubx/3.10.24",
               adding("CFG-VALGET", 1, 1),
               {},
               emulators::ublox_zed_f9p},
        Mutant{"items_of_another_key",
               "ubx/3.10.24",
               adding("CFG-VALGET", 4, 1),
               {},
               emulators::ublox_zed_f9p},
        Mutant{"fine_part_of_100",
               "ubx/32.17.11",
               writing("NAV-HPPOSLLH", 24, 100),
               {},
               emulators::ublox_zed_f9p},
        Mutant{"negative_variance",
               "ubx/3.15.2",
               writing("NAV-COV", 19, 0xBF),
               {},
               emulators::ublox_zed_f9p},
        Mutant{"relative_version",
               "ubx/3.15.14",
               writing("NAV-RELPOSNED", 0, 0),
               {},
               emulators::ublox_zed_f9p}),
    [](const auto& mutant) { return std::string(mutant.param.name); });

struct Faulty {
  const char* name;
  const char* found_by;
  std::function<void(emulators::UbloxFault&)> what;
};
void PrintTo(const Faulty& faulty, std::ostream* out) {
  *out << faulty.name;
}

class UbxFault : public testing::TestWithParam<Faulty> {};

TEST_P(UbxFault, IsNoticed) {
  UbloxSettings settings = settings_of(emulators::ublox_neo_m8());
  Device sound(settings);
  const UbxClaims claims = survey_ubx(sound.device);
  GetParam().what(settings.faults.emplace_back());
  Device broken(settings);
  EXPECT_THAT(wrong_in(judge(broken, claims, {GetParam().found_by})), testing::Not(IsEmpty()));
}

INSTANTIATE_TEST_SUITE_P(
    , UbxFault,
    testing::Values(
        Faulty{"frozen", "ubx/epoch",
               [](auto& fault) { fault.what = emulators::FrozenFixFault{}; }},
        Faulty{"slow", "ubx/32.10.27", [](auto& fault) { fault.what = emulators::SlowFixFault{}; }},
        Faulty{"wrong_leap_second", "ubx/32.17.30",
               [](auto& fault) { fault.what = emulators::WrongLeapSecondFault{}; }},
        Faulty{"refuses", "ubx/32.10.27",
               [](auto& fault) { fault.what = emulators::RefusedConfigurationFault{}; }},
        Faulty{
            "noise", "ubx/32.2",
            [](auto& fault) { fault.what = emulators::UartNoiseFault{.bit_error_rate = 1e-3}; }}),
    [](const auto& faulty) { return std::string(faulty.param.name); });

TEST(UbxPayload, IsReadByItsTable) {
  const UbxMessage& message = *ubx_message("NAV-SVINFO");
  Bytes bytes(8 + 2 * 12);
  bytes[4] = 2;
  bytes[8 + 12 + 5] = 0xFB;
  bytes[8 + 12 + 6] = 0x2C;
  bytes[8 + 12 + 7] = 0x01;
  const UbxPayload payload(message, bytes);
  ASSERT_TRUE(payload.whole());
  EXPECT_EQ(payload.blocks(), 2U);
  EXPECT_EQ(payload.value_in(1, "elev"), -5.0);
  EXPECT_EQ(payload.value_in(1, "azim"), 300.0);
  bytes[4] = 3;
  EXPECT_FALSE(UbxPayload(message, bytes).whole());
  bytes.pop_back();
  EXPECT_FALSE(UbxPayload(message, bytes).whole());
  EXPECT_FALSE(UbxPayload(message, {}).whole());
}

// Lengths as the overviews of the documents have them (R28 32.7; HPG 1.50, 3.8).
TEST(UbxPayload, HasTheLengthsOfTheDocuments) {
  struct Length {
    const char* name;
    std::size_t bytes;
  };
  for (const auto& [name, bytes] : std::initializer_list<Length>{
           {"NAV-POSECEF", 20},   {"NAV-POSLLH", 28},   {"NAV-STATUS", 16},    {"NAV-DOP", 18},
           {"NAV-SOL", 52},       {"NAV-PVT", 92},      {"NAV-PVT", 84},       {"NAV-ODO", 20},
           {"NAV-VELECEF", 20},   {"NAV-VELNED", 36},   {"NAV-COV", 64},       {"NAV-SVIN", 40},
           {"NAV-TIMEGPS", 16},   {"NAV-TIMEUTC", 20},  {"NAV-CLOCK", 20},     {"NAV-TIMELS", 24},
           {"MON-HW", 60},        {"MON-HW2", 28},      {"MON-MSGPP", 120},    {"MON-RXBUF", 24},
           {"MON-TXBUF", 28},     {"AID-INI", 48},      {"AID-HUI", 72},       {"TIM-TP", 16},
           {"TIM-TM2", 28},       {"CFG-PRT", 20},      {"CFG-DAT", 52},       {"CFG-NAV5", 36},
           {"CFG-NAVX5", 40},     {"CFG-TP5", 32},      {"CFG-USB", 108},      {"CFG-PM2", 44},
           {"CFG-PM2", 48},       {"CFG-ODO", 20},      {"CFG-TMODE3", 40},    {"LOG-INFO", 48},
           {"NAV-RELPOSNED", 64}, {"NAV-HPPOSLLH", 36}, {"NAV-HPPOSECEF", 28}, {"CFG-NMEA", 12},
           {"CFG-NMEA", 20}}) {
    EXPECT_TRUE(UbxPayload(*ubx_message(name), Bytes(bytes)).whole()) << name;
    EXPECT_FALSE(UbxPayload(*ubx_message(name), Bytes(bytes + 1)).whole()) << name;
  }
}

}  // namespace
}  // namespace rigwire::conform
