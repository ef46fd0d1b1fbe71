// A node's source address on a J1939 bus: claiming it, defending it, losing it.
//
// Source: SAE J1939-81, 4.2. The lower NAME keeps an address. A node with an address outside 0..127
// and 248..253 stays silent for 250 ms after its claim. Who loses takes the next free address of
// 128..247 where its NAME allows that, else says "cannot claim" (source 254) and sends nothing but
// the same answer to requests for claims. (OpenIMU's firmware does otherwise: openimu/address.h.)
#pragma once

#include <array>
#include <cstdint>

#include "emulators/device.h"
#include "sim/samples/time.h"

namespace rigwire::emulators {

struct J1939AddressPolicy {
  std::uint8_t preferred = 0;
  std::uint64_t name = 0;
  bool arbitrary_address = false;
  SimTime first_claim = kStart;
  Duration answer_delay{0};  ///< From an event to the frame.
};

class J1939Address {
 public:
  static constexpr Duration kSilence = std::chrono::milliseconds{250};

  J1939Address(const J1939AddressPolicy& policy, FrameOutput& output);

  void advance(SimTime now);
  /// The first claim, or the end of the silence after one.
  [[nodiscard]] SimTime next_event() const { return next_; }

  /// Another node claims `source`.
  void on_claim(SimTime now, std::uint8_t source, std::uint64_t name);
  /// Somebody asks for claims.
  void on_request(SimTime now);

  /// Whether messages may be sent.
  [[nodiscard]] bool held() const { return state_ == State::held; }
  /// kNullAddress when none could be claimed.
  [[nodiscard]] std::uint8_t address() const { return address_; }
  [[nodiscard]] std::uint64_t name() const { return policy_.name; }
  [[nodiscard]] std::uint64_t conflicts() const { return conflicts_; }

 private:
  enum class State : std::uint8_t { off, silent, held, lost };

  void claim(SimTime now);
  void lose(SimTime now);

  J1939AddressPolicy policy_;
  FrameOutput& output_;
  State state_ = State::off;
  SimTime next_;
  std::uint8_t address_;
  std::uint64_t conflicts_ = 0;
  std::array<bool, 256> taken_{};            ///< By others.
  std::array<std::uint64_t, 256> holder_{};  ///< Their NAMEs.
};

}  // namespace rigwire::emulators
