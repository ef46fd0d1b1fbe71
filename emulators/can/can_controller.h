// The CAN controller of one node: transmit queue, error counters, bus-off and the way back from it.
//
// It knows nothing of bits: the segment that it is connected to (can_segment.h) reports what became
// of frames and which rule of fault confinement applies.
//
// - At bus-off everything that waits is given up, and so is what the host offers until the
//   controller is back.
// - Recovery takes 128 sequences of 11 recessive bits from the instant at which it begins. It
//   begins CanNodeSettings::restart_after later, or when the host asks (ISO 11898-1:2015,
//   12.1.4.4).
// - A controller in listen-only mode has error counters that do not change.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>

#include "emulators/can/can_node.h"
#include "emulators/can/can_transmit_queue.h"
#include "emulators/device.h"
#include "protocols/can/controller_report.h"

namespace rigwire::emulators {

/// Error counter that an event on the bus changes.
enum class CanErrorRule : std::uint8_t {
  none,            ///< Seen, not counted: the exceptions of the standard.
  transmit,        ///< Transmit counter + 8.
  receive,         ///< Receive counter + 1.
  severe_receive,  ///< Receive counter + 8.
};

/// The two error counters of a CAN controller and what follows from them.
///
/// Source: ISO 11898-1:2015, 12.1.4 (fault confinement). CanBitLevel decides which rule applies to
/// which node and when; this class applies it to the counters.
class CanFaultConfinement {
 public:
  static constexpr unsigned kWarning = 96;
  static constexpr unsigned kPassive = 128;
  static constexpr unsigned kBusOff = 256;
  /// A successful reception leaves a passive receiver with a value of 119 .. 127: this one.
  static constexpr unsigned kAfterReception = 127;
  /// Limit of the receive counter, which need not count beyond the threshold of error passive.
  static constexpr unsigned kMostReceiveErrors = 255;

  void transmit_error() { transmit_errors_ = std::min(transmit_errors_ + 8, kBusOff); }
  void transmitted() { transmit_errors_ -= bus_off() || transmit_errors_ == 0 ? 0U : 1U; }
  void receive_error() { add_receive_errors(1); }
  /// Counts a dominant first bit after the own error flag, or an error that counts the same.
  void severe_receive_error() { add_receive_errors(8); }
  void received() {
    if (receive_errors_ >= kPassive) {
      receive_errors_ = kAfterReception;
    } else if (receive_errors_ > 0) {
      --receive_errors_;
    }
  }
  /// After power-on and after recovery from bus-off.
  void reset() { transmit_errors_ = receive_errors_ = 0; }

  /// 0 .. 256.
  [[nodiscard]] std::uint16_t transmit_errors() const {
    return static_cast<std::uint16_t>(transmit_errors_);
  }
  /// 0 .. 255.
  [[nodiscard]] std::uint16_t receive_errors() const {
    return static_cast<std::uint16_t>(receive_errors_);
  }
  [[nodiscard]] bool bus_off() const { return transmit_errors_ >= kBusOff; }
  /// Whether error flags are recessive.
  [[nodiscard]] bool passive() const {
    return transmit_errors_ >= kPassive || receive_errors_ >= kPassive;
  }
  [[nodiscard]] protocols::can::ErrorState state() const {
    using protocols::can::ErrorState;
    const unsigned greater = std::max(transmit_errors_, receive_errors_);
    return bus_off()             ? ErrorState::bus_off
           : greater >= kPassive ? ErrorState::passive
           : greater >= kWarning ? ErrorState::warning
                                 : ErrorState::active;
  }

 private:
  void add_receive_errors(unsigned count) {
    receive_errors_ = std::min(receive_errors_ + count, kMostReceiveErrors);
  }

  unsigned transmit_errors_ = 0;
  unsigned receive_errors_ = 0;
};

class CanController final : public FrameOutput {
 public:
  /// `exit` is nullptr for the client's. Settings without their defaults.
  CanController(const CanNodeSettings& settings, FrameOutput* exit);

  void attach(CanDevice& device) { device_ = &device; }
  void attach(CanOutside& outside) { outside_ = &outside; }
  [[nodiscard]] const CanNodeSettings& settings() const { return settings_; }
  [[nodiscard]] FrameOutput* exit() const { return exit_; }
  [[nodiscard]] bool is_outside() const { return exit_ == nullptr; }
  [[nodiscard]] bool is_open() const { return open_; }

  // ---- The host's side.
  void send(SimTime due, const protocols::can::Frame& frame) override;
  /// Opens, closes or sets the controller otherwise; its counters begin anew.
  void configure(SimTime now, const OutsideController& client, std::uint32_t bus_rate_bps);
  /// Begins recovery when it is bus-off, at once.
  void restart(SimTime now);
  /// The host's clock is wrong by a fault; nullopt: it is right again.
  void override_rate(std::optional<std::uint32_t> bit_rate_bps) { overridden_rate_ = bit_rate_bps; }

  // ---- The segment's side.
  /// `*stale` becomes true when next_start() or next_event() may have changed.
  void connect(SimTime now, bool* stale);
  [[nodiscard]] std::uint32_t bit_rate_bps() const {
    return overridden_rate_.value_or(settings_.bit_rate_bps);
  }
  [[nodiscard]] bool takes_part() const { return open_ && !confinement_.bus_off(); }
  [[nodiscard]] bool acknowledges() const { return takes_part() && !settings_.listen_only; }
  [[nodiscard]] bool passive() const { return confinement_.passive(); }
  /// From when on it has a frame to send, were the bus free.
  [[nodiscard]] SimTime next_start() const {
    return acknowledges() ? std::max(queue_.ready(), available_from_) : kNever;
  }
  /// It sent last and is passive, so it waits eight bits longer than others.
  [[nodiscard]] bool suspended() const { return suspended_; }
  void set_suspended(bool suspended) { suspended_ = suspended && passive(); }

  [[nodiscard]] const CanWaitingFrame& offered(SimTime now) { return queue_.front(now); }
  /// What was offered then goes onto the wire at `start`.
  void begin(SimTime start, SimTime offered_at);
  /// A more urgent frame of another node goes instead; nothing was begun.
  void lose_arbitration() { ++counters_.arbitration_losses; }
  /// Reports the outcome of the frame on the wire; ignored if the frame was given up meanwhile
  /// (bus-off, the client closed).
  void sent(SimTime now);
  void failed(SimTime now);
  /// Arbitration, at that bit (see ControllerReport). A one-shot controller gives the frame up.
  void lost(SimTime now, std::uint8_t bit, protocols::can::FrameField field);
  /// A frame of another node is complete and good.
  void receive(SimTime now, const protocols::can::Frame& frame, bool from_outside);
  /// An error, or with BusError::none a rule that applies without a new one. `report` says what is
  /// known of it; state and counters are filled in here.
  void count_error(SimTime now, CanErrorRule rule, protocols::can::ControllerReport report);

  /// The end of the wait in bus-off, kNever when there is none. Then begin_recovery().
  [[nodiscard]] SimTime restart_at() const { return restart_at_; }
  void begin_recovery(SimTime now);
  [[nodiscard]] bool recovering() const { return recovering_; }
  /// Sequences of eleven recessive bits that are still to come, from recessive_since() on.
  [[nodiscard]] unsigned sequences_left() const { return sequences_left_; }
  [[nodiscard]] SimTime recessive_since() const { return recessive_since_; }
  /// A frame begins: the run of recessive bits ends after so many.
  void end_recessive_run(std::uint64_t bits);
  void begin_recessive_run(SimTime instant) {
    recessive_since_ = std::max(recessive_since_, instant);
  }
  void recover(SimTime now);

  [[nodiscard]] CanNodeCounters counters() const;
  [[nodiscard]] const std::optional<CanRequest>& last_request() const { return last_request_; }
  [[nodiscard]] protocols::can::ControllerReport status() const;

  static constexpr unsigned kRecoverySequences = 128;
  static constexpr unsigned kSequenceBits = 11;

 private:
  void announce(SimTime now, protocols::can::ControllerReport report);
  void settle(SimTime now, const CanWaitingFrame& frame, bool was_sent);
  void refuse(SimTime now);
  void give_up_all(SimTime now);
  void wake() {
    if (stale_ != nullptr) {
      *stale_ = true;
    }
  }

  CanNodeSettings settings_;
  FrameOutput* exit_;
  CanDevice* device_ = nullptr;
  std::optional<CanRequest> last_request_;
  CanOutside* outside_ = nullptr;
  bool* stale_ = nullptr;
  CanTransmitQueue queue_;
  std::optional<CanWaitingFrame> on_wire_;
  SimTime start_of_frame_ = kStart;
  CanFaultConfinement confinement_;
  protocols::can::ErrorState announced_ = protocols::can::ErrorState::active;
  std::optional<std::uint32_t> overridden_rate_;
  bool open_ = true;
  bool suspended_ = false;
  bool recovering_ = false;
  SimTime available_from_ = kStart;
  SimTime restart_at_ = kNever;
  SimTime recessive_since_ = kStart;
  unsigned sequences_left_ = 0;
  CanNodeCounters counters_;
};

}  // namespace rigwire::emulators
