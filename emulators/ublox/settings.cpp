#include "emulators/ublox/settings.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

namespace rigwire::emulators {
namespace {

using namespace std::chrono_literals;

constexpr std::array<std::uint32_t, 9> kBauds{4800,   9600,   19200,  38400, 57600,
                                              115200, 230400, 460800, 921600};

[[noreturn]] void reject(const std::string& what) {
  throw std::invalid_argument("ublox receiver: " + what);
}

void check(const char* name, Duration value, Duration lower, Duration upper) {
  if (value < lower || value > upper) {
    reject(std::string(name) + " is " + std::to_string(to_seconds(value)) + " s, allowed are " +
           std::to_string(to_seconds(lower)) + " .. " + std::to_string(to_seconds(upper)) + " s");
  }
}

void check(const UbloxFault& fault) {
  check("faults begin", fault.begin, 0s, Duration::max());
  if (fault.end <= fault.begin) {
    reject("faults end is " + std::to_string(to_seconds(fault.end)) +
           " s, allowed is later than begin, " + std::to_string(to_seconds(fault.begin)) + " s");
  }
  if (fault.kind == UbloxFaultKind::wrong_leap_second &&
      (std::abs(fault.value) > 10.0 || fault.value == 0.0 ||
       std::round(fault.value) != fault.value)) {
    reject("faults value of wrong_leap_second is " + std::to_string(fault.value) +
           " s, allowed are whole seconds -10 .. 10 but 0");
  }
  if (fault.kind == UbloxFaultKind::line_noise && !(fault.value >= 0.0 && fault.value <= 0.5)) {
    reject("faults value of line_noise is " + std::to_string(fault.value) +
           ", allowed are 0 .. 0.5 errors per bit");
  }
}

std::size_t bytes_of(const UbloxProfile& profile, const std::vector<std::string>& names,
                     bool sentences, const char* setting) {
  std::size_t sum = 0;
  for (const auto& name : names) {
    const std::size_t index = message_index(profile, name);
    if (index == profile.messages.size() || profile.messages[index].sentence != sentences) {
      std::string allowed;
      for (const auto& message : profile.messages) {
        if (message.greatest_bytes > 0 && message.sentence == sentences) {
          allowed.append(1, ' ').append(message.name);
        }
      }
      reject(std::string(setting) + " has '" + name + "', allowed are" + allowed);
    }
    sum += profile.messages[index].greatest_bytes;
  }
  return sum;
}

/// What the device itself begins with is never refused, even where its longest sentences would not
/// all fit: it drops those that do not.
bool as_delivered(const UbloxSettings& settings) {
  static const UbloxSettings kDelivered;
  return settings.baud >= settings.profile->baud && settings.measurement_period >= 1s &&
         settings.ubx_messages.empty() && settings.nmea_sentences == kDelivered.nmea_sentences;
}

}  // namespace

std::span<const std::uint32_t> ublox_bauds() {
  return kBauds;
}

void validate(const UbloxSettings& settings) {
  if (settings.profile == nullptr) {
    reject("profile is null, allowed are ublox_neo_7p() and its like");
  }
  const UbloxProfile& profile = *settings.profile;
  if (settings.baud > profile.greatest_baud ||
      std::ranges::find(kBauds, settings.baud) == kBauds.end()) {
    std::string allowed;
    for (const auto baud : kBauds) {
      allowed.append(1, ' ').append(std::to_string(baud));
    }
    reject("baud is " + std::to_string(settings.baud) + ", allowed are" + allowed);
  }
  check("measurement_period", settings.measurement_period, profile.shortest_period, 60s);
  if (settings.measurement_period % 1ms != 0ns) {
    reject("measurement_period is " + std::to_string(settings.measurement_period.count()) +
           " ns, allowed are whole milliseconds");
  }
  check("time_to_first_fix", settings.time_to_first_fix, 0s, 1h);
  check("solution_latency", settings.solution_latency, 0ms, 200ms);
  check("start_up", settings.start_up, 0s, 10s);
  if (settings.transmit_buffer_bytes < 1024 || settings.transmit_buffer_bytes > 65536) {
    reject("transmit_buffer_bytes is " + std::to_string(settings.transmit_buffer_bytes) +
           ", allowed are 1024 .. 65536");
  }
  for (const auto& fault : settings.faults) {
    check(fault);
  }
  const std::size_t epoch_bytes =
      bytes_of(profile, settings.nmea_sentences, true, "nmea_sentences") +
      bytes_of(profile, settings.ubx_messages, false, "ubx_messages");
  const double needed = static_cast<double>(epoch_bytes) / to_seconds(settings.measurement_period);
  const double available = settings.baud / 10.0;
  if (needed > available && !as_delivered(settings)) {
    reject("the messages switched on need up to " + std::to_string(std::llround(needed)) +
           " bytes/s (" + std::to_string(epoch_bytes) + " bytes every " +
           std::to_string(settings.measurement_period / 1ms) + " ms), the line carries " +
           std::to_string(std::llround(available)) + " bytes/s at " +
           std::to_string(settings.baud) + " baud");
  }
}

}  // namespace rigwire::emulators
