#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <string>

#include "sim/driveline/driveline.h"
#include "sim/driveline/geared_driveline.h"
#include "sim/driveline/parameters.h"

namespace rigwire::sim {
namespace {

std::string refusal(const std::function<void(GearedParameters&)>& spoil) {
  GearedParameters p;
  spoil(p);
  try {
    validate(p);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

TEST(DrivelineParametersTest, DefaultsAreAllowed) {
  EXPECT_NO_THROW(validate(GearedParameters{}));
  EXPECT_NO_THROW(validate(CvtParameters{}));
}

TEST(DrivelineParametersTest, UnimogHasFourteenGears) {
  const GearboxParameters p;
  EXPECT_EQ(p.forward.size(), 8u);
  EXPECT_EQ(p.reverse.size(), 6u);
  const double axle = AxleParameters{}.ratio();
  EXPECT_NEAR(p.forward.back() * axle, 5.2, 1e-12);
  EXPECT_NEAR(p.forward.front() * axle, 66.8, 0.1);
  for (std::size_t i = 1; i < p.forward.size(); ++i) {
    EXPECT_NEAR(p.forward[i - 1] / p.forward[i], 1.44, 1e-12);
  }
}

TEST(DrivelineParametersTest, RefusalNamesQuantityValueAndWhatIsAllowed) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(refusal([](auto& p) { p.engine.inertia_kgm2 = -1.0; }),
            "engine.inertia: found -1 kg m2, allowed 1e-06 .. 1000000000 kg m2");
  EXPECT_NE(refusal([&](auto& p) { p.engine.drag_nm = nan; }).find("engine.drag: found nan"),
            std::string::npos);
  EXPECT_NE(refusal([](auto& p) { p.engine.full_load.clear(); }).find("at least one point"),
            std::string::npos);
  EXPECT_NE(refusal([](auto& p) {
              p.engine.full_load[2].speed_radps = 1.0;
            }).find("engine.full_load.2.speed: found 9.549"),
            std::string::npos);
  EXPECT_NE(refusal([](auto& p) {
              p.gearbox.forward[3] = 0.0;
            }).find("gearbox.forward.3: found 0, allowed 1e-06 .. 1000000"),
            std::string::npos);
  EXPECT_NE(refusal([](auto& p) {
              p.gearbox.forward.clear();
            }).find("gearbox.forward: found 0 gears, allowed 1 .. 125 gears"),
            std::string::npos);
  EXPECT_NE(
      refusal([](auto& p) { p.clutch.full_radps = 10.0; }).find("allowed above open, 740 rpm"),
      std::string::npos);
  EXPECT_NE(refusal([](auto& p) { p.clutch.open_radps = 1.0; }).find("clutch.open: found "),
            std::string::npos);
  EXPECT_NE(refusal([](auto& p) {
              p.axles.drive = AxleDrive::rear;
            }).find("axles.centre_lock: found true, allowed false"),
            std::string::npos);
  EXPECT_NE(refusal([](auto& p) {
              p.gearbox.crawler_factor = 0.5;
            }).find("gearbox.crawler_factor: found 0.5"),
            std::string::npos);
}

TEST(DrivelineParametersTest, AWrongSetMakesNoDriveline) {
  GearedParameters geared;
  geared.engine.cut_off_radps = 1.0;
  EXPECT_THROW(GearedDriveline{geared}, std::invalid_argument);
  CvtParameters cvt;
  cvt.variator.launch_ratio = 0.1;
  EXPECT_THROW((void)make_driveline(cvt), std::invalid_argument);
}

TEST(DrivelineParametersTest, TheVariantSaysWhichDrivelineIsMade) {
  const std::unique_ptr<Driveline> made = make_driveline(GearedParameters{});
  EXPECT_NE(dynamic_cast<GearedDriveline*>(made.get()), nullptr);
  VehicleSample sample;
  made->read(sample);
  EXPECT_EQ(sample.gear, 0);
  EXPECT_DOUBLE_EQ(sample.engine.speed_radps, rpm(700));
}

}  // namespace
}  // namespace rigwire::sim
