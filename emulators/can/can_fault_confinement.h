// The two error counters of a CAN controller and what follows from them.
//
// Source: ISO 11898-1:2015, 12.1.4 (fault confinement). Which rule applies to whom and when is the
// bit level's business (can_bit_level.h); here is what each does to the counters.
#pragma once

#include <algorithm>
#include <cstdint>

#include "protocols/can/controller_report.h"

namespace rigwire::emulators {

class CanFaultConfinement {
 public:
  static constexpr unsigned kWarning = 96;
  static constexpr unsigned kPassive = 128;
  static constexpr unsigned kBusOff = 256;
  /// A successful reception leaves a passive receiver with a value of 119 .. 127: this one.
  static constexpr unsigned kAfterReception = 127;
  /// Of the receive counter, which need not count further than it takes to be passive.
  static constexpr unsigned kMostReceiveErrors = 255;

  void transmit_error() { transmit_errors_ = std::min(transmit_errors_ + 8, kBusOff); }
  void transmitted() { transmit_errors_ -= bus_off() || transmit_errors_ == 0 ? 0U : 1U; }
  void receive_error() { add_receive_errors(1); }
  /// The first bit after the own error flag is dominant, and its like.
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

}  // namespace rigwire::emulators
