#include "drivers/usb_selector.h"

#include <algorithm>
#include <charconv>
#include <optional>
#include <stdexcept>

namespace rigwire::drivers {

namespace {

std::optional<std::uint16_t> hexadecimal(std::string_view text) {
  std::uint16_t value = 0;
  const char* const end = text.data() + text.size();
  const auto [stopped, error] = std::from_chars(text.data(), end, value, 16);
  if (error != std::errc{} || stopped != end || text.size() != 4) {
    return std::nullopt;
  }
  return value;
}

bool is_place(std::string_view text) {
  const auto dash = text.find('-');
  const auto digits = [](std::string_view part) {
    return !part.empty() && std::ranges::all_of(part, [](char c) { return c >= '0' && c <= '9'; });
  };
  if (dash == std::string_view::npos || !digits(text.substr(0, dash))) {
    return false;
  }
  std::string_view ports = text.substr(dash + 1);
  for (;;) {
    const auto dot = ports.find('.');
    if (!digits(ports.substr(0, dot))) {
      return false;
    }
    if (dot == std::string_view::npos) {
      return true;
    }
    ports.remove_prefix(dot + 1);
  }
}

}  // namespace

bool UsbSelector::matches(const UsbListed& device) const {
  if (!place.empty()) {
    return place == device.place;
  }
  return vendor == device.vendor && product == device.product &&
         (serial_number.empty() || serial_number == device.serial_number);
}

UsbSelector parse_usb_selector(std::string_view text) {
  UsbSelector selector;
  if (is_place(text)) {
    selector.place = text;
    return selector;
  }
  if (text.size() >= 9 && text[4] == ':' && (text.size() == 9 || text[9] == ':')) {
    const auto vendor = hexadecimal(text.substr(0, 4));
    const auto product = hexadecimal(text.substr(5, 4));
    const std::string_view serial = text.size() > 9 ? text.substr(10) : std::string_view{};
    if (vendor && product && (text.size() == 9 || !serial.empty())) {
      selector.vendor = *vendor;
      selector.product = *product;
      selector.serial_number = serial;
      return selector;
    }
  }
  throw std::invalid_argument("USB device '" + std::string(text) +
                              "': vendor:product (1d50:606f), vendor:product:serial number, or the "
                              "place where it is plugged in (1-1.4) expected");
}

}  // namespace rigwire::drivers
