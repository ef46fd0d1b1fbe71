// The one place where ground truth leaves: a file of JSON lines, never a device.
#pragma once

#include <array>
#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

#include "sim/samples/calendar.h"
#include "sim/samples/time.h"
#include "sim/samples/vector3.h"

namespace rigwire::hil {

/// What is true of the machine at one instant.
struct TruthRecord {
  SimTime time{};
  std::array<double, 4> joint_rad{};  ///< Swing, boom, stick, bucket.
  std::array<double, 4> joint_rate_radps{};
  std::array<double, 4> spool{};      ///< -1 .. 1.
  Vector3 bucket_tip_W_m;             ///< East, north, up of the map origin.
  double antenna_latitude_deg = 0.0;  ///< Of the first satellite receiver's antenna; NaN without.
  double antenna_longitude_deg = 0.0;
  double antenna_height_m = 0.0;  ///< Above the ellipsoid.
};

/// Writes one line per record, buffered by the system. A record has: sim_s, utc, time_of_hour_us,
/// joint_rad, joint_rate_radps, spool, bucket_tip_m, antenna {latitude_deg, longitude_deg,
/// height_m}.
class TruthTap {
 public:
  /// Throws std::runtime_error with path and reason when the file cannot be created.
  TruthTap(const std::filesystem::path& path, const Calendar& calendar);
  ~TruthTap();
  TruthTap(const TruthTap&) = delete;
  TruthTap& operator=(const TruthTap&) = delete;

  void record(const TruthRecord& record);

 private:
  std::FILE* file_;
  Calendar calendar_;
};

}  // namespace rigwire::hil
