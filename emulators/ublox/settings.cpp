#include "emulators/ublox/settings.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "fields/check.h"
#include "fields/visitor.h"

namespace rigwire::emulators {
namespace {

using namespace std::chrono_literals;

constexpr std::array<std::uint32_t, 9> kBauds{4800,   9600,   19200,  38400, 57600,
                                              115200, 230400, 460800, 921600};

/// 62.5 s; the counter of CFG-RATE holds 65.535 s.
constexpr double kLowestRate_hz = 0.016;

template <class Range>
std::string listed(const Range& numbers) {
  std::string text;
  for (const auto number : numbers) {
    text.append(text.empty() ? "" : " ").append(std::to_string(number));
  }
  return text;
}

[[noreturn]] void reject(const std::string& what) {
  throw std::invalid_argument("ublox receiver: " + what);
}

std::size_t bytes_of(const UbloxProfile& profile, const std::vector<std::string>& names,
                     bool sentences, const char* setting) {
  std::size_t sum = 0;
  for (const auto& name : names) {
    const std::size_t index = message_index(profile, name);
    if (index == profile.messages.size() || profile.messages[index].sentence != sentences ||
        !profile.messages[index].periodic) {
      std::string allowed;
      for (const auto& message : profile.messages) {
        if (message.greatest_bytes > 0 && message.sentence == sentences && message.periodic) {
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

void visit(fields::Visitor& v, WrongLeapSecondFault& p) {
  v.integer("seconds", p.seconds, fields::IntegerRule{-10, 10, fields::unit("s")},
            "Leap seconds that are too many; not 0.");
  v.check(p.seconds != 0, "seconds", "0 is the right number of leap seconds", "0",
          "-10 .. -1, 1 .. 10");
}

void visit(fields::Visitor& v, UartNoiseFault& p) {
  v.number("bit_error_rate", p.bit_error_rate, fields::in("1").above(0).at_most(0.5),
           "Probability with which each bit is turned over.");
  visit_ramp(v, p.ramp);
}

void visit(fields::Visitor& v, SlowFixFault& p) {
  v.number("share", p.share, fields::in("%").above(0).at_most(100),
           "Share of the epochs that are computed and sent, evenly spaced.");
  visit_ramp(v, p.ramp);
}

void visit(fields::Visitor& v, UbloxFault& p) {
  visit_fault(v, p);
}

void visit(fields::Visitor& v, UbloxSettings& p) {
  const UbloxProfile& profile = *p.profile;
  v.rate("rate", p.measurement_period,
         fields::in("Hz").between(kLowestRate_hz, 1.0 / to_seconds(profile.shortest_period)),
         "Navigation epochs per second; a client may change it by CFG-RATE.");
  v.check(p.measurement_period % 1ms == 0ns, "rate", "the device counts its period in milliseconds",
          fields::print_duration(p.measurement_period.count()), "whole milliseconds");
  v.integer("baud", p.baud, fields::IntegerRule{4800, profile.greatest_baud, fields::unit("bit/s")},
            "Speed of the line at power-on, 8N1.");
  v.check(std::ranges::find(kBauds, p.baud) != kBauds.end(), "baud",
          "not a speed that the device offers", std::to_string(p.baud), listed(kBauds));
  v.texts("nmea_sentences", p.nmea_sentences,
          "Sentences that are on at power-on: RMC VTG GGA GSA GSV GLL ZDA.");
  v.texts("ubx_messages", p.ubx_messages,
          "UBX messages that are on at power-on: NAV-PVT, NAV-SOL and others; of a ZED-F9P "
          "RTCM messages, too: RTCM-1005 and others.");
  if (profile.carrier_solution) {
    v.texts("uart2_messages", p.uart2_messages,
            "RTCM messages that its second UART sends from power-on: RTCM-1005, RTCM-1077, "
            "RTCM-4072.0 and others.");
    v.integer("uart2_baud", p.uart2_baud,
              fields::IntegerRule{4800, profile.greatest_baud, fields::unit("bit/s")},
              "Speed of the second UART at power-on, 8N1.");
    v.check(std::ranges::find(kBauds, p.uart2_baud) != kBauds.end(), "uart2_baud",
            "not a speed that the device offers", std::to_string(p.uart2_baud), listed(kBauds));
  }
  v.duration("time_to_first_fix", p.time_to_first_fix, {0, 3'600'000'000'000},
             "From power-on to the first fix; 0 = a fix in the first epoch.");
  v.duration("solution_latency", p.solution_latency, {0, 200'000'000},
             "From the navigation epoch to the first byte of what is said of it.");
  v.duration("start_up", p.start_up, {0, 10'000'000'000}, "From power-on to the first byte.");
  v.boolean("start_banner", p.start_banner, "Sends TXT sentences after power-on.");
  v.integer("transmit_buffer", p.transmit_buffer_bytes, fields::IntegerRule{1024, 65536},
            "Bytes that may wait for the line.");
  v.boolean("backup_battery", p.backup_battery,
            "Keeps time, orbits and the saved configuration while the supply is off.");
}

void validate(const UbloxSettings& settings) {
  if (settings.profile == nullptr) {
    reject("profile is null, allowed are ublox_neo_7p() and its like");
  }
  fields::check(settings);
  const UbloxProfile& profile = *settings.profile;
  for (const auto& fault : settings.faults) {
    fields::check(fault);
  }
  for (const SupplyFault& fault : settings.supply_faults) {
    fields::check(fault);
  }
  const std::size_t epoch_bytes =
      bytes_of(profile, settings.nmea_sentences, true, "nmea_sentences") +
      bytes_of(profile, settings.ubx_messages, false, "ubx_messages");
  for (const std::string& name : settings.uart2_messages) {
    const std::size_t index = message_index(profile, name);
    if (index == profile.messages.size() || !profile.messages[index].rtcm) {
      std::string allowed;
      for (const auto& message : profile.messages) {
        if (message.rtcm) {
          allowed.append(1, ' ').append(message.name);
        }
      }
      reject("uart2_messages has '" + name + "', allowed are" +
             (allowed.empty() ? " none" : allowed));
    }
  }
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
