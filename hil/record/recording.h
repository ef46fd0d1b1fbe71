// Reads a finished recording (hil/record/recording_writer.h), and cuts a piece out of it.
//
// Recordings of runs that were killed are read as far as their files are whole.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "hil/record/recording_writer.h"
#include "sim/samples/time.h"

namespace rigwire::hil {

struct RequestHandover;

struct RecordingContents {
  RecordedRun run;
  std::optional<SimTime> end;  ///< End of the run; empty: it was killed.

  struct Wire {
    RecordedWire about;
    std::uint64_t packets = 0;
    std::uint64_t of_clients = 0;
    std::uint64_t bytes = 0;
    /// Packets that passed and were not recorded, as the recorded packets report.
    std::uint64_t lost = 0;
    SimTime first{};  ///< Time of the first packet.
    SimTime last{};
  };
  std::vector<Wire> wires;

  struct Channel {
    std::string topic;
    std::string schema;
    std::uint64_t messages = 0;
  };
  std::vector<Channel> channels;  ///< Empty without truth.

  struct Note {
    SimTime at{};
    std::string wire;
    std::string text;
  };
  std::vector<Note> notes;  ///< Comments of packets, in order of time.
};

/// Throws drivers::EndpointError when a file cannot be read, std::invalid_argument with file and
/// place when it is no file of a recording.
[[nodiscard]] RecordingContents read_recording(const std::filesystem::path& folder);

/// A line of wires/NAME.ends, commands.log or requests.log (hil/record/recording_writer.h).
struct RecordedAct {
  SimTime at{};
  std::string text;
};
/// Returns the acts of a wire's client; empty when the recording has no such file. Throws
/// std::invalid_argument with file and line, and drivers::EndpointError when it cannot be read.
[[nodiscard]] std::vector<RecordedAct> client_acts(const std::filesystem::path& folder,
                                                   const std::string& wire);
/// Returns the commands that changed the run; empty or throws like client_acts().
[[nodiscard]] std::vector<RecordedAct> recorded_commands(const std::filesystem::path& folder);

/// Returns when the truth was asked and followed in a run that followed the wall clock; empty or
/// throws like client_acts().
[[nodiscard]] std::vector<RequestHandover> recorded_handovers(const std::filesystem::path& folder);

/// Reads only the description of the recording, without its packets and messages.
[[nodiscard]] RecordingContents read_recording_description(const std::filesystem::path& folder);

/// Calls `use` for each packet of all wires, in order of time, with the number of its wire.
void each_packet(const std::filesystem::path& folder,
                 const std::function<void(std::size_t wire, SimTime at,
                                          const protocols::pcapng::Packet& packet)>& use);
/// Calls `use` for each message of the truth, where there is one, in the order of the file.
void each_message(
    const std::filesystem::path& folder,
    const std::function<void(TruthTrack track, SimTime at, std::string_view text)>& use);

/// Returns a description for people.
[[nodiscard]] std::string to_text(const RecordingContents& contents);
[[nodiscard]] std::string to_json(const RecordingContents& contents);

/// Writes what is at or after `from` and before `to` into a folder that is new or empty: a
/// recording with the same calendar. Also completes the recording of a run that was killed. Throws
/// as read_recording(), and when the folder cannot be written.
void cut_recording(const std::filesystem::path& folder, SimTime from, SimTime to,
                   const std::filesystem::path& out);

}  // namespace rigwire::hil
