// Garbage and floods: no conformance. The camera serves the next client.
#include <array>

#include "conform/gige_vision/gige_vision_trial.h"

namespace rigwire::conform {

namespace boot = protocols::gige_vision::bootstrap;

namespace {

using T = GigeVisionTrial;
using Bytes = GigeBytes;

/// After that many of these datagrams it answers as ever.
void survives(T& trial, int count, const std::string& words,
              const std::function<Bytes(std::uint32_t number)>& datagram) {
  for (int i = 0; i < count; ++i) {
    const Bytes bytes = datagram(static_cast<std::uint32_t>(i));
    if (i == 0) {
      trial.sent(bytes, words + ", " + std::to_string(count) + " of them");
    }
    static_cast<void>(trial.device().line->send(T::kOther, trial.device().camera, bytes));
  }
  trial.wait(std::chrono::milliseconds(200));
  trial.drain();
  static_cast<void>(trial.read(boot::kVersion));
}

Bytes noise(std::size_t size, std::uint32_t seed) {
  Bytes bytes(size);
  std::uint32_t state = seed * 2'654'435'761U + 1U;
  for (std::uint8_t& byte : bytes) {
    state = state * 1'664'525U + 1'013'904'223U;
    byte = static_cast<std::uint8_t>(state >> 24U);
  }
  return bytes;
}

Bytes read_of(std::uint32_t address) {
  return T::framed(Gvcp::kReadRegisters, gige_word(address), 1);
}

struct RobustnessRow {
  const char* title;
  void (*run)(T&);
};
constexpr std::array kRobustnessRows{
    RobustnessRow{"Noise",
                  [](T& t) {
                    survives(t, 200, "noise",
                             [](std::uint32_t n) { return noise(1 + n % 500, n); });
                  }},
    RobustnessRow{"Empty datagrams",
                  [](T& t) { survives(t, 20, "nothing", [](std::uint32_t) { return Bytes(); }); }},
    RobustnessRow{"Noise behind the key of a command",
                  [](T& t) {
                    survives(t, 500, "a key and noise", [](std::uint32_t n) {
                      Bytes bytes = noise(8 + n % 540, n);
                      bytes[0] = 0x42;
                      bytes[2] = 0x7F;  // No command that does anything.
                      return bytes;
                    });
                  }},
    RobustnessRow{"Datagrams longer than any command",
                  [](T& t) {
                    survives(t, 10, "9000 bytes", [](std::uint32_t n) { return noise(9000, n); });
                  }},
    RobustnessRow{"Commands that end in the middle",
                  [](T& t) {
                    survives(t, 12, "part of a READREG", [](std::uint32_t n) {
                      Bytes bytes = read_of(0);
                      bytes.resize(n);
                      return bytes;
                    });
                  }},
    RobustnessRow{
        "A thousand reads without waiting",
        [](T& t) { survives(t, 1000, "READREG", [](std::uint32_t) { return read_of(0); }); }},
    RobustnessRow{"A thousand addresses that there are not",
                  [](T& t) {
                    survives(t, 1000, "READREG",
                             [](std::uint32_t n) { return read_of(0xFFF0'0000U + 4U * n); });
                  }},
    RobustnessRow{"A flood of DISCOVERY",
                  [](T& t) {
                    survives(t, 500, "DISCOVERY",
                             [](std::uint32_t) { return T::framed(Gvcp::kDiscovery, {}, 1); });
                  }},
};

}  // namespace

std::vector<GigeVisionCase> gige_robustness_cases() {
  std::vector<GigeVisionRow> rows;
  for (const RobustnessRow& row : kRobustnessRows) {
    rows.push_back({"robustness", row.title, Strength::must, row.run});
  }
  std::vector<GigeVisionCase> all = gige_cases_of(rows);
  for (GigeVisionCase& each : all) {
    each.identity.source = "No document: the camera goes on";
  }
  return all;
}

}  // namespace rigwire::conform
