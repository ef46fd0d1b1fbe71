// What is true of a run, its events and figures as messages that viewers know: the channels, their
// schemas and the text of each message. A recording writes them (hil/record/recording_writer.h), a
// stream sends them (hil/stream/run_stream.h).
//
// Messages are JSON, schemas JSON Schema; those of Foxglove have the members that are written here,
// under the names that its viewers know (foxglove.dev, "Foxglove schemas"). Stamps are on the rig's
// calendar.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "hil/record/motion_line.h"
#include "hil/record/run_log.h"
#include "hil/world/truth_observer.h"
#include "sim/machine.h"
#include "sim/samples/calendar.h"

namespace rigwire::hil {

/// Channels of the MCAP file, which are the first tracks of a recording.
enum class TruthTrack : std::uint16_t {
  truth,
  transforms,
  location,
  statistics,
  events,
  motion,
  joints,
  points
};
inline constexpr std::uint16_t kTruthTracks = 8;

struct ChannelRow {
  std::string_view topic;
  std::string_view schema_name;
  std::string schema;
};
/// By TruthTrack.
[[nodiscard]] std::array<ChannelRow, kTruthTracks> channel_rows();

/// {"sec","nsec"} of an instant of a run that started at `start_unix_ns`.
[[nodiscard]] std::string timestamp(std::int64_t start_unix_ns, SimTime at);

/// Uncertainty of a position along east, north and up: covariance of foxglove.LocationFix.
struct LocationSpread {
  /// Covariance types in the order of foxglove.LocationFix.
  enum class Kind : std::uint8_t { unknown, guessed, along_axes };
  std::array<double, 3> sigma_m{};
  Kind kind = Kind::unknown;
};
/// foxglove.LocationFix. `frame_id` is the device's name.
[[nodiscard]] std::string location_message(const std::string& timestamp, std::string_view frame_id,
                                           const sim::GeodeticPoint& place,
                                           const LocationSpread& spread = {},
                                           std::string_view more = {});

/// foxglove.Log.
[[nodiscard]] std::string log_message(std::int64_t start_unix_ns, SimTime at, LogLevel level,
                                      std::string_view name, std::string_view text);

/// foxglove.FrameTransforms: some frames in the world.
class TransformsMessage {
 public:
  void begin() { text_ = R"({"transforms":[)"; }
  void add(const std::string& timestamp, std::string_view parent, std::string_view frame,
           const Eigen::Isometry3d& X_PF);
  [[nodiscard]] const std::string& end() {
    text_ += "]}";
    return text_;
  }

 private:
  std::string text_;
};

/// A record of the truth as messages of the tracks truth, transforms, motion, joints and location.
class TruthMessages {
 public:
  TruthMessages(std::int64_t start_unix_ns, const Calendar& calendar,
                std::span<const sim::TruthField> fields, std::span<const std::string_view> links);

  using Wanted = std::function<bool(TruthTrack track)>;
  using Put = std::function<void(TruthTrack track, SimTime at, std::string_view text)>;
  /// Passes the messages of a record to `put`, one or more for each track that is wanted.
  void tell(const TruthRecord& record, const Wanted& wanted, const Put& put);

 private:
  std::int64_t start_unix_ns_;
  Calendar calendar_;
  std::vector<sim::TruthField> fields_;
  std::vector<std::string> links_;
  JointNames joints_;
  TransformsMessage transforms_;
};

}  // namespace rigwire::hil
