#include "protocols/usb/hid.h"

namespace rigwire::protocols::usb::hid {

std::vector<std::uint8_t> encode_items(std::initializer_list<ItemValue> items) {
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
