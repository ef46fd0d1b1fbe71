// Calibration of one HDL-64E unit from a file in the YAML form that ROS drivers read:
//
//   lasers:
//     - {laser_id: 0, rot_correction: -0.0929, vert_correction: -0.1227,           # rad
//        dist_correction: 1.43, dist_correction_x: 1.38, dist_correction_y: 1.40,  # m
//        vert_offset_correction: 0.21, horiz_offset_correction: 0.026,             # m
//        focal_distance: 12.5, focal_slope: 1.4, min_intensity: 0, max_intensity: 255}
//     - ...
//   num_lasers: 64
//   distance_resolution: 0.002
//
// laser_id, rot_correction and vert_correction are required, the others are 0 (max_intensity: 255)
// where they are left out; two_pt_correction_available is read over. The maker's own db.xml is not
// read: ROS' gen_calibration.py makes this form of it.
//
// Source: ros-drivers/velodyne, velodyne_pointcloud: gen_calibration.py and calibration.cpp.
#pragma once

#include <string>

#include "protocols/velodyne/hdl_64e_calibration.h"

namespace rigwire::hil {

/// Throws std::runtime_error with file, line, column, key, the value found and what is allowed: no
/// such file, no YAML, unknown keys, no finite number, lasers missing or twice, values
/// that no unit has (protocols::velodyne::validate).
[[nodiscard]] protocols::velodyne::Hdl64eCalibration load_lidar_calibration(
    const std::string& path);

}  // namespace rigwire::hil
