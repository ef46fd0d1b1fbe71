#include "emulators/ublox/settings.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "protocols/ubx/navigation.h"

namespace rigwire::emulators {
namespace {

using namespace std::chrono_literals;
namespace ubx = protocols::ubx;

constexpr std::array<std::uint32_t, 8> kBauds{4800,  9600,   19200,  38400,
                                              57600, 115200, 230400, 460800};

// Longest forms: three digits of knots, five of altitude; GSV of 16 satellites.
constexpr std::size_t kRmc = 76;
constexpr std::size_t kVtg = 46;
constexpr std::size_t kGga = 84;
constexpr std::size_t kGsa = 69;
constexpr std::size_t kGsv = 4 /*pages*/ * 70;
constexpr std::size_t kGll = 53;
constexpr std::size_t kZda = 40;
constexpr std::size_t kTrackable = 16;  // more than 24 slots ever show at once

template <class Message>
constexpr UbloxMessage produced(std::string_view name, std::size_t repeated = 0) {
  return {Message::kId, name, ubx::frame_size<Message>() + repeated, false};
}
constexpr UbloxMessage sentence(std::uint8_t id, std::string_view name, std::size_t bytes) {
  return {{0xF0, id}, name, bytes, true};
}
constexpr UbloxMessage known(std::uint8_t message_class, std::uint8_t id) {
  return {{message_class, id}, {}, 0, message_class >= 0xF0};
}

constexpr std::array kMessages{
    produced<ubx::NavPvt>("NAV-PVT"),
    produced<ubx::NavPosecef>("NAV-POSECEF"),
    produced<ubx::NavPosllh>("NAV-POSLLH"),
    produced<ubx::NavStatus>("NAV-STATUS"),
    produced<ubx::NavVelecef>("NAV-VELECEF"),
    produced<ubx::NavVelned>("NAV-VELNED"),
    sentence(0x04, "RMC", kRmc),
    sentence(0x05, "VTG", kVtg),
    sentence(0x00, "GGA", kGga),
    sentence(0x02, "GSA", kGsa),
    sentence(0x03, "GSV", kGsv),
    sentence(0x01, "GLL", kGll),
    sentence(0x08, "ZDA", kZda),
    produced<ubx::NavSol>("NAV-SOL"),
    produced<ubx::NavSvinfoHead>("NAV-SVINFO", kTrackable* ubx::NavSvinfoChannel::kLength),
    produced<ubx::NavDop>("NAV-DOP"),
    produced<ubx::NavTimegps>("NAV-TIMEGPS"),
    produced<ubx::NavTimeutc>("NAV-TIMEUTC"),
    produced<ubx::NavClock>("NAV-CLOCK"),
    UbloxMessage{{0x0A, 0x09}, "MON-HW", 68, false},
    known(0x01, 0x31),
    known(0x01, 0x32),
    known(0x01, 0x60),
    known(0x02, 0x10),
    known(0x02, 0x11),
    known(0x02, 0x13),
    known(0x02, 0x20),
    known(0x02, 0x30),
    known(0x02, 0x31),
    known(0x0A, 0x02),
    known(0x0A, 0x06),
    known(0x0A, 0x07),
    known(0x0A, 0x08),
    known(0x0A, 0x0B),
    known(0x0A, 0x21),
    known(0x0B, 0x01),
    known(0x0B, 0x30),
    known(0x0B, 0x31),
    known(0x0B, 0x32),
    known(0x0B, 0x33),
    known(0x0D, 0x01),
    known(0x0D, 0x03),
    known(0x21, 0x08),
    known(0xF0, 0x06),
    known(0xF0, 0x07),
    known(0xF0, 0x09),
    known(0xF0, 0x0A),
    known(0xF0, 0x0D),
    known(0xF1, 0x00),
    known(0xF1, 0x03),
    known(0xF1, 0x04),
};

[[noreturn]] void reject(const std::string& what) {
  throw std::invalid_argument("ublox receiver: " + what);
}

void check(const char* name, Duration value, Duration lower, Duration upper) {
  if (value < lower || value > upper) {
    reject(std::string(name) + " is " + std::to_string(to_seconds(value)) + " s, allowed are " +
           std::to_string(to_seconds(lower)) + " .. " + std::to_string(to_seconds(upper)) + " s");
  }
}

std::size_t bytes_of(const std::vector<std::string>& names, bool sentences, const char* setting) {
  std::size_t sum = 0;
  for (const auto& name : names) {
    const std::size_t index = ublox_message_index(name);
    if (index == kMessages.size() || kMessages[index].sentence != sentences) {
      std::string allowed;
      for (const auto& message : kMessages) {
        if (message.greatest_bytes > 0 && message.sentence == sentences) {
          allowed.append(1, ' ').append(message.name);
        }
      }
      reject(std::string(setting) + " has '" + name + "', allowed are" + allowed);
    }
    sum += kMessages[index].greatest_bytes;
  }
  return sum;
}

}  // namespace

std::span<const std::uint32_t> ublox_bauds() {
  return kBauds;
}

std::span<const UbloxMessage> ublox_messages() {
  return kMessages;
}

std::size_t ublox_message_index(ubx::MessageId id) {
  return static_cast<std::size_t>(std::ranges::find(kMessages, id, &UbloxMessage::id) -
                                  kMessages.begin());
}

std::size_t ublox_message_index(std::string_view name) {
  return name.empty()
             ? kMessages.size()
             : static_cast<std::size_t>(std::ranges::find(kMessages, name, &UbloxMessage::name) -
                                        kMessages.begin());
}

void validate(const UbloxSettings& settings) {
  if (std::ranges::find(kBauds, settings.baud) == kBauds.end()) {
    std::string allowed;
    for (const auto baud : kBauds) {
      allowed.append(1, ' ').append(std::to_string(baud));
    }
    reject("baud is " + std::to_string(settings.baud) + ", allowed are" + allowed);
  }
  check("measurement_period", settings.measurement_period, 50ms, 60s);
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
  const std::size_t epoch_bytes = bytes_of(settings.nmea_sentences, true, "nmea_sentences") +
                                  bytes_of(settings.ubx_messages, false, "ubx_messages");
  const double needed = static_cast<double>(epoch_bytes) / to_seconds(settings.measurement_period);
  const double available = settings.baud / 10.0;
  if (needed > available) {
    reject("the messages switched on need up to " + std::to_string(std::llround(needed)) +
           " bytes/s (" + std::to_string(epoch_bytes) + " bytes every " +
           std::to_string(settings.measurement_period / 1ms) + " ms), the line carries " +
           std::to_string(std::llround(available)) + " bytes/s at " +
           std::to_string(settings.baud) + " baud");
  }
}

}  // namespace rigwire::emulators
