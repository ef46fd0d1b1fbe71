// A minute of sentences read by two programs that are not ours: python3-nmea2 parses every one of
// them with its checksum, GPSBabel makes points of them. What they read is the truth.
//
// Both are required dependencies: without them these tests fail.
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "child_process.h"
#include "private_wires.h"
#include "simulated_receiver.h"

namespace rigwire {
namespace {

using namespace std::chrono_literals;
using Json = nlohmann::json;
using test::ChildProcess;

constexpr double kHalfStep_deg = 0.51e-5 / 60.0;

class NmeaClients : public testing::Test {
 protected:
  void record(const emulators::UbloxSettings& settings) {
    const test::Recording recording =
        test::run_receiver(settings, calendar_, test::driving_machine, 60s);
    EXPECT_EQ(recording.counters.messages_lost, 0U);
    std::ofstream(input(), std::ios::binary) << recording.bytes;
  }
  [[nodiscard]] std::filesystem::path input() const { return wires_.folder / "input.nmea"; }
  [[nodiscard]] std::string output_of(const std::vector<std::string>& command) {
    ChildProcess program(command, wires_.folder / "output");
    EXPECT_EQ(program.wait(), 0) << program.output();
    return program.output();
  }
  /// The epoch at which the receiver's clock shows so many seconds since midnight, UTC.
  [[nodiscard]] GnssSample truth_at(double second_of_day) const {
    const UtcTime begin = calendar_.utc(kStart);
    const double elapsed_s =
        second_of_day - (begin.hour * 3600.0 + begin.minute * 60.0 + begin.second);
    return test::driving_machine(kStart + from_seconds(std::round(elapsed_s * 10.0) / 10.0));
  }

  Calendar calendar_{UtcTime{2026, 6, 1, 8, 0, 0, 0}};
  test::PrivateWires wires_;
};

TEST_F(NmeaClients, Nmea2ParsesEverySentenceAndReadsTheTruth) {
  emulators::UbloxSettings settings;
  settings.nmea_sentences = {"RMC", "VTG", "GGA", "GSA", "GSV", "GLL", "ZDA"};
  settings.baud = 38'400;
  record(settings);
  // One object a sentence; a sentence that it cannot parse, or whose checksum is wrong, ends it.
  const std::string script =
      "import json, pynmea2, sys\n"
      "for line in open(sys.argv[1], encoding='ascii', newline='\\r\\n'):\n"
      "    assert line.endswith('\\r\\n') and len(line) <= 84, line\n"
      "    m = pynmea2.parse(line, check=True)\n"
      "    o = {f[1]: str(getattr(m, f[1])) for f in m.fields}\n"
      "    o['type'] = m.sentence_type\n"
      "    if hasattr(m, 'latitude') and o.get('lat'):\n"
      "        o['latitude'], o['longitude'] = m.latitude, m.longitude\n"
      "    t = getattr(m, 'timestamp', None)\n"
      "    if t: o['second'] = t.hour * 3600 + t.minute * 60 + t.second + t.microsecond / 1e6\n"
      "    print(json.dumps(o))\n";
  std::istringstream lines(output_of({"/usr/bin/python3", "-c", script, input().string()}));
  std::map<std::string, int> seen;
  double second = -1.0;
  for (std::string line; std::getline(lines, line);) {
    const Json read = Json::parse(line);
    const std::string type = read.at("type");
    ++seen[type];
    if (read.contains("second")) {
      second = read.at("second");
    }
    if (read.contains("latitude")) {
      const GnssSample truth = truth_at(read.at("second"));
      EXPECT_NEAR(read.at("latitude").get<double>(), truth.latitude_deg, kHalfStep_deg) << line;
      EXPECT_NEAR(read.at("longitude").get<double>(), truth.longitude_deg, kHalfStep_deg) << line;
    }
    if (type == "RMC") {
      EXPECT_NEAR(std::stod(read.at("spd_over_grnd").get<std::string>()) * 1852.0 / 3600.0,
                  std::hypot(2.226, 2.175), 0.0006);
      EXPECT_NEAR(std::stod(read.at("true_course").get<std::string>()),
                  std::atan2(2.175, 2.226) * 180.0 / M_PI, 0.0051);
      EXPECT_EQ(read.at("datestamp"), "2026-06-01");
      EXPECT_EQ(read.at("status"), "A");
    } else if (type == "GGA") {
      const GnssSample truth = truth_at(second);
      EXPECT_NEAR(std::stod(read.at("altitude").get<std::string>()),
                  truth.ellipsoid_height_m - truth.geoid_separation_m, 0.051);
      EXPECT_NEAR(std::stod(read.at("geo_sep").get<std::string>()), 48.0, 0.051);
      EXPECT_EQ(read.at("num_sats"), "11");
      EXPECT_EQ(read.at("horizontal_dil"), "1.02");
      EXPECT_EQ(read.at("gps_qual"), "1");
    } else if (type == "GSA") {
      EXPECT_EQ(read.at("mode_fix_type"), "3");
      EXPECT_EQ(read.at("pdop"), "1.84");
      EXPECT_EQ(read.at("vdop"), "1.92");
    } else if (type == "VTG") {
      EXPECT_NEAR(std::stod(read.at("spd_over_grnd_kmph").get<std::string>()),
                  3.6 * std::hypot(2.226, 2.175), 0.002);
    } else if (type == "GSV") {
      EXPECT_EQ(read.at("num_messages"), "3");
      EXPECT_EQ(read.at("num_sv_in_view"), "11");
    } else if (type == "ZDA") {
      EXPECT_EQ(read.at("year"), "2026");
    }
  }
  for (const char* type : {"RMC", "VTG", "GGA", "GSA", "GLL", "ZDA"}) {
    EXPECT_GE(seen[type], 58) << type;
  }
  EXPECT_GE(seen["GSV"], 3 * 58);
  EXPECT_GE(seen["TXT"], 11);
}

TEST_F(NmeaClients, GpsBabelMakesATrackOfTheTruth) {
  // It expects GGA before RMC: in the order of a u-blox it would date each position by the next
  // RMC.
  emulators::UbloxSettings settings;
  settings.nmea_sentences = {"GGA", "GSA", "GSV", "GLL"};
  record(settings);
  const std::string table = output_of({"gpsbabel", "-t", "-i", "nmea,date=20260601", "-f",
                                       input().string(), "-o", "unicsv,format=0,utc=0", "-F", "-"});
  std::istringstream lines(table);
  std::string line;
  ASSERT_TRUE(std::getline(lines, line));
  std::vector<std::string> names;
  const auto fields = [](const std::string& text) {
    std::vector<std::string> all;
    std::istringstream stream(text);
    for (std::string field; std::getline(stream, field, ',');) {
      std::erase(field, '"');
      std::erase(field, '\r');
      all.push_back(field);
    }
    return all;
  };
  names = fields(line);
  int points = 0;
  while (std::getline(lines, line)) {
    std::map<std::string, std::string> point;
    const auto values = fields(line);
    for (std::size_t i = 0; i < std::min(names.size(), values.size()); ++i) {
      point[names[i]] = values[i];
    }
    int hour = 0;
    int minute = 0;
    double second = 0.0;
    ASSERT_EQ(std::sscanf(point["Time"].c_str(), "%d:%d:%lf", &hour, &minute, &second), 3) << line;
    const GnssSample truth = truth_at(hour * 3600.0 + minute * 60.0 + second);
    // It prints six decimals.
    EXPECT_NEAR(std::stod(point["Latitude"]), truth.latitude_deg, kHalfStep_deg + 5e-7) << line;
    EXPECT_NEAR(std::stod(point["Longitude"]), truth.longitude_deg, kHalfStep_deg + 5e-7) << line;
    EXPECT_NEAR(std::stod(point["Altitude"]), truth.ellipsoid_height_m - truth.geoid_separation_m,
                0.11)
        << line;
    EXPECT_EQ(point["Date"], "2026/06/01");
    EXPECT_EQ(point["FIX"], "3d");
    EXPECT_EQ(point["Satellites"], "11");
    EXPECT_EQ(point["PDOP"], "1.84");
    ++points;
  }
  EXPECT_GE(points, 58);

  const std::string gpx = output_of({"gpsbabel", "-t", "-i", "nmea,date=20260601", "-f",
                                     input().string(), "-o", "gpx", "-F", "-"});
  std::size_t count = 0;
  for (std::size_t at = gpx.find("<trkpt"); at != std::string::npos;
       at = gpx.find("<trkpt", at + 1)) {
    ++count;
  }
  EXPECT_EQ(count, static_cast<std::size_t>(points));
}

}  // namespace
}  // namespace rigwire
