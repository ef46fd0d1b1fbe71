#include "emulators/starfire/settings.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <string_view>

namespace rigwire::emulators {
namespace {

using namespace std::chrono_literals;

constexpr std::array<std::uint32_t, 6> kBauds{4800, 9600, 19200, 38400, 57600, 115200};
constexpr std::array<Duration, 3> kPeriods{100ms, 200ms, 1s};

/// Longest forms, with CR and LF.
struct Sentence {
  std::string_view name;
  std::size_t bytes;
};
constexpr std::array<Sentence, 5> kSentences{
    {{"GGA", 100}, {"GSA", 80}, {"RMC", 90}, {"VTG", 50}, {"ZDA", 40}}};

[[noreturn]] void reject(const std::string& what) {
  throw std::invalid_argument("starfire receiver: " + what);
}

template <class Range>
std::string list(const Range& values) {
  std::string text;
  for (const auto& value : values) {
    text.append(1, ' ').append(value);
  }
  return text;
}

void check(const char* name, Duration value, Duration upper) {
  if (value < 0s || value > upper) {
    reject(std::string(name) + " is " + std::to_string(to_seconds(value)) +
           " s, allowed are 0 .. " + std::to_string(to_seconds(upper)) + " s");
  }
}

}  // namespace

void validate(const StarFireSettings& settings) {
  if (std::ranges::find(kBauds, settings.baud) == kBauds.end()) {
    reject("baud is " + std::to_string(settings.baud) +
           ", allowed are 4800 9600 19200 38400 57600 115200");
  }
  if (std::ranges::find(kPeriods, settings.sentence_period) == kPeriods.end()) {
    reject("sentence_period is " + std::to_string(to_seconds(settings.sentence_period)) +
           " s, allowed are 0.1 0.2 1 s");
  }
  if (settings.talker != "GP" && settings.talker != "GN") {
    reject("talker is '" + settings.talker + "', allowed are GP GN");
  }
  check("power_on", settings.power_on, 24h);
  check("start_up", settings.start_up, 10min);
  check("latency", settings.latency, 90ms);
  if (settings.source_address > 253) {
    reject("source_address is " + std::to_string(settings.source_address) +
           ", allowed are 0 .. 253");
  }
  constexpr std::uint32_t kGreatestSerial = (1U << 21U) - 1U;
  if (settings.serial == 0 || settings.serial > kGreatestSerial) {
    reject("serial is " + std::to_string(settings.serial) + ", allowed are 1 .. 2097151");
  }
  std::size_t bytes = 0;
  for (const std::string& name : settings.sentences) {
    const auto found = std::ranges::find(kSentences, name, &Sentence::name);
    if (found == kSentences.end() || std::ranges::count(settings.sentences, name) > 1) {
      reject("sentences are" + list(settings.sentences) +
             ", allowed are GGA GSA RMC VTG ZDA, each once");
    }
    bytes += found->bytes;
  }
  const double needed = static_cast<double>(bytes) / to_seconds(settings.sentence_period);
  const double available = settings.baud / 10.0;
  if (needed > available) {
    reject("the sentences need up to " + std::to_string(std::llround(needed)) +
           " bytes/s, the line carries " + std::to_string(std::llround(available)) +
           " bytes/s at " + std::to_string(settings.baud) + " baud");
  }
}

}  // namespace rigwire::emulators
