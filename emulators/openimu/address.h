// How an OpenIMU gets and keeps its J1939 source address.
//
// Follows the open firmware rather than SAE J1939-81 (docs/devices/openimu335ri.md): the first
// claim after a delay from the serial number, no silence of 250 ms after it, claims again when its
// lower NAME wins a conflict, otherwise takes the next free address of the pool 128..247, and never
// says "cannot claim": without a free address it falls silent. The 335RI waits its delay again
// before it claims another address, and gives way to anybody who was there before its own claim.
#pragma once

#include <array>
#include <cstdint>

#include "emulators/device.h"
#include "sim/samples/time.h"

namespace rigwire::emulators {

inline constexpr std::uint8_t kFirstPoolAddress = 128;
inline constexpr std::uint8_t kLastPoolAddress = 247;

struct AddressPolicy {
  std::uint8_t preferred = kFirstPoolAddress;
  std::uint64_t name = 0;
  SimTime first_claim = kStart;
  Duration repeat{0};         ///< The claim is repeated for ever at this period; 0 is never.
  Duration answer_delay{0};   ///< From an event to the frame that answers it.
  Duration reclaim_delay{0};  ///< From the loss of an address to the claim of another.
  bool gives_way = false;     ///< Before its own claim, even to a higher NAME.
};

class OpenImuAddress {
 public:
  OpenImuAddress(const AddressPolicy& policy, FrameOutput& output);

  /// Forgets whom it has heard; claims `preferred` at `first_claim` (kNever: switched off).
  void restart(std::uint8_t preferred, SimTime first_claim);

  void advance(SimTime now);
  [[nodiscard]] SimTime next_event() const { return next_claim_; }

  /// Another node claims `source`.
  void on_claim(SimTime now, std::uint8_t source, std::uint64_t name);
  /// Somebody asks for claims; answered when an address is held.
  void on_request(SimTime now);

  /// Whether messages may be sent.
  [[nodiscard]] bool held() const { return held_; }
  [[nodiscard]] std::uint8_t address() const { return address_; }
  [[nodiscard]] std::uint64_t name() const { return policy_.name; }
  /// Conflicts over the own address.
  [[nodiscard]] std::uint64_t conflicts() const { return conflicts_; }

 private:
  void claim(SimTime now);
  /// Moves to the next free address; false when there is none.
  [[nodiscard]] bool move();

  AddressPolicy policy_;
  FrameOutput& output_;
  SimTime next_claim_;
  bool held_ = false;
  std::uint8_t address_;
  std::uint64_t conflicts_ = 0;
  std::array<bool, 256> taken_{};            ///< By others.
  std::array<std::uint64_t, 256> holder_{};  ///< Their NAMEs.
};

}  // namespace rigwire::emulators
