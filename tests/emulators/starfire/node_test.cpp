#include "emulators/starfire/node.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <string>

#include "protocols/j1939/message.h"
#include "protocols/j1939/name.h"
#include "recorder.h"

namespace rigwire::emulators {
namespace {

using namespace std::chrono_literals;
namespace j1939 = protocols::j1939;
namespace vehicle = protocols::vehicle;
using protocols::can::Frame;

constexpr std::uint8_t kStarfireController = 0x27;
constexpr std::uint8_t kStarFire = 28;

class StarFireNodeTest : public testing::Test {
 protected:
  static StarFireSettings settings() {
    StarFireSettings s;
    s.start_up = 0s;
    s.latency = 50ms;
    return s;
  }
  static GnssSample sample(SimTime time) {
    GnssSample s;
    s.time = time;
    s.fix = GnssFix::three_d;
    s.latitude_deg = 49.4240123;
    s.longitude_deg = -7.7510456;
    s.ellipsoid_height_m = 328.25;
    s.geoid_separation_m = 48.0;
    s.velocity_ned_mps = {1.0, -1.0, 0.0};
    s.horizontal_dilution = 0.83;
    s.vertical_dilution = 1.24;
    s.position_dilution = 1.49;
    s.time_dilution = 0.71;
    for (std::uint8_t prn = 1; prn <= 8; ++prn) {
      s.satellites.push_back({prn, 0.5 * prn, 0.1 * prn, 40.0, true, true});
    }
    return s;
  }
  void run(SimTime until, bool fix = true) {
    for (SimTime next = node_.sample_plan().next_after(now_); next <= until;
         next = node_.sample_plan().next_after(now_)) {
      GnssSample s = sample(next);
      if (!fix) {
        s.fix = GnssFix::none;
      }
      node_.update(s);
      now_ = next;
    }
    node_.advance(until);
    now_ = until;
  }
  void ask(std::uint32_t pgn, std::uint8_t destination) {
    node_.receive(now_, j1939::make_request(kStarfireController, destination, pgn));
  }

  Calendar calendar_{UtcTime{2026, 6, 1, 8, 0, 0, 0}};
  test::FrameRecorder bus_;
  StarFireNode node_{settings(), calendar_, bus_};
  SimTime now_ = kStart;
};

TEST_F(StarFireNodeTest, ClaimsAddress28ThenSendsFiveTimesASecond) {
  run(kStart + 10s);
  ASSERT_FALSE(bus_.frames.empty());
  EXPECT_EQ(j1939::unpack(bus_.frames[0].second.id).pgn, j1939::kAddressClaimedPgn);
  EXPECT_EQ(node_.address(), kStarFire);
  for (const std::uint32_t pgn : {65267U, 65256U}) {
    const auto times = bus_.times(pgn);
    ASSERT_GE(times.size(), 49U);
    for (std::size_t i = 1; i < times.size(); ++i) {
      EXPECT_EQ(times[i] - times[i - 1], 200ms);
    }
  }
  EXPECT_EQ(bus_.times(64502).size(), 2U);
}

TEST_F(StarFireNodeTest, WithoutSupplyItIsSilentAndClaimsAgainAfterIt) {
  node_.supply().begin({{3s, 2s}, NoSupplyFault{}});
  run(kStart + 10s);
  std::vector<SimTime> during;
  for (const auto& [due, frame] : bus_.frames) {
    if (due >= kStart + 3s && due < kStart + 5s) {
      during.push_back(due);
    }
  }
  EXPECT_TRUE(during.empty());
  EXPECT_EQ(bus_.times(j1939::kAddressClaimedPgn).size(), 2U);
  EXPECT_GE(bus_.times(65267).back(), kStart + 9s);
}

TEST_F(StarFireNodeTest, CarriesPositionToAUnitAndCourseClockwiseFromNorth) {
  run(kStart + 1s);
  const auto position = bus_.latest<vehicle::VehiclePosition>();
  EXPECT_NEAR(position.latitude_deg, 49.4240123, 0.5e-7 + 1e-12);
  EXPECT_NEAR(position.longitude_deg, -7.7510456, 0.5e-7 + 1e-12);
  const auto direction = bus_.latest<vehicle::VehicleDirectionSpeed>();
  EXPECT_NEAR(direction.bearing_rad / vehicle::kDegree_rad, 315.0, 0.5 / 128.0);
  EXPECT_NEAR(direction.speed_mps, std::sqrt(2.0), 0.5 / 256.0 / 3.6);
  EXPECT_NEAR(direction.altitude_m, 280.25, 0.5 * 0.125);
  EXPECT_TRUE(std::isnan(direction.pitch_rad)) << "a receiver alone does not know it";
  const auto quality = bus_.latest<vehicle::VehiclePosition2>();
  EXPECT_EQ(quality.satellites, 8.0);
  EXPECT_NEAR(quality.horizontal_dilution, 0.83, 0.05 + 1e-9);
  EXPECT_NEAR(quality.position_dilution, 1.49, 0.05 + 1e-9);
}

// Worked by hand: (49.4240123 + 210) * 1e7 = 2594240123 = 9AA0F67B.
TEST_F(StarFireNodeTest, BytesOfVehiclePositionAreThoseOfTheStandard) {
  run(kStart + 1s);
  for (const auto& [due, frame] : bus_.frames) {
    if (j1939::unpack(frame.id).pgn == 65267) {
      EXPECT_EQ(frame.id, 0x18FEF31CU) << "priority 6, FEF3, from 1C";
      std::uint32_t latitude = 0;
      for (std::size_t i = 4; i-- > 0;) {
        latitude = latitude << 8U | frame.data[i];
      }
      EXPECT_EQ(latitude, 2'594'240'123U);
      return;
    }
  }
  FAIL() << "no position";
}

TEST_F(StarFireNodeTest, WithoutFixEverythingButSatellitesIsNotAvailable) {
  run(kStart + 1s, false);
  EXPECT_TRUE(std::isnan(bus_.latest<vehicle::VehiclePosition>().latitude_deg));
  EXPECT_TRUE(std::isnan(bus_.latest<vehicle::VehicleDirectionSpeed>().speed_mps));
  const auto quality = bus_.latest<vehicle::VehiclePosition2>();
  EXPECT_EQ(quality.satellites, 8.0);
  EXPECT_TRUE(std::isnan(quality.horizontal_dilution));
}

TEST_F(StarFireNodeTest, AnswersRequestsForItsGroupsAndRefusesOthers) {
  run(kStart + 1s);
  bus_.frames.clear();
  ask(64502, kStarFire);
  EXPECT_EQ(bus_.times(64502).size(), 1U);
  ask(65267, j1939::kGlobalAddress);
  EXPECT_EQ(bus_.times(65267).size(), 1U);
  ask(65265, j1939::kGlobalAddress);
  EXPECT_EQ(bus_.frames.size(), 2U) << "nobody is refused when everybody is asked";
  ask(65265, kStarFire);
  ASSERT_EQ(bus_.frames.size(), 3U);
  const auto refusal = j1939::decode_acknowledgement(bus_.frames.back().second);
  ASSERT_TRUE(refusal.ok());
  EXPECT_EQ(refusal->control, j1939::Acknowledge::negative);
  EXPECT_EQ(refusal->pgn, 65265U);
  ask(j1939::kAddressClaimedPgn, j1939::kGlobalAddress);
  EXPECT_EQ(bus_.times(j1939::kAddressClaimedPgn).size(), 1U);
}

TEST_F(StarFireNodeTest, ItsNameSaysNavigationAndNotATractor) {
  const j1939::Name name = j1939::unpack_name(node_.name());
  EXPECT_EQ(name.function, 23) << "26 is body control, 134 the tractor ECU";
  EXPECT_EQ(name.industry_group, 2);
  EXPECT_EQ(name.vehicle_system, 0);
  EXPECT_FALSE(name.arbitrary_address);
}

TEST_F(StarFireNodeTest, FallsSilentWhenALowerNameTakesItsAddress) {
  run(kStart + 1s);
  node_.receive(now_, j1939::make_address_claim(kStarFire, 1));
  EXPECT_FALSE(node_.address_held());
  bus_.frames.clear();
  run(kStart + 2s);
  ASSERT_EQ(bus_.frames.size(), 1U);
  EXPECT_EQ(bus_.frames[0].second, j1939::make_address_claim(j1939::kNullAddress, node_.name()));
}

TEST(StarFireSettings, NamesWhatItRefuses) {
  const auto message = [](auto change) {
    StarFireSettings settings;
    change(settings);
    try {
      validate(settings);
    } catch (const std::invalid_argument& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_EQ(message([](auto&) {}), "");
  EXPECT_NE(message([](auto& s) { s.baud = 9601; }).find("9601"), std::string::npos);
  EXPECT_NE(message([](auto& s) { s.sentences = {"GSV"}; }).find("GSV"), std::string::npos);
  EXPECT_NE(message([](auto& s) { s.talker = "GL"; }).find("GP GN"), std::string::npos);
  EXPECT_NE(message([](auto& s) { s.serial = 0; }).find("serial"), std::string::npos);
  EXPECT_NE(message([](auto& s) {
              s.baud = 4800;
              s.sentence_period = 100ms;
            }).find("bytes/s"),
            std::string::npos);
}

}  // namespace
}  // namespace rigwire::emulators
