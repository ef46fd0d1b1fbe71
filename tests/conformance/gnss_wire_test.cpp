// A minute of the emulated receiver's output, read by gpsd's own decoder (Debian's gpsdecode) and
// compared with the truth that was fed in. The program is a required dependency: without it these
// tests fail.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "emulators/ublox/receiver.h"
#include "sim/local_frame.h"
#include "sim/samples/calendar.h"
#include "simulated_receiver.h"

namespace rigwire {
namespace {

using namespace std::chrono_literals;
using Json = nlohmann::json;
using test::driving_machine;

std::string record_a_minute(const emulators::UbloxSettings& settings, const Calendar& calendar) {
  return test::run_receiver(settings, calendar, driving_machine, 60s).bytes;
}

/// What gpsdecode makes of the bytes, one JSON object per line.
std::vector<Json> gpsdecode(const std::string& bytes) {
  const auto path = std::filesystem::temp_directory_path() /
                    ("rigwire_gnss_wire_" + std::to_string(::getpid()) + ".bin");
  std::ofstream(path, std::ios::binary).write(bytes.data(), std::ssize(bytes));
  const std::string command = "gpsdecode -j < '" + path.string() + "' 2>&1";
  std::unique_ptr<std::FILE, int (*)(std::FILE*)> pipe(::popen(command.c_str(), "r"),
                                                       [](std::FILE* f) { return ::pclose(f); });
  std::string output;
  std::array<char, 4096> buffer{};
  for (std::size_t n = 0;
       pipe && (n = std::fread(buffer.data(), 1, buffer.size(), pipe.get())) > 0;) {
    output.append(buffer.data(), n);
  }
  std::filesystem::remove(path);
  std::vector<Json> objects;
  std::size_t at = 0;
  while (at < output.size()) {
    const std::size_t end = std::min(output.find('\n', at), output.size());
    const std::string line = output.substr(at, end - at);
    at = end + 1;
    if (Json object = Json::parse(line, nullptr, false); object.is_object()) {
      objects.push_back(std::move(object));
    } else {
      ADD_FAILURE() << "gpsdecode said: " << line;
    }
  }
  return objects;
}

std::vector<Json> of_class(const std::vector<Json>& objects, const std::string& name) {
  std::vector<Json> found;
  std::ranges::copy_if(objects, std::back_inserter(found),
                       [&](const Json& object) { return object.value("class", "") == name; });
  return found;
}

/// The truth at the epoch that a report names.
GnssSample truth_of(const Json& report, const Calendar& calendar) {
  std::string text = report.at("time").get<std::string>();
  const UtcTime utc = parse_utc(text);
  for (SimTime t = kStart; t < kStart + 61s; t += 1s) {
    if (calendar.utc(t) == utc) {
      return driving_machine(t);
    }
  }
  ADD_FAILURE() << "no epoch at " << text;
  return {};
}

class GnssOnTheWire : public testing::Test {
 protected:
  // gpsdecode resolves the date by the host's clock; a fixed recent date keeps the test
  // independent.
  Calendar calendar_{UtcTime{2026, 6, 1, 8, 0, 0, 0}};
};

TEST_F(GnssOnTheWire, NmeaPositionsAreTheTruth) {
  const std::string bytes = record_a_minute({}, calendar_);
  const auto reports = of_class(gpsdecode(bytes), "TPV");
  int complete = 0;
  for (const Json& report : reports) {
    if (report.value("mode", 0) != 3 || !report.contains("time") || !report.contains("lat")) {
      continue;
    }
    ++complete;
    const GnssSample truth = truth_of(report, calendar_);
    EXPECT_NEAR(report.at("lat").get<double>(), truth.latitude_deg, 0.6e-5 / 60.0 + 1e-9);
    EXPECT_NEAR(report.at("lon").get<double>(), truth.longitude_deg, 0.6e-5 / 60.0 + 1e-9);
    if (report.contains("altMSL")) {
      EXPECT_NEAR(report.at("altMSL").get<double>(),
                  truth.ellipsoid_height_m - truth.geoid_separation_m, 0.051);
    }
    if (report.contains("speed")) {
      EXPECT_NEAR(report.at("speed").get<double>(), std::hypot(2.226, 2.175), 0.001);
    }
  }
  EXPECT_GE(complete, 55);
}

TEST_F(GnssOnTheWire, NmeaSkyIsTheTruth) {
  const auto skies = of_class(gpsdecode(record_a_minute({}, calendar_)), "SKY");
  ASSERT_FALSE(skies.empty());
  const Json& sky = skies.back();
  ASSERT_EQ(sky.at("satellites").size(), 11U);
  for (const Json& satellite : sky.at("satellites")) {
    const int prn = satellite.at("PRN").get<int>();
    EXPECT_NEAR(satellite.at("el").get<double>(), 0.1 * prn * 180.0 / M_PI, 0.51);
    EXPECT_NEAR(satellite.at("ss").get<double>(), 35.0 + prn, 0.01);
    EXPECT_TRUE(satellite.at("used").get<bool>());
  }
}

TEST_F(GnssOnTheWire, UbxSolutionIsTheTruth) {
  emulators::UbloxSettings settings;
  settings.nmea_sentences.clear();
  settings.start_banner = false;
  settings.ubx_messages = {"NAV-SOL", "NAV-DOP", "NAV-TIMEGPS", "NAV-SVINFO"};
  const auto objects = gpsdecode(record_a_minute(settings, calendar_));
  int complete = 0;
  for (const Json& report : of_class(objects, "TPV")) {
    if (report.value("mode", 0) != 3 || !report.contains("time")) {
      continue;
    }
    ++complete;
    const GnssSample truth = truth_of(report, calendar_);
    // NAV-SOL carries centimetres of earth-centred coordinates. gpsdecode 3.22 turns them into
    // latitude and longitude for its first report only (the daemon does it for each), so they are
    // compared as they are.
    const Eigen::Vector3d p_E =
        sim::LocalFrame({truth.latitude_deg, truth.longitude_deg, truth.ellipsoid_height_m, 0.0})
            .to_ecef(Eigen::Vector3d::Zero());
    EXPECT_NEAR(report.at("ecefx").get<double>(), p_E.x(), 0.006);
    EXPECT_NEAR(report.at("ecefy").get<double>(), p_E.y(), 0.006);
    EXPECT_NEAR(report.at("ecefz").get<double>(), p_E.z(), 0.006);
    EXPECT_NEAR(std::hypot(report.at("ecefvx").get<double>(), report.at("ecefvy").get<double>(),
                           report.at("ecefvz").get<double>()),
                std::hypot(2.226, 2.175, 0.5), 0.02);
    if (report.contains("leapseconds")) {
      EXPECT_EQ(report.at("leapseconds").get<int>(), 18);
    }
  }
  EXPECT_GE(complete, 55);
  const auto skies = of_class(objects, "SKY");
  ASSERT_FALSE(skies.empty());
  const bool dilution = std::ranges::any_of(skies, [](const Json& sky) {
    return std::abs(sky.value("hdop", 0.0) - 1.02) < 1e-6 &&
           std::abs(sky.value("pdop", 0.0) - 1.84) < 1e-6;
  });
  EXPECT_TRUE(dilution);
  const bool satellites = std::ranges::any_of(skies, [](const Json& sky) {
    return sky.contains("satellites") && sky.at("satellites").size() == 11U;
  });
  EXPECT_TRUE(satellites);
}

TEST_F(GnssOnTheWire, UbxPvtIsTheTruth) {
  emulators::UbloxSettings settings;
  settings.nmea_sentences.clear();
  settings.start_banner = false;
  settings.ubx_messages = {"NAV-PVT", "NAV-TIMEGPS"};
  int complete = 0;
  for (const Json& report : of_class(gpsdecode(record_a_minute(settings, calendar_)), "TPV")) {
    if (report.value("mode", 0) != 3 || !report.contains("time") || !report.contains("lat")) {
      continue;
    }
    ++complete;
    const GnssSample truth = truth_of(report, calendar_);
    EXPECT_NEAR(report.at("lat").get<double>(), truth.latitude_deg, 1e-7);
    EXPECT_NEAR(report.at("lon").get<double>(), truth.longitude_deg, 1e-7);
  }
  EXPECT_GE(complete, 55);
}

}  // namespace
}  // namespace rigwire
