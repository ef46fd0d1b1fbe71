// A node whose address is taken by a NAME that wins, and that is given it back: SAE
// J1939-81, 4.2.2.
//
// The suite contends with a NAME of 1, against that with one of 0, and leaves the address again
// before the case ends. It tries three ways to give the address back: a commanded address (4.2.3),
// contending at each address that the node takes instead, as it may take the free one again, and
// requesting its claim. If none works, the node has to be switched off and on, and the later cases
// report that.
#include <algorithm>
#include <array>

#include "conform/j1939/j1939_trial.h"

namespace rigwire::conform {

namespace {

using T = J1939Trial;
using Bytes = std::vector<std::uint8_t>;
using std::chrono::milliseconds;

constexpr std::uint8_t kNoAddress = 254;  // Source of who has no address.
constexpr std::uint8_t kElsewhere = 196;  // Where the contender goes to leave an address.
constexpr std::uint32_t kCommandedAddress = 0xFED8;
constexpr std::uint8_t kBroadcast = 32;
constexpr milliseconds kBroadcastGap{60};

// Cannot claim comes 0 to 153 ms later, a claim of another address is silent for 250 ms before.
constexpr milliseconds kDispersed{153};
constexpr milliseconds kSilence{250};

struct Loss {
  Bytes name;
  std::uint8_t address = kNoAddress;  ///< Address that it has instead.

  [[nodiscard]] bool none() const { return address == kNoAddress; }
};

bool wins(const Bytes& name, const Bytes& other) {
  return std::lexicographical_compare(name.rbegin(), name.rend(), other.rbegin(), other.rend());
}

/// A NAME that wins, or that of all zeros, which does not win against itself.
Bytes contender_of(const Bytes& name) {
  const Bytes one{1, 0, 0, 0, 0, 0, 0, 0};
  return wins(one, name) ? one : Bytes(8);
}

bool contend(T& trial, const Bytes& name, std::uint8_t address, const std::string& words) {
  return trial.send(T::kClaim, T::kEverybody, contender_of(name), words, address);
}

void leave(T& trial, const Bytes& name) {
  static_cast<void>(contend(trial, name, kElsewhere, "the contender claims another address"));
  static_cast<void>(contend(trial, name, kNoAddress, "and leaves that"));
}

/// Returns the address claimed with that NAME within the time: the first that is not `but`, else
/// the last; nullopt if none.
std::optional<std::uint8_t> claimed(T& trial, const Bytes& name, milliseconds within,
                                    std::optional<std::uint8_t> but = {}) {
  const auto deadline = trial.now() + within;
  std::optional<std::uint8_t> found;
  while (const auto heard = trial.hear_anybody(deadline)) {
    if (heard->pgn == T::kClaim && heard->data == name) {
      trial.show(*heard);
      found = heard->source;
      if (found != but) {
        break;
      }
    }
  }
  return found;
}

std::optional<Loss> lose(T& trial, const Bytes& name) {
  const std::uint8_t own = trial.claims().address;
  if (!wins(contender_of(name), name)) {
    trial.not_applicable("no NAME wins against its own");
    return std::nullopt;
  }
  if (!contend(trial, name, own, "a claim of its address by a lower NAME")) {
    return std::nullopt;
  }
  const auto told =
      claimed(trial, name, trial.claims().patience + kDispersed + kSilence, std::optional(own));
  const bool gave_way =
      trial.expect(told && told != own, "cannot claim (source 254), or a claim of another address",
                   told ? "a claim of " + std::to_string(*told) + " again" : "nothing");
  return gave_way ? std::optional(Loss{name, *told}) : std::nullopt;
}

/// Sends the commanded address as a broadcast; the caller waits for the claim that follows.
void command_address(T& trial, const Bytes& name, std::uint8_t address) {
  const auto part = [&](std::uint32_t group, const Bytes& bytes) {
    static_cast<void>(trial.listen(kBroadcastGap));
    static_cast<void>(trial.send(group, T::kEverybody, bytes, "commanded address"));
  };
  part(T::kTransport,
       {kBroadcast, 9, 0, 2, 0xFF, kCommandedAddress & 0xFFU, kCommandedAddress >> 8U, 0});
  part(T::kPackets, {1, name[0], name[1], name[2], name[3], name[4], name[5], name[6]});
  part(T::kPackets, {2, name[7], address, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF});
}

/// Returns how the node came to have its address again; empty: it has not.
std::string give_back(T& trial, const Bytes& name) {
  const std::uint8_t own = trial.claims().address;
  const milliseconds patience = trial.claims().patience + kDispersed + kSilence;
  leave(trial, name);
  const auto asked = [&]() -> std::optional<std::uint8_t> {
    static_cast<void>(trial.request(T::kClaim, T::kEverybody));
    return claimed(trial, name, patience);
  };
  if (asked() == own) {
    return "by itself, when asked for its claim";
  }
  command_address(trial, name, own);
  auto address = claimed(trial, name, patience);
  if (address == own) {
    return "by a commanded address";
  }
  address = asked();
  constexpr int kTries = 3;
  for (int i = 0; i < kTries && address && *address != kNoAddress; ++i) {
    static_cast<void>(contend(trial, name, *address, "a claim of that address by a lower NAME"));
    address = claimed(trial, name, patience, address);
    leave(trial, name);
    if (address == own) {
      return "by contending at the address that it had instead";
    }
  }
  trial.lost("it has not taken its address back: it has to be switched off and on");
  return {};
}

/// Takes its address, and gives it back whatever came of it. Returns how.
template <class Check>
std::string without_address(T& trial, const Check& check) {
  const auto name = trial.name();
  if (!name) {
    return {};
  }
  if (const auto loss = lose(trial, *name)) {
    check(*loss);
  }
  std::string how = give_back(trial, *name);
  // Only then may it use the address that it has claimed again.
  static_cast<void>(trial.listen(kSilence + milliseconds(50)));
  return how;
}

/// What of that source comes in a second; its first is shown.
std::size_t spoken_by(T& trial, std::uint8_t source, const Bytes& but_claims_of = {}) {
  std::size_t count = 0;
  const auto deadline = trial.now() + std::chrono::seconds(1);
  while (const auto heard = trial.hear_anybody(deadline)) {
    const bool own_claim = heard->pgn == T::kClaim && heard->data == but_claims_of;
    if (heard->source == source && !own_claim && ++count == 1) {
      trial.show(*heard);
    }
  }
  return count;
}

void gives_way(T& trial) {
  static_cast<void>(without_address(trial, [&](const Loss& loss) {
    const bool arbitrary = (loss.name[7] & 0x80U) != 0;
    trial.expect(loss.none() || !arbitrary || (loss.address >= 128 && loss.address <= 247),
                 "of who takes any address one of 128 to 247", std::to_string(loss.address));
  }));
}

void leaves_it(T& trial) {
  static_cast<void>(without_address(trial, [&](const Loss&) {
    // What was on its way already.
    static_cast<void>(trial.listen(milliseconds(100)));
    const std::size_t count = spoken_by(trial, trial.claims().address);
    trial.expect(count == 0, "nothing with the address that it has lost",
                 std::to_string(count) + " frames in a second");
  }));
}

void is_silent(T& trial) {
  static_cast<void>(without_address(trial, [&](const Loss& loss) {
    if (!loss.none()) {
      return trial.not_applicable("it has taken address " + std::to_string(loss.address));
    }
    const std::size_t count = spoken_by(trial, kNoAddress, loss.name);
    trial.expect(count == 0, "without an address nothing but cannot claim",
                 std::to_string(count) + " frames in a second");
  }));
}

void still_answers(T& trial) {
  static_cast<void>(without_address(trial, [&](const Loss& loss) {
    if (!trial.request(T::kClaim, T::kEverybody)) {
      return;
    }
    const auto told = claimed(trial, loss.name, trial.claims().patience + kDispersed);
    trial.expect(
        told == loss.address,
        loss.none() ? "cannot claim again" : "a claim of address " + std::to_string(loss.address),
        told ? "a claim of " + std::to_string(*told) : "nothing");
  }));
}

void comes_back(T& trial) {
  const std::string how = without_address(trial, [](const Loss&) {});
  if (trial.fine()) {
    trial.observe(how.empty() ? "not at all: it has to be switched off and on" : how);
  }
}

}  // namespace

std::vector<J1939Case> j1939_loss_cases() {
  struct Row {
    const char* title;
    void (*run)(T&);
    Strength strength = Strength::must;
  };
  const std::array rows{
      Row{"It yields to a lower NAME: cannot claim, or claims another address", gives_way},
      Row{"It speaks no more with the address that it has lost", leaves_it},
      Row{"Without an address it says nothing but that", is_silent},
      Row{"It answers requests for claims with the address that it has now", still_answers},
      Row{"How it takes its address back", comes_back, Strength::observed}};
  std::vector<J1939Case> all;
  Citations citations("j1939-81", "SAE J1939-81");
  for (const Row& row : rows) {
    all.push_back({.identity = citations.next_in("lost", row.title, "SAE J1939-81, 4.2.2",
                                                 row.strength, Danger::moves),
                   .run = row.run});
  }
  return all;
}

}  // namespace rigwire::conform
