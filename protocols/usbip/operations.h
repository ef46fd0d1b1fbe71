// What is said before a device is imported: which devices there are, and which one is wanted.
//
// Source: see constants.h.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "protocols/result.h"
#include "protocols/usb/transfer.h"
#include "protocols/usbip/constants.h"

namespace rigwire::protocols::usbip {

/// One exported device.
struct DeviceRecord {
  std::string path;    ///< Path in the exporter's system; at most 255 bytes.
  std::string bus_id;  ///< Name that a client requests, "1-1"; at most 31 bytes.
  std::uint32_t bus = 0;
  std::uint32_t device = 0;
  usb::Speed speed = usb::Speed::full;  ///< Other numbers than the three are kept, up to 255.
  std::uint16_t vendor = 0;
  std::uint16_t product = 0;
  std::uint16_t release = 0;
  std::uint8_t device_class = 0;
  std::uint8_t subclass = 0;
  std::uint8_t protocol = 0;
  std::uint8_t configuration_value = 0;
  std::uint8_t configurations = 0;
  std::uint8_t interfaces = 0;

  friend bool operator==(const DeviceRecord&, const DeviceRecord&) = default;
};

struct InterfaceRecord {
  std::uint8_t device_class = 0;
  std::uint8_t subclass = 0;
  std::uint8_t protocol = 0;

  friend bool operator==(const InterfaceRecord&, const InterfaceRecord&) = default;
};

struct ListedDevice {
  DeviceRecord device;
  std::vector<InterfaceRecord> interfaces;  ///< device.interfaces of them.

  friend bool operator==(const ListedDevice&, const ListedDevice&) = default;
};

struct DeviceListRequest {
  friend bool operator==(const DeviceListRequest&, const DeviceListRequest&) = default;
};
struct ImportRequest {
  std::array<char, kBusIdSize> bus_id{};  ///< Ends with the first zero.

  [[nodiscard]] std::string_view name() const {
    const std::string_view all(bus_id.data(), bus_id.size());
    return all.substr(0, all.find('\0'));
  }
  friend bool operator==(const ImportRequest&, const ImportRequest&) = default;
};
using Request = std::variant<DeviceListRequest, ImportRequest>;

/// Malformed: another version, an operation that is no request.
[[nodiscard]] Decoded<Request> decode_request(std::span<const std::uint8_t> bytes);
[[nodiscard]] std::vector<std::uint8_t> encode_request(const Request& request);

/// Precondition of both encoders: each name fits with a zero behind it.
[[nodiscard]] std::vector<std::uint8_t> encode_device_list(std::span<const ListedDevice> devices);
[[nodiscard]] std::vector<std::uint8_t> encode_import_reply(const DeviceRecord& device);
/// Encodes the refusal when the device is not there or in use.
[[nodiscard]] std::array<std::uint8_t, kOperationHeaderSize> encode_import_refusal();

/// The client's side. At most kListMaximum devices are accepted.
inline constexpr std::uint32_t kListMaximum = 4096;
[[nodiscard]] Decoded<std::vector<ListedDevice>> decode_device_list(
    std::span<const std::uint8_t> bytes);
struct ImportReply {
  OperationStatus status = OperationStatus::failed;
  DeviceRecord device;  ///< Only when ok.
};
[[nodiscard]] Decoded<ImportReply> decode_import_reply(std::span<const std::uint8_t> bytes);

}  // namespace rigwire::protocols::usbip
