#include "hil/world/sky.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <fstream>
#include <stdexcept>
#include <string>

#include "emulators/gps_broadcast.h"
#include "protocols/rinex/navigation.h"

namespace rigwire::hil {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::HasSubstr;

constexpr std::array<GnssSystem, 1> kGps{GnssSystem::gps};

class SatelliteFile : public ::testing::Test {
 protected:
  void TearDown() override { fs::remove(file); }
  void write(const std::string& text) { std::ofstream(file, std::ios::binary) << text; }
  std::string refusal() {
    try {
      (void)load_satellites(file, calendar);
      return "";
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
  }

  fs::path file = fs::temp_directory_path() / ("rigwire-sky-" + std::to_string(::getpid()));
  Calendar calendar{UtcTime{2024, 6, 1, 8, 30, 0, 0}};
};

TEST_F(SatelliteFile, RinexBringsBackTheSatellitesThatWereWritten) {
  const auto nominal = sim::make_nominal_constellation(kGps);
  const GpsTime start = calendar.gps(kStart);
  const auto broadcast = nominal->navigation(start);
  protocols::rinex::NavigationFile written;
  for (const auto& ephemeris : broadcast->ephemerides) {
    if (ephemeris) {
      written.records.push_back({emulators::to_message(*ephemeris), 0.0});
    }
  }
  write(protocols::rinex::write_navigation(written, {}));
  const auto loaded = load_satellites(file, calendar);
  ASSERT_EQ(loaded->satellites().size(), 24U);
  for (std::size_t i = 0; i < 24; ++i) {
    ASSERT_EQ(loaded->satellites()[i], nominal->satellites()[i]);
    const auto expected = nominal->state(i, start, 0.0);
    const auto found = loaded->state(i, start, 0.0);
    // Restated under another reference time the orbit is off by 4 cm at most
    // (sim/gnss/ephemeris.h).
    EXPECT_LT((found.position_E_m - expected.position_E_m).norm(), 0.1) << i;
    EXPECT_NEAR(found.clock_s, expected.clock_s, 1e-9) << i;
  }
}

constexpr const char* kYuma = R"(******** Week 253 almanac for PRN-05 ********
ID:                         05
Health:                     000
Eccentricity:               0.5000000000E-002
Time of Applicability(s):  503808.0000
Orbital Inclination(rad):   0.9600000000
Rate of Right Ascen(r/s):  -0.8000000000E-008
SQRT(A)  (m 1/2):           5153.600000
Right Ascen at Week(rad):   0.1000000000E+001
Argument of Perigee(rad):   0.500000000
Mean Anom(rad):             0.2000000000E+001
Af0(s):                     0.1000000000E-003
Af1(s/s):                   0.0000000000E+000
week:                        253
)";

TEST_F(SatelliteFile, YumaWeekIsTakenNearTheStartOfTheRig) {
  write(kYuma);  // week 253 + 2 * 1024 = 2301, of February 2024
  const auto loaded = load_satellites(file, calendar);
  ASSERT_EQ(loaded->satellites().size(), 1U);
  EXPECT_EQ(loaded->satellites()[0].number, 5);
  const double radius_m = loaded->state(0, calendar.gps(kStart), 0.0).position_E_m.norm();
  EXPECT_NEAR(radius_m, 5153.6 * 5153.6, 0.006 * 5153.6 * 5153.6);
  const auto navigation = loaded->navigation(calendar.gps(kStart));
  ASSERT_TRUE(navigation->ephemerides[4].has_value());
  EXPECT_EQ(navigation->utc.leap_seconds, 18);
}

TEST_F(SatelliteFile, FaultyFilesAreNamedWithTheLine) {
  write("");
  EXPECT_THAT(refusal(), HasSubstr(file.string()));
  write("nonsense\n");
  EXPECT_THAT(refusal(), HasSubstr(file.string()));
  std::string cut = kYuma;
  cut.resize(cut.find("Mean Anom"));
  write(cut);
  EXPECT_THAT(refusal(), AllOf(HasSubstr(file.string() + ":"), HasSubstr("Mean Anom")));
  write(std::string(60, ' ') + "RINEX VERSION / TYPE\n");
  EXPECT_THAT(refusal(), HasSubstr(file.string()));
  file = "/nowhere/brdc.rnx";
  EXPECT_THAT(refusal(), HasSubstr("/nowhere/brdc.rnx: No such file"));
}

TEST(Satellites, StandInTheirSlotsWithoutAFile) {
  const Calendar calendar{UtcTime{2024, 6, 1, 8, 30, 0, 0}};
  SatellitesConfiguration configuration;
  EXPECT_GT(make_satellites(configuration, calendar)->satellites().size(), 90U);
  configuration.systems = {"gps"};
  EXPECT_EQ(make_satellites(configuration, calendar)->satellites().size(), 24U);
}

}  // namespace
}  // namespace rigwire::hil
