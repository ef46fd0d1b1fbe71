// The suite velodyne on our lidars, in their own time: right, with each of their faults, and with
// one thing wrong in what they send.
#include "conform/velodyne/velodyne_suite.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <ostream>
#include <string>

#include "emulated_lidar.h"
#include "suite_verdicts.h"

namespace rigwire::conform {
namespace {

using protocols::velodyne::ReturnMode;
using std::chrono::seconds;
using testing::Contains;
using testing::IsEmpty;
using testing::StartsWith;

SuiteResult judge(const LidarScene& scene, const VelodyneClaims& claims = {},
                  const std::vector<std::string>& wanted = {}) {
  return run_velodyne_suite(listened_to(scene, claims), claims, {wanted, false, false});
}

struct Sensor {
  const char* name;
  const char* model;
  ReturnMode mode;
  std::size_t least;  ///< Cases that pass.
  emulators::VelodyneFirmware firmware = emulators::VelodyneFirmware::newest;
};
void PrintTo(const Sensor& sensor, std::ostream* out) {
  *out << sensor.name;
}

LidarScene scene_of(const Sensor& sensor) {
  LidarScene scene;
  scene.settings.model = sensor.model;
  scene.settings.firmware = sensor.firmware;
  scene.settings.saved.return_mode = sensor.mode;
  if (scene.settings.model == "VLS-128") {
    scene.span = seconds{1};  // It sends up to 17307 packets in one.
  }
  return scene;
}

class VelodyneSuite : public testing::TestWithParam<Sensor> {};

TEST_P(VelodyneSuite, OurLidarIsRight) {
  const LidarScene scene = scene_of(GetParam());
  const VelodyneClaims claims = survey_velodyne(listened_to(scene));
  EXPECT_EQ(claims.model, GetParam().model);
  EXPECT_EQ(claims.rotor_rpm, 600.0);
  const SuiteResult result = judge(scene, claims);
  EXPECT_THAT(wrong_in(result), IsEmpty());
  EXPECT_GE(result.count(Verdict::pass), GetParam().least);
}

INSTANTIATE_TEST_SUITE_P(
    , VelodyneSuite,
    testing::Values(Sensor{"hdl_32e", "HDL-32E", ReturnMode::strongest, 55},
                    Sensor{"hdl_32e_dual", "HDL-32E", ReturnMode::dual, 55},
                    Sensor{"vlp_16", "VLP-16", ReturnMode::strongest, 55},
                    Sensor{"vlp_16_last", "VLP-16", ReturnMode::last, 55},
                    Sensor{"vlp_16_dual", "VLP-16", ReturnMode::dual, 55},
                    Sensor{"puck_hi_res", "Puck Hi-Res", ReturnMode::strongest, 55},
                    Sensor{"vlp_32c", "VLP-32C", ReturnMode::strongest, 55},
                    Sensor{"vlp_32c_dual", "VLP-32C", ReturnMode::dual, 55},
                    Sensor{"hdl_64e_s2", "HDL-64E S2", ReturnMode::strongest, 25},
                    Sensor{"hdl_64e_s3", "HDL-64E S3", ReturnMode::strongest, 25},
                    Sensor{"hdl_64e_s3_dual", "HDL-64E S3", ReturnMode::dual, 25},
                    Sensor{"vls_128", "VLS-128", ReturnMode::strongest, 55},
                    Sensor{"vls_128_dual", "VLS-128", ReturnMode::dual, 55},
                    Sensor{"vls_128_old", "VLS-128", ReturnMode::strongest, 55,
                           emulators::VelodyneFirmware::until_5_1_7}),
    [](const auto& sensor) { return std::string(sensor.param.name); });

TEST(VelodyneCases, HaveIdentitiesOfTheirOwn) {
  expect_identities(velodyne_cases(), 60);
}

TEST(VelodyneCases, SilenceIsTheToolsError) {
  VelodyneLog log;
  log.close(seconds{1}, 0, {});
  const SuiteResult result = run_velodyne_suite(log, {}, {});
  EXPECT_EQ(result.count(Verdict::error), result.cases.size());
}

TEST(VelodyneCases, WhatThisMachineLostIsNotTheSensors) {
  VelodyneLog log;
  std::size_t number = 0;
  LidarScene scene;
  scene.span = seconds{1};
  const VelodyneLog all = listened_to(scene);
  for (const VelodyneDatagram& datagram : all.data_datagrams()) {
    if (number++ % 100 != 50) {
      log.add_data(datagram);
    }
  }
  log.close(seconds{1}, 18, {});
  const SuiteResult result = run_velodyne_suite(log, {}, {{"velodyne/time"}, false, false});
  EXPECT_EQ(result.count(Verdict::fail), 0U);
  EXPECT_EQ(result.count(Verdict::error), 1U);
}

TEST(VelodyneCases, ANarrowedViewIsNoFailureWhereItIsClaimed) {
  LidarScene scene;
  scene.settings.saved.view_start_deg = 300;
  scene.settings.saved.view_end_deg = 60;
  VelodyneClaims claims;
  claims.view_start_deg = 300;
  claims.view_end_deg = 60;
  EXPECT_THAT(wrong_in(judge(scene, claims)), IsEmpty());
  EXPECT_THAT(wrong_ids(judge(scene)), Contains(StartsWith("velodyne/azimuth/")));
  claims.view_end_deg = 59;
  EXPECT_THAT(wrong_ids(judge(scene, claims)), testing::ElementsAre("velodyne/azimuth/11"));
}

TEST(VelodyneCases, APortOfTheSystemsChoiceIsLenient) {
  LidarScene scene;
  scene.source_port = 40'000;
  const SuiteResult result = judge(scene);
  EXPECT_THAT(wrong_ids(result), testing::ElementsAre("velodyne/source/3"));
  EXPECT_EQ(result.count(Verdict::lenient), 1U);
}

// --- what is broken is noticed ---

bool is_data(const DatagramBytes& packet) {
  return packet.size() == 1206;
}
/// Changes each packet of a port.
PacketChange of_data(const std::function<void(DatagramBytes&, std::size_t number)>& change) {
  return [change](const DatagramBytes& packet, std::size_t number) {
    DatagramBytes other = packet;
    if (is_data(packet)) {
      change(other, number);
    }
    return Datagrams{other};
  };
}
PacketChange of_position(const std::function<void(DatagramBytes&)>& change) {
  return [change](const DatagramBytes& packet, std::size_t) {
    DatagramBytes other = packet;
    if (!is_data(packet)) {
      change(other);
    }
    return Datagrams{other};
  };
}
PacketChange writing_data(std::size_t at, std::uint8_t value) {
  return of_data([=](DatagramBytes& bytes, std::size_t) { bytes.at(at) = value; });
}
PacketChange writing_position(std::size_t at, std::uint8_t value) {
  return of_position([=](DatagramBytes& bytes) { bytes.at(at) = value; });
}
unsigned u16(const DatagramBytes& bytes, std::size_t at) {
  return bytes.at(at) | bytes.at(at + 1) << 8U;
}
void put_u16(DatagramBytes& bytes, std::size_t at, unsigned value) {
  bytes.at(at) = static_cast<std::uint8_t>(value);
  bytes.at(at + 1) = static_cast<std::uint8_t>(value >> 8U);
}
void put_timestamp(DatagramBytes& bytes, std::size_t at, std::uint32_t value) {
  put_u16(bytes, at, value & 0xFFFFU);
  put_u16(bytes, at + 2, value >> 16U);
}
std::uint32_t timestamp(const DatagramBytes& bytes, std::size_t at) {
  return u16(bytes, at) | std::uint32_t{u16(bytes, at + 2)} << 16U;
}
/// Changes the sentence of each position packet, at the same length.
PacketChange of_sentence(const std::function<void(std::string&)>& change) {
  return of_position([change](DatagramBytes& bytes) {
    std::string text(bytes.begin() + 206, std::find(bytes.begin() + 206, bytes.end(), 0));
    change(text);
    std::ranges::copy(text, bytes.begin() + 206);
  });
}
/// Its check made right again.
void seal(std::string& text) {
  unsigned check = 0;
  const std::size_t star = text.rfind('*');
  for (std::size_t i = 1; i < star; ++i) {
    check ^= static_cast<unsigned char>(text[i]);
  }
  constexpr std::string_view kDigits = "0123456789ABCDEF";
  text[star + 1] = kDigits[check >> 4U];
  text[star + 2] = kDigits[check & 15U];
}
PacketChange of_field(std::size_t number, char value) {
  return of_sentence([=](std::string& text) {
    std::size_t at = 0;
    for (std::size_t i = 0; i < number; ++i) {
      at = text.find(',', at) + 1;
    }
    text.at(at) = value;
    seal(text);
  });
}

struct Mutant {
  const char* name;
  const char* found_by;  ///< The case that has to find it.
  PacketChange change;
  Sensor sensor = {"", "HDL-32E", ReturnMode::strongest, 0};
};
void PrintTo(const Mutant& mutant, std::ostream* out) {
  *out << mutant.name;
}

constexpr Sensor kDual{"", "VLP-16", ReturnMode::dual, 0};
constexpr Sensor kPlain{"", "VLP-16", ReturnMode::strongest, 0};
constexpr Sensor kExtended{"", "VLP-32C", ReturnMode::strongest, 0};
constexpr Sensor kBanks{"", "HDL-64E S3", ReturnMode::strongest, 0};
constexpr Sensor kBanksOfFour{"", "VLS-128", ReturnMode::dual, 0};

class VelodyneMutant : public testing::TestWithParam<Mutant> {};

TEST_P(VelodyneMutant, IsNoticed) {
  const Mutant& mutant = GetParam();
  LidarScene scene = scene_of(mutant.sensor);
  const VelodyneClaims claims = survey_velodyne(listened_to(scene));
  scene.change = mutant.change;
  EXPECT_THAT(wrong_ids(judge(scene, claims)), Contains(mutant.found_by));
}

INSTANTIATE_TEST_SUITE_P(
    , VelodyneMutant,
    testing::Values(
        Mutant{"a_byte_more", "velodyne/data/1",
               of_data([](DatagramBytes& bytes, std::size_t) { bytes.push_back(0); })},
        Mutant{"another_flag", "velodyne/data/2", writing_data(301, 0xDD)},
        Mutant{"azimuth_36000", "velodyne/data/3", of_data([](DatagramBytes& bytes, std::size_t) {
                 put_u16(bytes, 2, u16(bytes, 2) < 200 ? 36'000 : u16(bytes, 2));
               })},
        Mutant{"banks_of_other_azimuths", "velodyne/data/4",
               of_data([](DatagramBytes& bytes, std::size_t) { bytes.at(102) ^= 1U; }), kBanks},
        Mutant{"something_in_empty_blocks", "velodyne/data/5", writing_data(904, 1), kBanksOfFour},
        Mutant{"no_return", "velodyne/data/7", of_data([](DatagramBytes& bytes, std::size_t) {
                 for (std::size_t at = 0; at < 1200; at += 100) {
                   std::fill_n(bytes.begin() + static_cast<std::ptrdiff_t>(at) + 4, 96, 0);
                 }
               })},
        Mutant{"too_far", "velodyne/data/8",
               of_data([](DatagramBytes& bytes, std::size_t) { put_u16(bytes, 4, 60'000); })},
        Mutant{"too_near", "velodyne/data/8",
               of_data([](DatagramBytes& bytes, std::size_t) { put_u16(bytes, 4, 10); })},
        Mutant{"azimuth_turned_around", "velodyne/azimuth/1",
               of_data([](DatagramBytes& bytes, std::size_t) {
                 for (std::size_t at = 2; at < 1200; at += 100) {
                   put_u16(bytes, at, 35'999 - u16(bytes, at));
                 }
               })},
        Mutant{"azimuth_stands", "velodyne/azimuth/2",
               of_data([](DatagramBytes& bytes, std::size_t) {
                 for (std::size_t at = 2; at < 1200; at += 100) {
                   put_u16(bytes, at, 100);
                 }
               })},
        Mutant{"azimuth_in_steps_of_a_degree", "velodyne/azimuth/8",
               of_data([](DatagramBytes& bytes, std::size_t) {
                 for (std::size_t at = 2; at < 1200; at += 100) {
                   put_u16(bytes, at, u16(bytes, at) / 100 * 100);
                 }
               })},
        Mutant{"azimuth_of_the_packet_in_all_blocks", "velodyne/azimuth/7",
               of_data([](DatagramBytes& bytes, std::size_t) {
                 for (std::size_t at = 102; at < 1200; at += 100) {
                   put_u16(bytes, at, u16(bytes, 2));
                 }
               })},
        Mutant{"azimuth_jumps", "velodyne/azimuth/9",
               of_data([](DatagramBytes& bytes, std::size_t number) {
                 for (std::size_t at = 2; at < 1200; at += 100) {
                   put_u16(bytes, at,
                           (u16(bytes, at) + static_cast<unsigned>(number / 500) * 50U) % 36'000);
                 }
               })},
        Mutant{"half_of_the_circle", "velodyne/azimuth/10",
               [](const DatagramBytes& packet, std::size_t) {
                 const bool lost = is_data(packet) && u16(packet, 2) < 18'000;
                 return lost ? Datagrams() : Datagrams{packet};
               }},
        Mutant{"another_speed", "velodyne/azimuth/5",
               of_data([](DatagramBytes& bytes, std::size_t) {
                 put_timestamp(bytes, 1200, timestamp(bytes, 1200) / 100 * 102 % 3'600'000'000U);
               })},
        Mutant{"time_beyond_the_hour", "velodyne/time/1",
               of_data([](DatagramBytes& bytes, std::size_t number) {
                 put_timestamp(bytes, 1200, number == 50 ? 3'600'000'001U : timestamp(bytes, 1200));
               })},
        Mutant{"time_goes_back", "velodyne/time/2",
               of_data([](DatagramBytes& bytes, std::size_t number) {
                 put_timestamp(bytes, 1200, timestamp(bytes, 1200) - (number == 50 ? 2000U : 0U));
               })},
        Mutant{"time_trembles", "velodyne/time/4",
               of_data([](DatagramBytes& bytes, std::size_t number) {
                 put_timestamp(bytes, 1200, timestamp(bytes, 1200) + (number % 2 == 0 ? 0U : 10U));
               })},
        Mutant{"time_of_another_model", "velodyne/time/6",
               of_data([](DatagramBytes& bytes, std::size_t number) {
                 put_timestamp(
                     bytes, 1200,
                     static_cast<std::uint32_t>(553.1 * static_cast<double>(number)) + 1000U);
               })},
        Mutant{"hour_not_begun_anew", "velodyne/time/7",
               of_data([](DatagramBytes& bytes, std::size_t) {
                 const std::uint32_t us = timestamp(bytes, 1200);
                 put_timestamp(bytes, 1200, us < 3'000'000U ? us + 50'000U : us);
               })},
        Mutant{"half_as_fast", "velodyne/timing/1",
               [](const DatagramBytes& packet, std::size_t number) {
                 const bool lost = is_data(packet) && number % 2 == 0;
                 return lost ? Datagrams() : Datagrams{packet};
               }},
        Mutant{"return_mode_unknown", "velodyne/returns/1", writing_data(1204, 0x36)},
        Mutant{"return_mode_changes", "velodyne/returns/2",
               of_data([](DatagramBytes& bytes, std::size_t number) {
                 bytes.at(1204) = number == 100 ? 0x38 : 0x37;
               })},
        Mutant{"return_mode_of_another", "velodyne/returns/3", writing_data(1204, 0x38)},
        Mutant{"product_unknown", "velodyne/returns/4", writing_data(1205, 0x29)},
        Mutant{"product_changes", "velodyne/returns/5",
               of_data([](DatagramBytes& bytes, std::size_t number) {
                 bytes.at(1205) = number == 100 ? 0x22 : 0x21;
               })},
        Mutant{"product_of_another", "velodyne/returns/6", writing_data(1205, 0x28)},
        Mutant{"pairs_of_other_azimuths", "velodyne/returns/7",
               of_data([](DatagramBytes& bytes, std::size_t) { bytes.at(102) ^= 1U; }), kDual},
        Mutant{"one_of_a_pair", "velodyne/returns/8",
               of_data([](DatagramBytes& bytes, std::size_t) { put_u16(bytes, 4, 0); }), kDual},
        Mutant{"pairs_changed_about", "velodyne/returns/9",
               of_data([](DatagramBytes& bytes, std::size_t) {
                 for (std::ptrdiff_t at = 0; at < 1200; at += 200) {
                   std::swap_ranges(bytes.begin() + at, bytes.begin() + at + 100,
                                    bytes.begin() + at + 100);
                 }
               }),
               kDual},
        Mutant{"no_position_packets", "velodyne/position/1",
               [](const DatagramBytes& packet, std::size_t) {
                 return is_data(packet) ? Datagrams{packet} : Datagrams();
               }},
        Mutant{"position_too_short", "velodyne/position/2",
               of_position([](DatagramBytes& bytes) { bytes.pop_back(); })},
        Mutant{"head_of_something", "velodyne/position/3", writing_position(13, 1)},
        Mutant{"plain_of_something", "velodyne/position/4", writing_position(30, 1), kPlain},
        Mutant{"inertial_gap_of_something", "velodyne/position/5", writing_position(38, 1)},
        Mutant{"very_hot", "velodyne/position/6",
               of_position([](DatagramBytes& bytes) { put_u16(bytes, 16, 0x7FF); })},
        Mutant{"reason_unknown", "velodyne/position/7", writing_position(0xC4, 5), kExtended},
        Mutant{"boards_burn", "velodyne/position/8", writing_position(0xBB, 200), kExtended},
        Mutant{"extended_too_long", "velodyne/position/9", writing_position(0x1F0, 1), kExtended},
        Mutant{"gap_of_something", "velodyne/position/10", writing_position(203, 1)},
        Mutant{"position_beyond_the_hour", "velodyne/position/11",
               of_position([](DatagramBytes& bytes) { put_timestamp(bytes, 198, 3'600'000'000); })},
        Mutant{"position_goes_back", "velodyne/position/12",
               [](const DatagramBytes& packet, std::size_t number) {
                 DatagramBytes other = packet;
                 if (!is_data(packet) && number == 20) {
                   put_timestamp(other, 198, timestamp(packet, 198) - 20'000U);
                 }
                 return Datagrams{other};
               }},
        Mutant{"position_of_another_time", "velodyne/position/14",
               of_position([](DatagramBytes& bytes) {
                 put_timestamp(bytes, 198, (timestamp(bytes, 198) + 60'000U) % 3'600'000'000U);
               })},
        Mutant{"position_seldom", "velodyne/position/15",
               [](const DatagramBytes& packet, std::size_t number) {
                 const bool lost = !is_data(packet) && number % 2 == 0;
                 return lost ? Datagrams() : Datagrams{packet};
               }},
        Mutant{"pulse_unknown", "velodyne/pulse/1", writing_position(202, 4)},
        Mutant{"pulse_wrong", "velodyne/pulse/2", writing_position(202, 3)},
        Mutant{"pulse_absent", "velodyne/pulse/3", writing_position(202, 0)},
        Mutant{"text_behind_the_sentence", "velodyne/sentence/1", writing_position(400, 'x')},
        Mutant{"another_sentence", "velodyne/sentence/2",
               of_sentence([](std::string& text) { text.at(3) = 'L'; })},
        Mutant{"no_sentence", "velodyne/sentence/3", of_position([](DatagramBytes& bytes) {
                 std::fill(bytes.begin() + 206, bytes.end(), 0);
               })},
        Mutant{"line_feed_alone", "velodyne/sentence/4", of_sentence([](std::string& text) {
                 text.replace(text.size() - 2, 2, std::string("\n\0", 2));
               })},
        Mutant{"no_check", "velodyne/sentence/5",
               of_sentence([](std::string& text) { text.at(text.rfind('*')) = '.'; })},
        Mutant{"wrong_check", "velodyne/sentence/6",
               of_sentence([](std::string& text) { text.at(text.rfind('*') + 2) ^= 1; })},
        Mutant{"a_field_less", "velodyne/sentence/8", of_sentence([](std::string& text) {
                 for (std::size_t at = text.find(','); at != std::string::npos;
                      at = text.find(',', at + 1)) {
                   text.at(at) = at > 30 ? '0' : ',';
                 }
                 seal(text);
               })},
        Mutant{"hour_of_29", "velodyne/sentence/9", of_sentence([](std::string& text) {
                 text.replace(text.find(',') + 1, 2, "29");
                 seal(text);
               })},
        Mutant{"place_without_a_letter", "velodyne/sentence/10", of_field(4, 'X')},
        Mutant{"day_of_90", "velodyne/sentence/11", of_field(9, '9')},
        Mutant{"status_unknown", "velodyne/sentence/12", of_field(2, 'B')},
        Mutant{"sentence_of_another_minute", "velodyne/sentence/13",
               of_sentence([](std::string& text) {
                 char& minute = text.at(text.find(',') + 4);
                 minute = minute == '9' ? '0' : static_cast<char>(minute + 1);
                 seal(text);
               })},
        Mutant{"the_same_sentence_for_ever", "velodyne/sentence/14",
               of_sentence([](std::string& text) {
                 text.replace(text.find(',') + 1, 6, "085958");
                 seal(text);
               })},
        Mutant{"status_out_of_turn", "velodyne/status/1",
               of_data([](DatagramBytes& bytes, std::size_t number) {
                 bytes.at(1204) = number == 500 ? 'S' : bytes.at(1204);
               }),
               kBanks},
        Mutant{"status_month_13", "velodyne/status/2",
               of_data([](DatagramBytes& bytes, std::size_t) {
                 bytes.at(1205) = bytes.at(1204) == 'N' ? 13 : bytes.at(1205);
               }),
               kBanks},
        Mutant{"status_gps_unknown", "velodyne/status/3",
               of_data([](DatagramBytes& bytes, std::size_t) {
                 bytes.at(1205) = bytes.at(1204) == 'G' ? 'B' : bytes.at(1205);
               }),
               kBanks},
        Mutant{"record_damaged", "velodyne/status/4",
               of_data([](DatagramBytes& bytes, std::size_t number) {
                 bytes.at(1205) = bytes.at(1204) == '4' && number % 64 < 16
                                      ? static_cast<std::uint8_t>(bytes.at(1205) ^ 0x10U)
                                      : bytes.at(1205);
               }),
               kBanks}),
    [](const auto& mutant) { return std::string(mutant.param.name); });

struct Faulty {
  const char* name;
  const char* found_by;
  std::function<void(emulators::VelodyneSettings&)> what;
};
void PrintTo(const Faulty& faulty, std::ostream* out) {
  *out << faulty.name;
}

template <class Fault>
std::function<void(emulators::VelodyneSettings&)> with(const Fault& fault) {
  return [fault](emulators::VelodyneSettings& settings) {
    settings.faults.push_back({{Duration{0}, seconds{100}}, fault});
  };
}

class VelodyneFaulty : public testing::TestWithParam<Faulty> {};

TEST_P(VelodyneFaulty, IsNoticed) {
  LidarScene scene;
  const VelodyneClaims claims = survey_velodyne(listened_to(scene));
  GetParam().what(scene.settings);
  EXPECT_THAT(wrong_ids(judge(scene, claims)), Contains(GetParam().found_by));
}

INSTANTIATE_TEST_SUITE_P(
    , VelodyneFaulty,
    testing::Values(
        Faulty{"lost", "velodyne/time/5", with(emulators::LostPacketsFault{.share = 0.01})},
        Faulty{"swapped", "velodyne/time/2", with(emulators::SwappedPacketsFault{.share = 0.01})},
        Faulty{"repeated", "velodyne/time/3",
               with(emulators::DuplicatedPacketsFault{.share = 0.01})},
        Faulty{"dead_laser", "velodyne/data/9",
               with(emulators::DeadLaserFault{.first = 12, .last = 13})},
        Faulty{"dirt", "velodyne/data/10",
               with(emulators::DirtyWindowFault{
                   .from_deg = 35.0, .to_deg = 65.0, .transmission = 0.0})},
        Faulty{
            "motor_stall", "velodyne/azimuth/5",
            [](emulators::VelodyneSettings& settings) {
              settings.faults.push_back({{seconds{1}, seconds{100}}, emulators::MotorStallFault{}});
            }},
        Faulty{"pulse_loss", "velodyne/pulse/3", with(emulators::PulseLossFault{})},
        Faulty{"pulse_noise", "velodyne/pulse/2", with(emulators::PulseNoiseFault{})},
        Faulty{"sentence_loss", "velodyne/sentence/14", with(emulators::SentenceLossFault{})},
        Faulty{"wrong_time", "velodyne/sentence/13",
               with(emulators::ClockOffsetFault{.offset_s = 1.0})},
        Faulty{"hour_overrun", "velodyne/time/1",
               with(emulators::HourOverrunFault{.overrun_s = 0.05})},
        Faulty{"factory_bytes", "velodyne/returns/1", with(emulators::FactoryBytesFault{})},
        Faulty{"off", "velodyne/time/5",
               [](emulators::VelodyneSettings& settings) {
                 settings.start_up = std::chrono::milliseconds{500};
                 settings.supply_faults = {{{seconds{2}, seconds{1}}, emulators::NoSupplyFault{}}};
               }}),
    [](const auto& faulty) { return std::string(faulty.param.name); });

}  // namespace
}  // namespace rigwire::conform
