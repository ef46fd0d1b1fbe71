// RTK over the end of a week of GPS, a leap second and the end of a year, which fell into one
// minute on 2016-12-31: base and rover, every byte between them.
#include <gtest/gtest.h>

#include <array>
#include <filesystem>
#include <fstream>
#include <map>
#include <string>
#include <vector>

#include "child_process.h"
#include "emulators/ublox/receiver.h"
#include "protocols/nmea/sentence.h"
#include "protocols/rtcm3/message.h"
#include "protocols/ubx/navigation.h"
#include "protocols/ubx/raw_measurements.h"
#include "receivers_on_wires.h"

namespace rigwire::hil {
namespace {

namespace fs = std::filesystem;
namespace rtcm3 = protocols::rtcm3;
namespace ubx = protocols::ubx;
using namespace std::chrono_literals;

constexpr std::uint64_t kRtkOverMidnightSeed = 7;
constexpr int kSeconds = 180;  // from 23:58:30 on: the week ends after 73 s, the year after 91

class RtkOverMidnight : public ::testing::Test {
 protected:
  RtkOverMidnight() {
    settings_.profile = &emulators::ublox_zed_f9p();
    settings_.baud = settings_.uart2_baud = 460'800;
    settings_.nmea_sentences = {"RMC", "GGA", "ZDA"};
    settings_.ubx_messages = {"NAV-RELPOSNED", "RXM-RTCM"};
    parameters_.raw_measurements = true;
    parameters_.second_signals = true;
    parameters_.systems = {.gps = true, .glonass = true, .galileo = true, .beidou = true};
    parameters_.sky.maximum_channels = 60;
    parameters_.corrections.kind = sim::CorrectionKind::rtk;
    parameters_.corrections.convergence_s = 0.1;  // the shortest then, 4 s
  }

  /// The rover's second UART hears the base from the first second on.
  void run(const std::function<void(SimTime)>& watch) {
    settings_.uart2_messages = {"RTCM-1005", "RTCM-1077", "RTCM-1087",
                                "RTCM-1097", "RTCM-1127", "RTCM-1230"};
    const Eigen::Vector3d place_W(200.0, 0.0, 2.0);
    const Eigen::Vector3d place_E_m = frame_.to_ecef(place_W);
    settings_.place_E_m = {place_E_m.x(), place_E_m.y(), place_E_m.z()};
    base_ = make("base", place_W);
    settings_.uart2_messages = {};
    settings_.place_E_m.reset();
    rover_ = make("rover", {0.0, 0.0, 2.0});
    base_->wire.to = rover_.get();
    base_->wire.delay = delay_;
    for (ReceiverOnWires* one : {base_.get(), rover_.get()}) {
      // Their firmware is younger than the date: it would take it for one of 2036.
      one->receiver.advance(kStart + 900ms);
      set(*one, {{"CFG-NAVSPG-WKNROLLOVER", 1800}});
    }
    base_->wire.rewrite = [this](const rtcm3::FrameView& frame) {
      Bytes bytes(frame.payload.size() + rtcm3::kHeaderBytes + rtcm3::kChecksumBytes);
      rtcm3::encode_frame(frame.payload, bytes);
      said_.insert(said_.end(), bytes.begin(), bytes.end());
      return bytes;
    };
    run_until({base_.get(), rover_.get()}, kStart + std::chrono::seconds{kSeconds}, watch);
  }
  std::unique_ptr<ReceiverOnWires> make(const std::string& name, const Eigen::Vector3d& p_W) {
    return std::make_unique<ReceiverOnWires>(settings_, parameters_, calendar_, frame_, antennas_,
                                             kRtkOverMidnightSeed, name, standing_at(p_W));
  }
  /// Sentences of that type, as the rover said them.
  [[nodiscard]] std::vector<std::vector<std::string>> sentences(std::string_view type) const {
    std::vector<std::vector<std::string>> found;
    const auto& all = rover_->line.all;
    for (std::size_t at = 0; at < all.size(); ++at) {
      if (all[at] != '$') {
        continue;
      }
      const auto sentence = protocols::nmea::decode_sentence(std::span(all).subspan(at));
      if (sentence.ok() && sentence->type() == type) {
        auto& fields = found.emplace_back();
        for (std::size_t i = 0; i < sentence->field_count; ++i) {
          fields.emplace_back(sentence->field(i));
        }
      }
    }
    return found;
  }

  using Bytes = std::vector<std::uint8_t>;
  Calendar calendar_{parse_utc("2016-12-31T23:58:30Z")};
  sim::LocalFrame frame_{sim::LocalFrameParameters{}};
  std::shared_ptr<sim::AntennaBook> antennas_ = std::make_shared<sim::AntennaBook>();
  emulators::UbloxSettings settings_;
  sim::GnssParameters parameters_;
  std::unique_ptr<ReceiverOnWires> base_;
  std::unique_ptr<ReceiverOnWires> rover_;
  Bytes said_;         ///< By the base ...
  Duration delay_{0};  ///< ... so long before the rover hears it.
};

// At 5 Hz, so that some of what is measured in the leap second arrives when it is over.
TEST_F(RtkOverMidnight, TheFixIsKeptAndAgesAndTimesAreRight) {
  settings_.measurement_period = 200ms;
  delay_ = 300ms;
  SimTime fixed = kNever;
  SimTime seen = kStart;
  run([&](SimTime now) {
    const GnssSample& s = rover_->latest;
    if (s.carrier == CarrierSolution::fixed) {
      fixed = std::min(fixed, now);
    }
    if (fixed == kNever || s.time == seen) {
      return;
    }
    seen = s.time;
    ASSERT_EQ(s.carrier, CarrierSolution::fixed) << to_seconds(now - kStart);
    ASSERT_NEAR(*s.differential_age_s, 0.6, 0.01) << to_seconds(now - kStart);
    const Eigen::Vector3d place_W =
        frame_.to_world({s.latitude_deg, s.longitude_deg, s.ellipsoid_height_m});
    ASSERT_LT((place_W - Eigen::Vector3d(0.0, 0.0, 2.0)).norm(), 0.08);
  });
  ASSERT_LT(fixed, kStart + 20s);

  // What is said of it: 23:59:59, :60 and then 00:00:00 of the next year.
  std::vector<std::string> times;
  for (const auto& gga : sentences("GGA")) {
    times.push_back(gga[0]);
    if (times.size() > 100) {
      ASSERT_EQ(gga[5], "4") << gga[0];
      ASSERT_EQ(gga[12], "0.6") << gga[0];
    }
  }
  const auto last = std::ranges::find(times, "235959.80");
  ASSERT_GE(times.end() - last, 7);
  EXPECT_EQ(last[1], "235960.00");
  EXPECT_EQ(last[5], "235960.80");
  EXPECT_EQ(last[6], "000000.00");
  for (const auto& rmc : sentences("RMC")) {
    EXPECT_EQ(rmc[8], rmc[0] >= "235800" ? "311216" : "010117") << rmc[0];
    EXPECT_TRUE(rmc[11] == "R" || rmc[0] < "235900") << rmc[0] << ' ' << rmc[11];
  }
  for (const auto& zda : sentences("ZDA")) {
    EXPECT_EQ(zda[3], zda[0] >= "235800" ? "2016" : "2017") << zda[0];
  }
  // Time of week falls back to 0 between two epochs that are a second apart.
  std::vector<std::uint32_t> of_week;
  for (const auto& payload : rover_->said(ubx::NavRelposned::kId)) {
    const auto m = ubx::read_payload<ubx::NavRelposned>(payload);
    of_week.push_back(m.time_of_week_ms);
    if (of_week.size() > 100) {
      EXPECT_EQ(m.flags & ubx::kRelativeCarrierFixed, ubx::kRelativeCarrierFixed);
      EXPECT_NEAR(m.length_cm, 20'000, 6);
    }
  }
  const auto turn = std::ranges::adjacent_find(of_week, std::ranges::greater{});
  ASSERT_NE(turn, of_week.end());
  EXPECT_EQ(turn[0], 604'799'800U);
  EXPECT_EQ(turn[1], 0U);
  // Every message of the base was of use, once it had found its time and its place.
  std::size_t heard = 0;
  for (const auto& payload : rover_->said(ubx::RxmRtcm::kId)) {
    const auto m = ubx::read_payload<ubx::RxmRtcm>(payload);
    EXPECT_TRUE(++heard < 100 || m.flags == 2 << 1) << m.message;
  }
}

// Two decoders of the base's messages: our own, and RTKLIB's convbin. All systems' observations of
// an epoch belong together, before, between and after.
TEST_F(RtkOverMidnight, EpochsOfAllSystemsAreOneSecondApartForOthersToo) {
  run({});
  // By ours: GPS seconds since the start of the run, by system.
  std::map<rtcm3::MsmSystem, std::vector<std::int64_t>> epochs;
  const std::int64_t start_ms = calendar_.gps(kStart).time_of_week_ns / 1'000'000;
  for (std::span rest(said_); !rest.empty();) {
    const auto frame = rtcm3::decode_frame(rest);
    ASSERT_TRUE(frame.ok());
    rest = rest.subspan(frame.consumed());
    const auto message = rtcm3::decode_message(frame->payload);
    if (message.ok() && std::holds_alternative<rtcm3::MultipleSignals>(*message)) {
      const auto& m = std::get<rtcm3::MultipleSignals>(*message);
      auto& of = epochs[m.system];
      const SimTime about = kStart + std::chrono::seconds{of.size() + 1};
      const auto tow_ms =
          rtcm3::gps_time_of_week_ms(m.system, m.epoch, calendar_.leap_seconds(about));
      ASSERT_TRUE(tow_ms);
      constexpr std::int64_t kWeek_ms = 604'800'000;
      of.push_back((*tow_ms - start_ms + kWeek_ms) % kWeek_ms / 1000);
    }
  }
  ASSERT_EQ(epochs.size(), 4U);
  for (const auto& [system, of] : epochs) {
    ASSERT_GE(of.size(), kSeconds - 3U);
    for (std::size_t i = 1; i < of.size(); ++i) {
      EXPECT_EQ(of[i] - of[i - 1], 1) << static_cast<int>(system) << " after " << of[i - 1];
    }
  }

  const fs::path folder = fs::temp_directory_path() / ("midnight." + std::to_string(::getpid()));
  fs::create_directories(folder);
  std::ofstream(folder / "base.rtcm3", std::ios::binary)
      .write(reinterpret_cast<const char*>(said_.data()),
             static_cast<std::streamsize>(said_.size()));
  test::ChildProcess convbin(
      {"convbin", "-r", "rtcm3", "-v", "3.04", "-tr", "2016/12/31", "23:58:00", "-o",
       (folder / "out.obs").string(), (folder / "base.rtcm3").string()},
      folder / "convbin.log");
  ASSERT_EQ(convbin.wait(), 0) << convbin.output();
  // Epoch lines: > 2016 12 31 23 59 59.0000000  0 30.
  std::ifstream file(folder / "out.obs");
  std::vector<std::pair<std::string, std::map<char, int>>> read;
  for (std::string line; std::getline(file, line);) {
    if (line[0] == '>') {
      read.emplace_back(line.substr(2, 19), std::map<char, int>{});
    } else if (!read.empty()) {
      ++read.back().second[line[0]];
    }
  }
  fs::remove_all(folder);
  ASSERT_GE(read.size(), kSeconds - 3U);
  std::size_t whole = 0;
  for (const auto& [time, systems] : read) {
    whole += systems.size() == 4 ? 1U : 0U;
  }
  // GLONASS tells times of day by UTC, and the leap second has that of the one after it: a reader
  // that knows the leap second by the date alone puts one of both beside its epoch.
  EXPECT_GE(whole + 2, read.size());
  EXPECT_LE(read.size(), kSeconds + 1U);
}

}  // namespace
}  // namespace rigwire::hil
