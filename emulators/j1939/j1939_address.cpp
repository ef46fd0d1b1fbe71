#include "emulators/j1939/j1939_address.h"

#include "protocols/j1939/message.h"

namespace rigwire::emulators {

namespace j1939 = protocols::j1939;

namespace {

/// Addresses that a node may use at once.
constexpr bool is_assigned(std::uint8_t address) {
  return address <= 127 || (address >= 248 && address <= 253);
}

}  // namespace

J1939Address::J1939Address(const J1939AddressPolicy& policy, FrameOutput& output)
    : policy_(policy), output_(output), next_(policy.first_claim), address_(policy.preferred) {}

void J1939Address::restart(std::uint8_t preferred, SimTime first_claim) {
  state_ = State::off;
  next_ = first_claim;
  address_ = preferred;
  taken_ = {};
}

void J1939Address::send(SimTime now, std::uint8_t source) {
  output_.send(now + policy_.answer_delay, j1939::make_address_claim(source, policy_.name));
}

void J1939Address::advance(SimTime now) {
  while (next_ <= now) {
    const SimTime instant = next_;
    next_ = kNever;
    switch (state_) {
      case State::off:
        if (taken_[address_] && (policy_.gives_way || holder_[address_] <= policy_.name)) {
          move(instant, Duration{0});
        } else {
          claim(instant);
        }
        break;
      case State::silent:
        state_ = State::held;
        next_ = after_claim(instant);
        break;
      case State::held:
        claim(instant);
        break;
      case State::lost:
        send(instant, j1939::kNullAddress);
        break;
    }
  }
}

void J1939Address::claim(SimTime now) {
  if (is_assigned(address_) || !policy_.silent_after_claim) {
    state_ = State::held;
  } else if (state_ != State::held) {
    state_ = State::silent;
  }
  next_ = state_ == State::silent ? now + kSilence : after_claim(now);
  send(now, address_);
}

SimTime J1939Address::after_claim(SimTime now) const {
  return policy_.repeat > Duration{0} ? now + policy_.repeat : kNever;
}

void J1939Address::move(SimTime now, Duration delay) {
  state_ = State::off;
  for (unsigned address = kFirstArbitraryAddress;
       policy_.arbitrary_address && address <= kLastArbitraryAddress; ++address) {
    if (!taken_[address]) {
      address_ = static_cast<std::uint8_t>(address);
      next_ = now + delay;
      if (delay == Duration{0}) {
        claim(now);
      }
      return;
    }
  }
  give_up(now);
}

void J1939Address::give_up(SimTime now) {
  state_ = State::lost;
  address_ = j1939::kNullAddress;
  next_ = policy_.says_cannot_claim ? now + dispersed_delay() : kNever;
}

Duration J1939Address::dispersed_delay() const {
  // 0 .. 255 times 0.6 ms; every byte of the NAME counts, so that neighbours in serial number or
  // function differ.
  std::uint64_t number = 0;
  for (std::uint64_t rest = policy_.name; rest != 0; rest >>= 8U) {
    number = number * 31U + (rest & 0xFFU);
  }
  return static_cast<std::int64_t>(number & 0xFFU) * std::chrono::microseconds{600};
}

void J1939Address::on_claim(SimTime now, std::uint8_t source, std::uint64_t name) {
  for (std::size_t i = 0; i < taken_.size(); ++i) {
    if (taken_[i] && holder_[i] == name) {
      taken_[i] = false;  // it has moved, or has none any more
    }
  }
  if (source >= j1939::kNullAddress) {
    return;  // "cannot claim" occupies nothing
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
  if (conflict && policy_.name == name) {
    give_up(now);
  } else if (conflict) {
    move(now, policy_.reclaim_delay);
  }
}

void J1939Address::on_restart(SimTime now) {
  if (state_ == State::silent || state_ == State::held) {
    state_ = State::off;
    next_ = now + dispersed_delay();
  }
}

void J1939Address::on_request(SimTime now) {
  switch (state_) {
    case State::off:
      break;
    case State::silent:
    case State::held:
      send(now, address_);
      break;
    case State::lost:
      if (policy_.says_cannot_claim && next_ == kNever) {
        next_ = now + dispersed_delay();
      }
      break;
  }
}

void J1939Address::on_command(SimTime now, std::uint8_t address) {
  if (state_ == State::off || address >= j1939::kNullAddress) {
    return;
  }
  if (address != address_) {
    state_ = State::off;
    address_ = address;
  }
  claim(now);
}

}  // namespace rigwire::emulators
