// A piece of wire with the controllers that are connected to it: who starts, who wins, how long it
// takes, who hears it.
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

/// Which share of the last second a bus was occupied.
class CanBusLoad {
 public:
  /// The bus is occupied in [begin, end). Spans come in order and do not overlap.
  void occupy(SimTime begin, SimTime end);
  /// Share of the second before `now`, 0..1, in steps of 10 ms: counted are the hundred whole
  /// hundredths of a second that ended last.
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

  /// Room for so many nodes.
  void reserve(std::size_t nodes);
  /// In the order in which frames are handed out. The controller must not be connected elsewhere.
  void connect(SimTime now, CanController& node);
  /// Precondition: not busy().
  void disconnect(CanController& node);
  /// `noise` must outlive it.
  void set_noise(CanNoise& noise) { noise_ = &noise; }
  /// What the noise says of the frame on the wire may be otherwise: as if it had been so when the
  /// frame began, unless nodes have been told of an error in it.
  void reconsider();

  [[nodiscard]] SimTime next_event() const {
    if (stale_) {
      find_next();
    }
    return next_;
  }
  /// What happens at next_event().
  void step();
  /// A frame, or what an error made of it, is on the wire.
  [[nodiscard]] bool busy() const { return attempt_ != Attempt::none; }

  [[nodiscard]] const CanBusLoad& load() const { return load_; }
  [[nodiscard]] std::uint64_t frames() const { return frames_; }
  [[nodiscard]] std::uint64_t error_frames() const { return error_frames_; }
  /// Arbitrations that two nodes would have won.
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
  std::vector<Contender> contenders_;  ///< Of the attempt: those whose frame goes onto the wire,
  std::vector<Contender> losers_;      ///< and one-shot controllers that lost at once.
  Attempt attempt_ = Attempt::none;
  bool told_ = false;              ///< Nodes know of what has happened in it.
  SimTime loaded_until_ = kStart;  ///< What `load_` has been told.
  mutable bool stale_ = true;
  mutable SimTime next_ = kNever;
  std::uint64_t frames_ = 0;
  std::uint64_t error_frames_ = 0;
  std::uint64_t collisions_ = 0;
};

}  // namespace rigwire::emulators
