#include "emulators/starfire/settings.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <string_view>

#include "fields/check.h"
#include "fields/visitor.h"

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

}  // namespace

void visit(fields::Visitor& v, StarFireSettings& p) {
  v.integer("baud", p.baud, fields::IntegerRule{4800, 115200, fields::unit("bit/s")},
            "Speed of the line, 8N1.");
  v.check(std::ranges::find(kBauds, p.baud) != kBauds.end(), "baud",
          "not a usual speed of a serial line", std::to_string(p.baud),
          "4800 9600 19200 38400 57600 115200");
  v.rate("rate", p.sentence_period, fields::in("Hz").between(1, 10),
         "Rate of the sentences: 1, 5 or 10 Hz.");
  v.check(std::ranges::find(kPeriods, p.sentence_period) != kPeriods.end(), "rate",
          "not a rate that the receiver offers",
          "a period of " + fields::print_duration(p.sentence_period.count()), "1, 5, 10 Hz");
  v.texts("nmea_sentences", p.sentences, "Sentences that it sends, of GGA GSA RMC VTG ZDA.");
  v.text("talker", p.talker, "Talker of the sentences, GP or GN.");
  v.check(p.talker == "GP" || p.talker == "GN", "talker", "unknown value", "\"" + p.talker + "\"",
          "GP GN");
  v.integer("source_address", p.source_address, fields::IntegerRule{0, 253}, "J1939 address.");
  v.integer("serial", p.serial, fields::IntegerRule{1, (1 << 21) - 1},
            "Identity number in the NAME; unique on a bus.");
  visit(v, p.name);
  visit(v, p.supply);
  v.duration("start_up", p.start_up, {0, 600'000'000'000}, "From power-on to the first position.");
  v.duration("latency", p.latency, {0, 90'000'000},
             "From the navigation epoch to what it sends of it.");
}

void validate(const StarFireSettings& settings) {
  fields::check(settings);
  validate(settings.supply);
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
