// Every choice of the depth-image pipeline is a key.
#include <gtest/gtest.h>

#include <string>

#include "findings_of.h"
#include "sim/lidar/depth_image_parameters.h"

namespace rigwire::hil {
namespace {

sim::DepthImageParameters read_images(const std::string& yaml, std::string& findings) {
  sim::DepthImageParameters images;
  findings = findings_of(yaml, images);
  return images;
}

TEST(DepthImageKeys, EveryChoiceHasItsKey) {
  std::string findings;
  const sim::DepthImageParameters images = read_images(R"(
cameras: 4
field_of_view: 100 deg
width: 2048
height: 1200
images_per_revolution: 10
depth: fixed_24
near_plane: 0.5 m
rows: half_width
columns: uniform
elevations: pixels_per_beam
sampling: bilinear_depth
parallax_steps: 0
)",
                                                       findings);
  EXPECT_EQ(findings, "");
  EXPECT_EQ(images.cameras, 4);
  EXPECT_DOUBLE_EQ(images.field_of_view_deg, 100.0);
  EXPECT_EQ(images.width_px, 2048);
  EXPECT_EQ(images.height_px, 1200);
  EXPECT_EQ(images.images_per_revolution, 10);
  EXPECT_EQ(images.depth, sim::DepthFormat::fixed_24);
  EXPECT_DOUBLE_EQ(images.near_plane_m, 0.5);
  EXPECT_EQ(images.rows, sim::RowRule::hyperbola_half_width);
  EXPECT_EQ(images.columns, sim::ColumnRule::uniform);
  EXPECT_EQ(images.elevations, sim::ElevationRule::pixels_per_beam);
  EXPECT_EQ(images.sampling, sim::DepthSampling::bilinear_depth);
  EXPECT_EQ(images.parallax_steps, 0);
}

TEST(DepthImageKeys, WhatNoImageCanShowIsRefused) {
  std::string findings;
  (void)read_images("cameras: 2\n", findings);
  EXPECT_NE(findings.find("cameras"), std::string::npos) << findings;
  (void)read_images("rows: straight\n", findings);
  EXPECT_NE(findings.find("parallax_steps"), std::string::npos) << findings;
}

}  // namespace
}  // namespace rigwire::hil
