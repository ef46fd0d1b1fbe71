#include "protocols/usb/descriptor_reader.h"

#include <algorithm>
#include <bitset>

#include "protocols/bytes.h"
#include "protocols/usb/descriptors.h"
#include "protocols/usb/transfer.h"

namespace rigwire::protocols::usb {
namespace {

/// Reads the two bytes that every descriptor begins with.
struct Head {
  std::size_t length = 0;
  std::uint8_t type = 0;
};

Head head_of(std::span<const std::uint8_t> bytes) {
  return {bytes[0], bytes[1]};
}

EndpointDescription read_endpoint(std::span<const std::uint8_t> bytes) {
  EndpointDescription endpoint;
  endpoint.address = bytes[2];
  endpoint.type = static_cast<TransferType>(bytes[3] & 3U);
  endpoint.packet_bytes = load_little<std::uint16_t>(bytes, 4);
  endpoint.interval = bytes[6];
  return endpoint;
}

InterfaceDescriptor read_interface(std::span<const std::uint8_t> bytes) {
  InterfaceDescriptor read;
  read.interface.number = bytes[2];
  read.interface.alternate = bytes[3];
  read.interface.endpoints.reserve(bytes[4]);
  read.interface.device_class = bytes[5];
  read.interface.subclass = bytes[6];
  read.interface.protocol = bytes[7];
  read.text = bytes[8];
  return read;
}

}  // namespace

Decoded<DeviceDescriptor> decode_device(std::span<const std::uint8_t> bytes) {
  if (bytes.size() >= 2) {
    if (bytes[0] != kDeviceDescriptorSize) {
      return Malformed{"length of a device descriptor is 18", 0};
    }
    if (bytes[1] != descriptor_type::kDevice) {
      return Malformed{"type of a device descriptor is 1", 1};
    }
  }
  if (bytes.size() < kDeviceDescriptorSize) {
    return Incomplete{kDeviceDescriptorSize, bytes.size()};
  }
  DeviceDescriptor d;
  d.usb_version = load_little<std::uint16_t>(bytes, 2);
  d.device_class = bytes[4];
  d.subclass = bytes[5];
  d.protocol = bytes[6];
  d.control_packet_bytes = bytes[7];
  d.vendor = load_little<std::uint16_t>(bytes, 8);
  d.product = load_little<std::uint16_t>(bytes, 10);
  d.release = load_little<std::uint16_t>(bytes, 12);
  d.manufacturer_text = bytes[14];
  d.product_text = bytes[15];
  d.serial_text = bytes[16];
  d.configurations = bytes[17];
  return {d, kDeviceDescriptorSize};
}

// Walks through the descriptors by their lengths (USB 2.0, 9.5, 9.6) and checks that each interface
// has the endpoints that it announces, and the configuration its interfaces.
Decoded<ConfigurationDescriptor> decode_configuration(std::span<const std::uint8_t> bytes) {
  if (bytes.size() < 4) {
    return Incomplete{kConfigurationDescriptorSize, bytes.size()};
  }
  if (bytes[0] != kConfigurationDescriptorSize) {
    return Malformed{"length of a configuration descriptor is 9", 0};
  }
  if (bytes[1] != descriptor_type::kConfiguration) {
    return Malformed{"type of a configuration descriptor is 2", 1};
  }
  const std::size_t total = load_little<std::uint16_t>(bytes, 2);
  if (total < kConfigurationDescriptorSize) {
    return Malformed{"total length is at least the descriptor's own", 2};
  }
  if (bytes.size() < total) {
    return Incomplete{total, bytes.size()};
  }
  ConfigurationDescriptor configuration;
  configuration.interface_count = bytes[4];
  configuration.value = bytes[5];
  configuration.text = bytes[6];
  configuration.self_powered = (bytes[7] & 0x40U) != 0;
  configuration.remote_wakeup = (bytes[7] & 0x20U) != 0;
  configuration.maximum_power_2ma = bytes[8];

  std::bitset<256> numbers;
  std::size_t endpoints_due = 0;
  for (std::size_t at = kConfigurationDescriptorSize; at < total;) {
    if (total - at < 2) {
      return Malformed{"a descriptor has at least length and type", at};
    }
    const Head head = head_of(bytes.subspan(at));
    if (head.length < 2 || head.length > total - at) {
      return Malformed{"a descriptor's length is 2 to what is left", at};
    }
    const auto one = bytes.subspan(at, head.length);
    if (head.type == descriptor_type::kInterface) {
      if (head.length < kInterfaceDescriptorSize) {
        return Malformed{"length of an interface descriptor is 9", at};
      }
      if (endpoints_due != 0) {
        return Malformed{"an interface has fewer endpoints than it says", at};
      }
      endpoints_due = one[4];
      numbers.set(one[2]);
      configuration.interfaces.push_back(read_interface(one));
    } else if (head.type == descriptor_type::kEndpoint) {
      if (head.length < kEndpointDescriptorSize) {
        return Malformed{"length of an endpoint descriptor is 7", at};
      }
      if (endpoints_due == 0) {
        return Malformed{"an interface has more endpoints than it says", at};
      }
      --endpoints_due;
      configuration.interfaces.back().interface.endpoints.push_back(read_endpoint(one));
    } else {
      auto& extra = configuration.interfaces.empty()
                        ? configuration.extra
                        : configuration.interfaces.back().interface.extra;
      extra.insert(extra.end(), one.begin(), one.end());
    }
    at += head.length;
  }
  if (endpoints_due != 0) {
    return Malformed{"an interface has fewer endpoints than it says", total};
  }
  if (numbers.count() != configuration.interface_count) {
    return Malformed{"there are other interfaces than announced", 4};
  }
  return {std::move(configuration), total};
}

Decoded<std::string> decode_text(std::span<const std::uint8_t> bytes) {
  if (bytes.size() < 2) {
    return Incomplete{2, bytes.size()};
  }
  const Head head = head_of(bytes);
  if (head.type != descriptor_type::kString) {
    return Malformed{"type of a string descriptor is 3", 1};
  }
  if (head.length < 2 || head.length % 2 != 0) {
    return Malformed{"length of a string descriptor is even and at least 2", 0};
  }
  if (bytes.size() < head.length) {
    return Incomplete{head.length, bytes.size()};
  }
  std::u16string units;
  for (std::size_t at = 2; at < head.length; at += 2) {
    units.push_back(static_cast<char16_t>(load_little<std::uint16_t>(bytes, at)));
  }
  return {utf8_from_utf16(units), head.length};
}

}  // namespace rigwire::protocols::usb
