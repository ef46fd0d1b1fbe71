// Human interface devices: numbers of the class and items of report descriptors.
//
// Source: Device Class Definition for Human Interface Devices 1.11, 4 (subclass), 6.2.1 (HID
// descriptor), 6.2.2 (items), 7.1 and 7.2 (requests); HID Usage Tables 1.12, 4 (generic desktop),
// 12 (buttons).
#pragma once

#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <vector>

namespace rigwire::protocols::usb::hid {

inline constexpr std::uint8_t kClass = 3;
inline constexpr std::uint8_t kHidDescriptor = 0x21;
inline constexpr std::uint8_t kReportDescriptor = 0x22;
inline constexpr std::size_t kHidDescriptorSize =
    1 /* length */ + 1 /* type */ + 2 /* version */ + 1 /* country */ + 1 /* descriptors */ +
    1 /* type of the report descriptor */ + 2 /* its length */;

enum class Request : std::uint8_t {
  get_report = 1,
  get_idle = 2,
  get_protocol = 3,
  set_report = 9,
  set_idle = 10,
  set_protocol = 11,
};
enum class ReportType : std::uint8_t { input = 1, output = 2, feature = 3 };

/// Short items with their kind in bits 7..2; the two lowest bits say how many bytes follow.
enum class Item : std::uint8_t {
  input = 0x80,
  collection = 0xA0,
  end_collection = 0xC0,
  usage_page = 0x04,
  logical_minimum = 0x14,
  logical_maximum = 0x24,
  report_size = 0x74,
  report_count = 0x94,
  usage = 0x08,
  usage_minimum = 0x18,
  usage_maximum = 0x28,
};

namespace page {
inline constexpr int kGenericDesktop = 0x01;
inline constexpr int kButton = 0x09;
}  // namespace page

namespace usage {
inline constexpr int kJoystick = 0x04;
inline constexpr int kX = 0x30;
inline constexpr int kY = 0x31;
inline constexpr int kZ = 0x32;
inline constexpr int kRx = 0x33;
inline constexpr int kRy = 0x34;
inline constexpr int kRz = 0x35;
inline constexpr int kSlider = 0x36;
}  // namespace usage

inline constexpr int kApplication = 1;      ///< Type of a collection.
inline constexpr int kDataVariable = 0x02;  ///< Input: data, variable, absolute.

struct ItemValue {
  Item item;
  int value = 0;  ///< None for end_collection.
};
/// The items in as few bytes as their values, taken as signed, need.
[[nodiscard]] inline std::vector<std::uint8_t> encode_items(
    std::initializer_list<ItemValue> items) {
  std::vector<std::uint8_t> bytes;
  for (const auto& [item, value] : items) {
    const std::size_t size = item == Item::end_collection        ? 0
                             : value >= -128 && value <= 127     ? 1
                             : value >= -32768 && value <= 32767 ? 2
                                                                 : 4;
    const unsigned size_code = size == 4 ? 3U : static_cast<unsigned>(size);
    bytes.push_back(static_cast<std::uint8_t>(static_cast<unsigned>(item) | size_code));
    for (std::size_t i = 0; i < size; ++i) {
      bytes.push_back(static_cast<std::uint8_t>(static_cast<unsigned>(value) >> (8U * i)));
    }
  }
  return bytes;
}

}  // namespace rigwire::protocols::usb::hid
