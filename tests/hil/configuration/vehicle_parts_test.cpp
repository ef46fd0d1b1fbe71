// Drive lines and vehicle sensors in a configuration: what is printed reads back, what is wrong is
// refused with its place.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "findings_of.h"
#include "hil/configuration/outline.h"
#include "sim/driveline/parameters.h"
#include "sim/odometry/odometry.h"
#include "sim/vehicle_sensors/vehicle_sensors.h"

namespace rigwire::hil {
namespace {

using testing::HasSubstr;

struct Parts {
  sim::DrivelineParameters driveline;
  sim::VehicleSensorParameters sensors;
  sim::OdometryParameters odometry;
};

inline void visit(fields::Visitor& v, Parts& p) {
  v.section("driveline", p.driveline, "Engine to wheels.");
  v.section("sensors", p.sensors, "Own sensors.");
  v.section("odometry", p.odometry, "Own estimate.");
}

TEST(VehicleParts, BothDrivelinesPrintAndReadBackUnchanged) {
  for (const sim::DrivelineParameters& driveline :
       {sim::DrivelineParameters(sim::GearedParameters{}),
        sim::DrivelineParameters(sim::CvtParameters{})}) {
    Parts parts;
    parts.driveline = driveline;
    const std::string yaml = print_yaml(outline(parts), Origins{});
    Parts again;
    ASSERT_EQ(findings_of(yaml, again), "") << yaml;
    EXPECT_TRUE(again.driveline == driveline) << yaml;
    EXPECT_TRUE(again.sensors == parts.sensors) << yaml;
    EXPECT_TRUE(again.odometry == parts.odometry) << yaml;
  }
}

TEST(VehicleParts, AGatorIsWrittenShort) {
  Parts parts;
  ASSERT_EQ(findings_of("driveline: {type: cvt, engine: {idle: 1300 rpm}, axles: {drive: rear, "
                        "centre_lock: false}}\nsensors: {gate: 50 ms, radius_error: 2 %}\n",
                        parts),
            "");
  const auto& cvt = std::get<sim::CvtParameters>(parts.driveline);
  EXPECT_DOUBLE_EQ(cvt.engine.idle_radps, rpm(1300));
  EXPECT_EQ(cvt.axles.drive, sim::AxleDrive::rear);
  EXPECT_EQ(parts.sensors.gate_s, 0.05);
  EXPECT_EQ(parts.sensors.radius_error, 0.02);
}

TEST(VehicleParts, WhatTheModelRefusesIsReportedWithItsPlace) {
  Parts parts;
  EXPECT_THAT(findings_of("driveline: {clutch: {full: 100 rpm}}\n", parts),
              HasSubstr("driveline.clutch.full: found 100 rpm, allowed above open, 740 rpm"));
  EXPECT_THAT(findings_of("driveline: {engine: {inertia: -1}}\n", parts),
              HasSubstr("driveline.engine.inertia"));
  EXPECT_THAT(findings_of("driveline: {type: automatic}\n", parts), HasSubstr("driveline.type"));
  EXPECT_THAT(findings_of("driveline: {gearbox: {forward: [1, 0]}}\n", parts),
              HasSubstr("forward"));
  EXPECT_THAT(findings_of("odometry: {front_distance: 0 m}\n", parts),
              HasSubstr("odometry.front_distance: found 0 m, allowed a wheelbase above 0.01 m"));
}

}  // namespace
}  // namespace rigwire::hil
