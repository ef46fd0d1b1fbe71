// What the sensor's web interface serves: a page, and JSON documents, member by member in the order
// and with the types of real sensors: ports and the offset of the phase lock are strings, speeds
// and angles are numbers. docs/devices/velodyne-web.md names the recordings and clients they come
// from.
#pragma once

#include <string>

#include "emulators/velodyne/velodyne_control.h"

namespace rigwire::emulators {

[[nodiscard]] std::string settings_document(const VelodyneLiveSettings& settings);
[[nodiscard]] std::string status_document(const VelodyneLiveSettings& settings,
                                          const VelodyneReadings& readings);
/// `arrays`: as sensors of 32 and more lasers, which report noise figures by channel.
[[nodiscard]] std::string diagnostics_document(const VelodyneReadings& readings, bool arrays);
[[nodiscard]] std::string info_document(const VelodyneControl& control);
/// All four, under "info", "config", "status" and "diag".
[[nodiscard]] std::string snapshot_document(SimTime now, const VelodyneControl& control);

/// The page at "/", for use in a browser, with the settings as forms. The words are this project's;
/// only the requests that the forms send are the sensor's.
[[nodiscard]] std::string control_page(SimTime now, const VelodyneControl& control);

/// Whether that sensor's diagnostics have arrays.
[[nodiscard]] bool has_diagnostic_arrays(const VelodyneControl& control);

/// Counts of the sensor's 12-bit converter, 5 V full scale: the inverse of the conversions of
/// VLP-16 user's manual 63-9243 Rev. D, section 10.2.3.2. Clamped to 0 .. 4095; half a count of
/// error, which is 0.1 K, 6.7 mV and 6.1 mA.
[[nodiscard]] int temperature_counts(double temperature_c);
[[nodiscard]] int input_voltage_counts(double voltage_v);
[[nodiscard]] int input_current_counts(double current_a);

}  // namespace rigwire::emulators
