#include "hil/files/lidar_calibration_file.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <functional>
#include <numbers>
#include <string>

#include "private_wires.h"

namespace rigwire::hil {
namespace {

using protocols::velodyne::Hdl64eCalibration;
using ::testing::AllOf;
using ::testing::HasSubstr;

class LidarCalibrationFile : public ::testing::Test {
 protected:
  /// A laser's line; `more` comes last.
  static std::string laser(int id, const std::string& more = "") {
    return fmt::format(
        "- {{dist_correction: 1.4, dist_correction_x: 1.37, dist_correction_y: 1.38, "
        "focal_distance: 12.5, focal_slope: 1.1, horiz_offset_correction: 0.026, laser_id: {}, "
        "max_intensity: 250, min_intensity: 40, rot_correction: {}, vert_correction: -0.1, "
        "vert_offset_correction: 0.2{}}}\n",
        id, 0.001 * id, more);
  }
  static std::string file_of(int count, const std::string& head = "") {
    std::string text = head + "lasers:\n";
    for (int id = 0; id < count; ++id) {
      text += laser(id);
    }
    return text;
  }
  Hdl64eCalibration load(const std::string& text) {
    std::ofstream(path) << text;
    return load_lidar_calibration(path);
  }
  std::string complaint(const std::string& text) {
    try {
      load(text);
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return "loaded";
  }

  rigwire::test::PrivateWires wires;
  std::string path = (wires.folder / "unit.yaml").string();
};

TEST_F(LidarCalibrationFile, ReadsAnglesInDegreesAndLengthsInMetres) {
  const auto unit = load(file_of(64, "num_lasers: 64\ndistance_resolution: 0.002\n"));
  ASSERT_EQ(unit.lasers.size(), 64U);
  const auto& last = unit.lasers[63];
  EXPECT_DOUBLE_EQ(last.rot_correction_deg, 0.063 * 180.0 / std::numbers::pi);
  EXPECT_DOUBLE_EQ(last.vert_correction_deg, -0.1 * 180.0 / std::numbers::pi);
  EXPECT_EQ(last.dist_correction_m, 1.4);
  EXPECT_EQ(last.dist_correction_x_m, 1.37);
  EXPECT_EQ(last.dist_correction_y_m, 1.38);
  EXPECT_EQ(last.vert_offset_m, 0.2);
  EXPECT_EQ(last.horiz_offset_m, 0.026);
  EXPECT_EQ(last.focal_distance_m, 12.5);
  EXPECT_EQ(last.focal_slope, 1.1);
  EXPECT_EQ(last.min_intensity, 40);
  EXPECT_EQ(last.max_intensity, 250);
}

TEST_F(LidarCalibrationFile, OrderOfTheLinesDoesNotMatter) {
  std::string text = "lasers:\n";
  for (int id = 63; id >= 0; --id) {
    text += laser(id, ", two_pt_correction_available: true");
  }
  EXPECT_EQ(load(text), load(file_of(64)));
}

TEST_F(LidarCalibrationFile, UnitWith31LasersIsRefused) {
  EXPECT_EQ(complaint(file_of(31)), path + ":2:1: lasers: found 31, allowed: 64");
  EXPECT_THAT(complaint(file_of(31, "num_lasers: 64\n")),
              HasSubstr(":1:13: num_lasers: found 64, but the list has 31 lasers"));
}

TEST_F(LidarCalibrationFile, WhatIsNoNumberIsNamedWithItsPlace) {
  for (const char* value : {".nan", ".inf", "abc", "[1]", "~"}) {
    std::string text = file_of(63);
    text += fmt::format("- {{laser_id: 63, rot_correction: {}, vert_correction: 0}}\n", value);
    EXPECT_THAT(complaint(text), AllOf(HasSubstr("lasers.63.rot_correction: found '"),
                                       HasSubstr("allowed: a finite number")))
        << value;
  }
}

TEST_F(LidarCalibrationFile, UnknownKeysAreNamed) {
  std::string text = "lasers:\n" + laser(0, ", colour: 3");
  for (int id = 1; id < 64; ++id) {
    text += laser(id);
  }
  EXPECT_THAT(complaint(text), HasSubstr("lasers.0.colour: unknown key"));
  EXPECT_THAT(complaint(file_of(64, "unit: 7\n")), HasSubstr(":1:1: unit: unknown key"));
}

TEST_F(LidarCalibrationFile, LaserThatIsThereTwiceIsRefused) {
  std::string text = file_of(63) + laser(5);
  EXPECT_THAT(complaint(text), HasSubstr("lasers.63: laser 5 is there twice"));
  text = file_of(63) + laser(64);
  EXPECT_THAT(complaint(text), HasSubstr("lasers.63.laser_id: found 64, allowed: 0 .. 63"));
}

TEST_F(LidarCalibrationFile, WhatNoUnitHasIsRefused) {
  std::string text =
      file_of(63) + "- {laser_id: 63, rot_correction: 0, vert_correction: 0, dist_correction: 90}";
  EXPECT_THAT(complaint(text), HasSubstr(path + ": "));
}

TEST_F(LidarCalibrationFile, OtherFilesAreRefused) {
  EXPECT_THAT(complaint(""), HasSubstr("no list 'lasers'"));
  EXPECT_THAT(complaint("lasers: 64\n"), HasSubstr("no list 'lasers'"));
  EXPECT_THAT(complaint("lasers: [\n"), HasSubstr(path + ":"));
  EXPECT_THAT(complaint("<?xml version=\"1.0\"?><boost_serialization/>"), HasSubstr(path + ":"));
  EXPECT_EQ(complaint(file_of(63) + "- {laser_id: 63, vert_correction: 0}\n"),
            path + ":65:3: lasers.63: rot_correction is missing");
  std::filesystem::remove(path);
  EXPECT_THROW((void)load_lidar_calibration(path), std::runtime_error);
}

}  // namespace
}  // namespace rigwire::hil
