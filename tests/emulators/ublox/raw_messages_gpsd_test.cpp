// gpsd's decoder takes the subframes: it checks the parity of every word by itself, and finds what
// went in.
#include <gtest/gtest.h>

#include <sstream>
#include <string>
#include <vector>

#include "tests/emulators/ublox/raw_log.h"
#include "tests/support/child_process.h"

namespace rigwire::emulators {
namespace {

namespace ubx = protocols::ubx;

constexpr int kSeconds = 60;

std::vector<std::string> subframes_of(ubx::MessageId id, int generation) {
  const ExampleDirectory directory;
  const auto input = directory.path / "raw.ubx";
  EXPECT_EQ(write_example(input, generation, kSeconds, std::span(&id, 1)),
            kSeconds / 6 * kExamplePrns.size());
  test::ChildProcess gpsdecode({"sh", "-c", "exec gpsdecode < " + input.string()},
                               directory.path / "out.json");
  EXPECT_EQ(gpsdecode.wait(), 0);
  std::vector<std::string> found;
  std::istringstream lines(gpsdecode.output());
  for (std::string line; std::getline(lines, line);) {
    if (line.find("\"SUBFRAME\"") != std::string::npos) {
      found.push_back(line);
    }
  }
  return found;
}

double value(const std::string& line, const std::string& key) {
  const std::size_t at = line.find("\"" + key + "\":");
  EXPECT_NE(at, std::string::npos) << key << " in " << line;
  return at == std::string::npos ? 0.0 : std::stod(line.substr(at + key.size() + 3));
}

// The first line that holds all of `parts`.
std::string find(const std::vector<std::string>& lines, std::initializer_list<const char*> parts) {
  for (const std::string& line : lines) {
    bool all = true;
    for (const char* part : parts) {
      all = all && line.find(part) != std::string::npos;
    }
    if (all) {
      return line;
    }
  }
  ADD_FAILURE() << "no such subframe";
  return {};
}

void expect_content(const std::vector<std::string>& lines) {
  ASSERT_EQ(lines.size(), kSeconds / 6 * kExamplePrns.size()) << "a parity was wrong";
  const GpsEphemeris e = example_ephemeris(23);
  const double semicircle = 3.1415926535898;
  const std::string first = find(lines, {"\"tSV\":23,", "EPHEM1"});
  EXPECT_EQ(value(first, "TOW17"), 295'236.0) << "the start of the next subframe";
  EXPECT_EQ(value(first, "WN"), kExampleWeek % 1024);
  EXPECT_EQ(value(first, "IODC"), e.issue_of_clock);
  EXPECT_NEAR(value(first, "Tgd"), e.group_delay_s, 1e-20);
  EXPECT_NEAR(value(first, "af0"), e.clock_bias_s, 1e-15);
  EXPECT_NEAR(value(first, "af1"), e.clock_drift, 1e-22);
  const std::string second = find(lines, {"\"tSV\":23,", "EPHEM2"});
  EXPECT_NEAR(value(second, "M0") * semicircle, e.mean_anomaly_rad, 1e-11);
  EXPECT_NEAR(value(second, "sqrtA"), e.sqrt_semi_major_axis, 1e-8);
  const std::string third = find(lines, {"\"tSV\":23,", "EPHEM3"});
  EXPECT_NEAR(value(third, "Omega0") * semicircle, e.ascending_node_rad, 1e-11);
  EXPECT_NEAR(value(third, "IDOT") * semicircle, e.inclination_rate, 1e-21);
  // Subframe 5 page 17 is the almanac of PRN 17.
  const std::string almanac = find(lines, {"ALMANAC", "\"ID\":17,"});
  EXPECT_NEAR(value(almanac, "e"), 0.017, 3e-7);
  EXPECT_NEAR(value(almanac, "deltai") * semicircle + 0.3 * semicircle,
              example_ephemeris(17).inclination_rad, 4e-6);
  const std::string page18 = find(lines, {"IONO"});
  EXPECT_EQ(value(page18, "ls"), 18);
  EXPECT_EQ(value(page18, "b0"), 44 * 2048);
}

TEST(RawMessagesToGpsd, SfrbOfUblox7) {
  expect_content(subframes_of(ubx::RxmSfrb::kId, 7));
}

TEST(RawMessagesToGpsd, SfrbxOfUblox9) {
  expect_content(subframes_of(ubx::RxmSfrbxHead::kId, 9));
}

}  // namespace
}  // namespace rigwire::emulators
