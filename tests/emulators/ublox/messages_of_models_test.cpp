// Messages of each model and their content: what a client polls and what it switches on.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <set>
#include <string_view>

#include "child_process.h"
#include "protocols/rtcm3/frame.h"
#include "protocols/ubx/aiding.h"
#include "protocols/ubx/blocks.h"
#include "protocols/ubx/identity.h"
#include "protocols/ubx/key_values.h"
#include "protocols/ubx/monitor.h"
#include "protocols/ubx/navigation.h"
#include "protocols/ubx/raw_measurements.h"
#include "raw_log.h"
#include "rig.h"

namespace rigwire::emulators {
namespace {

using namespace std::chrono_literals;
using namespace protocols::ubx;
using testing::ElementsAre;

class UbloxModelsTest : public UbloxReceiverTest {
 protected:
  static UbloxSettings of(const UbloxProfile& profile) {
    UbloxSettings settings;
    settings.profile = &profile;
    settings.nmea_sentences.clear();
    settings.start_banner = false;
    settings.baud = 460'800;
    return settings;
  }
  /// Ids of what comes back within 300 ms, between two epochs.
  std::vector<MessageId> ask(UbloxReceiver& receiver, MessageId id, const Bytes& payload = {}) {
    line_.clear();
    say(receiver, id, payload);
    now_ += 300ms;
    receiver.advance(now_);
    return ids();
  }
  template <class Message>
  Message answer(UbloxReceiver& receiver) {
    EXPECT_THAT(ask(receiver, Message::kId), ElementsAre(Message::kId));
    const auto all = decoded<Message>();
    return all.empty() ? Message{} : all.front();
  }
  void settle(UbloxReceiver& receiver, const std::function<void(GnssSample&)>& change = {}) {
    run(receiver, kStart + 2500ms, change);
  }
};

constexpr MessageId kRxmRaw = RxmRawHead::kId;
constexpr MessageId kRxmRawx = RxmRawxHead::kId;
constexpr MessageId kMonRf = MonRfHead::kId;

// Once the answer to a poll was made by whoever knew the message, whatever the model.
TEST_F(UbloxModelsTest, APollOfWhatTheModelHasNotIsMetWithSilence) {
  const std::vector<std::pair<const UbloxProfile*, std::vector<MessageId>>> absent{
      {&ublox_neo_7p(),
       {kRxmRawx, kMonRf, NavSatHead::kId, NavHpposllh::kId, NavCov::kId, NavEoe::kId,
        MonCommsHead::kId, MonGnss::kId, SecUniqid::kId, RxmSfrb::kId, MonRxr::kId}},
      {&ublox_neo_m8(),
       {kRxmRawx, kMonRf, kRxmRaw, NavHpposllh::kId, NavCov::kId, MonCommsHead::kId,
        NavSigHead::kId, NavRelposned::kId, RxmSfrbxHead::kId}},
      {&ublox_zed_f9p(),
       {NavSol::kId, NavSvinfoHead::kId, kRxmRaw, AidIni::kId, AidHui::kId, AidEph::kId,
        NavAopstatus::kId, RxmSvsiHead::kId, NavEoe::kId}}};
  for (const auto& [profile, messages] : absent) {
    line_ = {};
    now_ = kStart;
    UbloxReceiver receiver(of(*profile), calendar_, line_);
    settle(receiver);
    for (const MessageId id : messages) {
      const std::uint64_t ignored = receiver.received().ignored;
      EXPECT_THAT(ask(receiver, id), ElementsAre())
          << profile->name << " " << int{id.message_class} << " " << int{id.message_id};
      EXPECT_EQ(receiver.received().ignored, ignored + 1);
    }
  }
}

TEST_F(UbloxModelsTest, EveryPolledMessageOfEveryModelAnswersWithItself) {
  for (const UbloxProfile* profile :
       {&ublox_neo_7p(), &ublox_neo_m8(), &ublox_neo_m8t(), &ublox_zed_f9p()}) {
    line_ = {};
    now_ = kStart;
    UbloxReceiver receiver(of(*profile), calendar_, line_);
    settle(receiver, [](GnssSample& sample) {
      sample.measurements.push_back({.number = 1, .pseudorange_m = 2e7, .cn0_dbhz = 40.0});
    });
    for (const UbloxMessage& message : profile->messages) {
      if (!message.polled || message.sentence) {
        continue;
      }
      const auto answers = ask(receiver, message.id);
      ASSERT_FALSE(answers.empty()) << profile->name << " " << message.name;
      for (const MessageId& id : answers) {
        EXPECT_EQ(id, message.id) << profile->name << " " << message.name;
      }
    }
  }
}

TEST_F(UbloxModelsTest, AidingIsIgnoredByAModelWithoutIt) {
  UbloxSettings settings = of(ublox_zed_f9p());
  settings.time_to_first_fix = 60s;
  UbloxReceiver receiver(settings, calendar_, line_);
  settle(receiver);
  AidIni aid;
  aid.flags = 0x02;
  say(receiver, aid);
  EXPECT_FALSE(receiver.solution().time_known);
}

TEST_F(UbloxModelsTest, ChipTellsItsNumberTheSameEachTimeAndAnotherForEachDevice) {
  const auto number = [&](const UbloxProfile& profile, std::uint64_t seed) {
    line_ = {};
    now_ = kStart;
    UbloxSettings settings = of(profile);
    settings.noise_seed = seed;
    UbloxReceiver receiver(settings, calendar_, line_);
    settle(receiver);
    const auto first = answer<SecUniqid>(receiver);
    EXPECT_EQ(first.version, 1);
    EXPECT_EQ(answer<SecUniqid>(receiver), first);
    return first.number;
  };
  EXPECT_EQ(number(ublox_neo_m8(), 5), number(ublox_neo_m8(), 5));
  EXPECT_NE(number(ublox_neo_m8(), 5), number(ublox_neo_m8(), 6));
  EXPECT_NE(number(ublox_zed_f9p(), 7), number(ublox_zed_f9p(), 6));
}

TEST_F(UbloxModelsTest, SelectionOfSystemsFollowsCfgGnss) {
  UbloxReceiver receiver(of(ublox_neo_m8()), calendar_, line_);
  settle(receiver);
  EXPECT_EQ(answer<MonGnss>(receiver), (MonGnss{0, 0x0F, 0x03, 0x03, 3}));
  // GLONASS off, BeiDou on.
  say(receiver, CfgGnssHead::kId, {0, 32, 32, 2, 6, 8, 14, 0, 0, 0, 1, 0, 3, 8, 16, 0, 1, 0, 1, 0});
  run(receiver, now_ + 100ms);
  EXPECT_EQ(answer<MonGnss>(receiver), (MonGnss{0, 0x0F, 0x03, 0x05, 3}));
  EXPECT_EQ(answer<MonPatchHead>(receiver), (MonPatchHead{1, 0}));
}

TEST_F(UbloxModelsTest, TimesOfOtherSystemsAreValidWhileTheirSatellitesAreTracked) {
  UbloxSettings settings = of(ublox_zed_f9p());
  settings.ubx_messages = {"NAV-TIMEGLO", "NAV-TIMEBDS", "NAV-TIMEGAL", "NAV-TIMEGPS"};
  UbloxReceiver receiver(settings, calendar_, line_);
  run(receiver, kStart + 1500ms);
  EXPECT_EQ(decoded<NavTimeglo>().back().valid, 0);
  EXPECT_EQ(decoded<NavTimegal>().back().valid, 0);
  line_.clear();
  const auto all_systems = [](GnssSample& sample) {
    sample.satellites[0].system = GnssSystem::glonass;
    sample.satellites[1].system = GnssSystem::galileo;
    sample.satellites[2].system = GnssSystem::beidou;
  };
  run(receiver, kStart + 2500ms, all_systems);
  const NavTimegps gps = decoded<NavTimegps>().back();
  const NavTimegal galileo = decoded<NavTimegal>().back();
  EXPECT_EQ(galileo.valid, 7);
  EXPECT_EQ(galileo.system_time_of_week_s * 1000, gps.time_of_week_ms);
  EXPECT_EQ(galileo.week, gps.week - 1024);
  EXPECT_EQ(galileo.leap_seconds, 18);
  const NavTimebds beidou = decoded<NavTimebds>().back();
  EXPECT_EQ((beidou.system_time_of_week_s + 14) * 1000, gps.time_of_week_ms);
  EXPECT_EQ(beidou.week, gps.week - 1356);
  EXPECT_EQ(beidou.leap_seconds, 4);
  // 2026-06-01 08:00:02 UTC is 11:00:02 in Moscow, day 883 of the eighth four years since 1996.
  const NavTimeglo glonass = decoded<NavTimeglo>().back();
  EXPECT_EQ(glonass.valid, 3);
  EXPECT_EQ(glonass.time_of_day_s, 11U * 3600 + 2);
  EXPECT_EQ(glonass.four_years, 8);
  EXPECT_EQ(glonass.day, 366 + 365 + 152);
}

TEST_F(UbloxModelsTest, OdometerCountsWhenCfgOdoSaysSoAndIsResetByCommand) {
  UbloxSettings settings = of(ublox_neo_m8());
  settings.ubx_messages = {"NAV-ODO"};
  UbloxReceiver receiver(settings, calendar_, line_);
  const auto driving = [](GnssSample& sample) { sample.velocity_ned_mps = {3.0, 4.0, 0.0}; };
  run(receiver, kStart + 10500ms, driving);
  EXPECT_EQ(decoded<NavOdo>().back().distance_m, 0U) << "off as delivered";
  CfgOdo wanted;
  wanted.flags = kOdoUse;
  wanted.profile = 3;
  say(receiver, wanted);
  run(receiver, kStart + 30500ms, driving);
  EXPECT_EQ(receiver.counters().acknowledged, 1U);
  EXPECT_EQ(decoded<NavOdo>().back().distance_m, 100U);
  EXPECT_EQ(decoded<NavOdo>().back().total_distance_m, 100U);
  say(receiver, kNavResetodo, {});
  EXPECT_EQ(receiver.counters().acknowledged, 2U);
  run(receiver, kStart + 34500ms, driving);
  EXPECT_EQ(decoded<NavOdo>().back().distance_m, 20U);
  EXPECT_EQ(decoded<NavOdo>().back().total_distance_m, 120U);
  // Noise of a receiver at rest does not add up.
  run(receiver, kStart + 60500ms, [](GnssSample& sample) {
    sample.velocity_ned_mps = {0.03, -0.05, 0.0};
  });
  EXPECT_LE(decoded<NavOdo>().back().distance_m, 25U);
}

TEST_F(UbloxModelsTest, SpeedAndCourseAreFilteredWhenCfgOdoSaysSo) {
  UbloxSettings settings = of(ublox_neo_m8());
  settings.ubx_messages = {"NAV-VELNED"};
  UbloxReceiver receiver(settings, calendar_, line_);
  run(receiver, kStart + 3500ms, [](GnssSample& s) { s.velocity_ned_mps = {2.0, 0.0, 0.0}; });
  CfgOdo wanted;
  wanted.flags = kOdoFilteredSpeed | kOdoFilteredCourse;
  wanted.speed_gain = 127;
  wanted.course_gain = 63;
  say(receiver, wanted);
  run(receiver, now_ + 100ms);
  line_.clear();
  run(receiver, kStart + 4500ms, [](GnssSample& s) { s.velocity_ned_mps = {0.0, 4.0, 0.0}; });
  const NavVelned turned = decoded<NavVelned>().back();
  EXPECT_EQ(turned.speed_cmps, 300U) << "half of the way from 2 to 4 m/s";
  EXPECT_EQ(turned.ground_speed_cmps, 400U);
  EXPECT_EQ(turned.heading_e5deg, 2'250'000) << "a quarter of the way from north to east";
}

// At 0.06 m/s the velocity has no course; the way has one, of what moves and not of what stands.
TEST_F(UbloxModelsTest, TheCourseOfSlowMotionComesFromPositionsWhenCfgOdoSaysSo) {
  for (const bool filtered : {false, true}) {
    line_ = {};
    now_ = kStart;
    UbloxSettings settings = of(ublox_zed_f9p());
    settings.ubx_messages = {"NAV-PVT"};
    UbloxReceiver receiver(settings, calendar_, line_);
    CfgOdo wanted;
    wanted.flags = filtered ? kOdoLowSpeedCourse : 0;
    wanted.course_speed_dmps = 2;
    wanted.course_accuracy_m = 1;
    run(receiver, kStart + 500ms);
    say(receiver, wanted);
    const auto creep = [&](double metres_per_s) {
      return [this, metres_per_s](GnssSample& s) {
        constexpr double kDegreesPerMetre = 1.0 / 111'195.0;
        // South-west.
        const double way_m = metres_per_s * to_seconds(s.time);
        s.latitude_deg -= kDegreesPerMetre * way_m * 0.6;
        s.longitude_deg -= kDegreesPerMetre * way_m * 0.8 / std::cos(s.latitude_deg / 57.29578);
        s.velocity_ned_mps = {-0.036, -0.048, 0.0};
        s.horizontal_accuracy_m = 0.02;
      };
    };
    run(receiver, kStart + 20s, creep(0.06));
    const NavPvt92 moving = decoded<NavPvt92>().back();
    EXPECT_EQ(moving.heading_accuracy_e5deg < 5 * 100'000, filtered);
    if (filtered) {
      EXPECT_NEAR(moving.heading_e5deg * 1e-5, 233.13, 0.5);
    }
    // It stands, and says so after ten seconds at most.
    line_.clear();
    run(receiver, kStart + 40s, [&](GnssSample& s) {
      creep(0.06)(s);
      const GnssSample still = good_sample(s.time);
      s.latitude_deg = still.latitude_deg;
      s.longitude_deg = still.longitude_deg;
    });
    EXPECT_EQ(decoded<NavPvt92>().back().heading_accuracy_e5deg, 180U * 100'000);
    // Beyond the accuracy that is asked for it does not try.
    line_.clear();
    run(receiver, kStart + 60s, [&](GnssSample& s) {
      creep(0.06)(s);
      s.horizontal_accuracy_m = 1.5;
    });
    EXPECT_EQ(decoded<NavPvt92>().back().heading_accuracy_e5deg, 180U * 100'000);
  }
}

TEST_F(UbloxModelsTest, WhatCannotBeHonouredOfOdometerAndPowerIsRefused) {
  UbloxReceiver receiver(of(ublox_neo_m8()), calendar_, line_);
  settle(receiver);
  CfgOdo unknown;
  unknown.flags = 0x10;
  say(receiver, unknown);
  CfgPms balanced;
  balanced.mode = 1;
  say(receiver, balanced);
  EXPECT_EQ(receiver.counters().refused, 2U);
  say(receiver, CfgPms{});
  EXPECT_EQ(receiver.counters().acknowledged, 1U);
  run(receiver, now_ + 100ms);
  EXPECT_THAT(ask(receiver, CfgPms::kId), ElementsAre(CfgPms::kId, AckAck::kId));
  EXPECT_EQ(decoded<CfgPms>().front(), CfgPms{});
  EXPECT_THAT(ask(receiver, kLogErase), ElementsAre(AckNak::kId));
  EXPECT_EQ(answer<LogInfo>(receiver).status, 0x10) << "no log";
}

// A ZED-F9P sends these without base and survey (u-center's log, HPG 1.32).
TEST_F(UbloxModelsTest, SurveyAndRelativePositionComeWithoutABase) {
  UbloxReceiver receiver(of(ublox_zed_f9p()), calendar_, line_);
  settle(receiver);
  const NavSvin survey = answer<NavSvin>(receiver);
  EXPECT_EQ(survey.valid, 0);
  EXPECT_EQ(survey.active, 0);
  EXPECT_EQ(survey.observations, 0U);
  const NavRelposned relative = answer<NavRelposned>(receiver);
  EXPECT_EQ(relative.version, 1);
  EXPECT_EQ(relative.flags, kRelativeFixOk);
}

TEST_F(UbloxModelsTest, SignalsAreThoseOfTheSatellites) {
  UbloxReceiver receiver(of(ublox_zed_f9p()), calendar_, line_);
  settle(receiver, [](GnssSample& sample) {
    sample.satellites[7].system = GnssSystem::glonass;
    sample.satellites[6].used = false;
  });
  EXPECT_THAT(ask(receiver, NavSigHead::kId), ElementsAre(NavSigHead::kId));
  const auto frames = line_.frames();
  const auto signals = decode_blocks<NavSigHead, NavSigBlock>({frames[0].first, frames[0].second});
  ASSERT_TRUE(signals.ok());
  ASSERT_EQ(signals->size(), 8U);
  EXPECT_EQ((*signals)[2].satellite, 3);
  EXPECT_EQ((*signals)[2].quality, 7);
  EXPECT_EQ((*signals)[2].flags, 0x02D) << "healthy, smoothed, range and Doppler used";
  EXPECT_EQ((*signals)[6].flags, 0x005) << "not used";
  EXPECT_EQ((*signals)[7].frequency_slot, 13) << "slot 8: channel 6";
}

TEST_F(UbloxModelsTest, CommunicationsCountWhatTheLineCarried) {
  UbloxReceiver receiver(of(ublox_zed_f9p()), calendar_, line_);
  settle(receiver);
  ask(receiver, MonVerHead::kId);
  const std::size_t sent = line_.all.size();
  EXPECT_THAT(ask(receiver, MonCommsHead::kId), ElementsAre(MonCommsHead::kId));
  const auto frames = line_.frames();
  const auto ports = decode_blocks<MonCommsHead, MonCommsPort>({frames[0].first, frames[0].second});
  ASSERT_TRUE(ports.ok());
  ASSERT_EQ(ports->size(), 1U) << "a port without traffic is left out";
  EXPECT_EQ(ports->head().protocols, (std::array<std::uint8_t, 4>{0, 1, 5, 6}));
  EXPECT_EQ((*ports)[0].port, 0x0100);
  EXPECT_EQ((*ports)[0].messages[0], 2);
  EXPECT_EQ((*ports)[0].received_bytes, 16U);
  EXPECT_GE((*ports)[0].sent_bytes, sent);
}

// CFG-MSG for RXM-RTCM was acknowledged, and nothing came.
TEST_F(UbloxModelsTest, CorrectionsThatComeInAreReported) {
  UbloxReceiver receiver(of(ublox_zed_f9p()), calendar_, line_);
  settle(receiver);
  // Message 1005 of station 2003.
  const Bytes correction{0xD3, 0x00, 0x13, 0x3E, 0xD7, 0xD3, 0x02, 0x02, 0x98,
                         0x0E, 0xDE, 0xEF, 0x34, 0xB4, 0xBD, 0x62, 0xAC, 0x09,
                         0x41, 0x98, 0x6F, 0x33, 0x36, 0x0B, 0x98};
  line_.clear();
  receiver.receive(now_, correction);
  run(receiver, now_ + 100ms);
  EXPECT_TRUE(line_.all.empty()) << "off as delivered";
  say(receiver, CfgMsg::kId, {RxmRtcm::kId.message_class, RxmRtcm::kId.message_id, 1});
  run(receiver, now_ + 100ms);
  line_.clear();
  const std::uint64_t malformed = receiver.received().malformed;
  receiver.receive(now_, correction);
  run(receiver, now_ + 100ms);
  EXPECT_EQ(receiver.received().malformed, malformed);
  ASSERT_THAT(ids(), ElementsAre(RxmRtcm::kId));
  const RxmRtcm report = decoded<RxmRtcm>().front();
  EXPECT_EQ(report.message, 1005);
  EXPECT_EQ(report.station, 2003);
  EXPECT_EQ(report.flags, 0x04) << "used";

  // Antenna and receiver of the station: 1033 of an empty description is taken, 1007 is not.
  const auto framed = [](const Bytes& payload) {
    Bytes frame(protocols::rtcm3::kGreatestFrame);
    frame.resize(protocols::rtcm3::encode_frame(payload, frame));
    return frame;
  };
  for (const std::uint16_t number : {std::uint16_t{1033}, std::uint16_t{1007}}) {
    Bytes payload{static_cast<std::uint8_t>(number >> 4U),
                  static_cast<std::uint8_t>((number & 0xFU) << 4U | 2003U >> 8U),
                  static_cast<std::uint8_t>(2003U & 0xFFU)};
    payload.resize(9);
    line_.clear();
    receiver.receive(now_, framed(payload));
    run(receiver, now_ + 100ms);
    ASSERT_THAT(ids(), ElementsAre(RxmRtcm::kId));
    EXPECT_EQ(decoded<RxmRtcm>().front().message, number);
    EXPECT_EQ(decoded<RxmRtcm>().front().flags, number == 1033 ? 0x04 : 0x02);
  }

  // RXM-RTCM has the number of a broken message, too, and that its checksum is wrong.
  Bytes broken = correction;
  broken.back() ^= 1;
  line_.clear();
  receiver.receive(now_, broken);
  run(receiver, now_ + 100ms);
  ASSERT_THAT(ids(), ElementsAre(RxmRtcm::kId));
  EXPECT_EQ(decoded<RxmRtcm>().front().flags, 0x01);
  EXPECT_EQ(decoded<RxmRtcm>().front().message, 1005);
  EXPECT_EQ(receiver.received().malformed, malformed + 1);
}

TEST_F(UbloxModelsTest, AntennaThatNobodyWatchesIsUnknown) {
  const auto of_model = [&](const UbloxProfile& profile) {
    line_ = {};
    now_ = kStart;
    UbloxReceiver receiver(of(profile), calendar_, line_);
    settle(receiver);
    const MonHw hardware = answer<MonHw>(receiver);
    return std::pair{hardware.antenna_status, hardware.antenna_power};
  };
  EXPECT_EQ(of_model(ublox_zed_f9p()), (std::pair<std::uint8_t, std::uint8_t>{1, 2}));
  EXPECT_EQ(of_model(ublox_neo_7p()), (std::pair<std::uint8_t, std::uint8_t>{2, 1}));
}

TEST_F(UbloxModelsTest, JammingIndicatorOfAQuietRadioIsAFewCountsAndNotZero) {
  UbloxSettings settings = of(ublox_neo_7p());
  settings.ubx_messages = {"MON-HW"};
  UbloxReceiver receiver(settings, calendar_, line_);
  run(receiver, kStart + 40500ms);
  std::set<int> seen;
  for (const MonHw& hardware : decoded<MonHw>()) {
    seen.insert(hardware.jamming_indicator);
  }
  EXPECT_EQ(seen, (std::set<int>{7, 8})) << "a real NEO-7P has 7 to 8";
}

// gpsd's ubxtool has its own tables of all these messages.
TEST_F(UbloxModelsTest, UbxtoolReadsWhatTheModernModelsAdd) {
  UbloxReceiver receiver(of(ublox_zed_f9p()), calendar_, line_);
  settle(receiver, [](GnssSample& sample) {
    sample.satellites[0].system = GnssSystem::glonass;
    sample.satellites[1].system = GnssSystem::galileo;
    sample.satellites[2].system = GnssSystem::beidou;
  });
  line_.clear();
  for (const MessageId id :
       {NavTimeglo::kId, NavTimebds::kId, NavTimegal::kId, NavOdo::kId, NavSvin::kId,
        NavRelposned::kId, NavSigHead::kId, MonCommsHead::kId, MonGnss::kId, MonPatchHead::kId,
        SecUniqid::kId, LogInfo::kId, CfgOdo::kId}) {
    say(receiver, id, {});
    now_ += 30ms;
    receiver.advance(now_);
  }
  const ExampleDirectory directory;
  const auto input = directory.path / "messages.ubx";
  std::ofstream(input, std::ios::binary)
      .write(reinterpret_cast<const char*>(line_.all.data()),
             static_cast<std::streamsize>(line_.all.size()));
  test::ChildProcess ubxtool({"ubxtool", "-f", input.string(), "-v", "2", "-w", "1"},
                             directory.path / "ubxtool.txt");
  EXPECT_EQ(ubxtool.wait(), 0);
  const std::string text = ubxtool.output();
  for (const char* expected :
       {"TOD 39602 fTOD 0 Nt 883  N4 8", "Valid x3 tAcc 20", "SOW 115206", "galTOW 115220",
        "UBX-NAV-ODO", "meanAcc 948683264", "UBX-NAV-RELPOSNED", "numSigs 8", "nPorts 1",
        "0x100 (UART1)", "UBX-MON-GNSS", "UBX-MON-PATCH", "UBX-SEC-UNIQID", "UBX-LOG-INFO",
        "UBX-CFG-ODO"}) {
    EXPECT_NE(text.find(expected), std::string::npos) << expected << "\n" << text;
  }
  EXPECT_EQ(text.find("Bad"), std::string::npos) << text;
}

// 28.0 was shown where 13.8 went over the wire: sentences of a protocol that was off.
TEST_F(UbloxModelsTest, NominalRateFollowsWhatTheClientConfigured) {
  UbloxSettings settings = of(ublox_neo_m8());
  settings.nmea_sentences = {"RMC", "GGA", "GSA", "GSV"};
  settings.ubx_messages = {"NAV-PVT", "NAV-EOE"};
  UbloxReceiver receiver(settings, calendar_, line_);
  const auto counted = [&] {
    run(receiver, now_ + 1s);
    const std::uint64_t before = receiver.messages_sent();
    run(receiver, now_ + 20s);
    return static_cast<double>(receiver.messages_sent() - before) / 20.0;
  };
  run(receiver, kStart + 1500ms);
  EXPECT_NEAR(receiver.nominal_rate_hz(), counted(), 0.1);
  say(receiver, CfgMsg::kId, {0xF0, 0x00, 5});  // GGA each fifth epoch
  say(receiver, CfgMsg::kId, {0x01, 0x07, 2});  // NAV-PVT each second one
  say(receiver, CfgMsg::kId, {0x01, 0x39, 1});  // known and never sent
  say(receiver, CfgMsg::kId, {0x0D, 0x03, 1});  // with an event only
  EXPECT_NEAR(receiver.nominal_rate_hz(), counted(), 0.11);
  CfgPrt port;
  port.port = kPortUart1;
  port.mode = 0x08C0;
  port.baud = 460'800;
  port.input_protocols = port.output_protocols = kProtocolUbx;
  say(receiver, port);
  EXPECT_NEAR(receiver.nominal_rate_hz(), 1.5, 1e-9);
  EXPECT_NEAR(counted(), 1.5, 0.06);
  say(receiver, CfgRate{200, 4, 1});
  EXPECT_NEAR(receiver.nominal_rate_hz(), 1.5 / 0.8, 1e-9);
  EXPECT_NEAR(counted(), 1.5 / 0.8, 0.11);
}

TEST_F(UbloxModelsTest, NavigationRatioLeavesMeasurementsBetweenTheSolutions) {
  UbloxSettings settings = of(ublox_neo_m8t());
  settings.ubx_messages = {"NAV-PVT", "RXM-RAWX"};
  UbloxReceiver receiver(settings, calendar_, line_);
  run(receiver, kStart + 500ms);
  say(receiver, CfgRate{100, 5, 1});
  run(receiver, kStart + 1950ms);
  line_.clear();
  run(receiver, kStart + 3950ms);
  const auto all = ids();
  EXPECT_EQ(std::ranges::count(all, NavPvt92::kId), 4);
  EXPECT_EQ(std::ranges::count(all, RxmRawxHead::kId), 20);
  for (const NavPvt92& pvt : decoded<NavPvt92>()) {
    EXPECT_EQ(pvt.time_of_week_ms % 500, 0U);
  }
}

}  // namespace
}  // namespace rigwire::emulators
