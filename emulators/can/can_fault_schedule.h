// The faults of a bus: the book of them, which may change while the bus runs, and what becomes of
// nodes, stubs and intruders by it. Those of the wire are can_noise.h's.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "emulators/can/can_bus_faults.h"
#include "emulators/can/can_controller.h"
#include "emulators/can/can_noise.h"
#include "emulators/can/can_segment.h"

namespace rigwire::emulators {

/// A fault of a node begins and ends between two frames: when its instant lies within one, after
/// it.
class CanFaultSchedule {
 public:
  using Book = FaultBook<CanFault>;

  /// Gives `wire` its noise and connects the intruders to it. Wire, exit and nodes must outlive it.
  /// Throws as begin().
  CanFaultSchedule(const CanBusFaults& faults, std::uint32_t bit_rate_bps,
                   std::span<CanController* const> nodes, CanSegment& wire,
                   FrameOutput& intruder_exit);

  /// One more, which acts as if it had been there from the start; it begins no earlier than the bus
  /// was advanced to. One of the wire does not reach into a frame in which an error was signalled
  /// before. Allocates. Throws std::invalid_argument when it is out of range, names a node that is
  /// none of the bus, or is the second of its kind on a node at a time.
  Book::Id begin(const CanFault& fault);
  /// As FaultBook::end(). Which bit of its last frame a disturbance turns over at random may be
  /// another one than if the end had been known beforehand.
  bool end(Book::Id id, SimTime now);
  [[nodiscard]] const Book& book() const { return book_; }

  [[nodiscard]] SimTime next_event() const;
  /// What happens at next_event(). `now` is later when it had to wait for the end of a frame.
  void step(SimTime now);

  [[nodiscard]] std::span<CanController* const> intruders() const { return intruder_nodes_; }

 private:
  /// A wrong rate, or a node that is disconnected.
  struct NodeFault {
    Book::Id id;
    CanController* node;
    CanSegment* stub;  ///< Of a node that is disconnected; else null.
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
  /// In the place of one whose fault is over, where there is such a one.
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
