#include "emulators/j1939/j1939_address.h"

#include "protocols/j1939/message.h"

namespace rigwire::emulators {

namespace j1939 = protocols::j1939;

namespace {

constexpr unsigned kFirstArbitrary = 128;
constexpr unsigned kLastArbitrary = 247;

/// Addresses that a node may use at once.
constexpr bool is_assigned(std::uint8_t address) {
  return address <= 127 || (address >= 248 && address <= 253);
}

}  // namespace

J1939Address::J1939Address(const J1939AddressPolicy& policy, FrameOutput& output)
    : policy_(policy), output_(output), next_(policy.first_claim), address_(policy.preferred) {}

void J1939Address::advance(SimTime now) {
  if (next_ > now) {
    return;
  }
  const SimTime instant = next_;
  next_ = kNever;
  if (state_ == State::silent) {
    state_ = State::held;
  } else if (taken_[address_] && holder_[address_] <= policy_.name) {
    lose(instant);
  } else {
    claim(instant);
  }
}

void J1939Address::claim(SimTime now) {
  if (is_assigned(address_)) {
    state_ = State::held;
    next_ = kNever;
  } else if (state_ != State::held) {
    state_ = State::silent;
    next_ = now + kSilence;
  }
  output_.send(now + policy_.answer_delay, j1939::make_address_claim(address_, policy_.name));
}

void J1939Address::lose(SimTime now) {
  state_ = State::off;
  for (unsigned address = kFirstArbitrary; policy_.arbitrary_address && address <= kLastArbitrary;
       ++address) {
    if (!taken_[address]) {
      address_ = static_cast<std::uint8_t>(address);
      claim(now);
      return;
    }
  }
  state_ = State::lost;
  next_ = kNever;
  address_ = j1939::kNullAddress;
  output_.send(now + policy_.answer_delay, j1939::make_address_claim(address_, policy_.name));
}

void J1939Address::on_claim(SimTime now, std::uint8_t source, std::uint64_t name) {
  if (source >= j1939::kNullAddress) {
    return;  // "cannot claim" occupies nothing
  }
  for (std::size_t i = 0; i < taken_.size(); ++i) {
    if (taken_[i] && holder_[i] == name) {
      taken_[i] = false;  // it has moved
    }
  }
  const bool claimed = state_ == State::held || state_ == State::silent;
  const bool conflict = claimed && source == address_;
  if (conflict) {
    ++conflicts_;
    if (policy_.name < name) {
      claim(now);
      return;
    }
  }
  taken_[source] = true;
  holder_[source] = name;
  if (conflict) {
    lose(now);
  }
}

void J1939Address::on_request(SimTime now) {
  if (state_ != State::off) {
    output_.send(now + policy_.answer_delay, j1939::make_address_claim(address_, policy_.name));
  }
}

}  // namespace rigwire::emulators
