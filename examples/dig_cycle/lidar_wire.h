// The lidar's packets into Surroundings.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>

#include "dig_cycle/machine.h"
#include "dig_cycle/surroundings.h"
#include "field/lidar_wire.h"

namespace rigwire::dig_cycle {

class LidarWire {
 public:
  /// Calls `heard` for every sound data packet, and `arm` once per packet.
  LidarWire(Surroundings& surroundings, std::function<ArmShape()> arm, std::function<void()> heard);

  void receive(std::span<const std::uint8_t> datagram) { wire_.receive(datagram); }

  /// Timestamp of the newest packet.
  [[nodiscard]] std::optional<std::uint32_t> time_of_hour_us() const {
    return wire_.time_of_hour_us();
  }
  [[nodiscard]] std::uint64_t packets() const { return wire_.packets(); }
  [[nodiscard]] std::uint64_t rejected() const { return wire_.rejected(); }

 private:
  field::LidarWire wire_;
};

}  // namespace rigwire::dig_cycle
