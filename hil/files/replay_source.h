// What passed on one wire, out of a file: units with the instants at which they are due again.
//
//   file                                     units                    instants
//   pcap, pcapng of Ethernet (VLAN tags      UDP datagrams that the   of the packets
//     too), Linux cooked, raw IP             filter lets through
//   pcapng of SocketCAN; candump -l log      CAN frames               of the packets, of the lines
//   pcapng of RTAC serial                    bytes                    of the packets
//   FILE beside an index of its stem         bytes                    of the index's lines
//     (gnss.bytes with gnss.index)
//   any other: NMEA, UBX as they are         messages                 of the clock within: GGA,
//   RMC,
//                                                                     GLL, ZDA or iTOW begins an
//                                                                     epoch, at line speed within
//                                                                     it
//
// What a client had sent (inbound packets, T of candump, < of an index) is no part of it.
//
// Instants are absolute, from the zero of the file, and are computed for each unit from its own:
// nothing accumulates. due = (instant - zero - start) / speed + offset, to the nanosecond; with
// `loop` the piece comes again after its length. A unit whose instant is before that of the unit in
// front goes together with that one, and is counted; more than a second back is refused.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "drivers/endpoints.h"
#include "fields/visitor.h"
#include "protocols/can/frame.h"
#include "sim/samples/time.h"

namespace rigwire::hil {

enum class ReplayedKind : std::uint8_t { bytes, datagrams, frames };
enum class ReplayedGaps : std::uint8_t { keep, cut };
inline constexpr std::array<fields::Choice<ReplayedGaps>, 2> kReplayedGaps{
    {{ReplayedGaps::keep, "keep", "As they are."},
     {ReplayedGaps::cut, "cut", "What is longer than a second lasts one second."}}};

struct ReplaySourceSettings {
  std::string file;
  std::string wire;             ///< Interface of a pcapng file; empty: the only one that fits.
  std::string from_address;     ///< UDP filter; empty: any.
  std::uint16_t from_port = 0;  ///< 0: any.
  std::uint16_t to_port = 0;    ///< 0: any.
  std::uint32_t baud = 9600;    ///< Of files without instants.
  Duration start{0};            ///< Of the piece, from the file's zero.
  Duration end{0};              ///< 0: all.
  Duration offset{0};           ///< From the run's start to the piece's.
  double speed = 1.0;
  bool loop = false;
  ReplayedGaps gaps = ReplayedGaps::keep;
  std::uint64_t zero_unix_ns = 0;  ///< The file's zero, ns since 1970; 0: its first unit.
};
void visit(fields::Visitor& v, ReplaySourceSettings& p);

struct ReplayedUnit {
  SimTime due{};
  std::vector<std::uint8_t> bytes;
  protocols::can::Frame frame;  ///< Of frames.
  drivers::IpEnd from;          ///< Of datagrams.
  drivers::IpEnd to;
};

/// What the whole piece is.
struct ReplayedSummary {
  ReplayedKind kind = ReplayedKind::bytes;
  std::uint64_t units = 0;
  std::uint64_t bytes = 0;
  std::uint64_t went_back = 0;          ///< Instants before that of the unit in front.
  Duration length{0};                   ///< From its first unit to its last.
  std::vector<std::uint16_t> to_ports;  ///< Of datagrams, in the order of their first.
  bool truncated = false;               ///< The file ends in the middle of a unit.
};

class ReplaySource {
 public:
  /// Reads the file once to its end. Throws drivers::EndpointError where it cannot be read,
  /// std::invalid_argument naming what is wrong with it: nothing of a kind that can be played, a
  /// wire that it does not have or has twice, units of two kinds, instants that go back.
  explicit ReplaySource(const ReplaySourceSettings& settings);
  ~ReplaySource();
  ReplaySource(const ReplaySource&) = delete;
  ReplaySource& operator=(const ReplaySource&) = delete;

  [[nodiscard]] const ReplayedSummary& summary() const { return summary_; }
  /// The next unit, null at the end. Valid until the next call. Does not throw: a file that was
  /// changed meanwhile ends where it is no longer whole.
  [[nodiscard]] const ReplayedUnit* next();

  class Reader;

 private:
  /// The next of the piece with its instant from the piece's start, cuts taken out; false at its
  /// end.
  bool next_of_piece(Duration& at);
  void rewind();

  ReplaySourceSettings settings_;
  ReplayedSummary summary_;
  std::unique_ptr<Reader> reader_;
  ReplayedUnit unit_;
  std::int64_t zero_ns_ = 0;  ///< In the file's own count.
  std::int64_t last_ns_ = 0;
  std::int64_t cut_ns_ = 0;  ///< Taken out so far.
  bool first_ = true;
  std::int64_t rounds_ = 0;
  Duration round_{0};  ///< Of the loop.
  SimTime last_due_{};
};

}  // namespace rigwire::hil
