// The CAN bus with the four inertial sensors: J1939 angular rate and acceleration frames into the
// estimator.
//
// The sensor of each link is identified by its source address (0x80 chassis, 0x81 boom, 0x82 stick,
// 0x83 bucket as delivered), or by the identity number in the sensors' NAMEs: then the addresses
// are learnt from their claims, and may change at any time.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>

#include "dig_cycle/estimator.h"
#include "protocols/can/frame.h"

namespace rigwire::dig_cycle {

struct ImuWireSettings {
  std::array<std::uint8_t, kLinks> addresses{0x80, 0x81, 0x82, 0x83};
  /// Set: addresses are learnt, in the order chassis, boom, stick, bucket.
  std::optional<std::array<std::uint32_t, kLinks>> identities = {};
};

class ImuWire {
 public:
  /// Calls `heard` for a link when one of its acceleration frames brought a sound value.
  ImuWire(Estimator& estimator, const ImuWireSettings& settings, std::function<void(Link)> heard);

  void receive(const protocols::can::Frame& frame);

  /// To send now and then while addresses are unknown: asks every node to claim its address.
  [[nodiscard]] std::optional<protocols::can::Frame> question() const;

  [[nodiscard]] std::optional<std::uint8_t> address(Link link) const { return addresses_[link]; }

 private:
  [[nodiscard]] std::optional<Link> link_of(std::uint8_t address) const;
  void learn(std::uint8_t address, std::uint64_t name);

  Estimator& estimator_;
  std::function<void(Link)> heard_;
  std::optional<std::array<std::uint32_t, kLinks>> identities_;
  std::array<std::optional<std::uint8_t>, kLinks> addresses_;
};

}  // namespace rigwire::dig_cycle
