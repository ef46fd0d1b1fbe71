// The CAN interfaces that the kernel has, and what it knows of them.
//
// Source: rtnetlink(7); include/uapi/linux/can/netlink.h. Needs no rights.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace rigwire::drivers {

struct CanInterface {
  std::string name;
  int index = 0;
  bool up = false;
  std::string kind;                ///< "vcan", "vxcan", or "can": one with a controller.
  std::uint32_t bit_rate_bps = 0;  ///< 0: none is set, or the kind has none.

  /// Nothing arbitrates there and there is no bit rate.
  [[nodiscard]] bool is_virtual() const { return kind == "vcan" || kind == "vxcan"; }

  friend bool operator==(const CanInterface&, const CanInterface&) = default;
};

/// Empty when the kernel has none, or no CAN at all.
[[nodiscard]] std::vector<CanInterface> can_interfaces();
[[nodiscard]] std::optional<CanInterface> find_can_interface(const std::string& name);

/// What an answer of rtnetlink (RTM_NEWLINK messages) says of CAN interfaces; other links are left
/// out, and so is everything from the first message on that is cut short.
[[nodiscard]] std::vector<CanInterface> parse_links(std::span<const std::uint8_t> answer);

}  // namespace rigwire::drivers
