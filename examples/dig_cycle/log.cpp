#include "dig_cycle/log.h"

#include "field/json_line.h"

namespace rigwire::dig_cycle {

std::string to_json(const LogEntry& entry) {
  constexpr double kPerDegree = 1.0 / kDegree;
  field::JsonLine line;
  line.number("uptime_s", entry.uptime_s, 3);
  if (entry.time_of_hour_us) {
    line.whole("time_of_hour_us", *entry.time_of_hour_us);
  } else {
    line.null("time_of_hour_us");
  }
  line.text("state", entry.state);
  line.text("phase", entry.phase);
  line.whole("cycles", static_cast<std::int64_t>(entry.cycles));
  line.numbers("joints_deg", entry.belief.angles_rad, kPerDegree, 4);
  line.numbers("joint_rates_dps", entry.belief.rates_radps, kPerDegree, 3);
  line.number("chassis_pitch_deg", entry.belief.chassis_pitch_rad * kPerDegree, 4);
  line.numbers("targets_deg", entry.output.target_rad, kPerDegree, 3);
  line.numbers("openings", entry.output.openings, 1.0, 4);
  line.numbers("spools", entry.spool, 1.0, 3);
  line.boolean("held_by_obstacle", entry.output.held_by_obstacle);
  line.open("gnss");
  line.whole("quality", entry.gnss.quality);
  line.number("latitude_deg", entry.gnss.latitude_deg, 8);
  line.number("longitude_deg", entry.gnss.longitude_deg, 8);
  line.number("altitude_m", entry.gnss.altitude_m, 2);
  line.whole("satellites", entry.gnss.satellites);
  line.close();
  line.number("lidar_nearest_m", entry.nearest_range_m, 3);
  line.number("ground_z_m", entry.ground_z_m, 3);
  return std::move(line).take();
}

}  // namespace rigwire::dig_cycle
