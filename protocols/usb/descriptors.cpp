#include "protocols/usb/descriptors.h"

#include <algorithm>
#include <cstdint>
#include <set>
#include <stdexcept>
#include <string>

namespace rigwire::protocols::usb {

using Bytes = std::vector<std::uint8_t>;

namespace {

constexpr char32_t kReplacement = 0xFFFD;
constexpr char32_t kFirstSupplementary = 0x10000;
constexpr char32_t kLast = 0x10FFFF;

constexpr bool is_high_surrogate(char32_t c) {
  return c >= 0xD800 && c < 0xDC00;
}
constexpr bool is_low_surrogate(char32_t c) {
  return c >= 0xDC00 && c < 0xE000;
}

void append_utf8(std::string& out, char32_t c) {
  const auto put = [&out](char32_t byte) { out.push_back(static_cast<char>(byte)); };
  const auto tail = [&put, c](unsigned shift) { put(0x80U | ((c >> shift) & 0x3FU)); };
  if (c < 0x80) {
    put(c);
  } else if (c < 0x800) {
    put(0xC0U | (c >> 6U));
    tail(0);
  } else if (c < kFirstSupplementary) {
    put(0xE0U | (c >> 12U));
    tail(6);
    tail(0);
  } else {
    put(0xF0U | (c >> 18U));
    tail(12);
    tail(6);
    tail(0);
  }
}

constexpr std::size_t kTextUnitsMaximum = (kDescriptorMaximum - 2 /* length, type */) / 2;

void append_little(Bytes& bytes, std::uint16_t value) {
  bytes.push_back(static_cast<std::uint8_t>(value));
  bytes.push_back(static_cast<std::uint8_t>(value >> 8U));
}

[[noreturn]] void refuse(const std::string& quantity, std::size_t found, const char* allowed) {
  throw std::invalid_argument("usb " + quantity + ": found " + std::to_string(found) +
                              ", allowed " + allowed);
}

void check_control_packet(const DeviceDescription& d) {
  const unsigned size = d.control_packet_bytes;
  const bool fits = d.speed == Speed::low    ? size == 8
                    : d.speed == Speed::high ? size == 64
                                             : size == 8 || size == 16 || size == 32 || size == 64;
  if (!fits) {
    refuse("control_packet_bytes", size,
           d.speed == Speed::low    ? "8 at low speed"
           : d.speed == Speed::high ? "64 at high speed"
                                    : "8, 16, 32, 64 at full speed");
  }
}

void check_endpoint(const EndpointDescription& e, Speed speed) {
  const unsigned number = e.address & 0x0FU;
  if (number == 0 || (e.address & 0x70U) != 0) {
    refuse("endpoint address", e.address, "numbers 1 .. 15 and the direction in bit 7");
  }
  const unsigned size = e.packet_bytes;
  if (e.type == TransferType::bulk) {
    const bool fits = speed == Speed::high   ? size == 512
                      : speed == Speed::full ? size == 8 || size == 16 || size == 32 || size == 64
                                             : false;
    if (!fits) {
      refuse("bulk packet_bytes", size, "8, 16, 32, 64 at full speed, 512 at high, none at low");
    }
  } else if (e.type == TransferType::interrupt) {
    const unsigned most = speed == Speed::low ? 8U : speed == Speed::full ? 64U : 1024U;
    if (size < 1 || size > most) {
      refuse("interrupt packet_bytes", size, "1 .. 8 (low), 64 (full), 1024 (high speed)");
    }
    if (e.interval == 0 || (speed == Speed::high && e.interval > 16)) {
      refuse("interrupt interval", e.interval, "1 .. 255, at high speed 1 .. 16");
    }
  } else {
    throw std::invalid_argument("usb endpoint type: only bulk and interrupt are emulated");
  }
}

/// Descriptors behind each other, each with its length first.
void check_extra(const InterfaceDescription& interface) {
  for (std::size_t at = 0; at < interface.extra.size();) {
    const std::size_t length = interface.extra[at];
    if (length < 2 || length > interface.extra.size() - at) {
      refuse("interface " + std::to_string(interface.number) + " extra descriptor length", length,
             "2 .. what is left");
    }
    at += length;
  }
}

void check_interfaces(const DeviceDescription& d) {
  std::size_t expected_number = 0;
  std::size_t expected_alternate = 0;
  for (const InterfaceDescription& interface : d.interfaces) {
    if (interface.number + 1U == expected_number && interface.alternate == expected_alternate) {
      ++expected_alternate;
    } else if (interface.number == expected_number && interface.alternate == 0) {
      ++expected_number;
      expected_alternate = 1;
    } else {
      throw std::invalid_argument("usb interface: found number " +
                                  std::to_string(interface.number) + " alternate " +
                                  std::to_string(interface.alternate) +
                                  ", allowed numbers and alternates from 0 up without gaps");
    }
    std::set<std::uint8_t> addresses;
    for (const EndpointDescription& endpoint : interface.endpoints) {
      check_endpoint(endpoint, d.speed);
      if (!addresses.insert(endpoint.address).second) {
        refuse("endpoint address", endpoint.address, "each once");
      }
    }
    check_extra(interface);
  }
  if (expected_number == 0 || expected_number > 32) {
    refuse("interfaces", expected_number, "1 .. 32");
  }
}

std::uint8_t interface_count(const DeviceDescription& d) {
  return static_cast<std::uint8_t>(
      std::ranges::count(d.interfaces, 0, &InterfaceDescription::alternate));
}

void append_endpoint(Bytes& bytes, const EndpointDescription& endpoint) {
  bytes.insert(bytes.end(), {kEndpointDescriptorSize, descriptor_type::kEndpoint, endpoint.address,
                             static_cast<std::uint8_t>(endpoint.type)});
  append_little(bytes, endpoint.packet_bytes);
  bytes.push_back(endpoint.interval);
}

}  // namespace

std::optional<std::u16string> utf16_from_utf8(std::string_view text) {
  std::u16string out;
  for (std::size_t at = 0; at < text.size();) {
    const auto first = static_cast<std::uint8_t>(text[at++]);
    const unsigned tails = first < 0x80 ? 0U : first < 0xE0 ? 1U : first < 0xF0 ? 2U : 3U;
    if ((first >= 0x80 && first < 0xC0) || first >= 0xF8 || text.size() - at < tails) {
      return std::nullopt;
    }
    char32_t c = tails == 0 ? first : first & (0x3FU >> tails);
    for (unsigned i = 0; i < tails; ++i) {
      const auto next = static_cast<std::uint8_t>(text[at++]);
      if ((next & 0xC0U) != 0x80) {
        return std::nullopt;
      }
      c = (c << 6U) | (next & 0x3FU);
    }
    constexpr char32_t kLeast[] = {0, 0x80, 0x800, kFirstSupplementary};
    if (c < kLeast[tails] || c > kLast || is_high_surrogate(c) || is_low_surrogate(c)) {
      return std::nullopt;
    }
    if (c < kFirstSupplementary) {
      out.push_back(static_cast<char16_t>(c));
    } else {
      out.push_back(static_cast<char16_t>(0xD800U + ((c - kFirstSupplementary) >> 10U)));
      out.push_back(static_cast<char16_t>(0xDC00U + ((c - kFirstSupplementary) & 0x3FFU)));
    }
  }
  return out;
}

std::string utf8_from_utf16(std::u16string_view text) {
  std::string out;
  for (std::size_t at = 0; at < text.size(); ++at) {
    const char32_t unit = text[at];
    if (is_high_surrogate(unit) && at + 1 < text.size() && is_low_surrogate(text[at + 1])) {
      append_utf8(out, kFirstSupplementary + ((unit - 0xD800U) << 10U) + (text[at + 1] - 0xDC00U));
      ++at;
    } else {
      append_utf8(out, is_high_surrogate(unit) || is_low_surrogate(unit) ? kReplacement : unit);
    }
  }
  return out;
}

void validate(const DeviceDescription& d) {
  check_control_packet(d);
  if (d.configuration_value == 0) {
    refuse("configuration_value", 0, "1 .. 255");
  }
  if (d.maximum_power_2ma > 250) {
    refuse("maximum_power_2ma", d.maximum_power_2ma, "0 .. 250 (500 mA)");
  }
  check_interfaces(d);
}

Bytes encode_text(std::string_view utf8) {
  const auto units = utf16_from_utf8(utf8);
  if (!units) {
    throw std::invalid_argument("usb text '" + std::string(utf8) + "' is not UTF-8");
  }
  if (units->size() > kTextUnitsMaximum) {
    refuse("text length", units->size(), "0 .. 126 UTF-16 units");
  }
  Bytes bytes{static_cast<std::uint8_t>(2 + 2 * units->size()), descriptor_type::kString};
  for (const char16_t unit : *units) {
    append_little(bytes, unit);
  }
  return bytes;
}

DescriptorBytes::DescriptorBytes(const DeviceDescription& d) {
  validate(d);
  texts_.push_back({4, descriptor_type::kString, kEnglishUnitedStates & 0xFFU,
                    static_cast<std::uint8_t>(kEnglishUnitedStates >> 8U)});

  device_ = {kDeviceDescriptorSize, descriptor_type::kDevice};
  append_little(device_, d.usb_version);
  device_.insert(device_.end(), {d.device_class, d.subclass, d.protocol, d.control_packet_bytes});
  append_little(device_, d.vendor);
  append_little(device_, d.product);
  append_little(device_, d.release);
  for (const std::string* text : {&d.manufacturer, &d.product_name, &d.serial_number}) {
    device_.push_back(add_text(*text));
  }
  device_.push_back(1);  // configurations

  constexpr std::uint8_t kAlwaysSet = 0x80;
  constexpr std::uint8_t kSelfPowered = 0x40;
  configuration_ = {kConfigurationDescriptorSize,
                    descriptor_type::kConfiguration,
                    0,  // total length: known at the end
                    0,
                    interface_count(d),
                    d.configuration_value,
                    0,  // no text
                    static_cast<std::uint8_t>(kAlwaysSet | (d.self_powered ? kSelfPowered : 0U)),
                    d.maximum_power_2ma};
  for (const InterfaceDescription& interface : d.interfaces) {
    configuration_.insert(
        configuration_.end(),
        {kInterfaceDescriptorSize, descriptor_type::kInterface, interface.number,
         interface.alternate, static_cast<std::uint8_t>(interface.endpoints.size()),
         interface.device_class, interface.subclass, interface.protocol, add_text(interface.text)});
    configuration_.insert(configuration_.end(), interface.extra.begin(), interface.extra.end());
    for (const EndpointDescription& endpoint : interface.endpoints) {
      append_endpoint(configuration_, endpoint);
    }
  }
  if (configuration_.size() > kConfigurationMaximum) {
    refuse("configuration length", configuration_.size(), "0 .. 65535");
  }
  configuration_[2] = static_cast<std::uint8_t>(configuration_.size());
  configuration_[3] = static_cast<std::uint8_t>(configuration_.size() >> 8U);
}

std::uint8_t DescriptorBytes::add_text(std::string_view text) {
  if (text.empty()) {
    return 0;
  }
  texts_.push_back(encode_text(text));
  return static_cast<std::uint8_t>(texts_.size() - 1);
}

}  // namespace rigwire::protocols::usb
