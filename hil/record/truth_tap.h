// The output of ground truth: a file of JSON lines, never sent to a device.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "hil/record/output_file.h"
#include "hil/world/truth_observer.h"
#include "sim/machine.h"
#include "sim/samples/calendar.h"

namespace rigwire::hil {

/// Returns one record as a line of JSON, without the end of the line. It has: sim_s, utc,
/// time_of_hour_us, position_m (east, north, up of the map origin), attitude_wxyz (unit
/// quaternion), velocity_mps and rate_radps (in the world's axes) of the machine's first link, the
/// machine's truth fields (a number, or a list when a field has several), state {NAME: value} with
/// the quantities of `read` in their units (hil/world/quantities.h), contact of machines that hit
/// obstacles {touching, body, with, place_m, force_n, deepest_m, dent_m, pressed_m, sunk_m, lost_j,
/// felled}, moved {name: {position_m, attitude_wxyz}} of the loose things that are not where they
/// began, antenna {latitude_deg, longitude_deg, height_m} of the first satellite receiver, and
/// antennas with the same of each by its name. Heights are above the ellipsoid.
[[nodiscard]] std::string truth_line(const TruthRecord& record, const Calendar& calendar,
                                     std::span<const sim::TruthField> fields);

/// Returns the paths of the numbers that each record of such a machine has, "joint_rad.1" and
/// "state.boom" (hil/record/number_paths.h), without a run. `antennas`: names of the satellite
/// receivers and base stations. Left out is what a record has at times only: `moved` and `hand`.
[[nodiscard]] std::vector<std::string> truth_numbers(const sim::Machine& machine,
                                                     std::span<const std::string> antennas);

/// Writes a line per record.
class TruthTap final : public TruthObserver {
 public:
  /// Throws drivers::EndpointError with path and reason when the file cannot be opened. Reports a
  /// later write error to `failures`, which may be null.
  TruthTap(const std::filesystem::path& path, const Calendar& calendar,
           std::span<const sim::TruthField> fields, OutputFailures* failures = nullptr,
           std::chrono::milliseconds patience = kReaderPatience);

  void record(const TruthRecord& record) override;

 private:
  GrowingFile file_;
  Calendar calendar_;
  std::vector<sim::TruthField> fields_;
};

}  // namespace rigwire::hil
