// Writes the files of a recording, on a thread of their own beside the run.
//
//   FOLDER/recording.json      what it is: run, wires, files; again at the end, with what was lost
//   FOLDER/rig.yaml            the effective configuration
//   FOLDER/all.pcapng          every wire
//   FOLDER/truth.mcap          truth, events, statistics, configuration
//   FOLDER/commands.log        commands that changed the run: "SECONDS {"verb":"set",...}",
//                              from the run's start on, so that a replay can repeat them
//   FOLDER/requests.log        requests that depended on the wall clock: "SECONDS SECONDS", up to
//                              when the truth had been asked and from when on it followed, and
//                              "SECONDS SECONDS promised", from when on it would; also from the
//                              run's start on
//   FOLDER/wires/NAME.pcapng   one wire
//   FOLDER/wires/NAME.log      a CAN bus as candump -L -x writes it
//   FOLDER/wires/NAME.bytes    what a device sent on a serial line
//   FOLDER/wires/NAME.client   what its client sent
//   FOLDER/wires/NAME.index    their times: a line for each piece, "SECONDS > OFFSET LENGTH" of the
//                              device, "SECONDS < OFFSET LENGTH" of its client; lines with # are
//                              comments
//   FOLDER/wires/NAME.ends     of a serial line or a CAN bus, what its client did with its end:
//                              "SECONDS open 9600" (bit/s; on a bus also listen_only, one_shot),
//                              "SECONDS closed", and when it offered a frame to the bus, "SECONDS
//                              frame 18EAFFFE#00EE00": so that a replay can repeat it
//
// Equal calls give equal bytes. What a disk does not take is counted and reported in the files as
// soon as they can be written again: packets carry the number of those lost before them.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "hil/record/lidar_clouds.h"
#include "hil/record/record_queue.h"
#include "hil/record/recording_file.h"
#include "hil/record/truth_messages.h"
#include "hil/wires/wire_tap.h"
#include "protocols/mcap/mcap.h"
#include "protocols/pcapng/pcapng.h"
#include "sim/samples/time.h"

namespace rigwire::hil {

/// Returns an instant in the form of a recording's lines: seconds with nine decimals.
[[nodiscard]] std::string instant_text(SimTime at);
/// "serial", "can", "ethernet".
[[nodiscard]] std::string_view name_of(WireKind kind);

/// The run that is recorded.
struct RecordedRun {
  std::string version;  ///< Version of rigwire.
  std::string rig;
  std::uint64_t seed = 0;
  std::string config_hash;
  std::string clock;
  std::string start_utc;
  std::int64_t start_unix_ns = 0;
  std::string configuration;    ///< YAML.
  SimTime begin{};              ///< What is due from here on is recorded.
  SimTime truth_begin{};        ///< The truth from here on: it runs ahead of the wires.
  bool clients_before = false;  ///< Clients acted before; those acts are not kept.
  bool tells_requests = true;   ///< False: recorded by a version without requests.log.
  CloudSettings clouds{};
};

struct RecordedWire {
  std::string name;  ///< Also the name of its files.
  WireKind kind = WireKind::serial;
  std::string address;  ///< What a client opens.
};

/// Track of the lines of commands.log, without the instant.
inline constexpr std::uint16_t kCommandTrack = kTruthTracks;
/// Track of the lines of requests.log, without the instant.
inline constexpr std::uint16_t kRequestTrack = kCommandTrack + 1;
/// Ends a line of requests.log that is only a promise.
inline constexpr const char* kPromised = " promised";
/// The track of a wire by its index.
[[nodiscard]] constexpr std::uint16_t wire_track(std::size_t wire) {
  return static_cast<std::uint16_t>(kRequestTrack + 1 + wire);
}

// Flags of an entry of a wire. Its bytes are those of a packet of the wire's link type; on a serial
// line the bytes that it carried.
inline constexpr std::uint8_t kInbound = 1;   ///< Sent by a client.
inline constexpr std::uint8_t kWireLost = 2;  ///< No packet: the wire did not take one.
inline constexpr std::uint8_t kWireNote = 4;  ///< No packet: a comment for the next one.
inline constexpr std::uint8_t kWireEnd = 8;   ///< No packet: what a client did, for NAME.ends.

/// Counts of what was recorded, and of what was not.
struct RecordingTotals {
  struct Wire {
    std::uint64_t packets = 0;
    std::uint64_t bytes = 0;
    std::uint64_t lost = 0;  ///< Passed on the wire and is not in its file.
    std::uint64_t dropped_by_wire = 0;
  };
  std::vector<Wire> wires;
  std::array<std::uint64_t, kTruthTracks> messages{};
  std::uint64_t lost_messages = 0;
};

class RecordingWriter {
 public:
  /// Makes the files in `folder`, which must be there and without them. `with_truth`: whether there
  /// is an MCAP. Throws drivers::EndpointError.
  RecordingWriter(const std::filesystem::path& folder, RecordedRun run,
                  std::vector<RecordedWire> wires, bool with_truth, const TellTrouble& tell);
  ~RecordingWriter();
  RecordingWriter(const RecordingWriter&) = delete;
  RecordingWriter& operator=(const RecordingWriter&) = delete;

  void write(const RecordEntry& entry);
  /// Counts entries of a track that were lost before they came here.
  void lost(std::uint16_t track, std::uint64_t count);
  /// Writes everything so far to the disk, but for an unfinished chunk of messages.
  void flush();
  /// Ends the files with their final parts. No further call may follow.
  void finish(SimTime end);
  [[nodiscard]] const RecordingTotals& totals() const { return totals_; }

 private:
  struct Wire;
  void write_packet(Wire& wire, const RecordEntry& entry);
  void write_message(TruthTrack track, SimTime at, std::string_view text);
  void write_cloud(Wire& wire, const RecordEntry& entry);
  void write_piece(Wire& wire, const RecordEntry& entry);
  void write_frame(Wire& wire, const RecordEntry& entry);
  static void write_line(BlockFile& file, const RecordEntry& entry);
  void flush_serial(Wire& wire);
  void flush_messages();
  void write_description(std::optional<SimTime> end) const;
  [[nodiscard]] std::uint64_t unix_ns(SimTime at) const;

  std::filesystem::path folder_;
  RecordedRun run_;
  std::vector<std::unique_ptr<Wire>> wires_;
  std::unique_ptr<BlockFile> all_;  ///< Null while there is no wire.
  std::unique_ptr<BlockFile> commands_;
  std::unique_ptr<BlockFile> requests_;
  std::unique_ptr<RecordingFile> truth_;
  std::optional<protocols::mcap::Writer> messages_;
  RecordingTotals totals_;
};

}  // namespace rigwire::hil
