// The requests of chapter 9, which every USB device answers alike.
//
// Answered: GET_DESCRIPTOR (device, configuration, strings), GET and SET_CONFIGURATION, GET and
// SET_INTERFACE, GET_STATUS, SET and CLEAR_FEATURE (endpoint halt), SET_ADDRESS. Answers are as
// long as asked for and no longer. Everything else stalls, which is also how a full-speed device
// says that it has no other speed (device qualifier, 9.6.2), and how a device without remote
// wake-up answers when asked to switch it on. Requests of the right number with a wrong direction,
// value, index or length stall, too (9.4 leaves their effect open).
//
// Source: Universal Serial Bus Specification 2.0, 9.4.
#pragma once

#include <array>
#include <bitset>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "emulators/usb/usb_device.h"
#include "protocols/usb/descriptors.h"
#include "protocols/usb/transfer.h"

namespace rigwire::emulators {

class UsbStandardRequests {
 public:
  /// `device` must outlive this. Throws std::invalid_argument when its description is not valid.
  explicit UsbStandardRequests(UsbDevice& device);

  /// Back to the state after power-on: no configuration, no halt.
  void reset();

  /// How a request ended; `data` goes to the host, already cut to setup.length.
  struct Answer {
    protocols::usb::Outcome outcome = protocols::usb::Outcome::stalled;
    std::span<const std::uint8_t> data;  ///< Valid until the next request.
  };
  /// Nothing when the request is the device's own: class and vendor requests, and descriptors of
  /// an interface's class. Notifies the device of configurations and alternate settings.
  [[nodiscard]] std::optional<Answer> answer(SimTime now, const protocols::usb::Setup& setup);

  /// Selected by SET_CONFIGURATION; 0 at first.
  [[nodiscard]] std::uint8_t configuration() const { return configuration_; }
  /// The endpoint in the present configuration and alternate settings; null when there is none.
  [[nodiscard]] const protocols::usb::EndpointDescription* endpoint(std::uint8_t address) const;
  [[nodiscard]] bool halted(std::uint8_t address) const { return halted_.test(index_of(address)); }
  [[nodiscard]] const protocols::usb::DescriptorBytes& descriptors() const { return descriptors_; }

 private:
  using Setup = protocols::usb::Setup;

  /// 0 .. 15 OUT, 16 .. 31 IN.
  static std::size_t index_of(std::uint8_t address) {
    return (address & 0x0FU) | ((address & protocols::usb::kToHost) != 0 ? 0x10U : 0U);
  }
  [[nodiscard]] bool has_interface(std::uint16_t index) const;
  [[nodiscard]] bool has_endpoint(std::uint16_t index) const;
  [[nodiscard]] Answer cut(const Setup& setup, std::span<const std::uint8_t> bytes) const;
  [[nodiscard]] Answer descriptor(const Setup& setup) const;
  [[nodiscard]] Answer status(const Setup& setup);
  [[nodiscard]] Answer feature(const Setup& setup, bool on);
  [[nodiscard]] Answer set_configuration(SimTime now, const Setup& setup);
  [[nodiscard]] Answer get_interface(const Setup& setup);
  [[nodiscard]] Answer set_interface(SimTime now, const Setup& setup);

  UsbDevice& device_;
  protocols::usb::DescriptorBytes descriptors_;
  std::uint8_t configuration_ = 0;
  std::vector<std::uint8_t> alternates_;  ///< By interface.
  std::bitset<32> halted_;
  std::array<std::uint8_t, 2> reply_{};
};

}  // namespace rigwire::emulators
