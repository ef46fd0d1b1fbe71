#include "protocols/rinex/observation.h"

#include <gtest/gtest.h>

#include <array>
#include <string>

namespace rigwire::protocols::rinex {
namespace {

TEST(RinexObservation, EpochHasTheDocumentsColumns) {
  std::string out;
  const std::array observations{Observation{.prn = 5,
                                            .pseudorange_m = 21'234'567.8914,
                                            .carrier_phase_cycles = -1234.5676,
                                            .doppler_hz = -3210.125,
                                            .cn0_dbhz = 44.0},
                                Observation{.prn = 32,
                                            .pseudorange_m = 25'000'000.0,
                                            .doppler_hz = 0.5,
                                            .cn0_dbhz = 60.0,
                                            .has_phase = false},
                                Observation{.prn = 1,
                                            .pseudorange_m = 20'000'000.0,
                                            .carrier_phase_cycles = 105'000'000.5,
                                            .cn0_dbhz = 2.0,
                                            .slipped = true}};
  append_observations(out, {2297, 295'200.0 - 0.001}, observations);
  EXPECT_EQ(out,
            "> 2024 01 17 09 59 59.9990000  0  3\n"
            "G05  21234567.891 7     -1234.568 7     -3210.125          44.000\n"
            "G32  25000000.000 9                         0.500          60.000\n"
            "G01  20000000.000 1 105000000.50011         0.000           2.000\n");
}

TEST(RinexObservation, AlmostAMinuteIsTheNextMinute) {
  std::string out;
  append_observations(out, {2297, 604'799.99999999}, {});
  EXPECT_EQ(out, "> 2024 01 21 00 00  0.0000000  0  0\n");
}

TEST(RinexObservation, HeaderHasEveryMandatoryLabelInItsColumns) {
  std::string out;
  ObservationHeader header;
  header.first = {2297, 295'200.0};
  append_observation_header(out, header);
  for (const char* label :
       {"RINEX VERSION / TYPE", "PGM / RUN BY / DATE", "MARKER NAME", "MARKER TYPE",
        "OBSERVER / AGENCY", "REC # / TYPE / VERS", "ANT # / TYPE", "APPROX POSITION XYZ",
        "ANTENNA: DELTA H/E/N", "SYS / # / OBS TYPES", "TIME OF FIRST OBS", "SYS / PHASE SHIFT",
        "END OF HEADER"}) {
    const std::size_t at = out.find(label);
    ASSERT_NE(at, std::string::npos) << label;
    const std::size_t begin = out.rfind('\n', at);
    EXPECT_EQ(at - (begin == std::string::npos ? 0 : begin + 1), 60U) << label;
  }
  EXPECT_NE(out.find("  2024     1    17    10     0    0.0000000     GPS"), std::string::npos);
}

}  // namespace
}  // namespace rigwire::protocols::rinex
