// The faults of a bus: the list of them, which may change while the bus runs, and their effect on
// nodes, stubs and intruders. can_noise.h has those of the wire.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "emulators/can/can_bus_faults.h"
#include "emulators/can/can_controller.h"
#include "emulators/can/can_noise.h"
#include "emulators/can/can_segment.h"

namespace rigwire::emulators {

/// Begins and ends faults of a node only between two frames: if the instant lies within a frame, at
/// the frame's end.
class CanFaultSchedule {
 public:
  using Book = FaultBook<CanFault>;

  /// Gives `wire` its noise and connects the intruders to it. Wire, exit and nodes must outlive the
  /// schedule. Throws as begin().
  CanFaultSchedule(const CanBusFaults& faults, std::uint32_t bit_rate_bps,
                   std::span<CanController* const> nodes, CanSegment& wire,
                   FrameOutput& intruder_exit);

  /// Adds a fault, which acts as if it had been there from the start; it begins no earlier than the
  /// time the bus was advanced to. A fault of the wire does not affect a frame in which an error
  /// was signalled before. Allocates. Throws std::invalid_argument if the fault is out of range,
  /// names a node that the bus does not have, or is the second of its kind on a node at one time.
  Book::Id begin(const CanFault& fault);
  /// Ends a fault like FaultBook::end(). The random bit that a disturbance inverts in its last
  /// frame may differ from the one of a run in which the end was known beforehand.
  bool end(Book::Id id, SimTime now);
  [[nodiscard]] const Book& book() const { return book_; }

  [[nodiscard]] SimTime next_event() const;
  /// Executes what is due at next_event(). `now` is later when it had to wait for the end of a
  /// frame.
  void step(SimTime now);

  [[nodiscard]] std::span<CanController* const> intruders() const { return intruder_nodes_; }

 private:
  /// A wrong rate, or a node that is disconnected.
  struct NodeFault {
    Book::Id id;
    CanController* node;
    CanSegment* stub;  ///< Separate bus of a disconnected node; else null.
    bool acts = false;
  };
  struct Stub {
    CanController* node;
    std::unique_ptr<CanSegment> wire;
  };
  struct Intruder {
    Book::Id id;
    std::unique_ptr<CanController> node;
    protocols::can::Frame frame;
    Duration period;
    SimTime next;
  };

  [[nodiscard]] CanController& find_node(const CanFault& fault) const;
  [[nodiscard]] CanSegment& stub_of(CanController& node);
  /// Replaces an intruder whose fault is over, if there is one, else adds one.
  void add_intruder(Book::Id id, const protocols::can::Frame& frame, Duration period);
  void find_due();
  [[nodiscard]] SimTime next_change() const;
  void change(SimTime now, NodeFault& fault);
  void intrude(SimTime now, Intruder& intruder);

  Book book_;
  CanNoise noise_;
  std::vector<CanController*> nodes_;
  CanSegment& wire_;
  FrameOutput& intruder_exit_;
  std::uint32_t bit_rate_bps_;
  std::vector<Stub> stubs_;
  std::vector<NodeFault> node_faults_;
  SimTime due_ = kStart;  ///< When the next of them changes, and which one:
  static constexpr std::size_t kNone = ~std::size_t{0};
  std::size_t pending_ = kNone;
  std::vector<Intruder> intruders_;
  std::vector<CanController*> intruder_nodes_;
};

}  // namespace rigwire::emulators
