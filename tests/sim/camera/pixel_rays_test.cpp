// Rays of pixels and samples against the lens itself and the pose at their instant, in doubles.
#include "sim/camera/pixel_rays.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>

#include "sim/camera/camera_renderer.h"
#include "sim/lidar/counter_noise.h"

namespace rigwire::sim {
namespace {

using namespace std::chrono_literals;

constexpr std::uint64_t kKey = 77;
/// A camera 1000 km from the world's origin; rays start near the local one.
const Eigen::Vector3d kFar_W(1e6, -4e5, 300.0);

ImageSensorParameters sensor_of(int width, int height) {
  ImageSensorParameters sensor;
  sensor.width_px = width;
  sensor.height_px = height;
  return sensor;
}

LensParameters lens_of(LensModel model, double focal_px) {
  LensParameters lens;
  lens.model = model;
  lens.focal_length_m = focal_px * ImageSensorParameters{}.pixel_pitch_m;
  if (model == LensModel::brown_conrady) {
    lens.k1 = -0.12;
    lens.p1 = 0.001;
  }
  return lens;
}

LinkMotion moving() {
  LinkMotion mount;
  mount.X_WL.translation() = kFar_W + Eigen::Vector3d(3.0, -2.0, 1.5);
  mount.X_WL.linear() = (Eigen::AngleAxisd(0.7, Eigen::Vector3d::UnitZ()) *
                         Eigen::AngleAxisd(-0.2, Eigen::Vector3d::UnitY()))
                            .toRotationMatrix();
  mount.v_WL_W << 4.0, 1.0, -0.5;
  mount.w_WL_W << 0.1, -0.2, 0.8;
  return mount;
}

ReadOut read_out_of(const PixelRectangle& region, int binning = 1) {
  ReadOut read_out;
  read_out.region = region;
  read_out.binning_x = read_out.binning_y = binning;
  read_out.exposure = 10ms;
  return read_out;
}

TEST(PixelRays, MiddlesLookWhereTheLensDoes) {
  for (const auto& [model, focal_px] : {std::pair{LensModel::brown_conrady, 100.0},
                                        {LensModel::kannala_brandt, 45.0},
                                        {LensModel::equirectangular, 25.0}}) {
    const ImageSensorParameters sensor = sensor_of(150, 70);
    const Lens lens(lens_of(model, focal_px), sensor.pixel_pitch_m, 150, 70);
    PixelRays rays(lens, sensor);
    const LinkMotion mount = moving();
    const std::array<PixelRays::RowPose, 1> poses{{{mount, 0.4F}}};
    // A region whose corner is no packet's.
    rays.prepare(read_out_of({3, 5, 141, 61}), {}, poses, kFar_W, 10.0, {0.1F, 100.0F, 5U}, kKey);
    PixelPacket packet;
    packet.limit({0.1F, 100.0F, 5U});
    for (int row = 0; row < 61; row += kPacketHeight) {
      for (int column = 0; column < 141; column += kPacketWidth) {
        rays.turn_to(column, row, packet);
        rays.aim(0, packet);
        for (std::size_t i = 0; i < kLanes; ++i) {
          const int c = column + static_cast<int>(i % kPacketWidth);
          const int w = row + static_cast<int>(i / kPacketWidth);
          ASSERT_EQ(packet.valid[i], c < 141 && w < 61 ? -1 : 0);
          if (packet.valid[i] == 0) {
            continue;
          }
          ASSERT_EQ(packet.active[i], -1);
          const Eigen::Vector3d expected =
              mount.X_WL.linear() * lens_to_mount(*lens.direction(Eigen::Vector2d(c + 3, w + 5)));
          const RTCRay8& ray = packet.rays.ray;
          const Eigen::Vector3d found(static_cast<double>(ray.dir_x[i]),
                                      static_cast<double>(ray.dir_y[i]),
                                      static_cast<double>(ray.dir_z[i]));
          ASSERT_LT((found - expected).norm(), 5e-7) << c << ", " << w;
          ASSERT_EQ(ray.org_x[i], 3.0F);
          ASSERT_EQ(ray.time[i], 0.4F);
          ASSERT_EQ(ray.tfar[i], 100.0F);
          ASSERT_EQ(ray.tnear[i], 0.1F);
          ASSERT_EQ(ray.mask[i], 5U);
          ASSERT_EQ(packet.rays.hit.geomID[i], RTC_INVALID_GEOMETRY_ID);
        }
      }
    }
  }
}

TEST(PixelRays, SamplesLookWhereTheLensDoesBesideTheMiddle) {
  // The scattered samples in doubles: place by the R2 sequence, instant by strata.
  constexpr int kSamples = 5;
  constexpr double kExposure_s = 0.01;
  for (const auto& [model, focal_px] : {std::pair{LensModel::brown_conrady, 250.0},
                                        {LensModel::kannala_brandt, 150.0},
                                        {LensModel::equirectangular, 90.0}}) {
    const ImageSensorParameters sensor = sensor_of(400, 240);
    const Lens lens(lens_of(model, focal_px), sensor.pixel_pitch_m, 400, 240);
    PixelRays rays(lens, sensor);
    const LinkMotion mount = moving();
    const std::array<PixelRays::RowPose, 1> poses{{{mount, 0.5F}}};
    rays.prepare(read_out_of({0, 0, 400, 240}), {kSamples}, poses, kFar_W, 10.0, {}, kKey);
    PixelPacket packet;
    double worst_px = 0.0;
    double mean_across = 0.0;
    int count = 0;
    for (int row = 0; row < 240; row += 6) {
      for (int column = 0; column < 400; column += kPacketWidth) {
        rays.turn_to(column, row, packet);
        for (int sample = 0; sample < kSamples; ++sample) {
          rays.aim(sample, packet);
          for (std::size_t i = 0; i < kLanes; ++i) {
            const int c = column + static_cast<int>(i % kPacketWidth);
            const int w = row + static_cast<int>(i / kPacketWidth);
            const std::uint64_t own = counter_bits(
                kKey, static_cast<std::uint64_t>(w) << 32U | static_cast<std::uint32_t>(c));
            const auto wrap = [](double x) { return x - std::floor(x); };
            const double across =
                wrap(0.7548776662466927 * sample + static_cast<double>(own & 0xFFFFU) / 65536.0);
            const double down = wrap(0.5698402909980532 * sample +
                                     static_cast<double>(own >> 16U & 0xFFFFU) / 65536.0);
            const auto stratum = (static_cast<std::uint64_t>(sample) + (own >> 56U)) % kSamples;
            const double dt_s = ((static_cast<double>(stratum) +
                                  static_cast<double>(own >> 32U & 0xFFFFU) / 65536.0) /
                                     kSamples -
                                 0.5) *
                                kExposure_s;
            const auto seen = lens.direction(Eigen::Vector2d(c - 0.5 + across, w - 0.5 + down));
            ASSERT_TRUE(seen);
            const Eigen::Vector3d turned = mount.X_WL.linear() * lens_to_mount(*seen);
            const Eigen::Vector3d expected = turned + dt_s * mount.w_WL_W.cross(turned);
            const RTCRay8& ray = packet.rays.ray;
            const Eigen::Vector3d found(static_cast<double>(ray.dir_x[i]),
                                        static_cast<double>(ray.dir_y[i]),
                                        static_cast<double>(ray.dir_z[i]));
            worst_px = std::max(
                worst_px, (found - expected).norm() / static_cast<double>(packet.pixel_rad[i]));
            ASSERT_NEAR(ray.org_x[i], 3.0 + 4.0 * dt_s, 1e-6);
            ASSERT_NEAR(ray.time[i], 0.5 + 10.0 * dt_s, 1e-6);
            mean_across += across - 0.5;
            ++count;
          }
        }
      }
    }
    EXPECT_LT(worst_px, 0.25 / focal_px) << focal_px;
    EXPECT_NEAR(mean_across / count, 0.0, 0.01);
  }
}

TEST(PixelRays, RowsHavePosesOfTheirOwnAndBinnedPixelsTheMiddleOfTheirBlock) {
  const ImageSensorParameters sensor = sensor_of(96, 64);
  const Lens lens(lens_of(LensModel::brown_conrady, 80.0), sensor.pixel_pitch_m, 96, 64);
  PixelRays rays(lens, sensor);
  for (const int binning : {2, 3}) {
    const PixelRectangle region{6, 12, 84, 48};
    const int height = region.height / binning;
    std::vector<PixelRays::RowPose> poses;
    for (int row = 0; row < height; ++row) {
      PixelRays::RowPose& pose = poses.emplace_back();
      pose.mount.X_WL.linear() =
          Eigen::AngleAxisd(0.01 * row, Eigen::Vector3d::UnitZ()).toRotationMatrix();
      pose.time = 0.01F * static_cast<float>(row);
    }
    rays.prepare(read_out_of(region, binning), {}, poses, Eigen::Vector3d::Zero(), 10.0, {}, kKey);
    PixelPacket packet;
    for (int row = 0; row < height; row += kPacketHeight) {
      rays.turn_to(8, row, packet);
      rays.aim(0, packet);
      for (std::size_t i = 0; i < kLanes; ++i) {
        const int c = 8 + static_cast<int>(i % kPacketWidth);
        const int w = row + static_cast<int>(i / kPacketWidth);
        const Eigen::Vector2d middle(region.x + c * binning + 0.5 * (binning - 1),
                                     region.y + w * binning + 0.5 * (binning - 1));
        const Eigen::Vector3d expected = poses[static_cast<std::size_t>(w)].mount.X_WL.linear() *
                                         lens_to_mount(*lens.direction(middle));
        const RTCRay8& ray = packet.rays.ray;
        const Eigen::Vector3d found(static_cast<double>(ray.dir_x[i]),
                                    static_cast<double>(ray.dir_y[i]),
                                    static_cast<double>(ray.dir_z[i]));
        // Between pixels the mean of their directions: the arc of half a pixel.
        ASSERT_LT((found - expected).norm() * 80.0, 2e-3);
        ASSERT_EQ(ray.time[i], poses[static_cast<std::size_t>(w)].time);
        ASSERT_NEAR(rays.along_axis(packet, i), lens_to_mount(*lens.direction(middle)).x(), 3e-5);
      }
    }
  }
}

}  // namespace
}  // namespace rigwire::sim
