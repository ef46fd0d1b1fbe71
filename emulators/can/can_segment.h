// One bus segment with the controllers connected to it: which node starts, which wins arbitration,
// how long a frame takes, which nodes receive it.
//
// A frame that goes well is settled in one step: its length is known (protocols/can/bits.h). Every
// other attempt is run bit by bit (can_bit_level.h): no acknowledgement, equal identifiers with
// different data, another bit rate, a fault of the wire.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "emulators/can/can_bit_level.h"
#include "emulators/can/can_controller.h"
#include "emulators/can/can_noise.h"
#include "sim/samples/time.h"

namespace rigwire::emulators {

/// Measures the share of the last second in which a bus was occupied.
class CanBusLoad {
 public:
  /// The bus is occupied in [begin, end). Spans come in order and do not overlap.
  void occupy(SimTime begin, SimTime end);
  /// Returns the share of the second before `now`, 0..1, in steps of 10 ms: the last hundred
  /// complete hundredths of a second are counted.
  [[nodiscard]] double share(SimTime now) const;

 private:
  static constexpr Duration kBucket = std::chrono::milliseconds{10};
  static constexpr std::int64_t kBuckets = 100;

  std::array<std::int64_t, kBuckets + 2> busy_ns_{};  ///< Per 10 ms, by number modulo size.
  std::int64_t newest_ = 0;
};

class CanSegment {
 public:
  explicit CanSegment(std::uint32_t bit_rate_bps) : clock_(bit_rate_bps), bits_(bit_rate_bps) {}

  /// Reserves memory for `nodes` nodes.
  void reserve(std::size_t nodes);
  /// Connects a node; the order of the calls is the order in which frames are delivered. The
  /// controller must not be connected elsewhere.
  void connect(SimTime now, CanController& node);
  /// Precondition: not busy().
  void disconnect(CanController& node);
  /// `noise` must outlive it.
  void set_noise(CanNoise& noise) { noise_ = &noise; }
  /// Repeats the noise of the frame on the wire after the faults have changed, as if the new state
  /// had held when the frame began, unless the nodes already know of events in it.
  void reconsider();

  [[nodiscard]] SimTime next_event() const {
    if (stale_) {
      find_next();
    }
    return next_;
  }
  /// Executes what is due at next_event().
  void step();
  /// Whether a frame, or what an error made of it, is on the wire.
  [[nodiscard]] bool busy() const { return attempt_ != Attempt::none; }

  [[nodiscard]] const CanBusLoad& load() const { return load_; }
  [[nodiscard]] std::uint64_t frames() const { return frames_; }
  [[nodiscard]] std::uint64_t error_frames() const { return error_frames_; }
  /// Returns the number of arbitrations that ended without a single winner.
  [[nodiscard]] std::uint64_t collisions() const { return collisions_; }

 private:
  enum class Attempt : std::uint8_t { none, good, bit_by_bit };

  void find_next() const;
  [[nodiscard]] SimTime start_of(const CanController& node) const;
  [[nodiscard]] SimTime first_start() const;
  [[nodiscard]] SimTime recovered_at(const CanController& node) const;
  [[nodiscard]] bool keeps_rate(const CanController& node) const {
    return node.bit_rate_bps() == clock_.bit_rate_bps();
  }
  void arbitrate(SimTime start);
  void begin_attempt(const CanLineState& line);
  void choose_winners(SimTime offered_at);
  void synchronise(SimTime start);
  void occupy(unsigned bits);
  [[nodiscard]] bool goes_well(const CanLineState& line) const;
  void complete();
  void begin_bit_by_bit(const CanLineState& line);
  void happen(SimTime now);
  void go_on_bit_by_bit();
  void settle_losers(SimTime now);
  void end_attempt(unsigned length, unsigned recessive_from);

  /// A controller with the frame that it wants on the wire.
  struct Contender {
    CanController* node = nullptr;
    protocols::can::Frame frame;
    std::uint32_t arbitration_field = 0;
    unsigned bits = 0;
  };
  CanBitClock clock_;
  CanBitLevel bits_;
  CanNoise* noise_ = nullptr;
  CanBusLoad load_;
  std::vector<CanController*> nodes_;
  std::vector<Contender> contenders_;  ///< Nodes whose frame is on the wire in this attempt.
  std::vector<Contender> losers_;      ///< One-shot controllers that lost arbitration in it.
  Attempt attempt_ = Attempt::none;
  bool told_ = false;              ///< The nodes know of events in this attempt.
  SimTime loaded_until_ = kStart;  ///< End of the last span given to `load_`.
  mutable bool stale_ = true;
  mutable SimTime next_ = kNever;
  std::uint64_t frames_ = 0;
  std::uint64_t error_frames_ = 0;
  std::uint64_t collisions_ = 0;
};

}  // namespace rigwire::emulators
