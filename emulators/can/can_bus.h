// One CAN bus: the wire that several devices share, with a bit rate, arbitration and frame lengths.
//
// - A node hands over a frame with the instant from which its controller wants to send it. Each
//   node sends its frames in order (one transmit mailbox behind a queue); when the queue is full
//   the new frame is lost and counted.
// - When the bus is free, all nodes with a ready frame start together; the arbitration field
//   decides (protocols/can/bits.h), the losers wait. Nodes that want to send within the first bit
//   after the start of frame still take part, as on a wire.
// - A frame occupies its exact number of bits, stuff bits and interframe space included. It is
//   complete, and delivered, at the end of its end-of-frame field; the bus is free again three bits
//   later.
// - Delivery goes to every other device on the bus, in the order of their attachment, and to the
//   sender's own exit, the way to the outside. Frames from outside enter as a node of their own.
//
// Not modelled: acknowledge and error frames, error counters, bus-off, bit errors between equal
// identifiers (two nodes with equal arbitration fields: the one attached first sends first and the
// case is counted), propagation time, CAN FD.
//
// Deterministic: depends only on the sequence of calls. The executive calls advance() of the
// devices and of the bus in the order of their events; at one instant the order does not matter.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "emulators/can/can_bus_faults.h"
#include "emulators/can/can_node.h"
#include "emulators/can/can_outside.h"
#include "emulators/device.h"
#include "protocols/can/frame.h"
#include "sim/samples/time.h"

namespace rigwire::emulators {

struct CanBusSettings {
  std::uint32_t bit_rate_bps = 250'000;  ///< 10 000 .. 1 000 000.
  std::size_t queue_frames = 64;         ///< Of each node; 1 .. 65536.
};

/// Throws std::invalid_argument with the value found and what is allowed.
void validate(const CanBusSettings& settings);

class CanBusModel {
 public:
  explicit CanBusModel(const CanBusSettings& settings);
  ~CanBusModel();
  CanBusModel(const CanBusModel&) = delete;
  CanBusModel& operator=(const CanBusModel&) = delete;

  /// A new node, and the output to construct its device with. Valid as long as the bus. `exit`
  /// receives every frame that the node has sent, with the instant of its end of frame.
  [[nodiscard]] FrameOutput& add_node(FrameOutput& exit, const CanNodeSettings& node = {});
  /// Names the device that hears what the others send. `output` is one of add_node()'s; the device
  /// must outlive the bus's last advance().
  void attach(FrameOutput& output, CanDevice& device);

  /// Optional, once.
  void set_outside(CanOutside& outside);
  /// The client opened or closed its controller, or set it otherwise. Before the first call it is
  /// OutsideController{}.
  void set_client(SimTime now, const OutsideController& client);
  /// The client asks its controller to come back from bus-off.
  void restart_outside(SimTime now);

  /// What will go wrong. Frames of intruders leave by `intruder_exit`. To be called once, after the
  /// last add_node() and before the first advance(). Throws std::invalid_argument.
  void set_faults(const CanBusFaults& faults, FrameOutput& intruder_exit);

  /// A frame from outside, wanting to be sent from `now` on.
  void receive(SimTime now, const protocols::can::Frame& frame);

  /// Lets the bus live up to and including `now`.
  void advance(SimTime now);
  [[nodiscard]] SimTime next_event() const;

  /// Share of the second before `now` in which the bus was occupied, 0..1, in steps of 10 ms:
  /// counted are the hundred whole hundredths of a second that ended last.
  [[nodiscard]] double load(SimTime now) const;
  [[nodiscard]] std::uint64_t frames() const { return frames_; }
  /// Arbitrations that two nodes would have won.
  [[nodiscard]] std::uint64_t collisions() const { return collisions_; }
  [[nodiscard]] CanNodeCounters counters(const FrameOutput& output) const;
  /// Of what came from outside.
  [[nodiscard]] CanNodeCounters outside_counters() const;
  [[nodiscard]] const CanBusSettings& settings() const { return settings_; }

 private:
  class Node;
  static constexpr Duration kLoadBucket = std::chrono::milliseconds{10};
  static constexpr std::size_t kLoadBuckets = 100;

  [[nodiscard]] Duration bits(std::uint64_t count) const;
  /// When the next arbitration is decided; kNever when nobody has a frame.
  [[nodiscard]] SimTime decision_time() const;
  [[nodiscard]] SimTime start_time() const;
  void arbitrate();
  void complete();
  void occupy(SimTime begin, SimTime end);
  [[nodiscard]] Node& node_of(const FrameOutput& output) const;

  CanBusSettings settings_;
  std::vector<std::unique_ptr<Node>> nodes_;  ///< The first one is the outside.
  Node* sender_ = nullptr;                    ///< Of the frame on the wire.
  protocols::can::Frame on_wire_;
  SimTime end_of_frame_ = kNever;
  SimTime free_at_ = kStart;
  std::uint64_t frames_ = 0;
  std::uint64_t collisions_ = 0;
  std::array<std::int64_t, kLoadBuckets + 2> busy_ns_{};  ///< Per 10 ms, by number modulo size.
  std::int64_t newest_bucket_ = 0;
};

}  // namespace rigwire::emulators
