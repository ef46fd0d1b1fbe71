// The configuration store of an emulated NEO-7P: what a client may poll and set by UBX-CFG, with
// the defaults, acknowledgements and refusals of the real device.
//
// Source: u-blox M8 receiver description, UBX-13003221 R28, section 32.10 "UBX-CFG" and section 3
// "Receiver configuration"; defaults and the table of refused ids from a complete poll of a NEO-7P.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "emulators/ublox/settings.h"
#include "protocols/ubx/configuration.h"

namespace rigwire::emulators {

class UbloxConfiguration {
 public:
  explicit UbloxConfiguration(const UbloxSettings& settings);

  /// True when the payload of this CFG message asks for its state rather than setting it.
  [[nodiscard]] static bool is_poll(const protocols::ubx::FrameView& frame);

  /// Payload of the answer to a poll; nothing when it is refused. Valid until the next call.
  [[nodiscard]] std::optional<std::span<const std::uint8_t>> poll(
      const protocols::ubx::FrameView& frame);

  /// Carries out a set; false when it is refused, and then nothing has changed. CFG-RST is not
  /// handled here.
  [[nodiscard]] bool set(const protocols::ubx::FrameView& frame);

  /// One rate of CFG-MSG; false when the message is not produced.
  bool set_rate(std::size_t message_index, std::size_t port, std::uint8_t rate);
  bool set_port(const protocols::ubx::CfgPrt& port);

  /// After a reset the saved state is in force again.
  void reload() { present_ = saved_; }

  [[nodiscard]] const protocols::ubx::CfgPrt& uart() const {
    return present_.ports[protocols::ubx::kPortUart1];
  }
  [[nodiscard]] const protocols::ubx::CfgRate& rate() const { return present_.rate; }
  [[nodiscard]] const protocols::ubx::CfgNav5& navigation() const { return present_.nav5; }
  [[nodiscard]] const protocols::ubx::CfgNmea& nmea() const { return present_.nmea; }
  /// Rate of a message of ublox_messages() on the UART; 0 = off.
  [[nodiscard]] std::uint8_t message_rate(std::size_t message_index) const {
    return present_.rates[message_index][protocols::ubx::kPortUart1];
  }
  [[nodiscard]] bool text_enabled(unsigned kind_bit) const;
  [[nodiscard]] bool gps_enabled() const;

 private:
  static constexpr std::size_t kSystems = 4;
  static constexpr std::size_t kMaximumMessages = 64;
  using Rates = std::array<std::uint8_t, protocols::ubx::kPorts>;

  struct State {
    std::array<protocols::ubx::CfgPrt, 5> ports{};
    std::array<Rates, kMaximumMessages> rates{};
    std::array<protocols::ubx::CfgInf, 3> information{};
    protocols::ubx::CfgRate rate;
    protocols::ubx::CfgNav5 nav5;
    protocols::ubx::CfgNavx5 navx5;
    protocols::ubx::CfgNmea nmea;
    protocols::ubx::CfgSbas sbas;
    protocols::ubx::CfgAnt antenna;
    protocols::ubx::CfgRxm power;
    std::array<protocols::ubx::CfgTp5, 2> pulses{};
    protocols::ubx::CfgGnssHead gnss;
    std::array<protocols::ubx::CfgGnssBlock, kSystems> systems{};
  };

  [[nodiscard]] bool set_ports(std::span<const std::uint8_t> payload);
  [[nodiscard]] bool set_message(std::span<const std::uint8_t> payload);
  [[nodiscard]] bool set_information(std::span<const std::uint8_t> payload);
  [[nodiscard]] bool set_rate(const protocols::ubx::CfgRate& wanted);
  [[nodiscard]] bool set_navigation(const protocols::ubx::CfgNav5& wanted);
  [[nodiscard]] bool set_expert(const protocols::ubx::CfgNavx5& wanted);
  [[nodiscard]] bool set_systems(std::span<const std::uint8_t> payload);
  [[nodiscard]] bool set_store(std::span<const std::uint8_t> payload);

  template <class Message>
  std::span<const std::uint8_t> reply(const Message& message);

  State default_;
  State saved_;
  State present_;
  std::array<std::uint8_t, 64> reply_{};
};

}  // namespace rigwire::emulators
