#include "emulators/ublox/receiver.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "protocols/ubx/monitor.h"
#include "rig.h"

namespace rigwire::emulators {
namespace {

using namespace std::chrono_literals;
using namespace protocols::ubx;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

TEST_F(UbloxReceiverTest, GreetsLikeANeo7p) {
  UbloxReceiver receiver(UbloxSettings{}, calendar_, line_);
  receiver.advance(kStart + 900ms);
  const auto sentences = line_.sentences();
  ASSERT_EQ(sentences.size(), 11U);
  EXPECT_EQ(sentences[0], "$GPTXT,01,01,02,u-blox ag - www.u-blox.com*50");
  EXPECT_EQ(sentences[1], "$GPTXT,01,01,02,HW  UBX-G70xx   00070000 FF7FFFFFo*69");
  EXPECT_EQ(sentences[2], "$GPTXT,01,01,02,EXT CORE 1.00 (71863) Jul 15 2013 15:48:11*45");
  EXPECT_EQ(sentences[3], "$GPTXT,01,01,02,ROM BASE 1.00 (59842) Jun 27 2012 17:43:52*57");
  EXPECT_EQ(sentences[4], "$GPTXT,01,01,02,MOD NEO-7P-0*38");
  EXPECT_EQ(sentences[5], "$GPTXT,01,01,02,PROTVER 14.00*1E");
  EXPECT_EQ(sentences[6], "$GPTXT,01,01,02,PPP RAW 1.01*47");
  EXPECT_EQ(sentences[7], "$GPTXT,01,01,02,ANTSUPERV=AC SD PDoS SR*20");
  EXPECT_EQ(sentences[8], "$GPTXT,01,01,02,ANTSTATUS=OK*3B");
  EXPECT_EQ(sentences[9], "$GPTXT,01,01,02,FIS 0xEF4015 found*2C");
  EXPECT_EQ(sentences[10], "$GPTXT,01,01,02,LLC FFFFFFFF-FFFFFFFF-FFFFFFFF-FFFFFFFF-FFFFFFFD*2C");
}

TEST_F(UbloxReceiverTest, DefaultEpochIsTheNmeaSetInTheRealOrder) {
  UbloxSettings settings;
  settings.start_banner = false;
  UbloxReceiver receiver(settings, calendar_, line_);
  run(receiver, kStart + 1900ms);
  EXPECT_THAT(line_.sentences(),
              ElementsAre(StartsWith("$GPRMC,080001.00,A,4925.44074,N,00745.06274,W,2.749,45.00,"
                                     "010626,,,A*"),
                          StartsWith("$GPVTG,45.00,T,,M,2.749,N,5.091,K,A*"),
                          StartsWith("$GPGGA,080001.00,4925.44074,N,00745.06274,W,1,08,1.59,"),
                          StartsWith("$GPGSA,A,3,01,02,03,04,05,06,07,08,,,,,2.03,1.59,3.04*"),
                          StartsWith("$GPGSV,2,1,08,01,06,029,40,"),
                          StartsWith("$GPGSV,2,2,08,05,29,143,40,"),
                          StartsWith("$GPGLL,4925.44074,N,00745.06274,W,080001.00,A,A*")));
}

TEST_F(UbloxReceiverTest, BytesLeaveAtTheLineSpeed) {
  UbloxSettings settings;
  settings.start_banner = false;
  UbloxReceiver receiver(settings, calendar_, line_);
  run(receiver, kStart + 1900ms);
  // First chunk: 8 bytes after epoch + latency; the whole epoch at 960 bytes/s without a gap.
  EXPECT_EQ(line_.first_due, kStart + 1080ms + Duration{8'333'333});
  const double receiver_seconds = double(line_.all.size()) / 960.0;
  EXPECT_NEAR(to_seconds(line_.last_due - (kStart + 1080ms)), receiver_seconds, 1e-8);
}

TEST_F(UbloxReceiverTest, EpochsAlignToGpsTime) {
  calendar_ = Calendar(UtcTime{2026, 6, 1, 8, 0, 0, 250'000'000});
  UbloxReceiver receiver(UbloxSettings{}, calendar_, line_);
  EXPECT_EQ(receiver.sample_plan().first, kStart + 750ms);
  EXPECT_EQ(receiver.sample_plan().period, 1s);
}

TEST_F(UbloxReceiverTest, UbxMessagesCarryTheTruth) {
  UbloxSettings settings = quiet();
  settings.ubx_messages = {"NAV-SOL",   "NAV-PVT",     "NAV-POSLLH",  "NAV-VELNED",
                           "NAV-DOP",   "NAV-SVINFO",  "NAV-TIMEGPS", "NAV-STATUS",
                           "NAV-CLOCK", "NAV-TIMEUTC", "NAV-POSECEF", "NAV-VELECEF"};
  UbloxReceiver receiver(settings, calendar_, line_);
  run(receiver, kStart + 1900ms);
  const auto pvt = decoded<NavPvt>();
  ASSERT_EQ(pvt.size(), 1U);
  EXPECT_EQ(pvt[0].latitude_e7deg, 494'240'123);
  EXPECT_EQ(pvt[0].longitude_e7deg, -77'510'456);
  EXPECT_EQ(pvt[0].ellipsoid_height_mm, 328'250);
  EXPECT_EQ(pvt[0].mean_sea_level_height_mm, 280'250);
  EXPECT_EQ(pvt[0].velocity_ned_mmps, (std::array{1000, 1000, -250}));
  EXPECT_EQ(pvt[0].ground_speed_mmps, 1414);
  EXPECT_EQ(pvt[0].heading_e5deg, 4'500'000);
  EXPECT_EQ(pvt[0].fix_type, 3);
  EXPECT_EQ(pvt[0].valid, 7);
  EXPECT_EQ(pvt[0].second, 1);
  EXPECT_EQ(pvt[0].satellites_used, 8);
  EXPECT_EQ(pvt[0].position_dilution_e2, 203);
  // Monday 08:00:01 UTC is 18 s later in GPS time.
  EXPECT_EQ(pvt[0].time_of_week_ms, (86'400U + 8 * 3600 + 19) * 1000);
  const auto sol = decoded<NavSol>();
  ASSERT_EQ(sol.size(), 1U);
  EXPECT_EQ(sol[0].week, 2421);
  EXPECT_EQ(sol[0].flags, 0xDD);
  // Independently: cartesian coordinates of that point (WGS-84), to a centimetre.
  const double norm = std::sqrt(std::pow(sol[0].position_cm[0] / 100.0, 2) +
                                std::pow(sol[0].position_cm[1] / 100.0, 2) +
                                std::pow(sol[0].position_cm[2] / 100.0, 2));
  EXPECT_NEAR(norm, 6'366'190.0, 500.0);
  const double speed =
      std::hypot(sol[0].velocity_cmps[0], sol[0].velocity_cmps[1], sol[0].velocity_cmps[2]);
  EXPECT_NEAR(speed, 143.6, 1.0);
  EXPECT_EQ(decoded<NavTimegps>().at(0).leap_seconds, 18);
  EXPECT_EQ(decoded<NavTimegps>().at(0).valid, 7);
  EXPECT_EQ(decoded<NavDop>().at(0).horizontal_e2, 159);
  EXPECT_EQ(decoded<NavVelned>().at(0).velocity_ned_cmps, (std::array{100, 100, -25}));
}

TEST_F(UbloxReceiverTest, NoFixHasNoDilutionAndGrowingAccuracy) {
  UbloxSettings settings = quiet();
  settings.ubx_messages = {"NAV-DOP", "NAV-SOL"};
  UbloxReceiver receiver(settings, calendar_, line_);
  run(receiver, kStart + 1900ms);
  run(receiver, kStart + 3900ms, [](GnssSample& sample) {
    const SimTime time = sample.time;
    sample = GnssSample{};
    sample.time = time;
  });
  const auto dop = decoded<NavDop>();
  const auto sol = decoded<NavSol>();
  ASSERT_GE(sol.size(), 2U);
  EXPECT_EQ(dop.back().position_e2, 9999);
  EXPECT_EQ(sol.back().position_dilution_e2, 9999);
  EXPECT_EQ(sol.back().flags, 0xDC);
  EXPECT_EQ(sol.back().satellites_used, 0);
  EXPECT_EQ(sol.back().position_cm, sol.front().position_cm);
  EXPECT_GT(sol.back().position_accuracy_cm, sol.front().position_accuracy_cm);
}

TEST_F(UbloxReceiverTest, TwoSatellitesGiveNoFixInNmea) {
  UbloxSettings settings;
  settings.start_banner = false;
  UbloxReceiver receiver(settings, calendar_, line_);
  run(receiver, kStart + 1900ms, [](GnssSample& sample) {
    sample.fix = GnssFix::bad;
    sample.satellites.resize(2);
  });
  EXPECT_THAT(line_.sentences(),
              testing::IsSupersetOf({StartsWith("$GPRMC,080001.00,V,,,,,,,010626,,,N*"),
                                     StartsWith("$GPGGA,080001.00,,,,,0,00,99.99,,,,,,*"),
                                     StartsWith("$GPGSA,A,1,,,,,,,,,,,,,99.99,99.99,99.99*30"),
                                     StartsWith("$GPGLL,,,,,080001.00,V,N*")}));
}

TEST_F(UbloxReceiverTest, ThreeSatellitesGiveA2dFix) {
  UbloxSettings settings = quiet();
  settings.nmea_sentences = {"GSA", "GGA"};
  settings.ubx_messages = {"NAV-SOL"};
  UbloxReceiver receiver(settings, calendar_, line_);
  run(receiver, kStart + 1900ms, [](GnssSample& sample) {
    sample.fix = GnssFix::two_d;
    sample.satellites.resize(3);
    sample.position_dilution = 0.0;  // the paper's rule
  });
  EXPECT_THAT(line_.sentences(),
              ElementsAre(HasSubstr(",1,03,1.59,"),
                          StartsWith("$GPGSA,A,2,01,02,03,,,,,,,,,,0.00,1.59,3.04*")));
  EXPECT_EQ(decoded<NavSol>().at(0).fix_type, 2);
}

TEST_F(UbloxReceiverTest, FixOutsideTheLimitsIsNotOk) {
  UbloxSettings settings = quiet();
  settings.ubx_messages = {"NAV-SOL"};
  settings.nmea_sentences = {"GGA"};
  UbloxReceiver receiver(settings, calendar_, line_);
  run(receiver, kStart + 1500ms, [](GnssSample& s) { s.position_dilution = 25.5; });
  run(receiver, kStart + 2500ms, [](GnssSample& s) { s.horizontal_accuracy_m = 101.0; });
  run(receiver, kStart + 3500ms);
  const auto sol = decoded<NavSol>();
  ASSERT_EQ(sol.size(), 3U);
  EXPECT_EQ(sol[0].fix_type, 3);
  EXPECT_EQ(sol[0].flags, 0xDC);
  EXPECT_EQ(sol[1].fix_type, 3);
  EXPECT_EQ(sol[1].flags, 0xDC);
  EXPECT_EQ(sol[2].flags, 0xDD);
  EXPECT_THAT(line_.sentences(),
              ElementsAre(HasSubstr(",0,08,"), HasSubstr(",0,08,"), HasSubstr(",1,08,")));
}

TEST_F(UbloxReceiverTest, PollBeforeTheFirstEpochKnowsTheTime) {
  UbloxReceiver receiver(quiet(), calendar_, line_);
  run(receiver, kStart + 500ms);
  say(receiver, NavTimegps::kId, {});
  run(receiver, now_ + 100ms);
  ASSERT_EQ(ids().size(), 1U);
  EXPECT_EQ(decoded<NavTimegps>().at(0).week, 2421);
  EXPECT_EQ(decoded<NavTimegps>().at(0).leap_seconds, 18);
}

TEST_F(UbloxReceiverTest, SecondsRoundIntoTheNextDay) {
  calendar_ = Calendar(UtcTime{2026, 6, 1, 23, 59, 58, 0});
  UbloxSettings settings = quiet();
  settings.nmea_sentences = {"RMC"};
  settings.ubx_messages = {"NAV-PVT"};
  UbloxReceiver receiver(settings, calendar_, line_);
  receiver.update(good_sample(kStart + 1996ms));
  receiver.advance(kStart + 3s);
  EXPECT_THAT(line_.sentences().at(0), StartsWith("$GPRMC,000000.00,A"));
  EXPECT_THAT(line_.sentences().at(0), HasSubstr(",020626,"));
  const NavPvt pvt = decoded<NavPvt>().at(0);
  EXPECT_EQ(pvt.day, 2);
  EXPECT_EQ(pvt.second, 0);
  EXPECT_EQ(pvt.nanosecond, -4'000'000);
}

TEST_F(UbloxReceiverTest, LeapSecondIsPrintedAsSecond60) {
  calendar_ = Calendar(UtcTime{2016, 12, 31, 23, 59, 58, 0});
  UbloxSettings settings = quiet();
  settings.nmea_sentences = {"GLL"};
  settings.ubx_messages = {"NAV-TIMEGPS"};
  UbloxReceiver receiver(settings, calendar_, line_);
  run(receiver, kStart + 3900ms);
  EXPECT_THAT(line_.sentences(), ElementsAre(HasSubstr(",235959.00,"), HasSubstr(",235960.00,"),
                                             HasSubstr(",000000.00,")));
  const auto times = decoded<NavTimegps>();
  EXPECT_EQ(times.at(1).leap_seconds, 17);
  EXPECT_EQ(times.at(2).leap_seconds, 18);
}

TEST_F(UbloxReceiverTest, WeekRollsOver) {
  calendar_ = Calendar(UtcTime{2026, 6, 6, 23, 59, 40, 0});
  UbloxSettings settings = quiet();
  settings.ubx_messages = {"NAV-TIMEGPS"};
  UbloxReceiver receiver(settings, calendar_, line_);
  run(receiver, kStart + 2500ms);
  const auto times = decoded<NavTimegps>();
  ASSERT_EQ(times.size(), 2U);
  EXPECT_EQ(times[0].week, 2421);
  EXPECT_EQ(times[0].time_of_week_ms, 604'799'000U);
  EXPECT_EQ(times[1].week, 2422);
  EXPECT_EQ(times[1].time_of_week_ms, 0U);
}

TEST_F(UbloxReceiverTest, TimeOfWeekRoundsUpIntoTheNextWeek) {
  calendar_ = Calendar(UtcTime{2026, 6, 6, 23, 59, 40, 0});
  UbloxSettings settings = quiet();
  settings.ubx_messages = {"NAV-TIMEGPS"};
  UbloxReceiver receiver(settings, calendar_, line_);
  receiver.update(good_sample(kStart + 2s - 300us));
  receiver.advance(kStart + 3s);
  const NavTimegps time = decoded<NavTimegps>().at(0);
  EXPECT_EQ(time.week, 2422);
  EXPECT_EQ(time.time_of_week_ms, 0U);
  EXPECT_EQ(time.time_of_week_rest_ns, -300'000);
}

TEST_F(UbloxReceiverTest, CourseFreezesAtStandstill) {
  UbloxSettings settings = quiet();
  settings.nmea_sentences = {"VTG"};
  settings.ubx_messages = {"NAV-VELNED"};
  UbloxReceiver receiver(settings, calendar_, line_);
  run(receiver, kStart + 1500ms);
  run(receiver, kStart + 2500ms, [](GnssSample& s) { s.velocity_ned_mps = {-0.02, 0.01, 0.0}; });
  EXPECT_THAT(line_.sentences(), ElementsAre(StartsWith("$GPVTG,45.00,T"),
                                             StartsWith("$GPVTG,,T,,M,0.043,N,0.080,K")));
  const auto velocity = decoded<NavVelned>();
  EXPECT_EQ(velocity.at(1).heading_e5deg, 4'500'000);  // the last course
  EXPECT_EQ(velocity.at(1).heading_accuracy_e5deg, 18'000'000U);
}

TEST_F(UbloxReceiverTest, ColdStartClimbsTheLadder) {
  UbloxSettings settings = quiet();
  settings.nmea_sentences = {"RMC", "GGA"};
  settings.ubx_messages = {"NAV-TIMEGPS"};
  settings.time_to_first_fix = 100s;
  UbloxReceiver receiver(settings, calendar_, line_);
  run(receiver, kStart + 101'500ms, [](GnssSample& sample) {
    for (SatelliteView& view : sample.satellites) {  // all around
      view.azimuth_rad = std::fmod(2.4 * view.number, 6.28);
      view.elevation_rad = 0.15 + 0.2 * (view.number % 5);
    }
  });
  const auto sentences = line_.sentences();
  ASSERT_EQ(sentences.size(), 202U);
  EXPECT_EQ(sentences[0], "$GPRMC,,V,,,,,,,,,,N*53");
  EXPECT_EQ(sentences[1], "$GPGGA,,,,,,0,00,99.99,,,,,,*48");
  // UTC by the firmware's 16 leap receiver_seconds, until the almanac's page 18 has been received.
  EXPECT_THAT(sentences[60], StartsWith("$GPRMC,080033.00,V,,,,,,,,,,N*"));
  EXPECT_THAT(sentences[80], StartsWith("$GPRMC,080043.00,V,,,,,,,010626,,,N*"));
  EXPECT_THAT(sentences[196], StartsWith("$GPRMC,080139.00,V,"));
  EXPECT_THAT(sentences[197], StartsWith("$GPGGA,080139.00,,,,,0,03,"));
  EXPECT_THAT(sentences[197], Not(HasSubstr("99.99")));  // real dilution
  EXPECT_THAT(sentences[198], StartsWith("$GPRMC,080140.00,A,"));
  const auto times = decoded<NavTimegps>();
  EXPECT_EQ(times[0].week, 0);
  EXPECT_EQ(times[0].time_of_week_ms, 1000U);
  EXPECT_EQ(times[0].valid, 0);
  EXPECT_EQ(times[31].valid, 3);
  EXPECT_EQ(times[31].leap_seconds, 16);
  EXPECT_EQ(times[99].valid, 7);
  EXPECT_EQ(times[99].leap_seconds, 18);
}

TEST_F(UbloxReceiverTest, FullLineLosesWholeMessagesAndSaysSo) {
  UbloxSettings settings = quiet();
  settings.baud = 9600;
  settings.transmit_buffer_bytes = 1024;
  UbloxReceiver receiver(settings, calendar_, line_);
  run(receiver, kStart + 500ms);
  for (int i = 0; i < 10; ++i) {
    say(receiver, MonVerHead::kId, {});
  }
  run(receiver, now_ + 3s);
  const auto counters = receiver.counters();
  EXPECT_EQ(counters.messages_lost, 6U);  // 4 of 228 bytes fit into 1024
  EXPECT_EQ(line_.frames().size(), 4U);
  EXPECT_THAT(line_.sentences(), ElementsAre(StartsWith("$GPTXT,01,01,00,txbuf alloc*")));
}

TEST_F(UbloxReceiverTest, NoMessageIsLongerThanTheTableSays) {
  // validate() refuses rates by this table, so it must hold for the most extreme epoch.
  for (const UbloxMessage& message : ublox_neo_7p().messages) {
    if (message.greatest_bytes == 0 || !message.periodic || message.name == "MON-HW") {
      continue;
    }
    UbloxSettings settings = quiet();
    const std::vector<std::string> only(1, std::string(message.name));
    if (message.sentence) {
      settings.nmea_sentences = only;
    } else {
      settings.ubx_messages = only;
    }
    line_ = UbloxLine{};
    now_ = kStart;
    UbloxReceiver receiver(settings, calendar_, line_);
    run(receiver, kStart + 1900ms, [](GnssSample& s) {
      s.latitude_deg = -89.99;
      s.longitude_deg = -179.99;
      s.ellipsoid_height_m = -9999.9;
      s.geoid_separation_m = -99.9;
      s.velocity_ned_mps = {240.0, -180.0, 0.0};  // below the portable model's limit
      s.horizontal_dilution = s.vertical_dilution = 99.0;
      s.position_dilution = 24.0;
      const SatelliteView view{32, 6.0, 1.5, 50.0, true, true};
      s.satellites.assign(16, view);
    });
    EXPECT_LE(line_.all.size(), message.greatest_bytes) << message.name;
    if (message.id.message_class == 0x01 && message.name != "NAV-SBAS") {
      EXPECT_GE(line_.all.size() + 20, message.greatest_bytes) << message.name;
    }
  }
}

}  // namespace
}  // namespace rigwire::emulators
