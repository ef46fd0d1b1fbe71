// Where the pixels of a picture look, packet by packet, each at its own instant.
//
// A packet is four pixels wide and two high. Directions of pixels' middles are the lens's own, from
// its table; those beside the middle follow by the slopes of the neighbours' middles, within
// 1 / (4 f) pixels for a focal length of f pixels (1e-3 pixels at 250; tested). Binned pixels look
// where the middle of their block does. Poses and rays are in floats from Embree's local origin,
// taken from doubles once for each row.
#pragma once

#include <embree3/rtcore.h>

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "sim/camera/image_sensor.h"
#include "sim/camera/lens.h"
#include "sim/lidar/ray_lanes.h"
#include "sim/link_motion.h"
#include "sim/scene/scene_internals.h"

namespace rigwire::sim {

inline constexpr int kPacketWidth = 4;
inline constexpr int kPacketHeight = 2;

/// What all rays of a picture have in common.
struct PictureLimits {
  float near_m = 0.0F;
  float far_m = 0.0F;
  std::uint32_t mask = ~0U;
};

/// A packet of pixels and the rays through one sample of them.
struct PixelPacket {
  /// Sets the members that aim() does not write.
  void limit(const PictureLimits& limits);

  int column = 0;
  int row = 0;
  int sample = 0;
  std::size_t block = 0;
  alignas(32) std::array<int, kLanes> valid{};   ///< Pixels of the picture.
  alignas(32) std::array<int, kLanes> active{};  ///< Those that the lens fills.
  LaneArray pixel_rad{};                         ///< Angle between neighbours.
  /// Numbers of a pixel's own, of which its samples are spread.
  alignas(32) std::array<std::uint32_t, kLanes> across{}, down{}, stratum{};
  LaneArray within_stratum{};
  RTCRayHit8 rays{};

  /// Number of this packet and sample within a picture, for random draws.
  [[nodiscard]] std::uint64_t number() const {
    return (static_cast<std::uint64_t>(row) << 30U) + (static_cast<std::uint64_t>(column) << 12U) +
           static_cast<std::uint64_t>(sample);
  }
};

/// The samples of each pixel.
struct PixelSamples {
  int count = 1;       ///< 1: its middle, at the middle of the exposure.
  int lattice = 0;     ///< Samples form as many rows of as many; 0: they are scattered.
  bool parts = false;  ///< aim_parts() is called.
};

/// Rays through parts of one pixel, by aim_parts().
inline constexpr std::size_t kParts = 4;
inline constexpr std::size_t kPixelsInParts = kLanes / kParts;
struct PixelPlace {
  int column = 0;
  int row = 0;
};

class PixelRays {
 public:
  /// `lens` must be made for that sensor.
  PixelRays(const Lens& lens, const ImageSensorParameters& sensor);

  /// Returns the share of the light that reaches each pixel of the sensor.
  [[nodiscard]] std::span<const float> falloff() const { return falloff_; }

  /// For a picture from now on. `poses`: of the mount at the middle of each row's exposure, or of
  /// all of them together, with its share of the slice. `key` draws where scattered samples go.
  struct RowPose {
    LinkMotion mount;
    float time = 0.0F;
  };
  void prepare(const ReadOut& read_out, const PixelSamples& samples, std::span<const RowPose> poses,
               const Eigen::Vector3d& origin_W, double slices_per_s, const PictureLimits& limits,
               std::uint64_t key);

  [[nodiscard]] int width() const { return width_; }
  [[nodiscard]] int height() const { return height_; }

  /// Turns to the pixels from (column, row) on, multiples of the packet's size.
  void turn_to(int column, int row, PixelPacket& packet) const;
  /// Rays through one sample of them; no hits.
  void aim(int sample, PixelPacket& packet) const;
  /// Through the middles at the middle of the exposure, however many samples there are.
  void aim_middle(PixelPacket& packet) const;
  /// Through four parts of each of two pixels, at the middle of the exposure: lane kParts * i + k
  /// has part k of pixel i. Each part has a row and a column of its own among four in the pixel.
  void aim_parts(const std::array<PixelPlace, kPixelsInParts>& places, PixelPacket& packet) const;
  /// Cosine of the angle between a ray of the packet and the optical axis.
  [[nodiscard]] float along_axis(const PixelPacket& packet, std::size_t lane) const;

 private:
  /// Direction through a pixel's middle, unit vector in S.
  struct alignas(16) PixelDirection {
    float x = 1.0F, y = 0.0F, z = 0.0F;
    float angle_rad = 0.0F;  ///< To the next pixel of its row; 0: no picture here.
  };
  /// Directions through the middles of a packet's pixels.
  struct PixelBlock {
    LaneArray x, y, z, angle_rad;
  };
  /// Change of the direction from one side of a pixel to the other.
  struct BlockSlopes {
    std::array<LaneArray, 3> across, down;
  };
  /// Camera pose at the middle of a row's exposure, in Embree's coordinates, for both rows of a
  /// packet.
  struct PacketPose {
    std::array<LaneArray, 9> R;  ///< R_WS, column by column.
    std::array<LaneArray, 3> p, v, w;
    LaneArray time;  ///< Share of the slice.
  };

  void look_through(const Lens& lens);
  void lay_blocks();
  [[nodiscard]] PixelDirection binned(int column, int row) const;
  [[nodiscard]] const PixelDirection& sensor_pixel(int column, int row) const {
    return directions_[static_cast<std::size_t>(row + 1) *
                           static_cast<std::size_t>(sensor_width_ + 2) +
                       static_cast<std::size_t>(column + 1)];
  }
  [[nodiscard]] const PacketPose& pose_of(const PixelPacket& packet) const {
    return poses_[poses_.size() == 1 ? 0 : static_cast<std::size_t>(packet.row / kPacketHeight)];
  }

  int sensor_width_;
  int sensor_height_;
  bool all_round_;
  float upright_rad_;
  std::vector<PixelDirection> directions_;  ///< One pixel more on each side.
  std::vector<float> falloff_;

  // State of the current picture. The blocks stay until region, binning or slopes change.
  PixelRectangle region_;
  int binning_x_ = 1;
  int binning_y_ = 1;
  int width_ = 0;
  int height_ = 0;
  int blocks_across_ = 0;
  std::vector<PixelBlock> blocks_;
  std::vector<BlockSlopes> slopes_;  ///< Empty if samples are at the pixel's middle.
  std::vector<PacketPose> poses_;    ///< One, or one for each row of packets.
  PixelSamples samples_;
  float exposure_s_ = 0.0F;
  float slices_per_s_ = 0.0F;
  PictureLimits limits_;
  std::uint64_t key_ = 0;
};

}  // namespace rigwire::sim
