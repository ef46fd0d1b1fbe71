#include "sim/camera/camera_parameters.h"

#include <gtest/gtest.h>

#include <limits>
#include <stdexcept>
#include <string>

#include "fields/check.h"

namespace rigwire::sim {
namespace {

/// The key that is refused; empty: none.
template <class Change>
std::string refused_change(const Change& change) {
  CameraParameters parameters;
  change(parameters);
  try {
    validate(parameters);
  } catch (const fields::Refused& refusal) {
    return refusal.path();
  }
  return "";
}

TEST(CameraParameters, DefaultsAreValid) {
  EXPECT_EQ(refused_change([](CameraParameters&) {}), "");
}

TEST(CameraParameters, RefusalsNameTheKey) {
  EXPECT_EQ(refused_change([](CameraParameters& p) { p.samples = 0; }), "samples");
  EXPECT_EQ(refused_change([](CameraParameters& p) { p.sky_rays = -1; }), "sky_rays");
  EXPECT_EQ(refused_change([](CameraParameters& p) { p.near_m = 3000.0; }), "near");
  EXPECT_EQ(refused_change([](CameraParameters& p) { p.lens.f_number = 0.0; }), "lens.f_number");
  EXPECT_EQ(refused_change(
                [](CameraParameters& p) { p.lens.k1 = std::numeric_limits<double>::quiet_NaN(); }),
            "lens.k1");
  EXPECT_EQ(refused_change([](CameraParameters& p) { p.sensor.full_well = 200.0; }),
            "image_sensor.full_well");
  EXPECT_EQ(refused_change([](CameraParameters& p) { p.sensor.dead_columns = 640; }),
            "image_sensor.dead_columns");
  EXPECT_EQ(refused_change([](CameraParameters& p) {
              p.auto_exposure.shortest = p.auto_exposure.longest + Duration{1};
            }),
            "auto_exposure.shortest");
  EXPECT_EQ(refused_change([](CameraParameters& p) {
              p.looks = {{.label = "ground", .kind = SurfaceKind::rock, .colour = {0.0, 2.0, 0.0}}};
            }),
            "looks.0.colour.1");
}

}  // namespace
}  // namespace rigwire::sim
