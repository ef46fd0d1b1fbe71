#include "protocols/velodyne/model.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

namespace rigwire::protocols::velodyne {
namespace {

const Model& model(std::string_view name) {
  const Model* found = find_model(name);
  EXPECT_NE(found, nullptr) << name;
  return *found;
}

/// Largest difference between the heights of the beams' exits and a common focus.
double worst_height_mm(const Model& model, double focus_mm) {
  double worst = 0.0;
  for (const Laser& laser : model.lasers) {
    const double height = focus_mm * std::tan(-laser.elevation_deg * std::numbers::pi / 180.0);
    worst = std::max(worst, std::abs(laser.vertical_offset_mm - height));
  }
  return worst;
}

TEST(VelodyneModel, IsFoundByNameAndByItsOwnProductId) {
  EXPECT_EQ(models().size(), 8U);
  for (const Model& model : models()) {
    EXPECT_EQ(find_model(model.name, model.firmware), &model);
    const bool older = model.firmware == "5.1.7";
    EXPECT_EQ(find_model(model.name) == &model, !older) << "the newest first";
    if (model.product_id != 0) {
      EXPECT_EQ(find_model(model.product_id) == &model, !older);
    }
  }
  EXPECT_EQ(find_model("VLP-16", "5.1.7"), nullptr);
  EXPECT_EQ(find_model("HDL-33"), nullptr);
  EXPECT_EQ(find_model(std::uint8_t{0}), nullptr) << "an HDL-64E has no product id";
  EXPECT_EQ(find_model(std::uint8_t{0x63}), nullptr);
}

TEST(VelodyneModel, BlocksHoldAllLasers) {
  for (const Model& model : models()) {
    EXPECT_EQ(model.lasers.size() * static_cast<std::size_t>(model.firings_per_block),
              32U * static_cast<std::size_t>(model.blocks_per_firing))
        << model.name;
  }
}

TEST(VelodyneModel, LasersFireWithinTheirPeriodAndTheFirstAtOnce) {
  for (const Model& model : models()) {
    EXPECT_EQ(model.lasers.front().time_offset_ns, 0) << model.name;
    for (const Laser& laser : model.lasers) {
      EXPECT_GE(laser.time_offset_ns, 0);
      EXPECT_LT(laser.time_offset_ns, model.firing_period_ns) << model.name;
    }
  }
}

TEST(VelodyneModel, ExitsObeyTheOptics) {
  EXPECT_LE(worst_height_mm(model("HDL-32E"), 28.83), 0.08);
  EXPECT_LE(worst_height_mm(model("VLP-16"), 41.91), 0.06);
  EXPECT_LE(worst_height_mm(model("VLP-32C"), 42.4), 0.006);
  EXPECT_LE(worst_height_mm(model("VLS-128"), 58.63), 0.006);
}

TEST(VelodyneModel, NoTwoLasersOfAHeadLookTheSameWay) {
  for (const Model& model : models()) {
    std::set<long> elevations;
    for (const Laser& laser : model.lasers) {
      elevations.insert(std::lround(laser.elevation_deg * 1e3));
    }
    EXPECT_EQ(elevations.size(), model.lasers.size()) << model.name;
  }
}

TEST(VelodyneModel, FansSpanWhatTheDataSheetsSay) {
  const auto expect_span = [](std::string_view name, double lowest_deg, double highest_deg) {
    const auto [low, high] = std::ranges::minmax(model(name).lasers, {}, &Laser::elevation_deg);
    EXPECT_NEAR(low.elevation_deg, lowest_deg, 0.01) << name;
    EXPECT_NEAR(high.elevation_deg, highest_deg, 0.01) << name;
  };
  expect_span("HDL-32E", -30.67, 10.67);
  expect_span("VLP-16", -15.0, 15.0);
  expect_span("Puck Hi-Res", -10.0, 10.0);
  expect_span("VLP-32C", -25.0, 15.0);
  expect_span("HDL-64E S2", -24.33, 2.0);
  expect_span("HDL-64E S3", -24.33, 2.0);
  expect_span("VLS-128", -25.0, 15.0);
}

TEST(VelodyneModel, OffsetAzimuthsOfAHeadCancel) {
  for (const std::string_view name : {"VLP-32C", "VLS-128"}) {
    std::set<long> columns;
    for (const Laser& laser : model(name).lasers) {
      columns.insert(std::lround(laser.azimuth_offset_deg * 1e3));
    }
    for (const long column : columns) {
      EXPECT_TRUE(columns.contains(-column)) << name << ' ' << column;
    }
  }
}

TEST(VelodyneModel, VlsPausesAfterEightGroupsAndFiresSlowerSinceFirmware523) {
  const Model& vls = *find_model("VLS-128", "5.1.7");
  EXPECT_EQ(vls.lasers[63].time_offset_ns, 7 * 2665);
  EXPECT_EQ(vls.lasers[64].time_offset_ns, 9 * 2665);
  EXPECT_EQ(vls.lasers[127].time_offset_ns, 16 * 2665);
  EXPECT_EQ(vls.firing_period_ns, 53300);
  EXPECT_NEAR(3 * model("VLS-128").firing_period_ns, 173'300, 50);
  EXPECT_EQ(model("VLS-128").lasers[64].time_offset_ns, 9 * 2889);
}

TEST(VelodyneModel, NearestReturnsArePossibleWhereTheCapturesHaveThem) {
  // Nearest distance of a public capture of each; of the VLS-128 its own car, 1.08 m.
  EXPECT_LE(model("HDL-32E").minimum_range_m, 0.17);
  EXPECT_LE(model("VLP-16").minimum_range_m, 0.5);
  EXPECT_LE(model("VLP-32C").minimum_range_m, 0.71);
  EXPECT_LE(model("VLS-128").minimum_range_m, 1.08);
}

TEST(VelodyneModel, HdlPacketsComeFromPort443AsInTheCapture) {
  EXPECT_EQ(model("HDL-32E").source_port, 443);
  EXPECT_EQ(model("HDL-64E S2").source_port, 443);
  EXPECT_EQ(model("VLP-16").source_port, 0) << "the destination's";
}

}  // namespace
}  // namespace rigwire::protocols::velodyne
