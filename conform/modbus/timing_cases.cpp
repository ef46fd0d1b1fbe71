// When answers come: distributions over many requests against what the device claims.
#include <algorithm>
#include <cstdio>
#include <string>

#include "conform/modbus/modbus_trial.h"

namespace rigwire::conform {

namespace {

constexpr int kRequests = 200;

std::string text_of(std::chrono::nanoseconds time) {
  char text[32];
  std::snprintf(text, sizeof text, "%.2f ms", static_cast<double>(time.count()) * 1e-6);
  return text;
}

/// Returns the answer times of requests for one register; empty if one was not answered.
std::vector<std::chrono::nanoseconds> times_of_answers(ModbusTrial& trial) {
  const unsigned address =
      trial.claims().table(protocols::modbus::Table::holding_registers).front().first;
  std::vector<std::chrono::nanoseconds> times;
  for (int i = 0; i < kRequests; ++i) {
    if (!trial.registers(3, address, 1)) {
      return {};
    }
    times.push_back(trial.took());
  }
  std::ranges::sort(times);
  return times;
}

}  // namespace

std::vector<ModbusCase> modbus_timing_cases() {
  std::vector<ModbusCase> all(2);
  Citations citations("modbus", "");
  all[0].identity = citations.next_in("timing", "99 of 100 answers come within what is claimed",
                                      "The device's claim: answer_within");
  all[0].needs.function = 3;
  all[0].run = [](ModbusTrial& trial) {
    const auto times = times_of_answers(trial);
    if (!times.empty()) {
      const auto late = times[times.size() * 99 / 100];
      trial.expect(late <= trial.claims().answer_within,
                   "99 of 100 within " + text_of(trial.claims().answer_within), text_of(late));
    }
  };
  all[1].identity = citations.next_in("timing", "When answers come", "", Strength::observed);
  all[1].needs.function = 3;
  all[1].run = [](ModbusTrial& trial) {
    const auto times = times_of_answers(trial);
    if (!times.empty()) {
      trial.observe("median " + text_of(times[times.size() / 2]) + ", 99 of 100 within " +
                    text_of(times[times.size() * 99 / 100]) + ", all within " +
                    text_of(times.back()));
    }
  };
  return all;
}

}  // namespace rigwire::conform
