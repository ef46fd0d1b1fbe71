// The configuration store of an emulated u-blox receiver: what a client may poll and set by
// UBX-CFG, with the defaults, acknowledgements and refusals of the real device.
//
// Three layers, as in the device: defaults of the firmware, what CFG-CFG saved in battery-backed
// memory, and what is in force.
//
// Source: u-blox M8 receiver description, UBX-13003221 R28, section 32.10 "UBX-CFG" and section 3
// "Receiver configuration"; the table of refused ids from a complete poll of a NEO-7P.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "emulators/ublox/configuration_state.h"
#include "emulators/ublox/key_store.h"
#include "emulators/ublox/settings.h"
#include "protocols/ubx/configuration.h"

namespace rigwire::emulators {

class UbloxConfiguration {
 public:
  explicit UbloxConfiguration(const UbloxSettings& settings);

  /// True when the payload of this CFG message asks for its state rather than setting it.
  [[nodiscard]] bool is_poll(const protocols::ubx::FrameView& frame) const;

  /// Payload of the answer to a poll; nothing when it is refused. Valid until the next call.
  [[nodiscard]] std::optional<std::span<const std::uint8_t>> poll(
      const protocols::ubx::FrameView& frame);

  /// Carries out a set; false when it is refused, and then nothing has changed. CFG-RST is not
  /// handled here.
  [[nodiscard]] bool set(const protocols::ubx::FrameView& frame);

  /// One rate of CFG-MSG; false when the message or port is unknown.
  bool set_rate(std::size_t message_index, std::size_t port, std::uint8_t rate);
  bool set_port(const protocols::ubx::CfgPrt& port);

  /// After a reset the saved state is in force again.
  void reload();
  /// The battery-backed memory lost its supply.
  void forget();

  [[nodiscard]] const UbloxProfile& profile() const { return *profile_; }
  [[nodiscard]] const UbloxConfigurationState& present() const { return present_; }
  [[nodiscard]] const protocols::ubx::CfgPrt& uart() const {
    return present_.ports[protocols::ubx::kPortUart1];
  }
  [[nodiscard]] const protocols::ubx::CfgRate& rate() const { return present_.rate; }
  [[nodiscard]] const protocols::ubx::CfgNav5& navigation() const { return present_.nav5; }
  [[nodiscard]] const protocols::ubx::CfgNavx5& expert() const { return present_.navx5; }
  [[nodiscard]] const protocols::ubx::CfgOdo& odometer() const { return present_.odometer; }
  [[nodiscard]] const protocols::ubx::CfgNmea& nmea() const { return present_.nmea; }
  [[nodiscard]] const protocols::ubx::CfgSbas& sbas() const { return present_.sbas; }
  [[nodiscard]] const protocols::ubx::CfgPrt& second_uart() const {
    return present_.ports[protocols::ubx::kPortUart2];
  }
  [[nodiscard]] std::uint8_t message_rate(std::size_t message_index, std::size_t port) const {
    return present_.rates[message_index][port];
  }
  /// Rate of a message of the profile on the UART; 0 = off.
  [[nodiscard]] std::uint8_t message_rate(std::size_t message_index) const {
    return present_.rates[message_index][protocols::ubx::kPortUart1];
  }
  /// Texts of that kind (bit of CFG-INF) over a protocol: 0 UBX, 1 NMEA.
  [[nodiscard]] bool text_enabled(std::uint8_t protocol, unsigned kind_bit) const;
  [[nodiscard]] bool enabled(GnssSystem system) const;
  /// Its second signal: L2C, E5b, B2I, L2OF.
  [[nodiscard]] bool second_enabled(GnssSystem system) const;

 private:
  // Ports and memory.
  [[nodiscard]] bool set_ports(std::span<const std::uint8_t> payload);
  [[nodiscard]] bool set_message(std::span<const std::uint8_t> payload);
  [[nodiscard]] bool set_information(std::span<const std::uint8_t> payload);
  [[nodiscard]] bool set_store(std::span<const std::uint8_t> payload);
  // Navigation and sentences.
  [[nodiscard]] bool set_rate(const protocols::ubx::CfgRate& wanted);
  [[nodiscard]] bool set_navigation(const protocols::ubx::CfgNav5& wanted);
  [[nodiscard]] bool set_expert(const protocols::ubx::CfgNavx5& wanted);
  [[nodiscard]] bool set_odometer(const protocols::ubx::CfgOdo& wanted);
  [[nodiscard]] bool set_base(const protocols::ubx::CfgTmode3& wanted);
  [[nodiscard]] bool set_systems(std::span<const std::uint8_t> payload);
  [[nodiscard]] bool set_sentences(std::span<const std::uint8_t> payload);
  [[nodiscard]] bool set_pulse(const protocols::ubx::CfgTp5& wanted);
  [[nodiscard]] bool set_datum(std::span<const std::uint8_t> payload);
  [[nodiscard]] bool set_inventory(std::span<const std::uint8_t> payload);
  [[nodiscard]] bool set_opaque(const protocols::ubx::FrameView& frame);
  [[nodiscard]] std::span<std::uint8_t> opaque(protocols::ubx::MessageId id);

  [[nodiscard]] std::uint32_t flags_of(GnssSystem system) const;

  template <class Message>
  std::span<const std::uint8_t> reply(const Message& message);
  [[nodiscard]] std::span<const std::uint8_t> reply_systems();
  [[nodiscard]] std::span<const std::uint8_t> reply_sentences();

  const UbloxProfile* profile_;
  UbloxConfigurationState default_;
  UbloxConfigurationState saved_;
  UbloxConfigurationState present_;
  std::optional<UbloxKeyStore> keys_;  ///< Where the type has CFG-VALSET.
  std::array<std::uint8_t, 1024> reply_{};
};

}  // namespace rigwire::emulators
