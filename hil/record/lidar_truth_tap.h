// Ground truth of every lidar shot: a file of fixed records, never sent to a device.
//
// The file begins with one line of JSON and goes on with records to its end, little-endian:
//
//   offset size
//     0     8   instant of the shot, ns of simulated time (signed)
//     8     2   number of the lidar in the header's `lidars`
//    10     2   laser, the model's own number
//    12     4   instance, index into the header's `instances`; 4294967295: no hit
//    16     4   exact range of the first surface in the middle of the beam, m (float); 0: none
//    20     4   cosine of the incidence there (float)
//    24     4   range that the sensor measured, strongest echo, m (float); 0: none
//    28     4   reflectivity that it measured (float): 0 .. 1 diffuse, 1 .. 2 retro-reflector
//
// Header: {"rigwire_lidar_truth": 1, "record_bytes": 32, "start_utc": …, "start_time_of_hour_us":
// …, "lidars": [names], "instances": [{"name", "label"}]}. The time of hour of a packet is
// start_time_of_hour_us + ns / 1000, modulo one hour, as long as the sensor's clock is locked.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "hil/record/output_file.h"
#include "hil/world/truth_observer.h"
#include "sim/samples/calendar.h"
#include "sim/scene/scene.h"

namespace rigwire::hil {

inline constexpr std::size_t kLidarTruthRecordSize = 8     // instant
                                                     + 2   // lidar
                                                     + 2   // laser
                                                     + 4   // instance
                                                     + 4   // exact range
                                                     + 4   // cosine
                                                     + 4   // measured range
                                                     + 4;  // measured reflectivity
static_assert(kLidarTruthRecordSize == 32);

class LidarTruthTap final : public LidarTruthObserver {
 public:
  /// `lidars`: the names of all that will be recorded; their order numbers them. Throws
  /// drivers::EndpointError with path and reason when the file cannot be opened. Reports a later
  /// write error to `failures`, which may be null.
  LidarTruthTap(const std::filesystem::path& path, const Calendar& calendar,
                const sim::Scene& scene, std::vector<std::string> lidars,
                OutputFailures* failures = nullptr,
                std::chrono::milliseconds patience = kReaderPatience);

  /// Precondition: `lidar` is one of the names.
  void record(std::string_view lidar, const LidarPattern& pattern,
              const std::vector<LidarFiring>& firings,
              const std::vector<sim::LidarBankTruth>& truth) override;

 private:
  GrowingFile file_;
  std::vector<std::string> lidars_;
  std::string records_;  ///< Records of one call; kept for its memory.
};

}  // namespace rigwire::hil
