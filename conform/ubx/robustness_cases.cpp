// What no client of good will sends. Not conformance: the receiver goes on, and answers the next
// poll. Only sync characters and polls that do nothing, so that nothing is set by chance.
#include <array>

#include "conform/ubx/ubx_trial.h"

namespace rigwire::conform {

namespace ubx = protocols::ubx;
using std::chrono::milliseconds;

namespace {

using T = UbxTrial;

/// MON-VER is answered, of twenty polls: what is sent may swallow what comes behind it as its own.
void survives(T& trial, const UbxBytes& bytes, const std::string& words) {
  if (!trial.send(bytes, words)) {
    return;
  }
  constexpr int kPolls = 20;
  const UbxId version = ubx_message("MON-VER")->id;
  for (int i = 0; i < kPolls; ++i) {
    if (!trial.send(version, {})) {
      return;
    }
    const bool last = i + 1 == kPolls;
    const auto deadline = trial.now() + (last ? trial.claims().patience : milliseconds(100));
    while (const auto heard = trial.hear(deadline)) {
      if (heard->kind == UbxHeard::Kind::frame && heard->id == version) {
        trial.show(*heard);
        trial.expect(true, "MON-VER", "");
        return;
      }
    }
  }
  trial.expect(false, "MON-VER after one of twenty polls", "none");
}

/// Returns pseudo-random bytes, identical on every call, without the first bytes of messages.
UbxBytes noise(std::size_t size) {
  UbxBytes bytes(size);
  std::uint32_t state = 1;
  for (std::uint8_t& byte : bytes) {
    state = state * 1'664'525U + 1'013'904'223U;
    byte = static_cast<std::uint8_t>(state >> 24U);
    byte = byte == ubx::kSync1 || byte == '$' || byte == 0xD3 ? std::uint8_t{0} : byte;
  }
  return bytes;
}

UbxBytes many(const UbxBytes& one, int count) {
  UbxBytes all;
  for (int i = 0; i < count; ++i) {
    all = std::move(all) + one;
  }
  return all;
}

struct RobustnessRow {
  const char* title;
  void (*run)(T&);
};

const std::array kRobustnessRows{
    RobustnessRow{"Noise", [](T& t) { survives(t, noise(500), "noise"); }},
    RobustnessRow{"Much noise", [](T& t) { survives(t, noise(20'000), "much noise"); }},
    RobustnessRow{"A hundred first synchronization characters",
                  [](T& t) { survives(t, UbxBytes(100, ubx::kSync1), "B5, a hundred times"); }},
    RobustnessRow{
        "A frame of a length of 65535, of which nothing comes",
        [](T& t) {
          survives(t, {ubx::kSync1, ubx::kSync2, 0x0A, 0x04, 0xFF, 0xFF}, "a length of FFFF");
        }},
    RobustnessRow{"A frame of a length of 100, of which ten bytes come",
                  [](T& t) {
                    survives(
                        t, UbxBytes{ubx::kSync1, ubx::kSync2, 0x0A, 0x04, 100, 0} + UbxBytes(10, 0),
                        "a frame cut short");
                  }},
    RobustnessRow{"A sentence without an end",
                  [](T& t) {
                    survives(t, UbxBytes{'$'} + UbxBytes(2000, 'A'), "a sentence without an end");
                  }},
    RobustnessRow{
        "A hundred polls without waiting",
        [](T& t) {
          survives(t, many(T::framed({0x01, 0x22}, {}), 100), "a hundred polls of NAV-CLOCK");
        }},
    RobustnessRow{"A thousand unknown polls",
                  [](T& t) {
                    survives(t, many(T::framed({0x7D, 1}, {}), 1000), "a thousand polls");
                  }},
};

}  // namespace

std::vector<UbxCase> ubx_robustness_cases(UbxCitations& citations) {
  std::vector<UbxCase> all;
  for (const RobustnessRow& row : kRobustnessRows) {
    UbxCase& made = all.emplace_back();
    made.identity =
        citations.m8.next_in("robustness", row.title, "No document: the receiver goes on");
    made.run = row.run;
  }
  return all;
}

}  // namespace rigwire::conform
