// The bus side of a node that is described by a DBC file: when its frames go out, what they
// contain, and what the frames that it takes ask for. Knows numbers only; what they are, and of
// which machine, is dbc_node.h's.
//
// A message goes out by time, on change, on request, after another one that came in, or several of
// these. A frame is put together when it is due: start values first, then what was measured last,
// counters, checksums. In a multiplexed message whose multiplexor shows nothing of its own, each
// frame has the next of the values that the file knows. Bits of no signal are 0, in J1939 1.
//
// A frame that is taken is refused as malformed when it is too short (not J1939, where what is left
// out is not available), when a checksum is wrong, or when a counter is not one more than in the
// last. What it asks for holds until the next one, or until the message's time-out; then, and
// before the first, the safe values do. A J1939 signal that is "not available" changes nothing, one
// that says "error" is safe.
//
// Off its supply a node sends and takes nothing; when it comes back it begins anew.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "emulators/dbc_node/settings.h"
#include "emulators/device.h"
#include "emulators/firmware_fault.h"
#include "emulators/j1939/j1939_node.h"

namespace rigwire::emulators {

class DbcTraffic final : J1939Application {
 public:
  /// `output` must outlive it. Throws std::invalid_argument for faults of messages or signals that
  /// are not there, and as validate(SupplySettings).
  DbcTraffic(const DbcNodeSettings& settings, FrameOutput& output);

  void advance(SimTime now);
  [[nodiscard]] SimTime next_event() const;
  void receive(SimTime now, const protocols::can::Frame& frame);
  void controller(SimTime now, const protocols::can::ControllerReport& report);
  /// In the order of DbcNodeSettings::measured, in SI; NaN: not available.
  void measure(SimTime now, std::span<const double> values);

  /// In the order of DbcNodeSettings::moved, in SI.
  [[nodiscard]] std::span<const double> moved() const { return moved_; }
  [[nodiscard]] ReceiveCounters received() const;
  /// Frames that go out by time, per second.
  [[nodiscard]] double nominal_rate_hz() const;
  /// The address it holds; kNullAddress without one, or when it claims none.
  [[nodiscard]] std::uint8_t address() const;

  [[nodiscard]] const DbcNodeSettings& settings() const { return settings_; }
  /// Adds a fault. Throws std::invalid_argument for a message or signal that the node does not
  /// have.
  DbcNodeFaults::Id begin(const DbcNodeFault& fault);
  /// Ends a fault from `now` on. Returns false if there is none of that number or it is over.
  bool end(DbcNodeFaults::Id id, SimTime now) { return faults_.end(id, now); }
  [[nodiscard]] Supply& supply() { return supply_; }
  [[nodiscard]] Pace& pace() { return pace_; }

 private:
  struct SentState {
    SimTime next_cycle = kNever;
    /// When a requested frame, delayed by the minimum distance, is due.
    SimTime next_extra = kNever;
    SimTime last = kNever;           ///< When the last one was sent; kNever: none yet.
    bool shown = false;              ///< `body` has been sent.
    std::vector<std::uint8_t> body;  ///< Bytes of the last message, without counters and checksums.
    std::vector<std::uint64_t> raw;  ///< By signal: raw value shown.
    std::vector<double> filtered;    ///< By signal.
    std::vector<std::size_t> order;  ///< Order of encoding: signals that others depend on first.
    std::size_t turning = protocols::can::kNoMultiplexor;  ///< A multiplexor without a source.
    std::vector<std::uint64_t> pages;                      ///< Its values that the file knows.
    std::size_t page = 0;
    std::size_t shown_page = 0;  ///< Page of the last message.
  };
  struct TakenState {
    SimTime expires = kNever;
    std::vector<std::optional<std::uint64_t>> raw;  ///< By signal; nullopt: not yet received.
  };

  J1939Answer answer(SimTime now, std::uint32_t pgn, std::uint8_t destination) override;
  J1939Reception take(SimTime now, const J1939Message& message) override;

  void power_up(SimTime now);
  void power_down();
  void request(SimTime now, std::size_t message);
  /// Whether the frame asks a message for itself that is none of a claimed address's.
  [[nodiscard]] bool is_plain(const protocols::can::Frame& frame) const;
  void send(SimTime now, std::size_t message);
  bool transmit(SimTime now, const protocols::can::OwnedMessage& layout,
                std::span<const std::uint8_t> payload);
  /// Fills `body`: everything but counters and checksums.
  void compose(SimTime now, std::size_t message, std::vector<std::uint8_t>& body);
  [[nodiscard]] std::uint64_t shown(std::size_t message, std::size_t signal) const;
  void filter(Duration step);
  void note_changes(SimTime now);
  J1939Reception take_payload(SimTime now, std::size_t message,
                              std::span<const std::uint8_t> payload);
  [[nodiscard]] bool is_sound(std::size_t message, std::span<const std::uint8_t> payload) const;
  void move(const DbcMove& use, const protocols::can::Coding& layout,
            std::span<const std::uint8_t> payload);
  void make_safe(std::size_t message);
  template <class Fault>
  [[nodiscard]] const Fault* fault_of(SimTime now, std::size_t message, std::size_t signal) const;

  DbcNodeSettings settings_;
  FrameOutput& output_;
  DbcNodeFaults faults_;
  Supply supply_;
  Pace pace_;
  std::optional<J1939Node> node_;
  SimTime measured_at_ = kNever;
  std::vector<double> measured_;
  std::vector<double> moved_;
  std::vector<SentState> sent_;
  std::vector<TakenState> taken_;
  std::vector<std::uint8_t> scratch_;
  std::vector<std::uint64_t> raw_scratch_;
  ReceiveCounters received_;
};

}  // namespace rigwire::emulators
