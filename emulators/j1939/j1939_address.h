// A node's source address on a J1939 bus: claiming it, defending it, losing it, being sent to
// another one.
//
// Source: SAE J1939-81, 4.2, 4.6. The lower NAME keeps an address. A node with an address outside
// 0..127 and 248..253 stays silent for 250 ms after its claim. The loser takes the next free
// address of 128..247 where its NAME allows that, else says "cannot claim" (source 254) after a
// delay of 0 to 153 ms that follows from its NAME, and sends nothing but the same answer, with the
// same delay, to requests for claims. A second node with the very same NAME on the own address is a
// defect of the installation that no address would heal: the node gives up its address and does not
// move.
//
// Firmware that does otherwise is described by the policy.
#pragma once

#include <array>
#include <cstdint>

#include "emulators/device.h"
#include "sim/samples/time.h"

namespace rigwire::emulators {

/// The addresses that a node may choose from.
inline constexpr std::uint8_t kFirstArbitraryAddress = 128;
inline constexpr std::uint8_t kLastArbitraryAddress = 247;

struct J1939AddressPolicy {
  std::uint8_t preferred = 0;
  std::uint64_t name = 0;
  bool arbitrary_address = false;
  SimTime first_claim = kStart;
  Duration answer_delay{0};  ///< From an event to the frame.
  // The defaults follow the standard; firmware that is known to differ changes them.
  bool silent_after_claim = true;  ///< For 250 ms, if the address requires it.
  bool says_cannot_claim = true;   ///< False: stops sending without a message.
  Duration repeat{0};              ///< The claim is repeated for ever at this period; 0: never.
  Duration reclaim_delay{0};       ///< From the loss of an address to the claim of another.
  bool gives_way = false;          ///< Before its own claim, even to a higher NAME.
};

class J1939Address {
 public:
  static constexpr Duration kSilence = std::chrono::milliseconds{250};

  J1939Address(const J1939AddressPolicy& policy, FrameOutput& output);

  /// Forgets the other nodes; claims `preferred` at `first_claim` (kNever: switched off).
  void restart(std::uint8_t preferred, SimTime first_claim);

  /// Sets the first claim of a node that is switched off; keeps what it knows of others.
  void claim_at(SimTime first_claim) { next_ = first_claim; }

  void advance(SimTime now);
  /// The next claim, the end of the silence after one, or the next "cannot claim".
  [[nodiscard]] SimTime next_event() const { return next_; }

  /// Another node claims `source`.
  void on_claim(SimTime now, std::uint8_t source, std::uint64_t name);
  /// The controller is back from bus-off, where a claim may have been lost: claims again, after a
  /// delay that differs between nodes, because two claims at one instant would destroy each other.
  void on_restart(SimTime now);
  /// Handles a request for claims.
  void on_request(SimTime now);
  /// Handles a commanded address: claims `address`, unless no node can have it or this one has not
  /// yet claimed any.
  void on_command(SimTime now, std::uint8_t address);

  /// Whether it has ever claimed an address since it was switched on.
  [[nodiscard]] bool has_claimed() const { return state_ != State::off; }
  /// Whether messages may be sent.
  [[nodiscard]] bool held() const { return state_ == State::held; }
  /// kNullAddress when none could be claimed.
  [[nodiscard]] std::uint8_t address() const { return address_; }
  [[nodiscard]] std::uint64_t name() const { return policy_.name; }
  /// Conflicts over the own address.
  [[nodiscard]] std::uint64_t conflicts() const { return conflicts_; }

 private:
  enum class State : std::uint8_t { off, silent, held, lost };

  void send(SimTime now, std::uint8_t source);
  void claim(SimTime now);
  /// To the next free address, claimed after `delay`; gives up when there is none.
  void move(SimTime now, Duration delay);
  void give_up(SimTime now);
  /// When an address that is held is claimed again by itself.
  [[nodiscard]] SimTime after_claim(SimTime now) const;
  /// 0 .. 153 ms, by the NAME.
  [[nodiscard]] Duration dispersed_delay() const;

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
