// Reads what passed on one wire from a file: units with the instants at which they were complete,
// by the file's own clock.
//
//   file                                     units                    instants
//   pcap, pcapng of Ethernet (VLAN tags      UDP datagrams that the   of the packets
//     too), Linux cooked, raw IP             filter lets through
//   pcapng of SocketCAN; candump -l log      CAN frames               of the packets, of the lines
//   pcapng of RTAC serial                    bytes                    of the packets
//   FILE beside an index of its stem         bytes                    of the index's lines
//     (gnss.bytes with gnss.index)
//   any other: NMEA, UBX as they are         messages                 of the time in them
//
// The time in messages (protocols/gnss_stream/time.h): a new time begins an epoch, and within it
// bytes follow each other at line speed.
//
// What a client had sent is not read: inbound packets of our own recordings, T of candump, < of an
// index. In captures of others `direction` chooses. What cannot be played is counted by its kind.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "drivers/endpoints.h"
#include "fields/visitor.h"
#include "protocols/can/frame.h"
#include "sim/samples/time.h"

namespace rigwire::hil {

/// Throws std::invalid_argument about the file of a source's key `file`.
[[noreturn]] void refuse_replayed(const std::string& file, const std::string& why);

enum class ReplayedKind : std::uint8_t { bytes, datagrams, frames };
enum class ReplayedGaps : std::uint8_t { keep, cut };
inline constexpr std::array<fields::Choice<ReplayedGaps>, 2> kReplayedGaps{
    {{ReplayedGaps::keep, "keep", "Gaps stay as they are."},
     {ReplayedGaps::cut, "cut", "What is longer than a second lasts one second."}}};

enum class ReplayedDirection : std::uint8_t { automatic, inbound, outbound, both };
inline constexpr std::array<fields::Choice<ReplayedDirection>, 4> kReplayedDirections{
    {{ReplayedDirection::automatic, "auto",
      "All but what a client had sent, in recordings of Rigwire; both in files of others."},
     {ReplayedDirection::inbound, "inbound", "What the recording machine received."},
     {ReplayedDirection::outbound, "outbound", "What the recording machine sent."},
     {ReplayedDirection::both, "both", "All of it."}}};

enum class ReplayedAlignment : std::uint8_t { zero, gps };
inline constexpr std::array<fields::Choice<ReplayedAlignment>, 2> kReplayedAlignments{
    {{ReplayedAlignment::zero, "zero", "The file's zero is played at the run's start."},
     {ReplayedAlignment::gps, "gps",
      "By the GPS time that is in the file, on the rig's calendar (key `start` of the rig)."}}};

struct ReplaySourceSettings {
  std::string file;
  ReplayedDirection direction = ReplayedDirection::automatic;
  std::string wire;             ///< Interface of a pcapng file; empty: the only one that fits.
  std::string from_address;     ///< UDP filter; empty: any.
  std::uint16_t from_port = 0;  ///< 0: any.
  std::uint16_t to_port = 0;    ///< 0: any.
  std::uint32_t baud = 9600;    ///< Rate for files without time stamps.
  Duration start{0};            ///< Start of the piece, from the file's zero.
  Duration end{0};              ///< End of the piece; 0: the end of the file.
  Duration offset{0};           ///< From the run's start to the piece's.
  double speed = 1.0;
  bool loop = false;
  ReplayedGaps gaps = ReplayedGaps::keep;
  ReplayedAlignment align = ReplayedAlignment::zero;
  std::uint64_t zero_unix_ns = 0;  ///< The file's zero, ns since 1970; 0: its first unit.
};
void visit(fields::Visitor& v, ReplaySourceSettings& p);

/// Smallest unit on a wire: bytes, a frame or a datagram.
struct ReplayedUnit {
  SimTime due{};  ///< Set by ReplaySource.
  std::vector<std::uint8_t> bytes;
  protocols::can::Frame frame;  ///< For CAN: the frame.
  drivers::IpEnd from;          ///< For datagrams: the source.
  drivers::IpEnd to;
};

/// A file as units with instants of its own clock, in ns.
class ReplayReader {
 public:
  virtual ~ReplayReader() = default;
  /// Reads the next unit; false at the end. Throws std::invalid_argument naming what is wrong with
  /// the file.
  virtual bool next(std::int64_t& at_ns, ReplayedUnit& unit) = 0;
  [[nodiscard]] virtual ReplayedKind kind() const = 0;
  /// After the end: whether the file ended in the middle of a unit.
  [[nodiscard]] virtual bool truncated() const = 0;
  /// For files without instants: how long a unit took that began with the time that it reports.
  [[nodiscard]] virtual std::int64_t transmission_ns(const ReplayedUnit& /*unit*/) const {
    return 0;
  }
  /// How often what was read is not played, or not as it was, by what it is ("CAN FD frame").
  [[nodiscard]] const std::map<std::string, std::uint64_t>& notes() const { return notes_; }

 protected:
  void count_note(const std::string& what, std::uint64_t count = 1) { notes_[what] += count; }

 private:
  std::map<std::string, std::uint64_t> notes_;
};

/// Opens the file of the settings, with the filter for captures. Throws drivers::EndpointError when
/// the file cannot be read, std::invalid_argument when it contains nothing that can be played.
[[nodiscard]] std::unique_ptr<ReplayReader> open_replay_reader(
    const ReplaySourceSettings& settings);

}  // namespace rigwire::hil
