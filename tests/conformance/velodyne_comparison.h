// What velodyne_points.py reads from a capture, against what was put in.
#pragma once

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <map>
#include <numbers>
#include <span>
#include <sstream>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

#include "velodyne_stream.h"

namespace rigwire {

/// "HDL64ES2Dual": what a test of this model and mode is called.
inline std::string velodyne_test_name(std::string_view model,
                                      protocols::velodyne::ReturnMode mode) {
  using protocols::velodyne::ReturnMode;
  std::string name(model);
  std::erase_if(name, [](char c) { return std::isalnum(static_cast<unsigned char>(c)) == 0; });
  return name + (mode == ReturnMode::dual   ? "Dual"
                 : mode == ReturnMode::last ? "Last"
                                            : "Strongest");
}

/// Largest differences over all returns.
struct DecodedDifference {
  std::size_t compared = 0;
  std::size_t missing = 0;  ///< Put in, not read.
  std::string unexpected;   ///< A line that could not be read, or of a return never put in.
  double range_m = 0.0;
  double azimuth_deg = 0.0;
  double elevation_deg = 0.0;
  double time_us = 0.0;
  double reflectivity = 0.0;
  double place_m = 0.0;  ///< Distance of x, y, z from the beam at the range that was read.
};

class VelodyneComparison {
 public:
  /// `lasers` as the sensor has them. Azimuths and places of the first packet are left out where it
  /// does not tell the rotor's speed.
  VelodyneComparison(const std::vector<TrueReturn>& truth,
                     std::span<const protocols::velodyne::Laser> lasers, double start_us,
                     bool first_speed_unknown)
      : lasers_(lasers), start_us_(start_us), first_speed_unknown_(first_speed_unknown) {
    for (const TrueReturn& one : truth) {
      const bool last = one.echo == protocols::velodyne::BlockEcho::last;
      const std::string echo = one.both ? "both" : last ? "last" : "strongest";
      expected_[{one.packet, one.firing, one.laser, echo}] = one;
    }
  }

  DecodedDifference run(const std::filesystem::path& capture) {
    std::istringstream lines(output_of("/usr/bin/python3 " + std::string(RIGWIRE_SOURCE_DIR) +
                                       "/tests/conformance/velodyne_points.py " + capture.string() +
                                       " 2>&1"));
    DecodedDifference difference;
    std::string line;
    while (std::getline(lines, line)) {
      if (!take(line, difference)) {
        difference.unexpected = line;
        break;
      }
    }
    difference.missing = expected_.size();
    return difference;
  }

 private:
  /// Packet, firing, laser, echo.
  using Key = std::tuple<std::size_t, std::size_t, std::size_t, std::string>;

  static std::string output_of(const std::string& command) {
    std::string text;
    FILE* pipe = popen(command.c_str(), "r");
    if (pipe == nullptr) {
      return "cannot run " + command;
    }
    std::array<char, 4096> piece{};
    while (std::fgets(piece.data(), static_cast<int>(piece.size()), pipe) != nullptr) {
      text += piece.data();
    }
    const int status = pclose(pipe);
    return status == 0 ? text : "exit status " + std::to_string(status) + "\n" + text;
  }

  static double wrapped(double value, double turn) {
    return value - turn * std::round(value / turn);
  }

  static void raise(double& worst, double difference) {
    worst = std::max(worst, std::abs(difference));
  }

  bool take(const std::string& line, DecodedDifference& difference) {
    std::istringstream values(line);
    std::size_t packet = 0;
    std::size_t firing = 0;
    std::size_t laser = 0;
    std::string echo;
    double time_us = 0.0;
    double azimuth = 0.0;
    double elevation = 0.0;
    double range = 0.0;
    double reflectivity = 0.0;
    double x = 0.0;
    double y = 0.0;
    double z = 0.0;
    values >> packet >> firing >> laser >> echo >> time_us >> azimuth >> elevation >> range >>
        reflectivity >> x >> y >> z;
    const auto found = expected_.find({packet, firing, laser, echo});
    if (values.fail() || found == expected_.end()) {
      return false;
    }
    const TrueReturn& truly = found->second;
    const protocols::velodyne::Laser& looks = lasers_[laser];
    if (packet > 0 || !first_speed_unknown_) {
      raise(difference.azimuth_deg, wrapped(azimuth - truly.azimuth_deg, 360.0));
      const double degree = std::numbers::pi / 180.0;
      const double b = truly.azimuth_deg * degree;
      const double w = looks.elevation_deg * degree;
      const double h = looks.horizontal_offset_mm * 1e-3;
      const double true_x = range * std::cos(w) * std::cos(b) - h * std::sin(b);
      const double true_y = -range * std::cos(w) * std::sin(b) - h * std::cos(b);
      const double true_z = range * std::sin(w) + looks.vertical_offset_mm * 1e-3;
      raise(difference.place_m, std::hypot(x - true_x, y - true_y, z - true_z));
    }
    raise(difference.elevation_deg, elevation - looks.elevation_deg);
    raise(difference.range_m, range - truly.range_m);
    raise(difference.reflectivity, reflectivity - truly.reflectivity);
    raise(difference.time_us, wrapped(time_us - start_us_ - truly.time_us, 3.6e9));
    expected_.erase(found);
    ++difference.compared;
    return true;
  }

  std::span<const protocols::velodyne::Laser> lasers_;
  double start_us_;
  bool first_speed_unknown_;
  std::map<Key, TrueReturn> expected_;
};

}  // namespace rigwire
