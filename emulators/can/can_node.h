// Settings and counters of one node of a CAN bus; and the client's node: its controller as the bus
// sees it, and what that controller reports to the client.
#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include "fields/rules.h"
#include "protocols/can/controller_report.h"
#include "protocols/can/frame.h"
#include "sim/samples/time.h"

namespace rigwire::emulators {

/// Order in which a controller offers its waiting frames to the bus. Both exist in hardware: a
/// queue in front of one mailbox, and several mailboxes of which the most urgent identifier is
/// chosen.
enum class CanQueueOrder : std::uint8_t {
  fifo,      ///< Order of arrival: an urgent frame waits behind others (inner priority inversion).
  priority,  ///< Order of the arbitration field; frames with equal fields in order of arrival.
};
inline constexpr std::array<fields::Choice<CanQueueOrder>, 2> kCanQueueOrders{
    {{CanQueueOrder::fifo, "fifo", "In the order in which the frames came."},
     {CanQueueOrder::priority, "priority", "The most urgent identifier first."}}};

/// Name of the node that stands for the client.
inline constexpr const char* kCanOutsideName = "client";

struct CanNodeSettings {
  std::string name{};              ///< Name used by faults and reports; may be empty.
  std::uint32_t bit_rate_bps = 0;  ///< 10 000 .. 1 000 000; 0: the bus's.
  /// Waiting frames, 1 .. 65536; 0: the bus's. One more is in the mailbox while it is on the wire.
  std::size_t queue_frames = 0;
  CanQueueOrder order = CanQueueOrder::fifo;
  bool listen_only = false;  ///< Sends nothing, acknowledges nothing, signals no errors.
  bool one_shot = false;     ///< Tries every frame once: ISO 11898-1, retransmission disabled.
  /// From bus-off to the beginning of the recovery, 0 .. 1 h; nullopt: only on request.
  std::optional<Duration> restart_after = std::chrono::milliseconds{100};
};

/// Throws std::invalid_argument with the quantity, the value found and what is allowed.
void validate(const CanNodeSettings& settings);

struct CanErrorCounts {
  std::uint64_t bit = 0;
  std::uint64_t stuff = 0;
  std::uint64_t form = 0;
  std::uint64_t crc = 0;
  std::uint64_t acknowledgement = 0;

  friend bool operator==(const CanErrorCounts&, const CanErrorCounts&) = default;
};

/// A frame of the client that the node's device accepted.
struct CanRequest {
  SimTime at{};
  protocols::can::Frame frame;
};

/// At every instant offered = sent + overflowed + abandoned + queued.
struct CanNodeCounters {
  std::uint64_t offered = 0;             ///< Frames that the host wanted to send.
  std::uint64_t sent = 0;                ///< Frames that left completely.
  std::uint64_t overflowed = 0;          ///< Frames lost because the queue was full.
  std::uint64_t abandoned = 0;           ///< Given up: one-shot, bus-off, closed, listen-only.
  std::uint64_t queued = 0;              ///< Waiting or on the wire now.
  std::uint64_t received = 0;            ///< Frames of others, complete and without error.
  std::uint64_t retransmissions = 0;     ///< Attempts after one that an error ended.
  std::uint64_t arbitration_losses = 0;  ///< Attempts that a more urgent frame ended.
  std::uint64_t bus_offs = 0;
  CanErrorCounts errors;     ///< Errors that this node detected, in own and in others' frames.
  Duration longest_wait{0};  ///< Longest time from the request to the start of a sent frame.

  friend bool operator==(const CanNodeCounters&, const CanNodeCounters&) = default;
};

/// Receives the events of the client's controller. Calls come from CanBusModel's advance(),
/// receive(), set_client() and restart_outside(), with times that never decrease.
class CanOutside {
 public:
  virtual ~CanOutside() = default;
  /// The oldest unsettled frame of CanBusModel::receive() was complete on the bus at `now`, or,
  /// with `sent` false, never will be: one-shot and failed, bus-off, queue full, no client present.
  virtual void confirm(SimTime now, bool sent) = 0;
  /// An error that the controller saw, a change of its state, or both.
  virtual void report(SimTime now, const protocols::can::ControllerReport& report) = 0;
};

/// How the client has set its controller.
struct OutsideController {
  bool present = true;             ///< False: no client is present, and none acknowledges.
  std::uint32_t bit_rate_bps = 0;  ///< 10 000 .. 1 000 000; 0: the bus's.
  bool listen_only = false;        ///< Sends nothing, acknowledges nothing.
  bool one_shot = false;           ///< Tries every frame once only.
  /// From bus-off to the beginning of the recovery; nullopt: only by restart_outside(), or when the
  /// client closes and opens.
  std::optional<Duration> restart_after = std::chrono::milliseconds{100};

  friend bool operator==(const OutsideController&, const OutsideController&) = default;
};

}  // namespace rigwire::emulators
