// What happens on a segment, bit by bit, when a frame does not simply go well.
//
// Every node is a small machine: it sends, reads, signals an error, waits for the bus to become
// recessive, counts its error delimiter. The level of each bit is the wired-and of what they all
// send, then inverted or shorted by what is wrong with the wire. So collisions, superposed error
// flags of 6 to 12 bits, error flags of passive nodes, missing acknowledgements and their cost in
// bits follow from the rules instead of being listed.
//
// Source: ISO 11898-1:2015, 10.4.4 (error frame), 10.11 (error detection), 12.1.4 (which counter
// moves when). From the last bit of the frame or of the last error delimiter on the bus is free
// after an intermission of three bits.
//
// Simplified: nodes end an error together, when the last one has its delimiter (a passive one whose
// flag no other node sees does not hold up the others' good frame); of overload frames only the one
// that answers a dominant last bit of the end of frame exists; a node with another bit rate counts
// its error flag in its own bits and its delimiter in the segment's.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "emulators/can/can_controller.h"
#include "protocols/can/wire_frame.h"
#include "sim/samples/time.h"

namespace rigwire::emulators {

/// Where a bus is in its bits, as exact simulated time.
///
/// Positions are whole bits since the last synchronisation, never sums of rounded spans: an instant
/// is rounded once, to the nearest nanosecond, whatever the bit rate and however long the bus has
/// been busy.
class CanBitClock {
 public:
  explicit CanBitClock(std::uint32_t bit_rate_bps) : rate_(bit_rate_bps) {}

  /// The present position: begin of a frame, or the bit from which the bus is free.
  [[nodiscard]] SimTime now() const { return after(0); }
  /// Returns the begin of the bit that is `bits` after now(). Precondition: bits < 2^33.
  [[nodiscard]] SimTime after(std::uint64_t bits) const { return anchor_ + span(bit_ + bits); }
  /// Returns the length of `bits` bits, to the nearest nanosecond. Precondition: bits < 2^34.
  [[nodiscard]] Duration span(std::uint64_t bits) const {
    return Duration{static_cast<std::int64_t>((bits * kSecond_ns + rate_ / 2) / rate_)};
  }
  /// Returns the number of bits in a span, to the nearest; spans beyond a second count as one
  /// second. Precondition: not negative.
  [[nodiscard]] std::uint64_t bits_in(Duration span) const {
    const auto ns = static_cast<std::uint64_t>(span.count());
    return ((ns < kSecond_ns ? ns : kSecond_ns) * rate_ + kSecond_ns / 2) / kSecond_ns;
  }

  void advance(std::uint64_t bits) {
    bit_ += bits;
    while (bit_ >= rate_) {
      bit_ -= rate_;
      anchor_ += Duration{static_cast<std::int64_t>(kSecond_ns)};
    }
  }
  /// A frame begins on an idle bus: everybody synchronises to its edge.
  void synchronise(SimTime instant) {
    anchor_ = instant;
    bit_ = 0;
  }
  [[nodiscard]] std::uint32_t bit_rate_bps() const { return static_cast<std::uint32_t>(rate_); }

 private:
  static constexpr std::uint64_t kSecond_ns = 1'000'000'000;
  std::uint64_t rate_;
  SimTime anchor_ = kStart;
  std::uint64_t bit_ = 0;  ///< Since anchor_, below rate_.
};

/// A frame as nodes with the segment's bit rate read it off the wire.
///
/// That of a sender with the same rate is the frame itself. One with another rate is sampled at
/// 80 % of each of the segment's bits, from the edge of its start of frame on, without
/// resynchronisation.
class CanWireView {
 public:
  CanWireView() = default;
  CanWireView(const protocols::can::Frame& frame, std::uint32_t sender_bps,
              std::uint32_t segment_bps)
      : wire_(frame), sender_bps_(sender_bps), segment_bps_(segment_bps) {}

  [[nodiscard]] bool readable() const { return sender_bps_ == segment_bps_; }
  [[nodiscard]] const protocols::can::WireFrame& wire() const { return wire_; }
  /// The sender's bit in the segment's bit of that number.
  [[nodiscard]] unsigned bit_at(unsigned bit) const {
    return readable() ? bit : sampled(bit, segment_bps_, sender_bps_);
  }
  [[nodiscard]] bool recessive(unsigned bit) const { return wire_.recessive(bit_at(bit)); }

  /// In which of the segment's bits a node with another rate finds the frame wrong: a stuff error
  /// in what it samples, or the checksum at the end.
  [[nodiscard]] unsigned misread_at(std::uint32_t reader_bps) const {
    unsigned run = 0;
    bool last = true;
    for (unsigned sample = 0;; ++sample) {
      const unsigned bit = sampled(sample, reader_bps, segment_bps_);
      const bool level = recessive(bit);
      run = level == last && run > 0 ? run + 1 : 1;
      last = level;
      if (run == 6 || bit_at(bit) > wire_.acknowledge_slot()) {
        return bit;
      }
    }
  }

 private:
  static constexpr unsigned sampled(unsigned bit, std::uint32_t reader_bps,
                                    std::uint32_t writer_bps) {
    return static_cast<unsigned>((bit * 10ULL + 8U) * writer_bps / (10ULL * reader_bps));
  }

  protocols::can::WireFrame wire_;
  std::uint32_t sender_bps_ = 1;
  std::uint32_t segment_bps_ = 1;
};

/// What is wrong with the wire during one attempt; bits from start of frame 0.
struct CanLineState {
  static constexpr unsigned kNoBit = ~0U;
  unsigned inverted_bit = kNoBit;
  unsigned short_begin = kNoBit;  ///< Recessive whatever is sent, in [short_begin, short_end).
  unsigned short_end = kNoBit;

  [[nodiscard]] bool clean() const { return inverted_bit == kNoBit && short_begin == kNoBit; }
};

struct CanHappening {
  enum class Kind : std::uint8_t {
    error,     ///< With a rule and a report.
    failed,    ///< The own frame ended in the error before.
    lost,      ///< Arbitration.
    sent,      ///< The own frame is complete.
    received,  ///< The frame of another is complete.
  };
  CanController* node = nullptr;
  Kind kind = Kind::error;
  CanErrorRule rule = CanErrorRule::none;
  protocols::can::ControllerReport report;
};

class CanBitLevel {
 public:
  explicit CanBitLevel(std::uint32_t segment_bps) : segment_bps_(segment_bps) {}

  /// Room for so many nodes.
  void reserve(std::size_t nodes);
  /// Begins an attempt; then add every node that takes part, transmitters first. Nothing happens
  /// before `first_bit`, up to which all transmitters send the same.
  void begin(const CanLineState& line, unsigned first_bit);
  void add_transmitter(CanController& node, const protocols::can::Frame& frame);
  void add_receiver(CanController& node);

  /// Advances to the next bit in which something happens. Returns false when nothing more does;
  /// length() is then known. The nodes must be notified of the happenings before the next call.
  [[nodiscard]] bool run();
  [[nodiscard]] std::span<const CanHappening> happenings() const { return happenings_; }
  /// The bit in which they happened; the nodes know of them at its end.
  [[nodiscard]] unsigned bit() const { return bit_ - 1; }
  /// Bits from start of frame until the bus is free.
  [[nodiscard]] unsigned length() const { return length_; }
  /// Number of the transmitter whose frame receivers read, in the order of adding.
  [[nodiscard]] std::size_t read_transmitter() const { return read_; }
  /// The first bit after the last dominant one.
  [[nodiscard]] unsigned recessive_from() const { return recessive_from_; }

 private:
  enum class Does : std::uint8_t {
    transmit,
    receive,
    active_flag,
    passive_flag,
    await_recessive,  ///< Between error flag and delimiter.
    delimiter,
    nothing,
  };
  struct Party {
    CanController* node = nullptr;
    Does does = Does::receive;
    bool own = false;           ///< It was the transmitter when its error occurred.
    bool overload = false;      ///< What looks like an error flag is none: nothing is counted.
    bool acknowledged = false;  ///< Transmitter: the slot is behind it.
    bool unacknowledged_passive = false;  ///< Counts only if a dominant bit hits its passive flag.
    bool first_after_flag = false;
    /// Bits counted in the present state: of the flag, of the delimiter, or equal bits of a passive
    /// flag.
    unsigned count = 0;
    bool equal_to = true;    ///< Passive flag: the level of the equal bits counted.
    unsigned dominants = 0;  ///< Dominant bits since the own flag ended.
    unsigned flag_bits = 6;
    unsigned misreads_at = CanLineState::kNoBit;  ///< A receiver with another bit rate.
    std::uint16_t view = 0;                       ///< Transmitter.
  };

  [[nodiscard]] bool busy() const;
  [[nodiscard]] const CanWireView& read() const { return views_[read_]; }
  void choose_what_is_read();
  [[nodiscard]] bool sends_recessive(const Party& party) const;
  void observe(Party& party, bool level);
  void observe_transmitter(Party& party, bool level);
  void observe_receiver(Party& party, bool level);
  void observe_passive_flag(Party& party, bool level);
  void observe_after_flag(Party& party, bool level);
  void report_error(Party& party, protocols::can::BusError error, CanErrorRule rule,
                    bool dominant = false);
  void tell(Party& party, CanHappening::Kind kind);
  void fail(Party& party);
  void signal(Party& party);
  void penalise(Party& party);
  void finish(Party& party);

  std::uint32_t segment_bps_;
  CanLineState line_;
  std::vector<Party> parties_;
  std::vector<CanWireView> views_;  ///< Frames on the wire, one per transmitter.
  std::size_t read_ = 0;            ///< Index of the view that receivers read.
  std::vector<CanHappening> happenings_;
  unsigned bit_ = 0;  ///< The next one.
  unsigned run_ = 0;  ///< Equal bits on the wire, since the start of frame was seen.
  bool last_ = true;
  bool seen_ = false;       ///< A start of frame was on the wire.
  bool readable_ = true;    ///< ... and in its place, by a sender with the segment's rate.
  bool corrupted_ = false;  ///< What was read up to the CRC is not what was to be sent.
  /// All transmitters have the segment's. Those with different ones would not stay in step as they
  /// do here, so nothing is excused.
  bool one_rate_ = true;
  bool complete_ = false;  ///< A frame went well: the bus is free after its intermission.
  unsigned length_ = 0;
  unsigned recessive_from_ = 0;
};

}  // namespace rigwire::emulators
