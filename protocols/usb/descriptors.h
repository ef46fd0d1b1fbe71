// What a USB device says about itself, as structures; and as the bytes that GET_DESCRIPTOR returns.
//
// Source: Universal Serial Bus Specification 2.0, 9.5 and 9.6.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "protocols/usb/transfer.h"

namespace rigwire::protocols::usb {

/// Table 9-13.
struct EndpointDescription {
  std::uint8_t address = 0;  ///< Number 1 .. 15, kToHost for IN.
  TransferType type = TransferType::bulk;
  std::uint16_t packet_bytes = 64;
  std::uint8_t interval = 0;  ///< Frames (interrupt, full speed); 0 for bulk.
};

/// Table 9-12; `extra` is what follows it in the configuration: class-specific descriptors.
struct InterfaceDescription {
  std::uint8_t number = 0;
  std::uint8_t alternate = 0;
  std::uint8_t device_class = 0;
  std::uint8_t subclass = 0;
  std::uint8_t protocol = 0;
  std::string text;  ///< Empty: no string.
  std::vector<std::uint8_t> extra;
  std::vector<EndpointDescription> endpoints;
};

/// Table 9-8 and one configuration (Table 9-10), which is all that the devices here have.
struct DeviceDescription {
  std::uint16_t usb_version = 0x0200;  ///< Binary coded decimal.
  std::uint8_t device_class = 0;
  std::uint8_t subclass = 0;
  std::uint8_t protocol = 0;
  std::uint8_t control_packet_bytes = 64;
  std::uint16_t vendor = 0;
  std::uint16_t product = 0;
  std::uint16_t release = 0x0100;  ///< Binary coded decimal.
  std::string manufacturer;        ///< Texts: UTF-8; empty ones are left out.
  std::string product_name;
  std::string serial_number;
  Speed speed = Speed::full;
  bool self_powered = false;
  std::uint8_t maximum_power_2ma = 50;  ///< In units of 2 mA.
  std::uint8_t configuration_value = 1;
  std::vector<InterfaceDescription> interfaces;
};

}  // namespace rigwire::protocols::usb
