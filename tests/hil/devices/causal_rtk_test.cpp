// RTK of a ZED-F9P lives on what another one sends over a wire: from bytes to a fix, and back when
// they stop.
#include <gtest/gtest.h>

#include <cmath>

#include "emulators/ublox/receiver.h"
#include "protocols/nmea/sentence.h"
#include "protocols/rtcm3/message.h"
#include "protocols/ubx/configuration_keys.h"
#include "protocols/ubx/navigation.h"
#include "protocols/ubx/raw_measurements.h"
#include "receivers_on_wires.h"

namespace rigwire::hil {
namespace {

namespace rtcm3 = protocols::rtcm3;
namespace ubx = protocols::ubx;
using namespace std::chrono_literals;
using Bytes = std::vector<std::uint8_t>;

constexpr std::uint64_t kSeed = 7;
constexpr std::uint16_t kStation = 42;

class CausalRtk : public ::testing::Test {
 protected:
  CausalRtk() {
    settings_.profile = &emulators::ublox_zed_f9p();
    settings_.baud = 460'800;
    settings_.uart2_baud = 460'800;
    settings_.nmea_sentences = {"GGA"};
    settings_.ubx_messages = {"NAV-PVT", "NAV-RELPOSNED", "NAV-SVIN", "RXM-RTCM", "MON-COMMS"};
    parameters_.raw_measurements = true;
    parameters_.systems = {.gps = true, .glonass = true, .galileo = true, .beidou = true};
    parameters_.sky.maximum_channels = 60;
    parameters_.corrections.kind = sim::CorrectionKind::rtk;
  }

  std::unique_ptr<ReceiverOnWires> make(const std::string& name, Motion motion) {
    return std::make_unique<ReceiverOnWires>(settings_, parameters_, calendar_, frame_, antennas_,
                                             kSeed, name, std::move(motion));
  }
  std::unique_ptr<ReceiverOnWires> make_base(const Eigen::Vector3d& p_W) {
    settings_.uart2_messages = {"RTCM-1005", "RTCM-1077"};
    auto base = make("base", standing_at(p_W));
    settings_.uart2_messages = {};
    base->receiver.advance(kStart + 900ms);
    return base;
  }
  /// A fixed base whose claim is off by so much along ECEF x.
  void fix_at(ReceiverOnWires& base, const Eigen::Vector3d& p_W, double off_m = 0.0) const {
    const Eigen::Vector3d e = frame_.to_ecef(p_W);
    Keys keys{{"CFG-TMODE-MODE", 2}, {"CFG-RTCM-DF003_OUT", kStation}};
    constexpr std::array<std::string_view, 3> kAxes{"CFG-TMODE-ECEF_X", "CFG-TMODE-ECEF_Y",
                                                    "CFG-TMODE-ECEF_Z"};
    constexpr std::array<std::string_view, 3> kRests{"CFG-TMODE-ECEF_X_HP", "CFG-TMODE-ECEF_Y_HP",
                                                     "CFG-TMODE-ECEF_Z_HP"};
    for (std::size_t i = 0; i < 3; ++i) {
      const auto tenths =
          std::llround((e[static_cast<Eigen::Index>(i)] + (i == 0 ? off_m : 0)) * 1e4);
      keys.emplace_back(kAxes[i], static_cast<std::uint32_t>(tenths / 100));
      keys.emplace_back(kRests[i], static_cast<std::uint8_t>(tenths % 100));
    }
    set(base, keys);
  }
  Eigen::Vector3d place_of(const GnssSample& sample) const {
    return frame_.to_world({sample.latitude_deg, sample.longitude_deg, sample.ellipsoid_height_m});
  }
  struct Gga {
    std::string quality;
    std::string age_s;
    std::string station;
  };
  static Gga last_gga(const ReceiverOnWires& one) {
    Gga last;
    const auto& all = one.line.all;
    for (std::size_t at = 0; at < all.size(); ++at) {
      if (all[at] != '$') {
        continue;
      }
      const auto sentence = protocols::nmea::decode_sentence(std::span(all).subspan(at));
      if (sentence.ok() && sentence->type() == "GGA") {
        last = {std::string(sentence->field(5)), std::string(sentence->field(12)),
                std::string(sentence->field(13))};
      }
    }
    return last;
  }
  template <class M>
  static M last(const ReceiverOnWires& one) {
    const auto all = one.said(M::kId);
    EXPECT_FALSE(all.empty());
    return all.empty() ? M{} : ubx::read_payload<M>(all.back());
  }

  Calendar calendar_{parse_utc("2026-06-01T08:00:00Z")};
  sim::LocalFrame frame_{sim::LocalFrameParameters{}};
  std::shared_ptr<sim::AntennaBook> antennas_ = std::make_shared<sim::AntennaBook>();
  emulators::UbloxSettings settings_;
  sim::GnssParameters parameters_;
};

TEST_F(CausalRtk, WithoutAByteThereIsNoDifferentialPosition) {
  const auto rover = make("rover", standing_at({0.0, 0.0, 2.0}));
  run_until({rover.get()}, kStart + 60s);
  EXPECT_FALSE(rover->latest.differential);
  EXPECT_EQ(rover->latest.carrier, CarrierSolution::none);
  EXPECT_EQ(last_gga(*rover).quality, "1");
}

TEST_F(CausalRtk, FloatThenFixedAndTheStationIsTold) {
  const Eigen::Vector3d base_W(500.0, 0.0, 2.0);
  const auto base = make_base(base_W);
  const auto rover = make("rover", standing_at({0.0, 0.0, 2.0}));
  base->wire.to = rover.get();
  fix_at(*base, base_W);
  run_until({base.get(), rover.get()}, kStart + 3500ms);
  EXPECT_EQ(last_gga(*rover).quality, "2") << "by code, before it floats";
  EXPECT_EQ(last_gga(*rover).station, "0042");
  EXPECT_EQ(last_gga(*rover).age_s, "1.0");
  SimTime differential = kNever;
  SimTime floating = kNever;
  SimTime fixed = kNever;
  double worst_m = 0.0;
  run_until({base.get(), rover.get()}, kStart + 150s, [&](SimTime now) {
    const GnssSample& s = rover->latest;
    differential = s.differential ? std::min(differential, now) : differential;
    floating = s.carrier == CarrierSolution::floating ? std::min(floating, now) : floating;
    if (s.carrier == CarrierSolution::fixed) {
      fixed = std::min(fixed, now);
      worst_m = std::max(worst_m, (place_of(s) - Eigen::Vector3d(0.0, 0.0, 2.0)).norm());
    }
  });
  EXPECT_LE(differential, kStart + 4s);
  EXPECT_EQ(floating, kStart + 4s);
  // GPS alone, one band: twelve times 7 s in the mean, at least twelve times 4 s.
  EXPECT_GT(fixed, kStart + 50s);
  ASSERT_LT(fixed, kStart + 150s);
  EXPECT_LT(worst_m, 0.08);
  const auto gga = last_gga(*rover);
  EXPECT_EQ(gga.quality, "4");
  EXPECT_EQ(gga.station, "0042");
  EXPECT_EQ(gga.age_s, "1.0");

  const auto relative = last<ubx::NavRelposned>(*rover);
  EXPECT_EQ(relative.station, kStation);
  EXPECT_NEAR(relative.length_cm, 50'000, 6);
  EXPECT_NEAR(relative.heading_e5deg * 1e-5, 270.0, 0.02);
  EXPECT_EQ(relative.flags, ubx::kRelativeFixOk | ubx::kRelativeDifferential | ubx::kRelativeValid |
                                ubx::kRelativeCarrierFixed | ubx::kRelativeHeadingValid);
  // Each message was counted, and was of use.
  std::size_t used = 0;
  const auto received = rover->said(ubx::RxmRtcm::kId);
  for (const auto& payload : received) {
    const auto one = ubx::read_payload<ubx::RxmRtcm>(payload);
    EXPECT_EQ(one.station, kStation);
    used += one.flags == 2 << 1 ? 1 : 0;
  }
  EXPECT_GE(received.size(), 290U);
  EXPECT_GE(used + 1, received.size()) << "observations before the first place are not used";
  const auto comms = rover->said({0x0A, 0x36});
  ASSERT_EQ(comms.back().size(), 8U + 2U * 40U) << "UART2 is listed";
  EXPECT_EQ(comms.back()[48] | comms.back()[49] << 8, 0x0201);
}

// Pulled: the error grows with the age, 30 s later ambiguities go, 60 s later everything.
TEST_F(CausalRtk, PullingTheWireDegradesItStepByStep) {
  parameters_.corrections.convergence_s = 0.1;  // 48 s then, the shortest
  const Eigen::Vector3d base_W(30.0, 0.0, 2.0);
  const auto base = make_base(base_W);
  const auto rover = make("rover", standing_at({0.0, 0.0, 2.0}));
  base->wire.to = rover.get();
  fix_at(*base, base_W);
  std::vector<ReceiverOnWires*> both{base.get(), rover.get()};
  run_until(both, kStart + 70s);
  ASSERT_EQ(rover->latest.carrier, CarrierSolution::fixed);
  const double fresh_m = rover->latest.horizontal_accuracy_m;
  base->wire.cut = true;
  run_until(both, kStart + 95s);
  EXPECT_EQ(rover->latest.carrier, CarrierSolution::fixed);
  EXPECT_NEAR(*rover->latest.differential_age_s, 26.0, 1.1);
  EXPECT_NEAR(rover->latest.horizontal_accuracy_m - fresh_m, 25.0 * 0.03 / 60.0, 2e-3);
  run_until(both, kStart + 105s);
  EXPECT_EQ(rover->latest.carrier, CarrierSolution::floating);
  EXPECT_EQ(last_gga(*rover).quality, "5");
  run_until(both, kStart + 135s);
  EXPECT_EQ(rover->latest.carrier, CarrierSolution::none);
  EXPECT_FALSE(rover->latest.differential);
  EXPECT_EQ(last_gga(*rover).quality, "1");
  base->wire.cut = false;
  run_until(both, kStart + 139s);
  EXPECT_EQ(rover->latest.carrier, CarrierSolution::floating) << "again with its second epoch";
}

TEST_F(CausalRtk, TimeoutIsThatOfTheConfiguration) {
  const Eigen::Vector3d base_W(30.0, 0.0, 2.0);
  const auto base = make_base(base_W);
  const auto rover = make("rover", standing_at({0.0, 0.0, 2.0}));
  base->wire.to = rover.get();
  fix_at(*base, base_W);
  rover->receiver.advance(kStart + 900ms);
  set(*rover, {{"CFG-NAVSPG-CONSTR_DGNSSTO", 5}});
  std::vector<ReceiverOnWires*> both{base.get(), rover.get()};
  run_until(both, kStart + 20s);
  base->wire.cut = true;
  run_until(both, kStart + 24s);
  EXPECT_TRUE(rover->latest.differential);
  run_until(both, kStart + 27s);
  EXPECT_FALSE(rover->latest.differential);
}

TEST_F(CausalRtk, FloatModeNeverFixes) {
  parameters_.corrections.convergence_s = 0.1;
  const Eigen::Vector3d base_W(30.0, 0.0, 2.0);
  const auto base = make_base(base_W);
  const auto rover = make("rover", standing_at({0.0, 0.0, 2.0}));
  base->wire.to = rover.get();
  fix_at(*base, base_W);
  rover->receiver.advance(kStart + 900ms);
  set(*rover, {{"CFG-NAVHPG-DGNSSMODE", 2}});
  run_until({base.get(), rover.get()}, kStart + 100s);
  EXPECT_EQ(rover->latest.carrier, CarrierSolution::floating);
}

// A base that claims to stand 20 m beside its place moves its rovers by as much.
TEST_F(CausalRtk, WrongPlaceOfTheBaseMovesTheRover) {
  parameters_.corrections.convergence_s = 0.1;
  const Eigen::Vector3d base_W(300.0, 0.0, 2.0);
  const auto base = make_base(base_W);
  const auto rover = make("rover", standing_at({0.0, 0.0, 2.0}));
  base->wire.to = rover.get();
  fix_at(*base, base_W, 20.0);
  run_until({base.get(), rover.get()}, kStart + 100s);
  ASSERT_EQ(rover->latest.carrier, CarrierSolution::fixed);
  const Eigen::Vector3d off_E =
      frame_.to_ecef(place_of(rover->latest)) - frame_.to_ecef(Eigen::Vector3d(0.0, 0.0, 2.0));
  EXPECT_NEAR(off_E.x(), 20.0, 0.1);
  EXPECT_LT(std::hypot(off_E.y(), off_E.z()), 0.1);
}

TEST_F(CausalRtk, OnlyTheStationThatTheFilterNames) {
  const Eigen::Vector3d base_W(30.0, 0.0, 2.0);
  const auto base = make_base(base_W);
  const auto rover = make("rover", standing_at({0.0, 0.0, 2.0}));
  base->wire.to = rover.get();
  fix_at(*base, base_W);
  rover->receiver.advance(kStart + 900ms);
  set(*rover, {{"CFG-RTCM-DF003_IN", kStation + 1}, {"CFG-RTCM-DF003_IN_FILTER", 2}});
  run_until({base.get(), rover.get()}, kStart + 20s);
  EXPECT_FALSE(rover->latest.differential);
  const auto one = last<ubx::RxmRtcm>(*rover);
  EXPECT_EQ(one.flags, 1 << 1) << "not used";
}

// No 1005 before the survey is over; then its mean is the place, and the receiver tells time only.
TEST_F(CausalRtk, SurveyEndsByDurationAndAccuracy) {
  const Eigen::Vector3d base_W(30.0, 0.0, 2.0);
  const auto base = make_base(base_W);
  const auto rover = make("rover", standing_at({0.0, 0.0, 2.0}));
  base->wire.to = rover.get();
  set(*base, {{"CFG-TMODE-MODE", 1},
              {"CFG-TMODE-SVIN_MIN_DUR", 30},
              {"CFG-TMODE-SVIN_ACC_LIMIT", 50'000}});
  std::vector<ReceiverOnWires*> both{base.get(), rover.get()};
  run_until(both, kStart + 25s);
  auto survey = last<ubx::NavSvin>(*base);
  EXPECT_EQ(survey.active, 1);
  EXPECT_EQ(survey.valid, 0);
  EXPECT_FALSE(rover->latest.differential);
  run_until(both, kStart + 45s);
  survey = last<ubx::NavSvin>(*base);
  EXPECT_EQ(survey.active, 0);
  EXPECT_EQ(survey.valid, 1);
  EXPECT_EQ(survey.duration_s, 30U);
  EXPECT_EQ(survey.observations, 31U);
  const Eigen::Vector3d e = frame_.to_ecef(base_W);
  // Two standard deviations of the height of a NEO-7P's errors, which half a minute does not
  // average.
  EXPECT_NEAR(survey.mean_cm[0] * 0.01, e.x(), 8.0);
  EXPECT_EQ(last<ubx::NavPvt92>(*base).fix_type, 5);
  EXPECT_EQ(rover->latest.carrier, CarrierSolution::floating);
}

// Two antennas a metre apart on something that turns: heading to the degree at 5 Hz.
TEST_F(CausalRtk, MovingBaseGivesHeading) {
  settings_.measurement_period = 200ms;
  parameters_.corrections.convergence_s = 0.1;
  const auto turning = [](double radius_m) {
    return Motion([radius_m](SimTime time) {
      constexpr double kRate = 0.3;
      const double angle = kRate * to_seconds(time);
      sim::LinkMotion motion;
      motion.X_WL.translation() =
          Eigen::Vector3d(50.0 + radius_m * std::cos(angle), radius_m * std::sin(angle), 2.0);
      motion.v_WL_W = kRate * radius_m * Eigen::Vector3d(-std::sin(angle), std::cos(angle), 0.0);
      return motion;
    });
  };
  settings_.uart2_messages = {"RTCM-4072.0", "RTCM-1077"};
  const auto base = make("base", turning(-0.5));
  settings_.uart2_messages = {};
  const auto rover = make("rover", turning(0.5));
  base->wire.to = rover.get();
  run_until({base.get(), rover.get()}, kStart + 120s);
  std::size_t headings = 0;
  double squares_deg2 = 0.0;
  for (const auto& payload : rover->said(ubx::NavRelposned::kId)) {
    const auto m = ubx::read_payload<ubx::NavRelposned>(payload);
    if ((m.flags & ubx::kRelativeHeadingValid) == 0) {
      continue;
    }
    EXPECT_NE(m.flags & ubx::kRelativeMovingBase, 0U);
    EXPECT_NEAR(m.length_cm, 100, 6);
    ++headings;
    // From base to rover: east of north by 90 degrees less the angle of the turn.
    const double start_ms = static_cast<double>(calendar_.gps(kStart).time_of_week_ns) * 1e-6;
    const double angle_deg = 0.3 * (m.time_of_week_ms - start_ms) * 1e-3 * 180.0 / 3.14159265358979;
    const double off_deg = std::remainder(m.heading_e5deg * 1e-5 - (90.0 - angle_deg), 360.0);
    squares_deg2 += off_deg * off_deg;
  }
  ASSERT_GT(headings, 200U);
  EXPECT_LT(std::sqrt(squares_deg2 / static_cast<double>(headings)), 1.5);
}

/// The observations as another station's older software has them: 1001 to 1004, 1009 to 1012, or
/// MSM5. Other messages stay what they are.
Bytes as_older(const rtcm3::FrameView& frame, bool multiple, bool second_band, bool extended) {
  auto message = *rtcm3::decode_message(frame.payload);
  auto* const signals = std::get_if<rtcm3::MultipleSignals>(&message);
  if (signals != nullptr && multiple) {
    signals->form = rtcm3::MsmForm::five;
  } else if (signals != nullptr) {
    constexpr std::uint32_t kOfDay = (1U << 27U) - 1U;
    rtcm3::LegacyObservations older;
    older.glonass = signals->system == rtcm3::MsmSystem::glonass;
    older.second_band = second_band;
    older.extended = extended;
    older.station = signals->station;
    older.time_ms = older.glonass ? signals->epoch & kOfDay : signals->epoch;
    older.more = signals->more;
    for (const auto& cell : std::span(signals->cells).first(signals->count)) {
      if (older.count == 0 || older.satellites[older.count - 1].number != cell.satellite) {
        auto& s = older.satellites[older.count++];
        s.number = cell.satellite;
        s.channel = signals->channels[cell.satellite - 1U].value_or(0);
        s.first = cell.observation;
      } else {
        older.satellites[older.count - 1].second = cell.observation;
      }
    }
    message = older;
  }
  Bytes bytes(rtcm3::kGreatestFrame);
  bytes.resize(rtcm3::encode(message, bytes));
  return bytes;
}

// Integration manual, table 6: all of them are taken. Without milliseconds of light in their ranges
// (1001, 1003, 1009, 1011) the receiver puts these in by what it knows of the orbits.
TEST_F(CausalRtk, OlderObservationsAreUsedLikeThoseOfToday) {
  parameters_.corrections.convergence_s = 0.1;
  parameters_.second_signals = true;
  struct Case {
    const char* name;
    bool glonass;
    bool multiple;
    bool second_band;
    bool extended;
  };
  constexpr std::array kCases{
      Case{"1001", false, false, false, false}, Case{"1002", false, false, false, true},
      Case{"1003", false, false, true, false},  Case{"1004", false, false, true, true},
      Case{"1009", true, false, false, false},  Case{"1010", true, false, false, true},
      Case{"1011", true, false, true, false},   Case{"1012", true, false, true, true},
      Case{"MSM5", false, true, true, true}};
  const Eigen::Vector3d base_W(30.0, 0.0, 2.0);
  for (const Case& c : kCases) {
    SCOPED_TRACE(c.name);
    antennas_ = std::make_shared<sim::AntennaBook>();
    settings_.uart2_messages = {"RTCM-1005", c.glonass ? "RTCM-1087" : "RTCM-1077"};
    auto base = make("base", standing_at(base_W));
    settings_.uart2_messages = {};
    base->receiver.advance(kStart + 900ms);
    const auto rover = make("rover", standing_at({0.0, 0.0, 2.0}));
    base->wire.to = rover.get();
    base->wire.rewrite = [&c](const rtcm3::FrameView& frame) {
      return as_older(frame, c.multiple, c.second_band, c.extended);
    };
    fix_at(*base, base_W);
    SimTime fixed = kNever;
    run_until({base.get(), rover.get()}, kStart + 65s, [&](SimTime now) {
      fixed = rover->latest.carrier == CarrierSolution::fixed ? std::min(fixed, now) : fixed;
    });
    const auto one = last<ubx::RxmRtcm>(*rover);
    EXPECT_EQ(one.flags, 2 << 1) << "used";
    EXPECT_TRUE(rover->latest.differential);
    if (c.glonass) {  // its carriers are not looked at
      EXPECT_EQ(rover->latest.carrier, CarrierSolution::floating);
      continue;
    }
    // GPS alone: three times the shortest 4 s with two bands, and four times that with one.
    ASSERT_EQ(rover->latest.carrier, CarrierSolution::fixed);
    EXPECT_GT(fixed, kStart + (c.second_band ? 14s : 50s));
    EXPECT_LT(fixed, kStart + (c.second_band ? 20s : 56s));
    EXPECT_LT((place_of(rover->latest) - Eigen::Vector3d(0.0, 0.0, 2.0)).norm(), 0.08);
  }
}

TEST_F(CausalRtk, AnAntennasNameIsCountedAndNotUsed) {
  const auto rover = make("rover", standing_at({0.0, 0.0, 2.0}));
  rover->receiver.advance(kStart + 900ms);
  // 1007: station 2003, antenna "ADVNULLANTENNA", set-up 0.
  constexpr std::array<std::uint8_t, 19> payload{0x3E, 0xF7, 0xD3, 14,  'A', 'D', 'V',
                                                 'N',  'U',  'L',  'L', 'A', 'N', 'T',
                                                 'E',  'N',  'N',  'A', 0};
  Bytes frame(payload.size() + rtcm3::kHeaderBytes + rtcm3::kChecksumBytes);
  rtcm3::encode_frame(payload, frame);
  rover->receiver.receive(kStart + 900ms, frame);
  run_until({rover.get()}, kStart + 3s);
  const auto one = last<ubx::RxmRtcm>(*rover);
  EXPECT_EQ(one.message, 1007);
  EXPECT_EQ(one.station, 2003);
  EXPECT_EQ(one.flags, 1 << 1);
}

TEST_F(CausalRtk, SameSeedSameBytes) {
  const auto bytes = [this] {
    antennas_ = std::make_shared<sim::AntennaBook>();
    const Eigen::Vector3d base_W(500.0, 0.0, 2.0);
    const auto base = make_base(base_W);
    const auto rover = make("rover", standing_at({0.0, 0.0, 2.0}));
    base->wire.to = rover.get();
    fix_at(*base, base_W);
    run_until({base.get(), rover.get()}, kStart + 30s);
    return rover->line.all;
  };
  EXPECT_EQ(bytes(), bytes());
}

}  // namespace
}  // namespace rigwire::hil
