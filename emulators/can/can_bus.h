// One CAN bus: the wire that several devices and the client share, with everything that makes it a
// bus and no pipe.
//
// - A node hands over a frame with the instant from which its controller wants to send it. Each
//   node has a transmit queue, first in first out or by priority (can_node.h); what does not fit is
//   lost and counted.
// - When the bus is free, all nodes with a ready frame start together; the arbitration field
//   decides (protocols/can/bits.h), the losers wait. Nodes that want to send within the first bit
//   after the start of frame still take part, as on a wire.
// - A frame occupies its exact number of bits, stuff bits and interframe space included. It is
//   complete, and delivered, at the end of its end-of-frame field; the bus is free again three bits
//   later. Instants are whole bits from the synchronising edge, rounded to the nanosecond once
//   (can_bit_level.h): error 0.5 ns, without drift.
// - Another node has to acknowledge: one at the same bit rate that is neither listen-only nor
//   bus-off. The client's controller is a node like the others, but does not acknowledge while no
//   client is present (OutsideController). A node that is alone retries for ever, becomes passive
//   and not bus-off.
// - Errors run bit by bit (can_bit_level.h): error flags, counters, states, retransmission, bus-off
//   and recovery (can_controller.h), at their exact instants.
// - Two nodes that send one identifier: with the same bits both have sent and the others receive it
//   once; with different ones the first differing bit is an error.
// - Delivery goes to every other device on the bus, in the order of their attachment, and to the
//   sender's own exit, the way to the outside; not to the exit when a client that is present could
//   not receive it (bus-off, another bit rate, a broken stub).
// - Faults (can_bus_faults.h) change levels, rates and who is connected.
//
// Not modelled: propagation time and sample points, clock tolerance, resynchronisation, overload
// frames asked for by receivers, CAN FD.
//
// Deterministic: depends only on the sequence of calls and on the faults' seed. The executive calls
// advance() of the devices and of the bus in the order of their events; at one instant the order
// does not matter. Neither allocates nor throws after set-up.
//
// Source: ISO 11898-1:2015.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string_view>
#include <vector>

#include "emulators/can/can_bus_faults.h"
#include "emulators/can/can_node.h"
#include "emulators/can/can_segment.h"
#include "emulators/device.h"
#include "fields/rules.h"
#include "protocols/can/frame.h"
#include "sim/samples/time.h"

namespace rigwire::emulators {

class CanFaultSchedule;

struct CanBusSettings {
  std::uint32_t bit_rate_bps = 250'000;  ///< 10 000 .. 1 000 000.
  std::size_t queue_frames = 64;         ///< Transmit queue of each node, frames; 1 .. 65536.
};

void visit(fields::Visitor& v, CanBusSettings& p);

/// Throws std::invalid_argument with the value found and what is allowed.
void validate(const CanBusSettings& settings);

/// One node as reports show it.
struct CanNodeStatus {
  std::string_view name;  ///< CanNodeSettings::name.
  std::uint32_t bit_rate_bps = 0;
  CanNodeCounters counters;
  protocols::can::ControllerReport controller;  ///< State and error counters.
};

class CanBusModel {
 public:
  explicit CanBusModel(const CanBusSettings& settings);
  ~CanBusModel();
  CanBusModel(const CanBusModel&) = delete;
  CanBusModel& operator=(const CanBusModel&) = delete;

  /// A new node, and the output to construct its device with. Valid as long as the bus. `exit`
  /// receives every frame that the node has sent, with the instant of its end of frame. Throws
  /// std::invalid_argument for settings out of range and for a name that another node has.
  [[nodiscard]] FrameOutput& add_node(FrameOutput& exit, const CanNodeSettings& node = {});
  /// Connects the device that receives what the others send. `output` is one of add_node()'s; the
  /// device must outlive the bus's last advance().
  void attach(FrameOutput& output, CanDevice& device);
  /// Connects the observer of the node's frames and of its controller, for a node that represents a
  /// further client.
  void attach(FrameOutput& output, CanOutside& outside);

  /// Optional, once.
  void set_outside(CanOutside& outside);
  /// The client opened or closed its controller, or changed its settings: its counters restart at
  /// zero, and what it still had to send while it closes is lost. Before the first call it is
  /// OutsideController{}. A bit rate out of range is replaced by the nearest one that is allowed.
  void set_client(SimTime now, const OutsideController& client);
  /// Sets the controller of a further client; `output` is its node, one of add_node()'s. Each call
  /// counts as a change.
  void set_client(SimTime now, FrameOutput& output, const OutsideController& client);
  /// The client asks its controller to come back from bus-off.
  void restart_outside(SimTime now);

  /// Sets the faults of the bus. Frames of intruders leave by `intruder_exit`. To be called once,
  /// after the last add_node() and before the first advance(). Throws std::invalid_argument.
  void set_faults(const CanBusFaults& faults, FrameOutput& intruder_exit);
  /// Returns the schedule to begin and end faults while the bus runs. Precondition: set_faults().
  [[nodiscard]] CanFaultSchedule& faults() { return *faults_; }

  /// A frame from outside, wanting to be sent from `now` on.
  void receive(SimTime now, const protocols::can::Frame& frame);

  /// Simulates the bus up to and including `now`.
  void advance(SimTime now);
  [[nodiscard]] SimTime next_event() const;

  /// Returns the share of the second before `now` in which the bus was occupied, errors included,
  /// 0..1, in steps of 10 ms: the last hundred complete hundredths of a second are counted.
  [[nodiscard]] double load(SimTime now) const { return wire_.load().share(now); }
  /// Returns the number of frames sent without error.
  [[nodiscard]] std::uint64_t frames() const { return wire_.frames(); }
  /// Returns the number of attempts that an error ended.
  [[nodiscard]] std::uint64_t error_frames() const { return wire_.error_frames(); }
  /// Returns the number of arbitrations that ended without a single winner.
  [[nodiscard]] std::uint64_t collisions() const { return wire_.collisions(); }
  [[nodiscard]] CanNodeCounters counters(const FrameOutput& output) const;
  /// Returns the client's last frame that the node's device accepted (ReceiveCounters::accepted).
  [[nodiscard]] const std::optional<CanRequest>& last_request(const FrameOutput& output) const;
  [[nodiscard]] protocols::can::ControllerReport controller(const FrameOutput& output) const;
  /// Returns the counters of the client's own node.
  [[nodiscard]] CanNodeCounters outside_counters() const { return nodes_.front()->counters(); }
  [[nodiscard]] protocols::can::ControllerReport outside_controller() const {
    return nodes_.front()->status();
  }
  /// The outside, the devices in the order of add_node(), and intruders.
  [[nodiscard]] std::vector<CanNodeStatus> nodes() const;
  [[nodiscard]] const CanBusSettings& settings() const { return settings_; }

 private:
  [[nodiscard]] CanController& node_of(const FrameOutput& output) const;
  void configure(SimTime now, CanController& node, const OutsideController& client) const;
  CanController& connect(const CanNodeSettings& settings, FrameOutput* exit);

  CanBusSettings settings_;
  std::vector<std::unique_ptr<CanController>> nodes_;  ///< The first one is the outside.
  CanSegment wire_;
  std::unique_ptr<CanFaultSchedule> faults_;
  OutsideController client_;
  SimTime last_event_ = kStart;
};

}  // namespace rigwire::emulators
