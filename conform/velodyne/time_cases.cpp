// Timestamps of data packets, and when packets came.
#include <algorithm>
#include <cmath>

#include "conform/velodyne/velodyne_rows.h"

namespace rigwire::conform {
namespace {

using Log = VelodyneLog;
using Claims = VelodyneClaims;

constexpr const char* kTimestamp = "63-9113 Rev. H, Packet format; 63-9243 Rev. D, 9.3, timestamp";
constexpr const char* kTiming = "the model's manual: firing timing";
constexpr std::uint32_t kWrap_us = 3'600'000'000;

void time_within_the_hour(Trial& trial, const Log& log, const Claims&) {
  each(trial, log.data(), "timestamps below 3 600 000 000 us", [](const VelodyneData& packet) {
    return packet.timestamp_us() < kWrap_us ? Wrong()
                                            : Wrong(std::to_string(packet.timestamp_us()));
  });
}

/// Checks each step from one packet to the next: `check(step_us)` returns a Wrong.
template <class Check>
void each_step(Trial& trial, const Log& log, const std::string& expected, const Check& check) {
  for (std::size_t i = 0; i < log.steps_us().size(); ++i) {
    if (Wrong wrong = check(log.steps_us()[i])) {
      for (const std::size_t packet : {i, i + 1}) {
        trial.received(log.data()[packet].datagram().bytes,
                       "timestamp " + std::to_string(log.data()[packet].timestamp_us()) + " us");
      }
      trial.expect(false, expected, std::move(*wrong));
      return;
    }
  }
  trial.expect(true, expected, "");
}

void time_forward(Trial& trial, const Log& log, const Claims&) {
  each_step(trial, log, "timestamps that never go back but at the hour", [](std::int64_t step) {
    return step < 0 ? Wrong(std::to_string(step) + " us") : Wrong();
  });
}

void once(Trial& trial, const Log& log, const Claims&) {
  each_step(trial, log, "each packet once", [](std::int64_t step) {
    return step == 0 ? Wrong("the same timestamp twice") : Wrong();
  });
}

/// Packets' periods in a step, and microseconds beside them.
struct Periods {
  double whole = 0.0;
  double rest_us = 0.0;
};
Periods periods_in(const Log& log, std::int64_t step_us) {
  const double period = log.packet_period_us();
  const double whole = std::round(static_cast<double>(step_us) / period);
  return {whole, static_cast<double>(step_us) - whole * period};
}

void whole_periods(Trial& trial, const Log& log, const Claims&) {
  each_step(trial, log,
            "steps of " + number_text(log.packet_period_us()) + " us, or of some such, within 2 us",
            [&](std::int64_t step) {
              const Periods periods = periods_in(log, step);
              // Lost packets make several of it; a clock of 100 ppm is off by more over these.
              const double allowed = 2.0 + std::abs(static_cast<double>(step)) * 1e-4;
              return std::abs(periods.rest_us) > allowed ? Wrong(std::to_string(step) + " us")
                                                         : Wrong();
            });
}

void none_missing(Trial& trial, const Log& log, const Claims&) {
  if (log.lost_here() > 0) {
    return trial.broken("this machine did not take " + std::to_string(log.lost_here()) +
                        " packets in time");
  }
  double missing = 0.0;
  for (const std::int64_t step : log.steps_us()) {
    missing += std::max(0.0, periods_in(log, step).whole - 1.0);
  }
  trial.expect(missing == 0.0, "no packet missing", number_text(missing) + " missing");
}

void firing_clock(Trial& trial, const Log& log, const Claims&) {
  double time = 0.0;
  double periods = 0.0;
  for (const std::int64_t step : log.steps_us()) {
    time += static_cast<double>(step);
    periods += periods_in(log, step).whole;
  }
  if (periods < 100.0) {
    return trial.not_applicable("too few packets");
  }
  const double off_ppm = (time / periods / log.packet_period_us() - 1.0) * 1e6;
  // Two microseconds of rounding at the ends.
  const double allowed_ppm = 100.0 + 2.0 / time * 1e6;
  trial.expect(std::abs(off_ppm) <= allowed_ppm, "a mean period within 100 ppm of the model's",
               number_text(off_ppm) + " ppm");
}

std::string an_hour(const Log& log, const Claims& claims) {
  for (std::size_t i = 1; i < log.data().size(); ++i) {
    if (log.data()[i].timestamp_us() < log.data()[i - 1].timestamp_us() &&
        log.data()[i - 1].timestamp_us() - log.data()[i].timestamp_us() > kWrap_us / 2) {
      return a_model(log, claims);
    }
  }
  return "no hour was full meanwhile";
}

void at_the_hour(Trial& trial, const Log& log, const Claims&) {
  for (std::size_t i = 1; i < log.data().size(); ++i) {
    const std::uint32_t from = log.data()[i - 1].timestamp_us();
    const std::uint32_t to = log.data()[i].timestamp_us();
    if (from > to && from - to > kWrap_us / 2) {
      const double step = static_cast<double>(log.steps_us()[i - 1]);
      trial.expect(step > 0.0 && step < 20.0 * log.packet_period_us(),
                   "behind the hour's last packet one of the hour's begin",
                   std::to_string(from) + " us, then " + std::to_string(to) + " us");
    }
  }
}

// --- arrival ---

double seconds(std::chrono::nanoseconds time) {
  return std::chrono::duration<double>(time).count();
}

void time_rate(Trial& trial, const Log& log, const Claims&) {
  const double span_s = seconds(log.data().back().datagram().at - log.data().front().datagram().at);
  const double found = static_cast<double>(log.data().size() - 1) / span_s;
  const double right = 1e6 / log.packet_period_us();
  trial.expect(std::abs(found - right) <= 0.02 * right,
               number_text(right) + " data packets in a second, within 2 %", number_text(found));
}

void pace(Trial& trial, const Log& log, const Claims&) {
  double time_us = 0.0;
  for (const std::int64_t step : log.steps_us()) {
    time_us += static_cast<double>(step);
  }
  const double span_s = seconds(log.data().back().datagram().at - log.data().front().datagram().at);
  trial.expect(std::abs(time_us * 1e-6 - span_s) <= 0.02 * span_s,
               "as much time by timestamps as by this machine's clock, within 2 %",
               number_text(time_us * 1e-6) + " s in " + number_text(span_s) + " s");
}

void gaps(Trial& trial, const Log& log, const Claims&) {
  std::vector<double> all_ms;
  for (std::size_t i = 1; i < log.data().size(); ++i) {
    all_ms.push_back(1e3 * seconds(log.data()[i].datagram().at - log.data()[i - 1].datagram().at));
  }
  std::ranges::sort(all_ms);
  trial.observe("half of the packets within " + number_text(all_ms[all_ms.size() / 2]) +
                " ms of the one before, 99 of 100 within " +
                number_text(all_ms[all_ms.size() * 99 / 100]) + " ms, all within " +
                number_text(all_ms.back()) + " ms");
}

std::string several(const Log& log, const Claims& claims) {
  return log.data().size() < 100 ? "too few packets" : all_round(log, claims);
}

}  // namespace

std::vector<VelodyneRow> velodyne_time_rows() {
  return {
      {"time", "Timestamps are within the hour", kTimestamp, kShould, nothing,
       time_within_the_hour},
      {"time", "Timestamps never go back", kTimestamp, kMust, nothing, time_forward},
      {"time", "No packet comes twice", kTimestamp, kShould, nothing, once},
      {"time", "A packet lasts as long as its firings", kTiming, kMust, all_round, whole_periods},
      {"time", "No packet is missing", kTiming, kShould, all_round, none_missing},
      {"time", "The firing clock is the model's", kTiming, kMust, all_round, firing_clock},
      {"time", "The timestamp begins anew with the hour", kTimestamp, kMust, an_hour, at_the_hour},
      {"timing", "Data packets come at the model's rate", kTiming, kShould, several, time_rate},
      {"timing", "The sensor's time goes as this machine's", kTimestamp, kShould, several, pace},
      {"timing", "How evenly data packets come", kTiming, kObserved, several, gaps},
  };
}

}  // namespace rigwire::conform
