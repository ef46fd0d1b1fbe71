// Cases of the control privilege, and of what it can change: all changes are undone.
#include <algorithm>
#include <array>

#include "conform/gige_vision/gige_vision_trial.h"

namespace rigwire::conform {

namespace gev = protocols::gige_vision;
namespace boot = protocols::gige_vision::bootstrap;
using std::chrono::milliseconds;

namespace {

using T = GigeVisionTrial;
using Bytes = GigeBytes;

constexpr auto kDenied = static_cast<std::uint16_t>(GigeStatus::access_denied);

void denied(T& trial, std::optional<std::uint16_t> status) {
  if (status) {
    trial.expect(*status == kDenied, gige_status_text(kDenied), gige_status_text(*status));
  }
}

void taken(T& trial) {
  if (trial.take_control()) {
    if (const auto value = trial.read(boot::kControlPrivilege)) {
      trial.expect((*value & 3U) == gev::Privilege::kControl, "control (2)",
                   gige_address_text(*value));
    }
  }
}

void given_back(T& trial) {
  if (trial.take_control() && trial.write(boot::kControlPrivilege, 0)) {
    if (const auto value = trial.read(boot::kControlPrivilege)) {
      trial.expect(*value == 0, "no controlling application (0)", gige_address_text(*value));
    }
    static_cast<void>(trial.write(boot::kControlPrivilege, gev::Privilege::kControl, T::kOther));
  }
}

void not_taken_twice(T& trial) {
  if (trial.take_control()) {
    denied(trial,
           trial.status_of_write(boot::kControlPrivilege, gev::Privilege::kControl, T::kOther));
  }
}

void others_read(T& trial) {
  if (trial.take_control()) {
    static_cast<void>(trial.read(boot::kVersion, T::kOther));
  }
}

void others_do_not_write(T& trial) {
  if (trial.take_control()) {
    if (const auto value = trial.read(boot::kHeartbeatTimeout)) {
      denied(trial, trial.status_of_write(boot::kHeartbeatTimeout, *value, T::kOther));
    }
  }
}

void exclusive(T& trial) {
  if (trial.write(boot::kControlPrivilege, gev::Privilege::kExclusive)) {
    denied(trial, trial.status_of_read(boot::kVersion, T::kOther));
  }
}

void primary(T& trial) {
  if (trial.take_control()) {
    const auto port = trial.read(boot::kPrimaryPort);
    const std::uint16_t own = trial.device().line->own(T::kOwn).port;
    if (port) {
      trial.expect(*port == own, std::to_string(own), std::to_string(*port));
    }
  }
}

/// Writes that value to that register of control, and puts back what was there.
void kept(T& trial, std::uint32_t address, std::uint32_t value) {
  const auto before = trial.take_control() ? trial.read(address) : std::nullopt;
  if (before && trial.write(address, value)) {
    if (const auto now = trial.read(address)) {
      trial.expect(*now == value, std::to_string(value), std::to_string(*now));
    }
    static_cast<void>(trial.write(address, *before));
  }
}

void heartbeat_floor(T& trial) {
  const auto before = trial.take_control() ? trial.read(boot::kHeartbeatTimeout) : std::nullopt;
  if (before && trial.status_of_write(boot::kHeartbeatTimeout, 100)) {
    if (const auto now = trial.read(boot::kHeartbeatTimeout)) {
      trial.expect(*now >= 500, "500 ms at least, whatever is written", std::to_string(*now));
    }
    static_cast<void>(trial.write(boot::kHeartbeatTimeout, *before));
  }
}

/// Control with a heartbeat of a second; what it was before.
std::optional<std::uint32_t> a_second(T& trial) {
  const auto before = trial.take_control() ? trial.read(boot::kHeartbeatTimeout) : std::nullopt;
  return before && trial.write(boot::kHeartbeatTimeout, 1000) ? before : std::nullopt;
}

void put_heartbeat_back(T& trial, std::uint32_t before) {
  static_cast<void>(trial.status_of_write(boot::kControlPrivilege, gev::Privilege::kControl));
  static_cast<void>(trial.status_of_write(boot::kHeartbeatTimeout, before));
}

void silence_loses(T& trial) {
  const auto before = a_second(trial);
  if (!before) {
    return;
  }
  // Simulated devices may be slower than this machine's clock.
  std::optional<std::uint32_t> value;
  for (int i = 0; i < 20 && value != 0U && trial.fine(); ++i) {
    trial.wait(milliseconds(500));
    value = trial.read(boot::kControlPrivilege, T::kOther);
  }
  trial.expect(value == 0U, "no controlling application after several missed heartbeats",
               gige_address_text(value.value_or(0)));
  put_heartbeat_back(trial, *before);
}

void heartbeat_keeps(T& trial) {
  const auto before = a_second(trial);
  for (int i = 0; before && i < 12 && trial.fine(); ++i) {
    trial.wait(milliseconds(200));
    if (const auto value = trial.read(boot::kControlPrivilege)) {
      trial.expect((*value & 3U) != 0, "control as long as heartbeats arrive", "none");
    }
  }
  if (before) {
    put_heartbeat_back(trial, *before);
  }
}

/// Twice, with the timeout of heartbeats changed between: a repeated_request command changes
/// nothing.
void repeated_request(T& trial) {
  const auto before = trial.take_control() ? trial.read(boot::kHeartbeatTimeout) : std::nullopt;
  if (!before) {
    return;
  }
  const std::uint16_t request = trial.next_request();
  const Bytes command = T::framed(
      Gvcp::kWriteRegisters, gige_word(boot::kHeartbeatTimeout) + gige_word(*before + 1), request);
  for (int i = 0; i < 2; ++i) {
    if (!trial.send(command, "WRITEREG, the same request")) {
      return;
    }
    const auto found = trial.answer(Gvcp::kWriteRegisters, request);
    if (!found ||
        !trial.expect(found->good(), "success each time", gige_status_text(found->status))) {
      return;
    }
  }
  static_cast<void>(trial.write(boot::kHeartbeatTimeout, *before));
}

void written_count(T& trial, std::uint16_t command, const Bytes& payload, unsigned right,
                   bool good) {
  const auto found = trial.ask(command, payload);
  if (!found || !trial.expect(found->good() == good, good ? "success" : "an error",
                              gige_status_text(found->status))) {
    return;
  }
  if (trial.expect(found->payload.size() == 4, "how many were written, in four bytes",
                   std::to_string(found->payload.size()) + " bytes")) {
    trial.expect((found->word(0) & 0xFFFFU) == right, std::to_string(right) + " written",
                 std::to_string(found->word(0) & 0xFFFFU));
  }
}

void two_written(T& trial, std::uint32_t second, unsigned right, bool good) {
  const auto before = trial.take_control() ? trial.read(boot::kHeartbeatTimeout) : std::nullopt;
  if (before) {
    const Bytes one = gige_word(boot::kHeartbeatTimeout) + gige_word(*before);
    written_count(trial, Gvcp::kWriteRegisters, one + gige_word(second) + gige_word(*before), right,
                  good);
  }
}

void memory_written(T& trial) {
  const auto before = trial.take_control() ? trial.read(boot::kHeartbeatTimeout) : std::nullopt;
  if (before) {
    written_count(trial, Gvcp::kWriteMemory,
                  gige_word(boot::kHeartbeatTimeout) + gige_word(*before), 4, true);
  }
}

void write_protected(T& trial) {
  const auto value = trial.take_control() ? trial.read(boot::kVersion) : std::nullopt;
  if (value) {
    trial.refused(Gvcp::kWriteRegisters, gige_word(boot::kVersion) + gige_word(*value),
                  GigeStatus::write_protect);
  }
}

void written_nowhere(T& trial) {
  if (trial.take_control()) {
    trial.refused(Gvcp::kWriteRegisters, gige_word(0xFFFF'FFF0) + gige_word(0),
                  GigeStatus::invalid_address);
  }
}

void user_name(T& trial) {
  const auto before =
      trial.take_control() ? trial.read_memory(boot::kUserDefinedName, 16) : std::nullopt;
  if (!before) {
    return;
  }
  Bytes name{'r', 'i', 'g', 'w', 'i', 'r', 'e'};
  name.resize(16);
  const auto put = [&](const Bytes& bytes) {
    const auto found = trial.ask(Gvcp::kWriteMemory, gige_word(boot::kUserDefinedName) + bytes);
    return found && trial.expect(found->good(), "a name written", gige_status_text(found->status));
  };
  if (put(name)) {
    const auto now = trial.read_memory(boot::kUserDefinedName, 16);
    trial.expect(now == name, "the name that was written", now ? hex_text(*now) : "none");
    static_cast<void>(put(*before));
  }
}

// --- time ---

std::optional<std::uint64_t> latched(T& trial) {
  if (!trial.write(boot::kTimestampControl, gev::TimestampControl::kLatch)) {
    return std::nullopt;
  }
  const auto high = trial.read(boot::kTimestampHigh);
  const auto low = high ? trial.read(boot::kTimestampLow) : std::nullopt;
  return low ? std::optional(std::uint64_t{*high} << 32U | *low) : std::nullopt;
}

void time_goes(T& trial) {
  const auto one = trial.take_control() ? latched(trial) : std::nullopt;
  trial.wait(milliseconds(200));
  const auto two = one ? latched(trial) : std::nullopt;
  if (two) {
    trial.expect(*two > *one, "a time stamp that grows",
                 std::to_string(*one) + ", then " + std::to_string(*two));
  }
}

void time_stands_latched(T& trial) {
  if (trial.take_control() && latched(trial)) {
    const auto one = trial.read(boot::kTimestampLow);
    trial.wait(milliseconds(50));
    const auto two = one ? trial.read(boot::kTimestampLow) : std::nullopt;
    if (two) {
      trial.expect(*one == *two, "the latched value until it is latched again", "another");
    }
  }
}

void time_as_here(T& trial) {
  const auto high = trial.take_control() ? trial.read(boot::kTickFrequencyHigh) : std::nullopt;
  const auto low = high ? trial.read(boot::kTickFrequencyLow) : std::nullopt;
  const auto begin = trial.now();
  const auto one = low ? latched(trial) : std::nullopt;
  trial.wait(std::chrono::seconds(1));
  const auto end = trial.now();
  const auto two = one ? latched(trial) : std::nullopt;
  if (!two) {
    return;
  }
  const double frequency = static_cast<double>(std::uint64_t{*high} << 32U | *low);
  if (frequency == 0.0) {
    return trial.not_applicable("no frequency of ticks");
  }
  const double seconds = static_cast<double>(*two - *one) / frequency;
  const double here = std::chrono::duration<double>(end - begin).count();
  trial.expect(seconds > 0.95 * here && seconds < 1.05 * here + 0.05,
               "as much time by ticks as by this machine's clock, within 5 %",
               std::to_string(seconds) + " s in " + std::to_string(here) + " s");
}

constexpr GigeVisionRow row(const char* chapter, const char* title, Strength strength,
                            void (*run)(T&), std::uint32_t capability = 0) {
  return {chapter, title, strength, run, Danger::writes, capability, false};
}

constexpr std::array kPrivilegeRows{
    row("control", "Control is taken", kMust, taken),
    row("control", "Control is given back, and another may take it", kMust, given_back),
    row("control", "Another application does not take it meanwhile", kMust, not_taken_twice),
    row("control", "Others may read", kMust, others_read),
    row("control", "Others may not write", kMust, others_do_not_write),
    row("control", "With exclusive control others do not read", kMust, exclusive),
    row("control", "It reports the port of the controlling application", kMust, primary,
        gev::Capability::kPrimaryApplication),
    row("control", "The heartbeat's timeout is kept", kMust,
        [](T& t) { kept(t, boot::kHeartbeatTimeout, 5000); }),
    row("control", "A heartbeat's timeout below 500 ms is not taken", kShould, heartbeat_floor),
    row("control", "A silent client loses control", kMust, silence_loses),
    row("control", "Control is kept while heartbeats arrive", kMust, heartbeat_keeps),
    row("control", "WRITEREG that comes again is answered again", kMust, repeated_request),
    row(
        "control", "WRITEREG of two reports that two were written", kMust,
        [](T& t) { two_written(t, boot::kHeartbeatTimeout, 2, true); },
        gev::Capability::kConcatenation),
    row(
        "control", "WRITEREG stops at the first that is refused", kMust,
        [](T& t) { two_written(t, 0xFFFF'FFF0, 1, false); }, gev::Capability::kConcatenation),
    row("control", "WRITEMEM reports how many bytes were written", kMust, memory_written,
        gev::Capability::kWriteMemory),
    row("control", "A register that is read only is refused", kShould, write_protected),
    row("control", "An address that there is not is refused", kShould, written_nowhere),
    row("control", "The user's name is kept", kMust, user_name, gev::Capability::kUserDefinedName),
    row("time", "The time stamp grows", kMust, time_goes),
    row("time", "A latched time stamp does not change", kMust, time_stands_latched),
    row("timing-ticks", "Ticks are as fast as they are said to be", kShould, time_as_here),
};

}  // namespace

std::vector<GigeVisionCase> gige_privilege_cases() {
  return gige_cases_in_control_of(kPrivilegeRows);
}

}  // namespace rigwire::conform
