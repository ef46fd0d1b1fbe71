#include "emulators/openimu/address.h"

#include "protocols/j1939/message.h"

namespace rigwire::emulators {

namespace j1939 = protocols::j1939;

OpenImuAddress::OpenImuAddress(const AddressPolicy& policy, FrameOutput& output)
    : policy_(policy),
      output_(output),
      next_claim_(policy.first_claim),
      address_(policy.preferred) {}

void OpenImuAddress::restart(std::uint8_t preferred, SimTime first_claim) {
  address_ = preferred;
  next_claim_ = first_claim;
  held_ = false;
  taken_ = {};
}

void OpenImuAddress::advance(SimTime now) {
  while (next_claim_ <= now) {
    const SimTime instant = next_claim_;
    next_claim_ = policy_.repeat > Duration{0} ? instant + policy_.repeat : kNever;
    const bool yields =
        taken_[address_] && (policy_.gives_way || holder_[address_] <= policy_.name);
    if (!held_ && yields && !move()) {
      next_claim_ = kNever;
      return;
    }
    claim(instant);
  }
}

void OpenImuAddress::claim(SimTime now) {
  held_ = true;
  output_.send(now + policy_.answer_delay, j1939::make_address_claim(address_, policy_.name));
}

bool OpenImuAddress::move() {
  for (unsigned address = kFirstPoolAddress; address <= kLastPoolAddress; ++address) {
    if (!taken_[address]) {
      address_ = static_cast<std::uint8_t>(address);
      return true;
    }
  }
  return false;
}

void OpenImuAddress::on_claim(SimTime now, std::uint8_t source, std::uint64_t name) {
  if (source >= j1939::kNullAddress) {
    return;  // "cannot claim" occupies nothing
  }
  for (std::size_t i = 0; i < taken_.size(); ++i) {
    if (taken_[i] && holder_[i] == name) {
      taken_[i] = false;  // it has moved
    }
  }
  const bool conflict = held_ && source == address_;
  if (conflict && policy_.name < name) {
    ++conflicts_;
    claim(now);
    return;
  }
  taken_[source] = true;
  holder_[source] = name;
  if (conflict) {
    ++conflicts_;
    if (!move()) {
      held_ = false;
      next_claim_ = kNever;
    } else if (policy_.reclaim_delay > Duration{0}) {
      held_ = false;
      next_claim_ = now + policy_.reclaim_delay;
    } else {
      claim(now);
    }
  }
}

void OpenImuAddress::on_request(SimTime now) {
  if (held_) {
    claim(now);
  }
}

}  // namespace rigwire::emulators
