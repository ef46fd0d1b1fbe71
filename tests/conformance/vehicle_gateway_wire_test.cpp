// tshark's J1939 dissector, which shares no table with us, names group, priority and addresses of
// every frame of a drive; the values are read from its bytes by positions written down here anew.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "emulators/vehicle_gateway/vehicle_gateway.h"
#include "j1939_capture.h"

namespace rigwire::emulators {
namespace {

using namespace std::chrono_literals;

constexpr std::uint8_t kSource = 0x17;

class VehicleGatewayConformance : public testing::Test {
 protected:
  /// Eleven seconds on a left circle at 18 km/h.
  static void SetUpTestSuite() {
    const auto file = std::filesystem::temp_directory_path() /
                      ("rigwire_vehicle_" + std::to_string(getpid()) + ".pcap");
    CanCapture capture(file);
    VehicleGatewaySettings settings;
    settings.source_address = kSource;
    settings.steering = SteeringLayout::crab;
    settings.engine.reference_torque_nm = 1000.0;
    VehicleGateway gateway(settings, capture);
    VehicleSample sample;
    sample.engine.speed_radps = 1800.0 * 2.0 * 3.14159265358979 / 60.0;
    sample.engine.torque_nm = 340.0;
    sample.engine.friction_nm = 60.0;
    sample.engine.full_load_nm = 740.0;
    sample.gear = sample.gear_requested = 3;
    sample.gear_ratio = 2.5;
    sample.wheel_radius_m.fill(0.5);
    sample.wheel_rate_radps.fill(10.0);  // 5 m/s = 18 km/h
    sample.front_steer_rad = 10.0 * 3.14159265358979 / 180.0;
    sample.tyre_pressure_pa.fill(300e3);
    sample.hydraulic_pressure_pa = 20e6;
    sample.parking_brake = false;
    sample.lock = {true, false, true};
    sample.odometry = {5.0, 0.02, 0.0};
    const SamplePlan plan = gateway.sample_plan();
    for (SimTime t = plan.first; t < kStart + 11s; t = plan.next_after(t)) {
      sample.time = t;
      gateway.update(sample);
    }
    capture.close();
    sent_ = capture.sent;
    frames_ = tshark(file);
    std::filesystem::remove(file);
  }

  /// The last one of a group.
  static Seen last(unsigned pgn) {
    for (auto frame = frames_.rbegin(); frame != frames_.rend(); ++frame) {
      if (frame->pgn == pgn) {
        return *frame;
      }
    }
    ADD_FAILURE() << "tshark saw no group " << pgn;
    return {0.0, 0, pgn, 0, 0, std::vector<unsigned>(8)};
  }

  static inline int sent_ = 0;
  static inline std::vector<Seen> frames_;
};

TEST_F(VehicleGatewayConformance, EveryFrameIsJ1939OfOurAddress) {
  ASSERT_EQ(std::ssize(frames_), sent_);
  for (const Seen& frame : frames_) {
    EXPECT_EQ(frame.source, kSource);
    EXPECT_EQ(frame.destination, 255U);
    EXPECT_EQ(frame.bytes.size(), 8U);
  }
  EXPECT_EQ(frames_.front().pgn, 60928U);
}

TEST_F(VehicleGatewayConformance, PrioritiesAndPeriodsAreThoseOfTheStandard) {
  struct Expected {
    unsigned pgn, priority;
    double period_s;
  };
  for (const Expected& expected :
       std::initializer_list<Expected>{{65215, 6, 0.1},     // EBC2
                                       {65134, 2, 0.02},    // HRW
                                       {65265, 6, 0.1},     // CCVS1
                                       {61444, 3, 0.02},    // EEC1
                                       {61443, 3, 0.05},    // EEC2
                                       {61442, 3, 0.01},    // ETC1
                                       {61445, 6, 0.1},     // ETC2
                                       {61441, 6, 0.1},     // EBC1
                                       {61449, 6, 0.01},    // VDC2
                                       {61469, 6, 0.01},    // SAS
                                       {61446, 6, 0.5},     // EAC1
                                       {65263, 6, 0.5},     // EFL/P1
                                       {65262, 6, 1.0},     // ET1
                                       {65276, 6, 1.0},     // DD1
                                       {65128, 6, 1.0},     // VF
                                       {61448, 6, 0.05},    // HPG
                                       {44032, 3, 0.1},     // guidance machine info
                                       {61474, 3, 0.1},     // machine selected speed
                                       {65096, 3, 0.1},     // wheel-based speed and distance
                                       {65226, 6, 1.0}}) {  // DM1
    double previous_s = -1.0;
    int count = 0;
    for (const Seen& frame : frames_) {
      if (frame.pgn != expected.pgn) {
        continue;
      }
      EXPECT_EQ(frame.priority, expected.priority) << frame.pgn;
      if (previous_s >= 0.0) {
        EXPECT_NEAR(frame.time_s - previous_s, expected.period_s, 0.02 * expected.period_s);
      }
      previous_s = frame.time_s;
      ++count;
    }
    EXPECT_NEAR(count, 11.0 / expected.period_s, 1.0) << expected.pgn;
  }
}

TEST_F(VehicleGatewayConformance, BytesSayWhatTheMachineDoes) {
  using testing::ElementsAre;
  EXPECT_THAT(last(65215).bytes, ElementsAre(0x00, 0x12, 0x7D, 0x7D, 0x7D, 0x7D, 0xFF, 0xFF));
  for (std::size_t wheel = 0; wheel < 4; ++wheel) {
    EXPECT_EQ(last(65134).word(2 * wheel), 18U * 256U);
  }
  EXPECT_EQ(last(65265).word(1), 18U * 256U);
  EXPECT_EQ((last(65265).bytes[0] >> 2) & 3U, 0U);  // parking brake off
  EXPECT_EQ(last(61444).word(3), 0x3840U);          // 1800 rpm
  EXPECT_EQ(last(61444).bytes[2], 0xA5U);           // 40 %
  EXPECT_EQ(last(61445).bytes[3], 125U + 3U);
  EXPECT_EQ(last(61445).word(1), 2500U);
  EXPECT_EQ(last(44032).word(0), 32128U - 80U);  // 20 per km to the left
  EXPECT_EQ(last(61474).word(0), 5000U);
  EXPECT_EQ(last(61474).bytes[7] & 3U, 1U);  // forward
  EXPECT_EQ(last(61448).word(0), 10000U);
  EXPECT_EQ(last(61446).bytes[1] & 0x33U, 0x11U);  // front and rear lock engaged
  EXPECT_EQ(last(61446).bytes[2] & 3U, 0U);
  EXPECT_EQ(last(65268).bytes[1], 75U);  // 300 kPa
  EXPECT_EQ(last(64578).word(1), 300U);
}

TEST_F(VehicleGatewayConformance, SteeredAxlesAreToldApart) {
  std::map<unsigned, unsigned> angles;
  for (const Seen& frame : frames_) {
    if (frame.pgn == 61451) {
      angles[frame.bytes.at(2) >> 4U] = frame.word(0);
    }
  }
  ASSERT_EQ(angles.size(), 2U);
  EXPECT_EQ(angles[0], (125U + 10U) * 256U);
  EXPECT_EQ(angles[1], 125U * 256U);
}

TEST_F(VehicleGatewayConformance, FirstFramesAreNotAvailable) {
  for (const Seen& frame : frames_) {
    if (frame.time_s < 0.19 && frame.pgn == 61444) {
      EXPECT_THAT(frame.bytes, testing::Each(0xFFU));
    }
  }
}

}  // namespace
}  // namespace rigwire::emulators
