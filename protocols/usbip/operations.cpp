#include "protocols/usbip/operations.h"

#include <algorithm>
#include <cassert>

#include "protocols/bytes.h"

namespace rigwire::protocols::usbip {
namespace {

using Bytes = std::vector<std::uint8_t>;

constexpr std::size_t kListHeaderSize = kOperationHeaderSize + 4 /* count */;

// Offsets in the device record.
constexpr std::size_t kBusIdAt = kPathSize;
constexpr std::size_t kBusAt = kBusIdAt + kBusIdSize;
constexpr std::size_t kDeviceNumberAt = kBusAt + 4;
constexpr std::size_t kSpeedAt = kDeviceNumberAt + 4;
constexpr std::size_t kVendorAt = kSpeedAt + 4;
constexpr std::size_t kProductAt = kVendorAt + 2;
constexpr std::size_t kReleaseAt = kProductAt + 2;
constexpr std::size_t kClassAt = kReleaseAt + 2;
constexpr std::size_t kSubclassAt = kClassAt + 1;
constexpr std::size_t kProtocolAt = kSubclassAt + 1;
constexpr std::size_t kConfigurationValueAt = kProtocolAt + 1;
constexpr std::size_t kConfigurationsAt = kConfigurationValueAt + 1;
constexpr std::size_t kInterfacesAt = kConfigurationsAt + 1;
static_assert(kInterfacesAt + 1 == kDeviceRecordSize);

void store_header(std::span<std::uint8_t> bytes, Operation operation, OperationStatus status) {
  store_big<std::uint16_t>(bytes, 0, kVersion);
  store_big(bytes, 2, static_cast<std::uint16_t>(operation));
  store_big(bytes, 4, static_cast<std::uint32_t>(status));
}

void store_name(std::span<std::uint8_t> field, std::string_view name) {
  assert(name.size() < field.size());
  std::ranges::copy(name, field.begin());
}

std::string load_name(std::span<const std::uint8_t> field) {
  return {field.begin(), std::ranges::find(field, std::uint8_t{0})};
}

void store_device(std::span<std::uint8_t> bytes, const DeviceRecord& d) {
  store_name(bytes.first(kPathSize), d.path);
  store_name(bytes.subspan(kBusIdAt, kBusIdSize), d.bus_id);
  store_big(bytes, kBusAt, d.bus);
  store_big(bytes, kDeviceNumberAt, d.device);
  store_big(bytes, kSpeedAt, static_cast<std::uint32_t>(d.speed));
  store_big(bytes, kVendorAt, d.vendor);
  store_big(bytes, kProductAt, d.product);
  store_big(bytes, kReleaseAt, d.release);
  bytes[kClassAt] = d.device_class;
  bytes[kSubclassAt] = d.subclass;
  bytes[kProtocolAt] = d.protocol;
  bytes[kConfigurationValueAt] = d.configuration_value;
  bytes[kConfigurationsAt] = d.configurations;
  bytes[kInterfacesAt] = d.interfaces;
}

DeviceRecord load_device(std::span<const std::uint8_t> bytes) {
  DeviceRecord d;
  d.path = load_name(bytes.first(kPathSize));
  d.bus_id = load_name(bytes.subspan(kBusIdAt, kBusIdSize));
  d.bus = load_big<std::uint32_t>(bytes, kBusAt);
  d.device = load_big<std::uint32_t>(bytes, kDeviceNumberAt);
  d.speed = static_cast<usb::Speed>(
      std::min<std::uint32_t>(load_big<std::uint32_t>(bytes, kSpeedAt), 0xFF));
  d.vendor = load_big<std::uint16_t>(bytes, kVendorAt);
  d.product = load_big<std::uint16_t>(bytes, kProductAt);
  d.release = load_big<std::uint16_t>(bytes, kReleaseAt);
  d.device_class = bytes[kClassAt];
  d.subclass = bytes[kSubclassAt];
  d.protocol = bytes[kProtocolAt];
  d.configuration_value = bytes[kConfigurationValueAt];
  d.configurations = bytes[kConfigurationsAt];
  d.interfaces = bytes[kInterfacesAt];
  return d;
}

/// What is wrong with the first four bytes of a reply, if anything.
const char* reply_fault(std::span<const std::uint8_t> bytes, Operation expected) {
  if (load_big<std::uint16_t>(bytes, 0) != kVersion) {
    return "version is 0x0111";
  }
  if (load_big<std::uint16_t>(bytes, 2) != static_cast<std::uint16_t>(expected)) {
    return "another reply was asked for";
  }
  return nullptr;
}

}  // namespace

Decoded<Request> decode_request(std::span<const std::uint8_t> bytes) {
  if (bytes.size() >= 2 && load_big<std::uint16_t>(bytes, 0) != kVersion) {
    return Malformed{"version is 0x0111", 0};
  }
  if (bytes.size() < 4) {
    return Incomplete{kOperationHeaderSize, bytes.size()};
  }
  switch (static_cast<Operation>(load_big<std::uint16_t>(bytes, 2))) {
    case Operation::device_list_request:
      if (bytes.size() < kOperationHeaderSize) {
        return Incomplete{kOperationHeaderSize, bytes.size()};
      }
      return {DeviceListRequest{}, kOperationHeaderSize};
    case Operation::import_request: {
      if (bytes.size() < kImportRequestSize) {
        return Incomplete{kImportRequestSize, bytes.size()};
      }
      ImportRequest request;
      std::ranges::transform(bytes.subspan(kOperationHeaderSize, kBusIdSize),
                             request.bus_id.begin(),
                             [](std::uint8_t byte) { return static_cast<char>(byte); });
      return {request, kImportRequestSize};
    }
    default:
      return Malformed{"a client asks for the list or for a device", 2};
  }
}

Bytes encode_request(const Request& request) {
  const auto* import = std::get_if<ImportRequest>(&request);
  Bytes bytes(import == nullptr ? kOperationHeaderSize : kImportRequestSize);
  store_header(bytes,
               import == nullptr ? Operation::device_list_request : Operation::import_request,
               OperationStatus::ok);
  if (import != nullptr) {
    std::ranges::transform(import->bus_id, bytes.begin() + kOperationHeaderSize,
                           [](char c) { return static_cast<std::uint8_t>(c); });
  }
  return bytes;
}

Bytes encode_device_list(std::span<const ListedDevice> devices) {
  std::array<std::uint8_t, kListHeaderSize> header{};
  store_header(header, Operation::device_list_reply, OperationStatus::ok);
  store_big(header, kOperationHeaderSize, static_cast<std::uint32_t>(devices.size()));
  Bytes bytes(header.begin(), header.end());
  for (const ListedDevice& listed : devices) {
    assert(listed.interfaces.size() == listed.device.interfaces);
    std::array<std::uint8_t, kDeviceRecordSize> record{};
    store_device(record, listed.device);
    bytes.insert(bytes.end(), record.begin(), record.end());
    for (const InterfaceRecord& interface : listed.interfaces) {
      bytes.insert(bytes.end(),
                   {interface.device_class, interface.subclass, interface.protocol, 0});
    }
  }
  return bytes;
}

Bytes encode_import_reply(const DeviceRecord& device) {
  Bytes bytes(kImportReplySize);
  store_header(bytes, Operation::import_reply, OperationStatus::ok);
  store_device(std::span(bytes).subspan(kOperationHeaderSize), device);
  return bytes;
}

std::array<std::uint8_t, kOperationHeaderSize> encode_import_refusal() {
  std::array<std::uint8_t, kOperationHeaderSize> bytes{};
  store_header(bytes, Operation::import_reply, OperationStatus::failed);
  return bytes;
}

Decoded<std::vector<ListedDevice>> decode_device_list(std::span<const std::uint8_t> bytes) {
  if (bytes.size() < kListHeaderSize) {
    return Incomplete{kListHeaderSize, bytes.size()};
  }
  if (const char* fault = reply_fault(bytes, Operation::device_list_reply)) {
    return Malformed{fault, 0};
  }
  const auto count = load_big<std::uint32_t>(bytes, kOperationHeaderSize);
  if (count > kListMaximum) {
    return Malformed{"a list has at most 4096 devices", kOperationHeaderSize};
  }
  std::vector<ListedDevice> devices;
  std::size_t at = kListHeaderSize;
  for (std::uint32_t i = 0; i < count; ++i) {
    if (bytes.size() - at < kDeviceRecordSize) {
      return Incomplete{at + kDeviceRecordSize, bytes.size()};
    }
    ListedDevice listed{load_device(bytes.subspan(at, kDeviceRecordSize)), {}};
    at += kDeviceRecordSize;
    const std::size_t interfaces_size = listed.device.interfaces * kInterfaceRecordSize;
    if (bytes.size() - at < interfaces_size) {
      return Incomplete{at + interfaces_size, bytes.size()};
    }
    for (std::size_t j = 0; j < listed.device.interfaces; ++j, at += kInterfaceRecordSize) {
      listed.interfaces.push_back({bytes[at], bytes[at + 1], bytes[at + 2]});
    }
    devices.push_back(std::move(listed));
  }
  return {std::move(devices), at};
}

Decoded<ImportReply> decode_import_reply(std::span<const std::uint8_t> bytes) {
  if (bytes.size() < kOperationHeaderSize) {
    return Incomplete{kOperationHeaderSize, bytes.size()};
  }
  if (const char* fault = reply_fault(bytes, Operation::import_reply)) {
    return Malformed{fault, 0};
  }
  if (load_big<std::uint32_t>(bytes, 4) != static_cast<std::uint32_t>(OperationStatus::ok)) {
    return {ImportReply{}, kOperationHeaderSize};
  }
  if (bytes.size() < kImportReplySize) {
    return Incomplete{kImportReplySize, bytes.size()};
  }
  return {ImportReply{OperationStatus::ok,
                      load_device(bytes.subspan(kOperationHeaderSize, kDeviceRecordSize))},
          kImportReplySize};
}

}  // namespace rigwire::protocols::usbip
