// Point clouds for viewers, decoded from the packets that a lidar sent: one turn of the head per
// period, as foxglove.PointCloud: JSON in a recording, CDR (protocols/foxglove/cdr_messages.h) in a
// stream, which has every turn.
//
// A cloud begins and ends where the azimuth passes from 360 to 0 degrees, and is published when its
// turn is over. Its points are in the sensor's frame; `pose` places that in the link that carries
// it. A turn takes a tenth of a second, and the link's motion during it is not compensated. Packets
// alone identify neither every model (HDL-64E, old firmware) nor the calibration of an HDL-64E: as
// with other clients, the caller gives both.
#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "protocols/velodyne/points.h"
#include "sim/samples/time.h"

namespace rigwire::hil {

/// A lidar whose packets pass on the wire of its name.
struct RecordedLidar {
  std::string name;
  std::string link;
  Eigen::Isometry3d X_LS = Eigen::Isometry3d::Identity();
  const protocols::velodyne::Model* model = nullptr;  ///< Not null.
  std::optional<protocols::velodyne::Hdl64eCalibration> calibration{};
};

struct CloudSettings {
  Duration every{0};  ///< Minimum time from a cloud's beginning to the next one's; 0: no clouds.
  std::vector<RecordedLidar> lidars;
};

/// One turn of a lidar's head.
struct LidarCloud {
  SimTime begun{};
  const RecordedLidar& lidar;
  std::span<const protocols::velodyne::Point> points;
  /// Time of each point's firing after the time stamp of the turn's first packet, s.
  std::span<const float> times_s;
};
/// Returns the cloud as a message of a run that started at `start_unix_ns`.
[[nodiscard]] std::string json_message(const LidarCloud& cloud, std::int64_t start_unix_ns);
[[nodiscard]] std::string cdr_message(const LidarCloud& cloud, std::int64_t start_unix_ns);

class LidarClouds {
 public:
  /// Collects the clouds of the lidar on one wire.
  LidarClouds(RecordedLidar lidar, Duration every)
      : lidar_(std::move(lidar)), every_(every), reader_(*lidar_.model, lidar_.calibration) {}

  /// Takes the next datagram of the lidar, sent at the instant `at`; returns the cloud that it
  /// completes. The cloud is valid until the next call.
  [[nodiscard]] std::optional<LidarCloud> take(SimTime at, std::span<const std::uint8_t> datagram);

 private:
  RecordedLidar lidar_;
  Duration every_;
  protocols::velodyne::PointReader reader_;
  struct Turn {
    std::vector<protocols::velodyne::Point> points;
    std::vector<float> times_s;
  };
  Turn turn_;  ///< The turn that is being collected.
  Turn whole_;
  std::optional<SimTime> begun_;
  /// Time stamp of the turn's first packet, microseconds.
  std::uint32_t begun_us_ = 0;
  SimTime next_ = kStart;
  std::optional<std::uint16_t> azimuth_counts_;
};

}  // namespace rigwire::hil
