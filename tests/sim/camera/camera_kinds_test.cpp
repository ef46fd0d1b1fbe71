#include "sim/camera/camera_kinds.h"

#include <gtest/gtest.h>

#include <limits>
#include <numbers>
#include <string>

#include "camera_site.h"
#include "fields/check.h"

namespace rigwire::sim {
namespace {

using namespace camera_test;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// The key that is refused; empty: none.
template <class Parameters, class Change>
std::string refused_key(const Change& change) {
  Parameters parameters;
  change(parameters);
  try {
    (void)abilities_of(parameters);
  } catch (const fields::Refused& refusal) {
    return refusal.path();
  }
  return "";
}

TEST(CameraKinds, DefaultsAreValidAndCanBeMade) {
  for (const CameraKind& kind :
       {CameraKind(CameraParameters{}), CameraKind(StereoCameraParameters{}),
        CameraKind(DepthCameraParameters{}), CameraKind(AllRoundCameraParameters{})}) {
    const CameraAbilities abilities = abilities_of(kind);
    // What GigE Vision cameras of the bridge have: sides of whole steps.
    EXPECT_EQ(abilities.width_px % 8, 0);
    EXPECT_EQ(abilities.height_px % 4, 0);
    EXPECT_FALSE(abilities.formats.empty());
    EXPECT_NE(make_camera(kind, 1, "camera"), nullptr);
  }
}

TEST(CameraKinds, AbilitiesAreThoseOfTheKind) {
  CameraParameters grey;
  EXPECT_EQ(abilities_of(grey).formats.front(), PixelFormat::mono8);
  EXPECT_TRUE(abilities_of(grey).binning);
  CameraParameters colour;
  colour.sensor.colour = true;
  EXPECT_EQ(abilities_of(colour).formats.front(), PixelFormat::bayer_rg8);
  EXPECT_FALSE(abilities_of(colour).binning);
  EXPECT_FALSE(abilities_of(grey).geometry);

  StereoCameraParameters stereo;
  stereo.camera.lens.principal_offset_px = {3.0, -2.0};
  const CameraAbilities of_stereo = abilities_of(stereo);
  ASSERT_TRUE(of_stereo.geometry);
  EXPECT_TRUE(of_stereo.parts.disparity && of_stereo.parts.intensity_right);
  EXPECT_FALSE(of_stereo.parts.range || of_stereo.binning);
  EXPECT_NEAR(of_stereo.geometry->focal_length_px, 0.004 / 7.5e-6, 1e-9);
  EXPECT_EQ(of_stereo.geometry->baseline_m, 0.16);
  EXPECT_EQ(of_stereo.geometry->principal_u_px, 319.5 + 3.0);
  EXPECT_EQ(of_stereo.geometry->principal_v_px, 239.5 - 2.0);
  EXPECT_EQ(of_stereo.geometry->coding, (CoordinateCoding{0.0625, 0.0, 0}));

  const CameraAbilities of_depth = abilities_of(DepthCameraParameters{});
  ASSERT_TRUE(of_depth.geometry);
  EXPECT_TRUE(of_depth.parts.range && of_depth.parts.confidence);
  EXPECT_EQ(of_depth.geometry->baseline_m, 0.0);
  EXPECT_EQ(of_depth.geometry->coding.scale, 0.0002);

  AllRoundCameraParameters round;
  round.camera.sensor.colour = true;
  const CameraAbilities of_round = abilities_of(round);
  EXPECT_EQ(of_round.width_px, 1024);
  EXPECT_EQ(of_round.height_px, 256);
  EXPECT_EQ(of_round.formats, std::vector{PixelFormat::rgb8});
}

TEST(CameraKinds, StereoRefusesWhatIsNoNumberZeroOrAbsurd) {
  using P = StereoCameraParameters;
  EXPECT_EQ(refused_key<P>([](P&) {}), "");
  EXPECT_EQ(refused_key<P>([](P& p) { p.baseline_m = kNan; }), "baseline");
  EXPECT_EQ(refused_key<P>([](P& p) { p.baseline_m = 0.0; }), "baseline");
  EXPECT_EQ(refused_key<P>([](P& p) { p.baseline_m = -0.1; }), "baseline");
  EXPECT_EQ(refused_key<P>([](P& p) { p.baseline_m = 1e9; }), "baseline");
  EXPECT_EQ(refused_key<P>([](P& p) { p.misalignment_rad.y() = kNan; }), "misalignment.1");
  EXPECT_EQ(refused_key<P>([](P& p) { p.camera.sensor.width_px = 0; }), "image_sensor.width");
  EXPECT_EQ(refused_key<P>([](P& p) { p.camera.sensor.colour = true; }), "image_sensor.colour");
  EXPECT_EQ(refused_key<P>([](P& p) { p.camera.lens.f_number = kNan; }), "lens.f_number");
  EXPECT_EQ(refused_key<P>([](P& p) { p.camera.lens.model = LensModel::kannala_brandt; }),
            "lens.model");
  EXPECT_EQ(refused_key<P>([](P& p) { p.matching.disparities = 0; }), "matching.disparities");
  EXPECT_EQ(refused_key<P>([](P& p) { p.matching.disparities = 100; }), "matching.disparities");
  EXPECT_EQ(refused_key<P>([](P& p) { p.matching.disparities = 640; }), "matching.disparities");
  EXPECT_EQ(refused_key<P>([](P& p) { p.matching.large_step_bits = 3; }),
            "matching.large_step_bits");
}

TEST(CameraKinds, DepthRefusesWhatIsNoNumberZeroOrAbsurd) {
  using P = DepthCameraParameters;
  EXPECT_EQ(refused_key<P>([](P& p) { p.nearest_m = kNan; }), "nearest");
  EXPECT_EQ(refused_key<P>([](P& p) { p.nearest_m = 20.0; }), "nearest");
  EXPECT_EQ(refused_key<P>([](P& p) { p.farthest_m = 40.0; }), "farthest");
  EXPECT_EQ(refused_key<P>([](P& p) { p.farthest_m = 14.0; }), "farthest");  // over 65535 steps
  EXPECT_EQ(refused_key<P>([](P& p) { p.step_m = 0.0; }), "step");
  EXPECT_EQ(refused_key<P>([](P& p) { p.noise_m = -1.0; }), "noise");
  EXPECT_EQ(refused_key<P>([](P& p) { p.noise_reflectance = 0.0; }), "noise_reflectance");
  EXPECT_EQ(refused_key<P>([](P& p) { p.noise_exposure = Duration{0}; }), "noise_exposure");
  EXPECT_EQ(refused_key<P>([](P& p) { p.noise_floor_m = 0.02; }), "noise_floor");
  EXPECT_EQ(refused_key<P>([](P& p) { p.doubling_luminance_cd = 0.0; }), "doubling_luminance");
  EXPECT_EQ(refused_key<P>([](P& p) { p.cycle_m = 0.0; }), "cycle");
  EXPECT_EQ(refused_key<P>([](P& p) { p.rays_across = 0; }), "rays_across");
  EXPECT_EQ(refused_key<P>([](P& p) { p.camera.lens.k2 = 0.1; }), "lens.k2");
  EXPECT_EQ(refused_key<P>([](P& p) { p.camera.sensor.colour = true; }), "image_sensor.colour");
}

TEST(CameraKinds, AllRoundRefusesWhatIsNoNumberZeroOrAbsurd) {
  using P = AllRoundCameraParameters;
  EXPECT_EQ(refused_key<P>([](P& p) { p.width_px = 0; }), "width");
  EXPECT_EQ(refused_key<P>([](P& p) { p.width_px = 100000; }), "width");
  EXPECT_EQ(refused_key<P>([](P& p) { p.elevation_upper_rad = kNan; }), "elevation_upper");
  EXPECT_EQ(refused_key<P>([](P& p) { p.elevation_upper_rad = 3.0; }), "elevation_upper");
  EXPECT_EQ(refused_key<P>([](P& p) { p.height_px = 400; }), "height");  // beyond the lower pole
  EXPECT_EQ(refused_key<P>([](P& p) {
              p.height_px = 512;
              p.elevation_upper_rad = 0.5 * std::numbers::pi;
            }),
            "");
  EXPECT_EQ(refused_key<P>([](P& p) { p.camera.lens.vignetting = 1.0; }), "lens.vignetting");
  EXPECT_EQ(refused_key<P>([](P& p) { p.camera.lens.f_number = 0.0; }), "lens.f_number");
  EXPECT_EQ(refused_key<P>([](P& p) { p.camera.sensor.read_noise = kNan; }),
            "image_sensor.read_noise");
  EXPECT_EQ(refused_key<P>([](P& p) {
              p.camera.sensor.colour = true;
              p.width_px = 1023;
            }),
            "width");
  const auto views = [](P& p) { p.method = AllRoundMethod::views; };
  EXPECT_EQ(refused_key<P>([&](P& p) { views(p), p.views = 2; }), "views");
  EXPECT_EQ(refused_key<P>([&](P& p) { views(p), p.camera.lens.vignetting = 1.0; }), "");
  EXPECT_EQ(refused_key<P>([&](P& p) { views(p), p.camera.sensor.width_px = 1; }), "view.width");
  // Three narrow ones would see more than 120 degrees with their margin.
  AllRoundCameraParameters narrow;
  views(narrow);
  narrow.camera.sensor.width_px = 16;
  EXPECT_THROW((void)make_camera(narrow, 1, "camera"), std::invalid_argument);
}

}  // namespace
}  // namespace rigwire::sim
