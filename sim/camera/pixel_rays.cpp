#include "sim/camera/pixel_rays.h"

#include <algorithm>
#include <cmath>

#include "sim/camera/camera_renderer.h"
#include "sim/lidar/counter_noise.h"

namespace rigwire::sim {
namespace {

/// The R2 sequence (M. Roberts, 2018) in units of 2^-32: fractions add up by overflow.
constexpr std::uint32_t kAcross = 0xC13FA9A9U;
constexpr std::uint32_t kDown = 0x91E10DA6U;

/// Where the rays through the parts of a pixel go, from its middle, in pixels.
constexpr std::array<float, kParts> kPartAcross{-0.125F, 0.375F, 0.125F, -0.375F};
constexpr std::array<float, kParts> kPartDown{-0.375F, -0.125F, 0.375F, 0.125F};

}  // namespace

void PixelPacket::limit(const PictureLimits& limits) {
  for (std::size_t i = 0; i < kLanes; ++i) {
    rays.ray.tnear[i] = limits.near_m;
    rays.ray.mask[i] = limits.mask;
  }
}

PixelRays::PixelRays(const Lens& lens, const ImageSensorParameters& sensor)
    : sensor_width_(sensor.width_px),
      sensor_height_(sensor.height_px),
      all_round_(lens.parameters().model == LensModel::equirectangular),
      upright_rad_(static_cast<float>(1.0 / lens.focal_length_px())) {
  look_through(lens);
}

void PixelRays::look_through(const Lens& lens) {
  const int width = sensor_width_;
  const int height = sensor_height_;
  directions_.resize(static_cast<std::size_t>(width + 2) * static_cast<std::size_t>(height + 2));
  falloff_.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  std::size_t at = 0;
  for (int row = -1; row <= height; ++row) {
    for (int column = -1; column <= width; ++column, ++at) {
      const auto direction = lens.direction(Eigen::Vector2d(column, row));
      PixelDirection& to = directions_[at];
      if (direction) {
        const Eigen::Vector3f d = lens_to_mount(*direction).cast<float>();
        to = {d.x(), d.y(), d.z(), 1.0F};
        if (column > -1) {
          PixelDirection& before = directions_[at - 1];
          const float angle_rad = std::sqrt((before.x - to.x) * (before.x - to.x) +
                                            (before.y - to.y) * (before.y - to.y) +
                                            (before.z - to.z) * (before.z - to.z));
          // The last one of a row has that of its neighbour; pixels are never wider than 0.2 rad.
          // Near the poles of an equirectangular picture they are as high as everywhere.
          to.angle_rad = std::clamp(all_round_ ? upright_rad_ : angle_rad, 1e-7F, 0.2F);
          before.angle_rad = before.angle_rad > 0.0F ? to.angle_rad : 0.0F;
        }
      }
      if (row >= 0 && row < height && column >= 0 && column < width) {
        falloff_[static_cast<std::size_t>(row) * static_cast<std::size_t>(width) +
                 static_cast<std::size_t>(column)] =
            direction ? static_cast<float>(lens.falloff(*direction)) : 0.0F;
      }
    }
  }
}

PixelRays::PixelDirection PixelRays::binned(int column, int row) const {
  // The middle of the block: of one, two or four pixels of the sensor; without a picture where one
  // of them has none. Beyond the sensor's margin there is nothing to look through.
  const int x = region_.x + column * binning_x_;
  const int y = region_.y + row * binning_y_;
  const std::array<int, 2> columns{x + (binning_x_ - 1) / 2, x + binning_x_ / 2};
  const std::array<int, 2> rows{y + (binning_y_ - 1) / 2, y + binning_y_ / 2};
  PixelDirection sum{0.0F, 0.0F, 0.0F, 0.2F};
  for (const int r : rows) {
    for (const int c : columns) {
      if (c < -1 || r < -1 || c > sensor_width_ || r > sensor_height_) {
        return {};
      }
      const PixelDirection& one = sensor_pixel(c, r);
      sum.x += 0.25F * one.x;
      sum.y += 0.25F * one.y;
      sum.z += 0.25F * one.z;
      sum.angle_rad = std::min(sum.angle_rad, one.angle_rad);
    }
  }
  const float size = 1.0F / std::sqrt(sum.x * sum.x + sum.y * sum.y + sum.z * sum.z);
  return {sum.x * size, sum.y * size, sum.z * size, sum.angle_rad * static_cast<float>(binning_x_)};
}

void PixelRays::lay_blocks() {
  const bool single = binning_x_ == 1 && binning_y_ == 1;
  const auto pixel = [&](int column, int row) {
    return single ? sensor_pixel(region_.x + column, region_.y + row) : binned(column, row);
  };
  blocks_across_ = (width_ + kPacketWidth - 1) / kPacketWidth;
  const int blocks_down = (height_ + kPacketHeight - 1) / kPacketHeight;
  blocks_.resize(static_cast<std::size_t>(blocks_across_) * static_cast<std::size_t>(blocks_down));
  slopes_.resize(samples_.count > 1 || samples_.parts ? blocks_.size() : 0);
  for (std::size_t block = 0; block < blocks_.size(); ++block) {
    const auto across = static_cast<std::size_t>(blocks_across_);
    for (std::size_t i = 0; i < kLanes; ++i) {
      // Lanes beside the picture look as the pixel next to them does.
      const int column = std::min(
          static_cast<int>(block % across) * kPacketWidth + static_cast<int>(i) % kPacketWidth,
          width_ - 1);
      const int row = std::min(
          static_cast<int>(block / across) * kPacketHeight + static_cast<int>(i) / kPacketWidth,
          height_ - 1);
      const PixelDirection here = pixel(column, row);
      blocks_[block].x[i] = here.x;
      blocks_[block].y[i] = here.y;
      blocks_[block].z[i] = here.z;
      blocks_[block].angle_rad[i] = here.angle_rad;
      if (slopes_.empty()) {
        continue;
      }
      // Central differences; of one side where the lens ends on the other.
      const auto slope = [&](const PixelDirection& before, const PixelDirection& after,
                             std::array<LaneArray, 3>& to) {
        const PixelDirection& a = before.angle_rad > 0.0F ? before : here;
        const PixelDirection& b = after.angle_rad > 0.0F ? after : here;
        const float per_pixel = before.angle_rad > 0.0F && after.angle_rad > 0.0F ? 0.5F : 1.0F;
        to[0][i] = per_pixel * (b.x - a.x);
        to[1][i] = per_pixel * (b.y - a.y);
        to[2][i] = per_pixel * (b.z - a.z);
      };
      slope(pixel(column - 1, row), pixel(column + 1, row), slopes_[block].across);
      slope(pixel(column, row - 1), pixel(column, row + 1), slopes_[block].down);
    }
  }
}

void PixelRays::prepare(const ReadOut& r, const PixelSamples& samples,
                        std::span<const RowPose> poses, const Eigen::Vector3d& origin_W,
                        double slices_per_s, const PictureLimits& limits, std::uint64_t key) {
  const bool stale = blocks_.empty() || !(region_ == r.region) || binning_x_ != r.binning_x ||
                     binning_y_ != r.binning_y ||
                     ((samples.count > 1 || samples.parts) && slopes_.empty());
  samples_ = samples;
  region_ = r.region;
  binning_x_ = r.binning_x;
  binning_y_ = r.binning_y;
  width_ = r.region.width / r.binning_x;
  height_ = r.region.height / r.binning_y;
  if (stale) {
    lay_blocks();
  }
  exposure_s_ = static_cast<float>(to_seconds(r.exposure));
  slices_per_s_ = static_cast<float>(slices_per_s);
  limits_ = limits;
  key_ = key;
  poses_.resize((poses.size() + kPacketHeight - 1) / kPacketHeight);
  for (std::size_t pair = 0; pair < poses_.size(); ++pair) {
    for (std::size_t i = 0; i < kLanes; ++i) {
      const RowPose& pose =
          poses[std::min(pair * kPacketHeight + i / kPacketWidth, poses.size() - 1)];
      const Eigen::Matrix3f R = pose.mount.X_WL.linear().cast<float>();
      const Eigen::Vector3f p = (pose.mount.X_WL.translation() - origin_W).cast<float>();
      for (std::size_t k = 0; k < 9; ++k) {
        poses_[pair].R[k][i] = R.data()[k];
      }
      for (std::size_t k = 0; k < 3; ++k) {
        poses_[pair].p[k][i] = p[static_cast<int>(k)];
        poses_[pair].v[k][i] = static_cast<float>(pose.mount.v_WL_W[static_cast<int>(k)]);
        poses_[pair].w[k][i] = static_cast<float>(pose.mount.w_WL_W[static_cast<int>(k)]);
      }
      poses_[pair].time[i] = pose.time;
    }
  }
}

RIGWIRE_WIDE_VECTORS void PixelRays::turn_to(int column, int row, PixelPacket& packet) const {
  packet.column = column;
  packet.row = row;
  packet.block =
      static_cast<std::size_t>(row / kPacketHeight) * static_cast<std::size_t>(blocks_across_) +
      static_cast<std::size_t>(column / kPacketWidth);
  const LaneArray& angle_rad = blocks_[packet.block].angle_rad;
  // Tiles go down from here: the block below comes next.
  const PixelBlock* const below =
      blocks_.data() +
      std::min(packet.block + static_cast<std::size_t>(blocks_across_), blocks_.size() - 1);
  __builtin_prefetch(&below->x);
  __builtin_prefetch(&below->z);
  const int columns = width_ - column;
  const int rows = height_ - row;
#pragma GCC ivdep
  for (std::size_t i = 0; i < kLanes; ++i) {
    const int c = static_cast<int>(i % kPacketWidth);
    const int w = static_cast<int>(i / kPacketWidth);
    packet.valid[i] = (c < columns ? -1 : 0) & (w < rows ? -1 : 0);
    packet.active[i] = angle_rad[i] > 0.0F ? packet.valid[i] : 0;
    packet.pixel_rad[i] = angle_rad[i];
  }
  if (samples_.count == 1) {
    return;
  }
  for (std::size_t i = 0; i < kLanes; ++i) {
    // By the place on the sensor, so that a region is that part of the picture.
    const int c = std::min(column + static_cast<int>(i % kPacketWidth), width_ - 1);
    const int w = std::min(row + static_cast<int>(i / kPacketWidth), height_ - 1);
    const auto pixel = static_cast<std::uint64_t>(region_.y + w * binning_y_) << 32U |
                       static_cast<std::uint32_t>(region_.x + c * binning_x_);
    const std::uint64_t own = counter_bits(key_, pixel);
    packet.across[i] = static_cast<std::uint32_t>(own & 0xFFFFU) << 16U;
    packet.down[i] = static_cast<std::uint32_t>(own >> 16U & 0xFFFFU) << 16U;
    packet.stratum[i] =
        static_cast<std::uint32_t>((own >> 56U) % static_cast<std::uint64_t>(samples_.count));
    packet.within_stratum[i] = static_cast<float>(own >> 32U & 0xFFFFU) * 0x1.0p-16F;
  }
}

namespace {

/// Resets lane `i` to a ray of length `far_m` without a hit.
inline void release(RTCRayHit8& rays, std::size_t i, float far_m) {
  rays.ray.tfar[i] = far_m;
  rays.hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
  rays.hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
}

}  // namespace

RIGWIRE_WIDE_VECTORS void PixelRays::aim_middle(PixelPacket& packet) const {
  const PixelBlock& block = blocks_[packet.block];
  const PacketPose& pose = pose_of(packet);
  RTCRay8& ray = packet.rays.ray;
  const float far_m = limits_.far_m;
#pragma GCC ivdep
  for (std::size_t i = 0; i < kLanes; ++i) {
    const float x = block.x[i];
    const float y = block.y[i];
    const float z = block.z[i];
    ray.dir_x[i] = pose.R[0][i] * x + pose.R[3][i] * y + pose.R[6][i] * z;
    ray.dir_y[i] = pose.R[1][i] * x + pose.R[4][i] * y + pose.R[7][i] * z;
    ray.dir_z[i] = pose.R[2][i] * x + pose.R[5][i] * y + pose.R[8][i] * z;
    ray.org_x[i] = pose.p[0][i];
    ray.org_y[i] = pose.p[1][i];
    ray.org_z[i] = pose.p[2][i];
    ray.time[i] = pose.time[i];
    release(packet.rays, i, far_m);
  }
}

RIGWIRE_WIDE_VECTORS void PixelRays::aim(int sample, PixelPacket& packet) const {
  packet.sample = sample;
  if (samples_.count == 1) {
    aim_middle(packet);
    return;
  }
  const PixelBlock& block = blocks_[packet.block];
  const BlockSlopes& slopes = slopes_[packet.block];
  const PacketPose& pose = pose_of(packet);
  RTCRay8& ray = packet.rays.ray;
  const float far_m = limits_.far_m;
  const auto number = static_cast<std::uint32_t>(sample);
  const auto count = static_cast<std::uint32_t>(samples_.count);
  const float stratum_s = exposure_s_ / static_cast<float>(count);
  const float half_s = 0.5F * exposure_s_;
  const bool in_rows = samples_.lattice > 0;
  const int in_row = in_rows ? samples_.lattice : 1;
  const int column_of = sample % in_row;
  const int row_of = sample / in_row;
  const float per_row = 1.0F / static_cast<float>(in_row);
  const float row_across = (static_cast<float>(column_of) + 0.5F) * per_row - 0.5F;
  const float row_down = (static_cast<float>(row_of) + 0.5F) * per_row - 0.5F;
#pragma GCC ivdep
  for (std::size_t i = 0; i < kLanes; ++i) {
    // Place from the pixel's middle, in pixels: the R2 sequence, turned for each pixel by a number
    // of its own; instants in strata.
    const auto centred = [](std::uint32_t share) {
      return static_cast<float>(static_cast<std::int32_t>(share - 0x80000000U)) * 0x1.0p-32F;
    };
    const float across = in_rows ? row_across : centred(packet.across[i] + number * kAcross);
    const float down = in_rows ? row_down : centred(packet.down[i] + number * kDown);
    std::uint32_t stratum = packet.stratum[i] + number;
    stratum = stratum >= count ? stratum - count : stratum;
    const float dt =
        (static_cast<float>(static_cast<std::int32_t>(stratum)) + packet.within_stratum[i]) *
            stratum_s -
        half_s;
    float sx = block.x[i] + across * slopes.across[0][i] + down * slopes.down[0][i];
    float sy = block.y[i] + across * slopes.across[1][i] + down * slopes.down[1][i];
    float sz = block.z[i] + across * slopes.across[2][i] + down * slopes.down[2][i];
    const float size = 1.0F / std::sqrt(sx * sx + sy * sy + sz * sz);
    sx *= size;
    sy *= size;
    sz *= size;
    const float x = pose.R[0][i] * sx + pose.R[3][i] * sy + pose.R[6][i] * sz;
    const float y = pose.R[1][i] * sx + pose.R[4][i] * sy + pose.R[7][i] * sz;
    const float z = pose.R[2][i] * sx + pose.R[5][i] * sy + pose.R[8][i] * sz;
    // Turned and moved on since the middle of the exposure.
    ray.dir_x[i] = x + dt * (pose.w[1][i] * z - pose.w[2][i] * y);
    ray.dir_y[i] = y + dt * (pose.w[2][i] * x - pose.w[0][i] * z);
    ray.dir_z[i] = z + dt * (pose.w[0][i] * y - pose.w[1][i] * x);
    ray.org_x[i] = pose.p[0][i] + dt * pose.v[0][i];
    ray.org_y[i] = pose.p[1][i] + dt * pose.v[1][i];
    ray.org_z[i] = pose.p[2][i] + dt * pose.v[2][i];
    const float time = pose.time[i] + dt * slices_per_s_;
    ray.time[i] = time < 0.0F ? 0.0F : (time > 1.0F ? 1.0F : time);
    release(packet.rays, i, far_m);
  }
}

void PixelRays::aim_parts(const std::array<PixelPlace, kPixelsInParts>& places,
                          PixelPacket& packet) const {
  packet.column = places.front().column;
  packet.row = places.front().row;
  packet.sample = 1;
  RTCRay8& ray = packet.rays.ray;
  for (std::size_t lane = 0; lane < kLanes; ++lane) {
    const PixelPlace& place = places[lane / kParts];
    const std::size_t part = lane % kParts;
    const auto in_row = static_cast<std::size_t>(place.row % kPacketHeight);
    const std::size_t i =
        in_row * kPacketWidth + static_cast<std::size_t>(place.column % kPacketWidth);
    const std::size_t at = static_cast<std::size_t>(place.row / kPacketHeight) *
                               static_cast<std::size_t>(blocks_across_) +
                           static_cast<std::size_t>(place.column / kPacketWidth);
    const PixelBlock& block = blocks_[at];
    const BlockSlopes& slopes = slopes_[at];
    const PacketPose& pose =
        poses_[poses_.size() == 1 ? 0 : static_cast<std::size_t>(place.row / kPacketHeight)];
    const float across = kPartAcross[part];
    const float down = kPartDown[part];
    float x = block.x[i] + across * slopes.across[0][i] + down * slopes.down[0][i];
    float y = block.y[i] + across * slopes.across[1][i] + down * slopes.down[1][i];
    float z = block.z[i] + across * slopes.across[2][i] + down * slopes.down[2][i];
    const float size = 1.0F / std::sqrt(x * x + y * y + z * z);
    x *= size;
    y *= size;
    z *= size;
    ray.dir_x[lane] = pose.R[0][i] * x + pose.R[3][i] * y + pose.R[6][i] * z;
    ray.dir_y[lane] = pose.R[1][i] * x + pose.R[4][i] * y + pose.R[7][i] * z;
    ray.dir_z[lane] = pose.R[2][i] * x + pose.R[5][i] * y + pose.R[8][i] * z;
    ray.org_x[lane] = pose.p[0][i];
    ray.org_y[lane] = pose.p[1][i];
    ray.org_z[lane] = pose.p[2][i];
    ray.time[lane] = pose.time[i];
    release(packet.rays, lane, limits_.far_m);
    packet.valid[lane] = -1;
    packet.active[lane] = block.angle_rad[i] > 0.0F ? -1 : 0;
    packet.pixel_rad[lane] = 0.5F * block.angle_rad[i];  // between parts
  }
}

float PixelRays::along_axis(const PixelPacket& packet, std::size_t lane) const {
  // The axis is the mount's x, the first column of R_WS.
  const PacketPose& pose = pose_of(packet);
  const RTCRay8& ray = packet.rays.ray;
  return pose.R[0][lane] * ray.dir_x[lane] + pose.R[1][lane] * ray.dir_y[lane] +
         pose.R[2][lane] * ray.dir_z[lane];
}

}  // namespace rigwire::sim
