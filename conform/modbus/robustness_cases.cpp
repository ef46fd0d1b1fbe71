// What no client of good will sends. Not conformance: no document says what is answered, but a
// device that goes on serving others is asked for.
#include <array>
#include <string>
#include <thread>

#include "conform/modbus/modbus_trial.h"

namespace rigwire::conform {

using std::chrono::milliseconds;

namespace {

using T = ModbusTrial;

// What is sent may be answered, or end the connection; the next connection is served.
void survives(T& trial, const std::vector<std::uint8_t>& bytes, const std::string& what) {
  trial.sent(bytes, what);
  static_cast<void>(trial.line().send(bytes));
  std::this_thread::sleep_for(milliseconds(100));
  trial.reopen();
  static_cast<void>(trial.ask(trial.any_request()));
}

std::vector<std::uint8_t> header(std::uint16_t length) {
  return {0, 1, 0, 0, static_cast<std::uint8_t>(length >> 8U), static_cast<std::uint8_t>(length),
          1};
}

/// Returns pseudo-random bytes, identical on every call.
std::vector<std::uint8_t> noise(std::size_t size) {
  std::vector<std::uint8_t> bytes(size);
  std::uint32_t state = 1;
  for (std::uint8_t& byte : bytes) {
    state = state * 1'664'525U + 1'013'904'223U;
    byte = static_cast<std::uint8_t>(state >> 24U);
  }
  return bytes;
}

struct RobustnessRow {
  bool tcp;
  const char* title;
  void (*run)(T&);
};

constexpr std::array kRobustnessRows{
    RobustnessRow{true, "A length of 0", [](T& t) { survives(t, header(0), "length 0"); }},
    RobustnessRow{true, "A length of 1", [](T& t) { survives(t, header(1), "length 1"); }},
    RobustnessRow{true, "A length of 255",
                  [](T& t) {
                    auto bytes = header(255);
                    bytes.resize(6 + 255);
                    survives(t, bytes, "length 255");
                  }},
    RobustnessRow{true, "A length of 65535",
                  [](T& t) { survives(t, header(0xFFFF), "length 65535"); }},
    RobustnessRow{true, "Half a header, and the connection ends",
                  [](T& t) {
                    survives(t, {0, 1, 0}, "three bytes");
                  }},
    RobustnessRow{true, "A header without its data unit, and the connection ends",
                  [](T& t) { survives(t, header(6), "a header"); }},
    RobustnessRow{false, "Noise", [](T& t) { survives(t, noise(260), "noise"); }},
    RobustnessRow{true, "Much noise", [](T& t) { survives(t, noise(100'000), "much noise"); }},
    RobustnessRow{true, "A thousand requests without waiting",
                  [](T& t) {
                    std::vector<std::uint8_t> bytes;
                    for (int i = 0; i < 1000; ++i) {
                      const auto one = t.framed(t.any_request());
                      bytes.insert(bytes.end(), one.begin(), one.end());
                    }
                    survives(t, bytes, "a thousand requests");
                  }},
    RobustnessRow{true, "Fifty connections that say nothing",
                  [](T& t) {
                    std::vector<std::unique_ptr<ByteLine>> idle;
                    try {
                      for (int i = 0; i < 50; ++i) {
                        idle.push_back(t.another());
                      }
                    } catch (const Unreachable& refused) {
                      t.note(std::to_string(idle.size()) + " were let in: " + refused.what());
                    }
                    idle.clear();
                    survives(t, {}, "nothing");
                  }},
};

}  // namespace

std::vector<ModbusCase> modbus_robustness_cases() {
  std::vector<ModbusCase> all;
  Citations citations("modbus", "");
  for (const RobustnessRow& row : kRobustnessRows) {
    ModbusCase& made = all.emplace_back();
    made.identity = citations.next_in("robustness", row.title, "No document: the device goes on");
    made.needs.tcp = row.tcp;
    made.run = row.run;
  }
  return all;
}

}  // namespace rigwire::conform
