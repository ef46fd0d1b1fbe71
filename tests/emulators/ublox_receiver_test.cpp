#include "emulators/ublox_receiver.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "protocols/ubx/configuration.h"
#include "protocols/ubx/navigation.h"
#include "protocols/ubx/version.h"

namespace rigwire::emulators {
namespace {

using namespace std::chrono_literals;
using namespace protocols::ubx;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::StartsWith;
using Bytes = std::vector<std::uint8_t>;

class Line final : public ByteOutput {
 public:
  void send(SimTime due, std::span<const std::uint8_t> bytes) override {
    EXPECT_GE(due, last_due);
    EXPECT_LE(bytes.size(), 8U);
    EXPECT_FALSE(bytes.empty());
    if (first_due == kNever) {
      first_due = due;
    }
    last_due = due;
    all.insert(all.end(), bytes.begin(), bytes.end());
  }
  void clear() {
    all.clear();
    first_due = kNever;
  }
  std::string text() const { return {all.begin(), all.end()}; }
  std::vector<std::string> sentences() const {
    std::vector<std::string> found;
    for (std::size_t at = 0; at < all.size();) {
      const auto rest = std::span(all).subspan(at);
      if (const auto s = protocols::nmea::decode_sentence(rest); s.ok()) {
        found.emplace_back(rest.begin(), rest.begin() + std::ptrdiff_t(s.consumed()) - 2);
        at += s.consumed();
      } else if (const auto f = decode_frame(rest); f.ok()) {
        at += f.consumed();
      } else {
        ADD_FAILURE() << "garbage on the line at " << at;
        break;
      }
    }
    return found;
  }
  std::vector<std::pair<MessageId, Bytes>> frames() const {
    std::vector<std::pair<MessageId, Bytes>> found;
    for (std::size_t at = 0; at < all.size();) {
      const auto rest = std::span(all).subspan(at);
      if (const auto f = decode_frame(rest); f.ok()) {
        found.emplace_back(f->id, Bytes(f->payload.begin(), f->payload.end()));
        at += f.consumed();
      } else if (const auto s = protocols::nmea::decode_sentence(rest); s.ok()) {
        at += s.consumed();
      } else {
        ADD_FAILURE() << "garbage on the line at " << at;
        break;
      }
    }
    return found;
  }
  Bytes all;
  SimTime first_due = kNever;
  SimTime last_due{};
};

GnssSample good_sample(SimTime time) {
  GnssSample sample;
  sample.time = time;
  sample.fix = GnssFix::three_d;
  sample.latitude_deg = 49.4240123;
  sample.longitude_deg = -7.7510456;
  sample.ellipsoid_height_m = 328.25;
  sample.geoid_separation_m = 48.0;
  sample.velocity_ned_mps = {1.0, 1.0, -0.25};
  sample.horizontal_accuracy_m = 2.5;
  sample.vertical_accuracy_m = 4.0;
  sample.speed_accuracy_mps = 0.1;
  sample.time_accuracy_s = 20e-9;
  sample.horizontal_dilution = 1.59;
  sample.vertical_dilution = 3.04;
  sample.position_dilution = 2.03;
  sample.time_dilution = 1.2;
  for (std::uint8_t prn = 1; prn <= 8; ++prn) {
    sample.satellites.push_back({prn, 0.5 * prn, 0.1 * prn, 40.0, true, true});
  }
  return sample;
}

class UbloxReceiverTest : public testing::Test {
 protected:
  UbloxSettings quiet() const {
    UbloxSettings settings;
    settings.nmea_sentences.clear();
    settings.start_banner = false;
    settings.baud = 115200;
    return settings;
  }
  /// Feeds samples as planned until `until`, then lets everything leave.
  void run(UbloxReceiver& receiver, SimTime until,
           const std::function<void(GnssSample&)>& change = {}) {
    while (true) {
      const SimTime next = receiver.sample_plan().next_after(now_);
      const SimTime event = receiver.next_event();
      const SimTime step = std::min(next, event);
      if (step > until) {
        break;
      }
      receiver.advance(step);
      now_ = std::max(now_, step);
      if (next == step) {
        GnssSample sample = good_sample(step);
        if (change) {
          change(sample);
        }
        receiver.update(sample);
      }
    }
    receiver.advance(until);
    now_ = until;
  }
  template <class Message>
  std::vector<Message> decoded() const {
    std::vector<Message> found;
    for (const auto& [id, payload] : line_.frames()) {
      if (id == Message::kId) {
        EXPECT_EQ(payload.size(), Message::kLength);
        found.push_back(read_payload<Message>(payload));
      }
    }
    return found;
  }
  std::vector<MessageId> ids() const {
    std::vector<MessageId> found;
    for (const auto& [id, payload] : line_.frames()) {
      found.push_back(id);
    }
    return found;
  }
  void say(UbloxReceiver& receiver, MessageId id, const Bytes& payload) {
    Bytes frame(kOverheadBytes + payload.size());
    ASSERT_EQ(encode_frame(id, payload, frame), frame.size());
    receiver.receive(now_, frame);
  }
  template <class Message>
  void say(UbloxReceiver& receiver, const Message& message) {
    receiver.receive(now_, encode(message));
  }

  Calendar calendar_{UtcTime{2026, 6, 1, 8, 0, 0, 0}};
  Line line_;
  SimTime now_ = kStart;
};

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
  const double seconds = double(line_.all.size()) / 960.0;
  EXPECT_NEAR(to_seconds(line_.last_due - (kStart + 1080ms)), seconds, 1e-8);
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
    sample = GnssSample{};
    sample.time = sample.time;
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

TEST_F(UbloxReceiverTest, FixOutsideTheLimitsIsNoFix) {
  UbloxSettings settings = quiet();
  settings.ubx_messages = {"NAV-SOL"};
  UbloxReceiver receiver(settings, calendar_, line_);
  run(receiver, kStart + 1500ms, [](GnssSample& s) { s.position_dilution = 25.5; });
  run(receiver, kStart + 2500ms, [](GnssSample& s) { s.horizontal_accuracy_m = 101.0; });
  run(receiver, kStart + 3500ms);
  const auto sol = decoded<NavSol>();
  ASSERT_EQ(sol.size(), 3U);
  EXPECT_EQ(sol[0].fix_type, 0);
  EXPECT_EQ(sol[0].position_accuracy_cm, 0xFFFFFFFFU);
  EXPECT_EQ(sol[1].fix_type, 0);
  EXPECT_EQ(sol[2].fix_type, 3);
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
  run(receiver, kStart + 101'500ms);
  const auto sentences = line_.sentences();
  ASSERT_EQ(sentences.size(), 202U);
  EXPECT_EQ(sentences[0], "$GPRMC,,V,,,,,,,,,,N*53");
  EXPECT_EQ(sentences[1], "$GPGGA,,,,,,0,00,99.99,,,,,,*48");
  EXPECT_THAT(sentences[60], StartsWith("$GPRMC,080031.00,V,,,,,,,,,,N*"));
  EXPECT_THAT(sentences[80], StartsWith("$GPRMC,080041.00,V,,,,,,,010626,,,N*"));
  EXPECT_THAT(sentences[198], StartsWith("$GPRMC,080140.00,A,"));
  const auto times = decoded<NavTimegps>();
  EXPECT_EQ(times[0].week, 0);
  EXPECT_EQ(times[0].time_of_week_ms, 1000U);
  EXPECT_EQ(times[0].valid, 0);
  EXPECT_EQ(times[99].valid, 7);
}

TEST_F(UbloxReceiverTest, PollGivesTheDataThenTheAcknowledgement) {
  UbloxReceiver receiver(quiet(), calendar_, line_);
  run(receiver, kStart + 500ms);
  say(receiver, CfgRate::kId, {});
  run(receiver, now_ + 100ms);
  EXPECT_THAT(ids(), ElementsAre(CfgRate::kId, AckAck::kId));
  EXPECT_EQ(decoded<CfgRate>().at(0), (CfgRate{1000, 1, 1}));
  EXPECT_EQ(decoded<AckAck>().at(0), (AckAck{6, 8}));
}

TEST_F(UbloxReceiverTest, DefaultsAreThoseOfTheRecordedNeo7p) {
  UbloxSettings settings = quiet();
  settings.baud = 9600;
  UbloxReceiver receiver(settings, calendar_, line_);
  run(receiver, kStart + 500ms);
  const std::vector<std::pair<MessageId, std::string>> expected{
      {CfgAnt::kId, "1b00f0b9"},
      {CfgGnssHead::kId,
       "001616040004ff0001000000010103000100000005000300010000000608ff0000000000"},
      {CfgNav5::kId, "ffff000300000000102700000500fa00fa0064002c01003c000000000000000000000000"},
      {CfgRxm::kId, "0800"},
      {CfgSbas::kId, "01030300d1a20600"},
      {CfgNmea::kId, "002300020000000000000000"},
      {CfgPrt::kId, "01000000c0080000802500000700030000000000"},
      {CfgRate::kId, "e80301000100"},
  };
  for (const auto& [id, hex] : expected) {
    line_.clear();
    say(receiver, id, {});
    run(receiver, now_ + 200ms);
    const auto frames = line_.frames();
    ASSERT_EQ(frames.size(), 2U);
    std::string found;
    for (const auto byte : frames[0].second) {
      constexpr std::string_view kDigits = "0123456789abcdef";
      found += kDigits[byte / 16];
      found += kDigits[byte % 16];
    }
    EXPECT_EQ(found, hex);
    EXPECT_EQ(frames[1].first, AckAck::kId);
  }
}

TEST_F(UbloxReceiverTest, UnknownConfigurationIsRefused) {
  UbloxReceiver receiver(quiet(), calendar_, line_);
  run(receiver, kStart + 500ms);
  for (const std::uint8_t id :
       Bytes{0x07, 0x0E, 0x12, 0x1D, 0x1E, 0x29, 0x32, 0x3D, 0x53, 0x60, 0x61, 0x62, 0x8A, 0x8B}) {
    line_.clear();
    say(receiver, {0x06, id}, {});
    say(receiver, {0x06, id}, {1, 2, 3, 4});
    run(receiver, now_ + 50ms);
    EXPECT_THAT(ids(), ElementsAre(AckNak::kId, AckNak::kId)) << int(id);
    EXPECT_EQ(decoded<AckNak>().at(0), (AckNak{6, id}));
  }
}

TEST_F(UbloxReceiverTest, WrongLengthsAreRefusedAndChangeNothing) {
  UbloxReceiver receiver(quiet(), calendar_, line_);
  run(receiver, kStart + 500ms);
  say(receiver, CfgRate::kId, {0x64});
  say(receiver, CfgPrt::kId, Bytes(21, 1));
  say(receiver, CfgMsg::kId, {1, 2, 3, 4, 5});
  say(receiver, CfgGnssHead::kId, {0, 0, 22, 2, 0, 0});
  say(receiver, CfgNav5::kId, Bytes(35));
  run(receiver, now_ + 50ms);
  EXPECT_THAT(ids(), testing::Each(AckNak::kId));
  EXPECT_EQ(ids().size(), 5U);
  EXPECT_EQ(receiver.sample_plan().period, 1s);
}

TEST_F(UbloxReceiverTest, MessageRatesOfUnsupportedIdsAreRefused) {
  UbloxReceiver receiver(quiet(), calendar_, line_);
  run(receiver, kStart + 500ms);
  for (const auto& [message_class, message_id] : {std::pair{0x0B, 0x02},
                                                  {0x01, 0x35},
                                                  {0x01, 0x61},
                                                  {0x13, 0x60},
                                                  {0xF0, 0x0E},
                                                  {0x06, 0x00},
                                                  {0x01, 0x09}}) {
    line_.clear();
    const Bytes id{std::uint8_t(message_class), std::uint8_t(message_id)};
    say(receiver, CfgMsg::kId, id);
    say(receiver, CfgMsg::kId, {id[0], id[1], 1});
    run(receiver, now_ + 50ms);
    EXPECT_THAT(ids(), ElementsAre(AckNak::kId, AckNak::kId));
  }
}

TEST_F(UbloxReceiverTest, MessageRateSwitchesOnAndOff) {
  UbloxReceiver receiver(quiet(), calendar_, line_);
  run(receiver, kStart + 500ms);
  say(receiver, CfgMsg::kId, {0x01, 0x02, 2});
  run(receiver, kStart + 4900ms);
  EXPECT_EQ(decoded<NavPosllh>().size(), 2U);
  EXPECT_EQ(ids().at(0), AckAck::kId);
  line_.clear();
  say(receiver, CfgMsg{0x01, 0x02, {0, 0, 0, 0, 0, 0}});
  run(receiver, kStart + 8900ms);
  EXPECT_EQ(decoded<NavPosllh>().size(), 0U);
  line_.clear();
  say(receiver, CfgMsg::kId, {0x01, 0x02});
  run(receiver, now_ + 50ms);
  EXPECT_EQ(decoded<CfgMsg>().at(0), (CfgMsg{0x01, 0x02, {}}));
}

TEST_F(UbloxReceiverTest, RateChangesTheSamplePlan) {
  UbloxReceiver receiver(quiet(), calendar_, line_);
  run(receiver, kStart + 530ms);
  say(receiver, CfgRate{200, 5, 0});
  EXPECT_EQ(receiver.sample_plan(), (SamplePlan{kStart + 600ms, 200ms}));
  run(receiver, now_ + 20ms);
  line_.clear();
  say(receiver, CfgRate{49, 1, 1});
  say(receiver, CfgRate::kId, {});
  run(receiver, now_ + 50ms);
  EXPECT_THAT(ids(), testing::Contains(AckNak::kId));
  EXPECT_EQ(decoded<CfgRate>().at(0), (CfgRate{200, 1, 0}));  // ratio forced to 1 below protocol 18
}

TEST_F(UbloxReceiverTest, BaudChangeTakesEffectForWhatFollows) {
  UbloxSettings settings = quiet();
  settings.baud = 9600;
  UbloxReceiver receiver(settings, calendar_, line_);
  run(receiver, kStart + 500ms);
  CfgPrt uart{1, 0, 0x08D0, 115200, 0x27, 0x23, 0};
  CfgPrt usb{3, 0, 0, 0, 7, 3, 0};
  Bytes blocks(40);
  write_payload(uart, std::span(blocks).first(20));
  write_payload(usb, std::span(blocks).subspan(20));
  say(receiver, CfgPrt::kId, blocks);
  run(receiver, now_ + 50ms);
  EXPECT_EQ(receiver.baud(), 115200U);
  EXPECT_THAT(ids(), ElementsAre(AckAck::kId));
  EXPECT_NEAR(to_seconds(line_.last_due - (kStart + 500ms)), 10 * 10 / 115200.0, 1e-8);
  line_.clear();
  uart.baud = 12345;
  say(receiver, uart);
  run(receiver, now_ + 50ms);
  EXPECT_THAT(ids(), ElementsAre(AckNak::kId));
  EXPECT_EQ(receiver.baud(), 115200U);
}

TEST_F(UbloxReceiverTest, VersionIsThatOfTheNeo7p) {
  UbloxReceiver receiver(quiet(), calendar_, line_);
  run(receiver, kStart + 500ms);
  say(receiver, MonVerHead::kId, {});
  run(receiver, now_ + 100ms);
  const auto frames = line_.frames();
  ASSERT_EQ(frames.size(), 1U);  // no acknowledgement
  EXPECT_EQ(frames[0].second.size(), 220U);
  const auto version = decode_version({frames[0].first, frames[0].second});
  ASSERT_TRUE(version.ok());
  EXPECT_EQ(version->software, "1.00 (71863)");
  EXPECT_EQ(version->hardware, "00070000");
  EXPECT_THAT(version->extensions,
              ElementsAre("1.00 (59842)", "PROTVER 14.00", "FIS 0xEF4015", "MOD NEO-7P-0",
                          "PPP RAW 1.01", "GPS;SBAS;GLO;QZSS"));
}

TEST_F(UbloxReceiverTest, BurstOfTwentyFramesIsAnsweredInOrder) {
  UbloxReceiver receiver(quiet(), calendar_, line_);
  run(receiver, kStart + 500ms);
  Bytes burst;
  for (unsigned i = 0; i < 20; ++i) {
    const auto frame = encode(CfgMsg{0xF0, static_cast<std::uint8_t>(i % 6), {0, 0, 0, 0, 0, 0}});
    burst.insert(burst.end(), frame.begin(), frame.end());
  }
  receiver.receive(now_, burst);
  run(receiver, now_ + 100ms);
  EXPECT_EQ(decoded<AckAck>().size(), 20U);
  EXPECT_EQ(receiver.received().accepted, 20U);
}

TEST_F(UbloxReceiverTest, ByteByByteIsAsGoodAsAtOnce) {
  UbloxReceiver receiver(quiet(), calendar_, line_);
  run(receiver, kStart + 500ms);
  Bytes bytes{'x', 0xB5, 'y', '\r', '\n', '$', 'P', '\r', '\n'};
  const auto frame = encode(CfgRate{500, 1, 1});
  bytes.insert(bytes.end(), frame.begin(), frame.end());
  for (const auto byte : bytes) {
    receiver.receive(now_, {&byte, 1});
  }
  EXPECT_EQ(receiver.sample_plan().period, 500ms);
  EXPECT_EQ(receiver.received().accepted, 1U);
  EXPECT_GE(receiver.received().malformed, 1U);
}

TEST_F(UbloxReceiverTest, BadChecksumIsDroppedInSilence) {
  UbloxReceiver receiver(quiet(), calendar_, line_);
  run(receiver, kStart + 500ms);
  auto frame = encode(CfgRate{500, 1, 1});
  frame.back() ^= 1;
  receiver.receive(now_, frame);
  run(receiver, now_ + 50ms);
  EXPECT_TRUE(line_.all.empty());
  EXPECT_EQ(receiver.sample_plan().period, 1s);
  EXPECT_EQ(receiver.received().malformed, 1U);
}

TEST_F(UbloxReceiverTest, OversizedFrameDoesNotSwallowTheNext) {
  UbloxReceiver receiver(quiet(), calendar_, line_);
  run(receiver, kStart + 500ms);
  Bytes bytes{0xB5, 0x62, 0x06, 0x00, 0xFF, 0xFF};
  const auto frame = encode(CfgRate{500, 1, 1});
  bytes.insert(bytes.end(), frame.begin(), frame.end());
  receiver.receive(now_, bytes);
  EXPECT_EQ(receiver.sample_plan().period, 500ms);
}

TEST_F(UbloxReceiverTest, SurvivesAMegabyteOfNoise) {
  UbloxReceiver receiver(quiet(), calendar_, line_);
  run(receiver, kStart + 500ms);
  std::uint64_t state = 1;
  Bytes noise(1 << 20);
  for (auto& byte : noise) {
    state = state * 6364136223846793005ULL + 1442695040888963407ULL;
    byte = static_cast<std::uint8_t>(state >> 56U);
  }
  for (std::size_t at = 0; at < noise.size(); at += 777) {
    receiver.receive(now_,
                     std::span(noise).subspan(at, std::min<std::size_t>(777, noise.size() - at)));
  }
  EXPECT_EQ(receiver.received().bytes, noise.size());
  EXPECT_EQ(receiver.received().accepted, 0U);
  // Whatever frame the noise left open is closed by at most one longest payload.
  receiver.receive(now_, Bytes(1100, 0));
  say(receiver, CfgRate{500, 1, 1});
  EXPECT_EQ(receiver.sample_plan().period, 500ms);
}

TEST_F(UbloxReceiverTest, UnknownSentenceIsAnswered) {
  UbloxReceiver receiver(quiet(), calendar_, line_);
  run(receiver, kStart + 500ms);
  const std::string_view good = "$PUBX,40,GLL,0,1,0,0,0,0*5D\r\n";
  receiver.receive(now_, {reinterpret_cast<const std::uint8_t*>(good.data()), good.size()});
  protocols::nmea::Sentence strange("PGRMO");
  strange.empty().field("2");
  receiver.receive(now_, strange.bytes());
  run(receiver, now_ + 50ms);
  EXPECT_THAT(line_.sentences(), ElementsAre("$GPTXT,01,01,01,NMEA unknown msg*58"));
  line_.clear();
  run(receiver, kStart + 1500ms);
  EXPECT_THAT(line_.sentences(), ElementsAre(StartsWith("$GPGLL,")));
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

TEST_F(UbloxReceiverTest, ResetGreetsAgainAndForgetsWhatWasNotSaved) {
  UbloxSettings settings = quiet();
  settings.start_banner = true;
  UbloxReceiver receiver(settings, calendar_, line_);
  run(receiver, kStart + 500ms);
  say(receiver, CfgRate{200, 1, 1});
  say(receiver, CfgRst{0, 1});
  line_.clear();
  run(receiver, now_ + 900ms);
  EXPECT_EQ(line_.sentences().size(), 11U);
  EXPECT_EQ(receiver.sample_plan().period, 1s);
  say(receiver, CfgRate{200, 1, 1});
  say(receiver, CfgCfg{0, 0xFFFF, 0});
  say(receiver, CfgRst{0, 1});
  run(receiver, now_ + 900ms);
  EXPECT_EQ(receiver.sample_plan().period, 200ms);
  say(receiver, CfgCfg{0xFFFF, 0, 0xFFFF});
  EXPECT_EQ(receiver.sample_plan().period, 1s);
}

TEST_F(UbloxReceiverTest, StoppedReceiverAsksForNoSamples) {
  UbloxReceiver receiver(quiet(), calendar_, line_);
  run(receiver, kStart + 500ms);
  say(receiver, CfgRst{0, 8});
  EXPECT_EQ(receiver.sample_plan().first, kNever);
  say(receiver, CfgRst{0, 9});
  EXPECT_EQ(receiver.sample_plan().first, kStart + 1s);
}

TEST_F(UbloxReceiverTest, OnlyOneRadioPath) {
  UbloxReceiver receiver(quiet(), calendar_, line_);
  run(receiver, kStart + 500ms);
  say(receiver, CfgGnssHead::kId, {0, 0, 22, 1, 6, 8, 255, 0, 1, 0, 0, 0});  // GLONASS too
  say(receiver, CfgGnssHead::kId,
      {0, 0, 22, 4, 0, 4, 255, 0, 0, 0, 0, 0, 1,   1, 3, 0, 0, 0,
       0, 0, 5,  0, 3, 0, 0,   0, 0, 0, 6, 8, 255, 0, 1, 0, 0, 0});  // alone
  run(receiver, now_ + 50ms);
  EXPECT_THAT(ids(), ElementsAre(AckNak::kId, AckAck::kId));
}

TEST_F(UbloxReceiverTest, NoMessageIsLongerThanTheTableSays) {
  // validate() refuses rates by this table, so it must hold for the most extreme epoch.
  for (const UbloxMessage& message : ublox_messages()) {
    if (message.greatest_bytes == 0 || message.name == "MON-HW") {
      continue;
    }
    UbloxSettings settings = quiet();
    const std::vector<std::string> only(1, std::string(message.name));
    if (message.sentence) {
      settings.nmea_sentences = only;
    } else {
      settings.ubx_messages = only;
    }
    line_ = Line{};
    now_ = kStart;
    UbloxReceiver receiver(settings, calendar_, line_);
    run(receiver, kStart + 1900ms, [](GnssSample& s) {
      s.latitude_deg = -89.99;
      s.longitude_deg = -179.99;
      s.ellipsoid_height_m = -9999.9;
      s.geoid_separation_m = -99.9;
      s.velocity_ned_mps = {400.0, -300.0, 0.0};
      s.horizontal_dilution = s.vertical_dilution = 99.0;
      s.position_dilution = 24.0;
      const SatelliteView view{32, 6.0, 1.5, 50.0, true, true};
      s.satellites.assign(16, view);
    });
    EXPECT_LE(line_.all.size(), message.greatest_bytes) << message.name;
    EXPECT_GE(line_.all.size() + 20, message.greatest_bytes) << message.name;
  }
}

TEST(UbloxSettings, RefuseMoreThanTheLineCarries) {
  UbloxSettings settings;
  settings.measurement_period = 200ms;
  try {
    validate(settings);
    FAIL() << "accepted";
  } catch (const std::invalid_argument& error) {
    EXPECT_THAT(error.what(), HasSubstr("960 bytes/s at 9600 baud"));
    EXPECT_THAT(error.what(), HasSubstr("bytes every 200 ms"));
  }
  settings.baud = 38400;
  EXPECT_NO_THROW(validate(settings));
}

TEST(UbloxSettings, RefuseUnknownNames) {
  UbloxSettings settings;
  settings.nmea_sentences = {"XYZ"};
  EXPECT_THROW(validate(settings), std::invalid_argument);
  settings.nmea_sentences = {"NAV-SOL"};
  EXPECT_THROW(validate(settings), std::invalid_argument);
  settings = {};
  settings.baud = 12345;
  EXPECT_THROW(validate(settings), std::invalid_argument);
}

}  // namespace
}  // namespace rigwire::emulators
