// The faults of a bus that come and go with time: wrong rates, broken stubs, intruders. Those of
// the wire are can_noise.h's.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "emulators/can/can_bus_faults.h"
#include "emulators/can/can_controller.h"
#include "emulators/can/can_segment.h"

namespace rigwire::emulators {

/// A fault of a node begins and ends between two frames: when its instant lies within one, after
/// it.
class CanFaultSchedule {
 public:
  /// Gives `wire` its noise and connects the intruders to it. Throws std::invalid_argument when a
  /// fault names a node that is none of `nodes`, or disconnects one twice at a time.
  CanFaultSchedule(const CanBusFaults& faults, std::uint32_t bit_rate_bps,
                   std::span<CanController* const> nodes, CanSegment& wire,
                   FrameOutput& intruder_exit);

  [[nodiscard]] SimTime next_event() const;
  /// What happens at next_event(). `now` is later when it had to wait for the end of a frame.
  void step(SimTime now);

  [[nodiscard]] std::span<CanController* const> intruders() const { return intruder_nodes_; }

 private:
  struct Change {
    SimTime at;
    CanController* node;
    bool begins;
    std::uint32_t bit_rate_bps;  ///< Of a wrong rate.
    CanSegment* stub;            ///< Of a node that is disconnected; else null.
  };
  struct Intruder {
    std::unique_ptr<CanController> node;
    protocols::can::Frame frame;
    SimTime next;
    SimTime end;
    Duration period;
  };

  /// Throws std::invalid_argument where another of its kind holds on the node meanwhile.
  void change_node(const FaultPeriod& when, CanController& node, std::uint32_t bit_rate_bps,
                   CanSegment* stub);
  void add_intruder(const FaultPeriod& when, const protocols::can::Frame& frame, Duration period,
                    FrameOutput& exit);
  [[nodiscard]] SimTime next_change() const;
  void change(SimTime now, const Change& change);
  void intrude(SimTime now, Intruder& intruder);

  CanSegment& wire_;
  std::uint32_t bit_rate_bps_;
  std::vector<std::unique_ptr<CanSegment>> stubs_;
  std::vector<Change> changes_;  ///< In order of time.
  std::size_t next_change_ = 0;
  std::vector<Intruder> intruders_;
  std::vector<CanController*> intruder_nodes_;
};

}  // namespace rigwire::emulators
