#include "dig_cycle/log.h"

#include <cerrno>
#include <cmath>
#include <stdexcept>
#include <system_error>

namespace rigwire::dig_cycle {
namespace {

std::string text(double value, int decimals) {
  if (!std::isfinite(value)) {
    return "null";
  }
  char buffer[64];
  (void)std::snprintf(buffer, sizeof(buffer), "%.*f", decimals, value);
  return buffer;
}

std::string text(const std::optional<double>& value, int decimals) {
  return value ? text(*value, decimals) : "null";
}

std::string text(const PerJoint& values, double scale, int decimals) {
  std::string list = "[";
  for (const double value : values) {
    list += list.size() > 1 ? "," : "";
    list += text(value * scale, decimals);
  }
  list += "]";
  return list;
}

}  // namespace

std::string to_json(const LogEntry& entry) {
  constexpr double kPerDegree = 1.0 / kDegree;
  std::string line = "{";
  const auto add = [&line](std::string_view key, std::string_view value) {
    line += line.back() == '{' ? "\"" : ",\"";
    line += key;
    line += "\":";
    line += value;
  };
  const auto add_name = [&line, &add](std::string_view key, std::string_view value) {
    add(key, "\"");
    line += value;
    line += '"';
  };
  add("uptime_s", text(entry.uptime_s, 3));
  add("time_of_hour_us", entry.time_of_hour_us ? std::to_string(*entry.time_of_hour_us) : "null");
  add_name("state", entry.state);
  add_name("phase", entry.phase);
  add("cycles", std::to_string(entry.cycles));
  add("joints_deg", text(entry.belief.angles_rad, kPerDegree, 4));
  add("joint_rates_dps", text(entry.belief.rates_radps, kPerDegree, 3));
  add("chassis_pitch_deg", text(entry.belief.chassis_pitch_rad * kPerDegree, 4));
  add("targets_deg", text(entry.output.target_rad, kPerDegree, 3));
  add("openings", text(entry.output.openings, 1.0, 4));
  add("spools", text(entry.spool, 1.0, 3));
  add("held_by_obstacle", entry.output.held_by_obstacle ? "true" : "false");
  add("gnss", "{");
  add("quality", std::to_string(entry.gnss.quality));
  add("latitude_deg", text(entry.gnss.latitude_deg, 8));
  add("longitude_deg", text(entry.gnss.longitude_deg, 8));
  add("altitude_m", text(entry.gnss.altitude_m, 2));
  add("satellites", std::to_string(entry.gnss.satellites));
  line += '}';
  add("lidar_nearest_m", text(entry.nearest_range_m, 3));
  add("ground_z_m", text(entry.ground_z_m, 3));
  line += '}';
  return line;
}

Log::Log(const std::string& path) {
  if (path.empty()) {
    return;
  }
  file_.reset(std::fopen(path.c_str(), "w"));
  if (!file_) {
    throw std::runtime_error("log " + path +
                             ": cannot be written: " + std::generic_category().message(errno));
  }
}

void Log::write(const LogEntry& entry) {
  if (!file_) {
    return;
  }
  const std::string line = to_json(entry) + "\n";
  (void)std::fwrite(line.data(), 1, line.size(), file_.get());
  (void)std::fflush(file_.get());
}

}  // namespace rigwire::dig_cycle
