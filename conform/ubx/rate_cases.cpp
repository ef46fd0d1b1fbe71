// When messages come: UBX-13003221 R28, sections 32.10.18 (CFG-MSG) and 32.10.27 (CFG-RATE), over
// several epochs each. The time is the receiver's own, iTOW; its deviation from this machine's
// clock is reported as a distribution.
#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "conform/nmea/nmea_log.h"
#include "conform/ubx/ubx_trial.h"

namespace rigwire::conform {

namespace {

using T = UbxTrial;
using std::chrono::milliseconds;

constexpr double kWeek_ms = 604'800'000.0;
constexpr double kDay_ms = 86'400'000.0;

/// Periodic messages received in a span, in order; earlier ones are discarded.
struct Periodic {
  std::vector<double> times_ms;     ///< iTOW, or the time of day of sentences.
  std::vector<double> arrivals_ms;  ///< Arrival of each message, from the begin of the recording.
};

Periodic listen_for(T& trial, std::string_view name, std::chrono::nanoseconds span) {
  const UbxMessage& message = *ubx_message(name);
  Periodic all;
  trial.drain();
  const auto begin = trial.now();
  for (const UbxHeard& heard : trial.listen(span)) {
    if (heard.kind == UbxHeard::Kind::frame && heard.id == message.id) {
      const UbxPayload payload(message, heard.payload());
      if (!trial.demand(payload.whole(), std::string(name) + " of " + payload.lengths(),
                        std::to_string(payload.bytes().size()) + " bytes")) {
        return all;
      }
      if (all.times_ms.size() < 12) {
        trial.show(heard);
      }
      all.times_ms.push_back(payload.value("iTOW"));
      all.arrivals_ms.push_back(
          std::chrono::duration<double, std::milli>(heard.at - begin).count());
    }
  }
  return all;
}

std::string text_of(const std::vector<double>& all) {
  std::string text;
  for (std::size_t i = 0; i < std::min<std::size_t>(all.size(), 12); ++i) {
    text += (i > 0 ? ", " : "") + std::to_string(std::llround(all[i]));
  }
  return text + (all.size() > 12 ? ", ..." : "");
}

std::vector<double> steps(const std::vector<double>& times, double turn) {
  std::vector<double> all;
  for (std::size_t i = 1; i < times.size(); ++i) {
    all.push_back(std::fmod(times[i] - times[i - 1] + turn, turn));
  }
  return all;
}

/// Each step of the times is `period`, with the millisecond of the receiver's clock.
void regular(T& trial, const Periodic& all, double period_ms, std::size_t least) {
  if (!trial.expect(all.times_ms.size() >= least, std::to_string(least) + " of them at least",
                    std::to_string(all.times_ms.size()))) {
    return;
  }
  const auto found = steps(all.times_ms, kWeek_ms);
  trial.expect(
      std::ranges::all_of(found, [&](double step) { return std::abs(step - period_ms) <= 2.0; }),
      "every step " + std::to_string(std::llround(period_ms)) + " ms", text_of(found) + " ms");
}

/// Runs with NAV-CLOCK at a rate of CFG-MSG on the line's own port, and puts the rates back.
void with_rate(T& trial, std::uint8_t rate, const std::function<void()>& run) {
  const UbxId id = ubx_message("NAV-CLOCK")->id;
  const UbxBytes of{id.message_class, id.message_id};
  const auto before = trial.poll("CFG-MSG", of);
  if (!before) {
    return;
  }
  if (trial.accepts("CFG-MSG", of + UbxBytes{rate})) {
    run();
  }
  trial.accepts("CFG-MSG", before->bytes());
}

/// The period of CFG-RATE: what a message at rate 1 comes with.
std::optional<double> period_ms(T& trial) {
  const auto rate = trial.poll("CFG-RATE");
  return rate ? std::optional(rate->value("measRate") * std::max(1.0, rate->value("navRate")))
              : std::nullopt;
}

/// Time for `epochs` of them, and one more.
std::chrono::nanoseconds time_for(double period, int epochs) {
  return milliseconds(std::llround(period * (epochs + 1)) + 200);
}

void every(T& trial, std::uint8_t rate) {
  const auto period = period_ms(trial);
  if (!period) {
    return;
  }
  with_rate(trial, rate, [&] {
    const double step = *period * rate;
    regular(trial, listen_for(trial, "NAV-CLOCK", time_for(step, 4)), step, 3);
  });
}

void switched_off(T& trial) {
  const auto period = period_ms(trial);
  if (!period) {
    return;
  }
  with_rate(trial, 1, [&] {
    const UbxId id = ubx_message("NAV-CLOCK")->id;
    if (trial.accepts("CFG-MSG", {id.message_class, id.message_id, 0})) {
      // What was on its way may still come.
      static_cast<void>(trial.listen(milliseconds(300)));
      const auto all = listen_for(trial, "NAV-CLOCK", time_for(*period, 3));
      trial.expect(all.times_ms.empty(), "none", std::to_string(all.times_ms.size()) + " of them");
    }
  });
}

/// Once with the ratio or period of `change`, put back afterwards.
void with_period(T& trial, unsigned measurement_ms, unsigned ratio) {
  const auto before = trial.poll("CFG-RATE");
  if (!before) {
    return;
  }
  with_rate(trial, 1, [&] {
    const auto reference = static_cast<unsigned>(before->value("timeRef"));
    const UbxBytes other = u2(measurement_ms) + u2(ratio) + u2(reference);
    if (trial.accepts("CFG-RATE", other)) {
      static_cast<void>(trial.listen(milliseconds(500)));
      const double step = static_cast<double>(measurement_ms) * ratio;
      regular(trial, listen_for(trial, "NAV-CLOCK", time_for(step, 6)), step, 4);
    }
    trial.accepts("CFG-RATE", before->bytes());
  });
}

/// Times of navigation epochs as they come by themselves, of sentences or of messages.
Periodic epochs(T& trial, std::chrono::nanoseconds span) {
  Periodic all;
  NmeaLog log;
  double turn = kDay_ms;
  trial.drain();
  const auto begin = trial.now();
  for (const UbxHeard& heard : trial.listen(span)) {
    const double at = std::chrono::duration<double, std::milli>(heard.at - begin).count();
    std::optional<double> time;
    if (heard.kind == UbxHeard::Kind::frame) {
      const UbxMessage* const known = ubx_message(heard.id);
      if (known != nullptr && heard.id.message_class == 0x01) {
        const UbxPayload payload(*known, heard.payload());
        turn = kWeek_ms;
        time = payload.whole() ? std::optional(payload.value("iTOW")) : std::nullopt;
      }
    } else if (heard.kind == UbxHeard::Kind::sentence && turn == kDay_ms) {
      log.add({}, heard.bytes);
      const NmeaSentence& s = log.sentences().back();
      const auto field = time_field(s.type);
      const auto value = field && !s.field(*field).empty() ? s.number(*field) : std::nullopt;
      if (value) {
        const double whole = std::floor(*value / 100.0);
        time = (std::floor(whole / 100.0) * 3600.0 + std::fmod(whole, 100.0) * 60.0 + *value -
                whole * 100.0) *
               1000.0;
      }
    }
    if (time && (all.times_ms.empty() || std::abs(*time - all.times_ms.back()) > 0.5)) {
      all.times_ms.push_back(*time);
      all.arrivals_ms.push_back(at);
    }
  }
  if (all.times_ms.size() > 1) {
    all.times_ms.erase(all.times_ms.begin());  // It may have begun before.
    all.arrivals_ms.erase(all.arrivals_ms.begin());
  }
  return all;
}

std::chrono::nanoseconds time_for_epochs(const T& trial) {
  return milliseconds(std::llround(std::max(5000.0, 9.0 * 1000.0 / trial.claims().rate_hz)));
}

void at_the_claimed_rate(T& trial) {
  if (trial.claims().rate_hz <= 0.0) {
    return trial.not_applicable("no rate is claimed");
  }
  const double period = 1000.0 / trial.claims().rate_hz;
  const Periodic all = epochs(trial, time_for_epochs(trial));
  if (all.times_ms.size() < 3) {
    return trial.not_applicable("no epochs come by themselves");
  }
  const auto found = steps(all.times_ms, kDay_ms);
  // Sentences have hundredths of a second.
  trial.expect(
      std::ranges::all_of(found, [&](double step) { return std::abs(step - period) <= 11.0; }),
      "every step " + std::to_string(std::llround(period)) + " ms", text_of(found) + " ms");
}

void pace(T& trial) {
  if (trial.claims().rate_hz <= 0.0) {
    return trial.not_applicable("no rate is claimed");
  }
  const Periodic all = epochs(trial, time_for_epochs(trial));
  if (all.times_ms.size() < 3) {
    return trial.not_applicable("no epochs come by themselves");
  }
  auto gaps = steps(all.arrivals_ms, kWeek_ms);
  std::ranges::sort(gaps);
  trial.observe("from one to the next " + text_of({gaps.front()}) + " to " +
                text_of({gaps.back()}) + " ms, median " + text_of({gaps[gaps.size() / 2]}) + " ms");
}

/// The messages of an epoch come together, and its sentences with them.
void one_after_the_other(T& trial) {
  const Periodic all = epochs(trial, time_for_epochs(trial));
  if (all.times_ms.size() < 3) {
    return trial.not_applicable("no epochs come by themselves");
  }
  const std::set<double> once(all.times_ms.begin(), all.times_ms.end());
  trial.expect(once.size() == all.times_ms.size(), "no time again after another",
               text_of(all.times_ms));
}

struct RateRow {
  const char* section;
  const char* title;
  Strength strength;
  Danger danger;
  void (*run)(T&);
  bool settings = true;  ///< Needs CFG-MSG, CFG-RATE and NAV-CLOCK.
};

constexpr std::array kRateRows{
    RateRow{"32.10.18", "With a rate of 1 a message comes in every epoch", kMust, kWrites,
            [](T& t) { every(t, 1); }},
    RateRow{"32.10.18", "With a rate of 2 it comes in every second", kMust, kWrites,
            [](T& t) { every(t, 2); }},
    RateRow{"32.10.18", "With a rate of 5 it comes in every fifth", kMust, kWrites,
            [](T& t) { every(t, 5); }},
    RateRow{"32.10.18", "With a rate of 0 it comes no more", kMust, kWrites, switched_off},
    RateRow{"32.10.27", "With a period of 200 ms there are five epochs in a second", kMust, kWrites,
            [](T& t) { with_period(t, 200, 1); }},
    RateRow{"32.10.27", "With a period of 500 ms there are two", kMust, kWrites,
            [](T& t) { with_period(t, 500, 1); }},
    RateRow{"32.10.27", "Epochs have the claimed period in their own time", kMust, kNone,
            at_the_claimed_rate, false},
    RateRow{"32.10.27", "The time of an epoch comes once", kMust, kNone, one_after_the_other,
            false},
    RateRow{"32.10.27", "How epochs come by this machine's clock", Strength::observed, kNone, pace,
            false},
};

}  // namespace

std::vector<UbxCase> ubx_rate_cases(UbxCitations& citations) {
  std::vector<UbxCase> all;
  for (const RateRow& row : kRateRows) {
    UbxCase& made = all.emplace_back();
    made.identity = citations.m8.next(row.section, row.title, row.strength, row.danger);
    if (row.settings) {
      made.needs = {"CFG-MSG", "CFG-RATE", "NAV-CLOCK"};
    }
    made.run = row.run;
  }
  return all;
}

}  // namespace rigwire::conform
