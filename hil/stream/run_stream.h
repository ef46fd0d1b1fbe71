// Publishes a run to viewers while it runs, beside its wires: ground truth, the state of the scene,
// and what a client would read from the bytes that were sent. Channels of Viewers, each computed
// only while it has a subscriber.
//
//   /truth /tf /antenna /joints /motion   as a recording has them (hil/record/truth_messages.h)
//   /events                               the same, foxglove.Log
//   /scene                                foxglove.SceneUpdate (hil/stream/scene_model.h)
//   /air                                  rigwire.Air: rain, snow, extinction of all but dust, dust
//   /points/NAME                          foxglove_msgs/msg/PointCloud, CDR: each turn of a
//                                         lidar's head by its packets (hil/record/lidar_clouds.h)
//   /fix/NAME                             foxglove.LocationFix: the fix in a receiver's bytes, with
//                                         `position_m` in the world
//   /satellites/NAME                      rigwire.Satellites: those in its bytes, with directions
//                                         (hil/stream/sky_reader.h)
//   /camera/NAME                          foxglove_msgs/msg/RawImage, CDR: pictures that a client
//                                         takes, from their packets, smaller
//                                         (hil/stream/picture_reader.h); while no client takes
//                                         any, previews (hil/world/camera_previews.h)
//   /sensors                              rigwire.Sensors: their mounts; once
//   /wire/NAME                            rigwire.WireMessage: what passes on a wire
//                                         (hil/stream/wire_reading.h)
//   /identifiers/NAME                     rigwire.Identifiers: of a CAN bus, a count of each while
//                                         viewers were subscribed
//                                         (hil/stream/identifier_counts.h)
//   /registers/NAME                       rigwire.Registers: the known values of those of a Modbus
//                                         line (hil/stream/modbus_reader.h)
//
// A new subscriber to the truth first receives its newest record, so that a paused run is shown.
//
// Threads. Viewers, and all that is made for them, are on the thread of the stream's io_context,
// which may have a lower priority than the run. It polls the queues of the other threads, and none
// of them wakes it: the truth, which comes ahead of the wires, is kept until its instant; of wires
// it takes copies of their bytes, from a bounded queue. What finds no room there is not shown, and
// counted. Previews, two a second, are posted to it by their own thread.
#pragma once

#include <atomic>
#include <boost/asio/io_context.hpp>
#include <boost/asio/steady_timer.hpp>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "hil/record/lidar_clouds.h"
#include "hil/record/run_events.h"
#include "hil/record/truth_messages.h"
#include "hil/stream/modbus_reader.h"
#include "hil/stream/picture_reader.h"
#include "hil/stream/scene_model.h"
#include "hil/stream/viewers.h"
#include "hil/wires/wire_tap.h"
#include "hil/world/camera_previews.h"
#include "hil/world/truth_observer.h"
#include "hil/world/view.h"
#include "protocols/can/message.h"
#include "sim/local_frame.h"
#include "sim/samples/calendar.h"

namespace rigwire::hil {

/// A sensor on the machine, with its mount.
struct ShownSensor {
  std::string name;
  std::string kind;  ///< "receiver", "imu", "camera", "lidar".
  std::string link;
  Eigen::Isometry3d X_LS = Eigen::Isometry3d::Identity();
  // A camera's fields of view between the middles of opposite edges of the picture.
  double horizontal_rad = 0.0;
  double vertical_rad = 0.0;
  std::optional<CoordinateScale> coordinates{};  ///< For a camera with a third coordinate.
};

struct StreamedRun {
  std::string name;
  std::string session;  ///< Differs for each run.
  std::int64_t start_unix_ns = 0;
  sim::LocalFrame frame;
  std::vector<RecordedLidar> lidars;
  std::set<std::string> receivers;  ///< Names of satellite receivers.
  /// Returns the messages on the CAN bus of that name; called once, before the run.
  std::function<std::vector<protocols::can::OwnedMessage>(const std::string& bus)> messages;
  /// Returns the units of the Modbus line, or of the device with a line of its own, of that name;
  /// called once, before the run.
  std::function<std::vector<NamedUnit>(const std::string& wire)> units;
  std::vector<ShownSensor> sensors;
};

class RunStream {
 public:
  /// Maximum size of the data that waits to be decoded.
  static constexpr std::size_t kQueueBytes = 8 * 1024 * 1024;

  /// `io`: the viewers' io_context. It must not run before the rig is made, nor while the stream is
  /// destroyed.
  RunStream(boost::asio::io_context& io, StreamedRun run);
  ~RunStream();
  RunStream(const RunStream&) = delete;
  RunStream& operator=(const RunStream&) = delete;

  [[nodiscard]] boost::asio::io_context& io() { return io_; }
  [[nodiscard]] Viewers& viewers() { return viewers_; }
  [[nodiscard]] std::uint64_t unix_ns(SimTime at) const {
    return static_cast<std::uint64_t>(run_.start_unix_ns + at.time_since_epoch().count());
  }

  // To be called while the rig is made.

  /// Returns the tap of a wire; it lives as long as the stream.
  [[nodiscard]] WireTap& add_wire(const std::string& name, WireKind kind);

  // To be called when the rig is made, before it runs. The results must not outlive the stream.

  [[nodiscard]] std::unique_ptr<TruthObserver> truth_observer(
      const Calendar& calendar, std::span<const sim::TruthField> fields,
      std::span<const std::string_view> links);
  /// `links`: of the machine.
  [[nodiscard]] std::unique_ptr<WorldSensor> world_view(const sim::Scene& scene, std::size_t links);

  /// Returns what renders previews of these cameras while they are watched and no client takes
  /// their pictures; null without cameras. `surroundings` as for make_camera_previews().
  [[nodiscard]] std::unique_ptr<WorldSensor> camera_previews(
      const std::vector<PreviewedCamera>& cameras, std::uint64_t seed, const sim::Scene& scene,
      sim::Scene::InstanceId terrain, std::shared_ptr<CameraSurroundings> surroundings);

  /// Sets the source of the present simulated time, which is called on any thread.
  void follow(std::function<SimTime()> now) { now_ = std::move(now); }

  /// May be called from any thread.
  void tell(const RunEvent& event);
  /// Sends the newest input to the viewers, too. May be called from any thread.
  void flush();
  /// Returns the number of pieces that were not shown because the queue was full.
  [[nodiscard]] std::uint64_t not_shown() const;

 private:
  class Ahead;
  class Truth;
  class Wire;
  struct Piece;
  class Decoder;

  void look();
  void show_preview(const std::string& camera, Viewers::ChannelId channel,
                    const CameraPreview& preview);

  boost::asio::io_context& io_;
  StreamedRun run_;
  Viewers viewers_;
  std::function<SimTime()> now_ = [] { return kStart; };
  std::unique_ptr<Ahead> ahead_;
  std::array<Viewers::ChannelId, kTruthTracks> tracks_{};
  Truth* truth_ = nullptr;  ///< Truth of the world; null before there is a world.
  Viewers::ChannelId scene_channel_ = 0;
  std::optional<SceneModel> scene_;
  Viewers::ChannelId air_channel_ = 0;
  AirView air_;
  std::vector<std::unique_ptr<Wire>> wires_;
  std::unique_ptr<Decoder> decoder_;
  boost::asio::steady_timer timer_;
};

}  // namespace rigwire::hil
