// Where the rotor is, and how it turns: azimuths against timestamps.
#include <algorithm>
#include <cmath>
#include <limits>

#include "conform/velodyne/velodyne_rows.h"

namespace rigwire::conform {
namespace {

using Log = VelodyneLog;
using Claims = VelodyneClaims;

constexpr const char* kAzimuth = "63-9113 Rev. H, Packet format; 63-9243 Rev. D, 9.3, azimuth";
constexpr const char* kSpeed = "63-9243 Rev. D, rotation speed";

std::string turning(const Log& log, const Claims& claims) {
  const auto rpm = log.rotor_rpm();
  return !rpm || std::abs(*rpm) < 1.0 ? "its rotor does not turn" : a_model(log, claims);
}
/// Requires an all-round view: after the gap of a narrowed view the time of a firing is unknown.
std::string turning_all_round(const Log& log, const Claims& claims) {
  const std::string missing = all_round(log, claims);
  return missing.empty() ? turning(log, claims) : missing;
}

/// Checks each pair of consecutive firings without a long gap: `check(step_counts, time_ns,
/// within)` returns a Wrong; `within`: both in one packet.
template <class Check>
void each_azimuth_step(Trial& trial, const Log& log, const char* expected, const Check& check) {
  const auto& firings = log.firings();
  for (std::size_t i = 1; i < firings.size(); ++i) {
    const VelodyneFiring& from = firings[i - 1];
    const VelodyneFiring& to = firings[i];
    if (std::abs(to.time_ns - from.time_ns) > kLongestRotorGap_ns) {
      continue;
    }
    if (Wrong wrong = check(azimuth_step(from.azimuth_counts, to.azimuth_counts),
                            to.time_ns - from.time_ns, from.packet == to.packet)) {
      trial.received(log.data()[to.packet].datagram().bytes, *wrong);
      trial.expect(false, expected,
                   std::to_string(from.azimuth_counts) + " to " +
                       std::to_string(to.azimuth_counts) + ": " + *wrong);
      return;
    }
  }
  trial.expect(true, expected, "");
}

void forward(Trial& trial, const Log& log, const Claims&) {
  each_azimuth_step(trial, log, "azimuths that never go back", [](int step, std::int64_t, bool) {
    return step < 0 ? Wrong(std::to_string(step)) : Wrong();
  });
}

/// Counts that a rotor of that speed turns in that time.
double turned(double rotor_rpm, std::int64_t time_ns) {
  return rotor_rpm / 60.0 * 36'000.0 * static_cast<double>(time_ns) * 1e-9;
}

// Encoders of real sensors tremble by some counts from block to block (38 to 42 of a VLP-16).
constexpr double kTremble_counts = 5.0;

void steps(Trial& trial, const Log& log, const Claims&) {
  const double rotor_rpm = *log.rotor_rpm();
  each_azimuth_step(
      trial, log, "within a packet steps of the azimuth as the rotor turns, but for 5 counts",
      [&](int step, std::int64_t time_ns, bool within) {
        const double off = std::abs(step - turned(rotor_rpm, time_ns));
        const double allowed = kTremble_counts + 0.02 * turned(rotor_rpm, time_ns);
        return within && off > allowed ? Wrong(std::to_string(step) + " counts") : Wrong();
      });
}

void from_packet_to_packet(Trial& trial, const Log& log, const Claims&) {
  const double rotor_rpm = *log.rotor_rpm();
  each_azimuth_step(
      trial, log, "from packet to packet as much azimuth as time, within 0.3 degrees",
      [&](int step, std::int64_t time_ns, bool within) {
        const double off = std::remainder(step - turned(rotor_rpm, time_ns), 36'000.0);
        return !within && std::abs(off) > 30.0 ? Wrong(number_text(off / 100.0) + " degrees off")
                                               : Wrong();
      });
}

void covers(Trial& trial, const Log& log, const Claims&) {
  std::vector<bool> seen(360);
  for (const VelodyneFiring& firing : log.firings()) {
    seen[static_cast<std::size_t>(firing.azimuth_counts) / 100 % 360] = true;
  }
  for (std::size_t degree = 0; degree < seen.size(); ++degree) {
    trial.expect(seen[degree], "an azimuth in each degree of the circle",
                 "none in " + std::to_string(degree) + " degrees");
  }
}

std::string narrowed(const Log& log, const Claims& claims) {
  return claims.all_round() ? "its view is not narrowed" : a_model(log, claims);
}

void in_view(Trial& trial, const Log& log, const Claims& claims) {
  const unsigned width_deg = (claims.view_end_deg + 360U - claims.view_start_deg) % 360U;
  for (const VelodyneFiring& firing : log.firings()) {
    const unsigned from_start =
        (static_cast<unsigned>(firing.azimuth_counts) + 36'000U - 100U * claims.view_start_deg) %
        36'000U;
    // Its last degree is included, and azimuths are rounded.
    if (!trial.expect(from_start <= 100U * (width_deg + 1U), "azimuths of the view alone",
                      number_text(firing.azimuth_counts / 100.0) + " degrees")) {
      return;
    }
  }
}

void turns(Trial& trial, const Log& log, const Claims&) {
  trial.observe(number_text(*log.rotor_rpm()) + " rpm");
}

void moves(Trial& trial, const Log& log, const Claims&) {
  const auto rpm = log.rotor_rpm();
  trial.expect(rpm.has_value() && *rpm > 1.0, "a rotor that turns",
               number_text(rpm.value_or(0.0)) + " rpm");
}

void limits(Trial& trial, const Log& log, const Claims&) {
  const double rpm = *log.rotor_rpm();
  trial.expect(
      rpm >= log.model()->minimum_rotor_rpm * 0.99 && rpm <= log.model()->maximum_rotor_rpm * 1.01,
      number_text(log.model()->minimum_rotor_rpm) + " to " +
          number_text(log.model()->maximum_rotor_rpm) + " rpm",
      number_text(rpm) + " rpm");
}

std::string claimed_speed(const Log& log, const Claims& claims) {
  return claims.rotor_rpm == 0.0 ? "no rotor speed is claimed" : all_round(log, claims);
}

void as_claimed(Trial& trial, const Log& log, const Claims& claims) {
  const double rpm = log.rotor_rpm().value_or(0.0);
  trial.expect(std::abs(rpm - claims.rotor_rpm) <= 0.01 * claims.rotor_rpm,
               number_text(claims.rotor_rpm) + " rpm within 1 %", number_text(rpm) + " rpm");
}

// Speeds of whole turns: what trembles once in a turn does not count.
void steady(Trial& trial, const Log& log, const Claims&) {
  const auto& firings = log.firings();
  std::int64_t begin_ns = 0;
  double counts = 0.0;
  double least = std::numeric_limits<double>::infinity();
  double greatest = 0.0;
  bool whole = false;
  for (std::size_t i = 1; i < firings.size(); ++i) {
    if (std::abs(firings[i].time_ns - firings[i - 1].time_ns) > kLongestRotorGap_ns) {
      begin_ns = firings[i].time_ns;
      counts = 0.0;
      continue;
    }
    counts += azimuth_step(firings[i - 1].azimuth_counts, firings[i].azimuth_counts);
    const std::int64_t took_ns = firings[i].time_ns - begin_ns;
    if (counts >= 36'000.0 && took_ns > 0) {
      const double rpm = counts / 36'000.0 / (static_cast<double>(took_ns) * 1e-9) * 60.0;
      least = std::min(least, rpm);
      greatest = std::max(greatest, rpm);
      whole = true;
      begin_ns = firings[i].time_ns;
      counts = 0.0;
    }
  }
  if (!whole) {
    return trial.not_applicable("no whole revolution was received");
  }
  trial.expect(greatest - least <= 0.02 * greatest, "turns of one speed within 2 %",
               number_text(least) + " to " + number_text(greatest) + " rpm");
}

void differs(Trial& trial, const Log& log, const Claims&) {
  std::size_t same = 0;
  std::size_t all = 0;
  each_azimuth_step(trial, log, "", [&](int step, std::int64_t, bool within) {
    all += within ? 1U : 0U;
    same += within && step == 0 ? 1U : 0U;
    return Wrong();
  });
  trial.expect(same * 100 <= all, "another azimuth in each firing, which two returns do not have",
               std::to_string(same) + " of " + std::to_string(all) + " the same");
}

}  // namespace

std::vector<VelodyneRow> velodyne_azimuth_rows() {
  return {
      {"azimuth", "The azimuth never goes back", kAzimuth, kMust, all_round, forward},
      {"azimuth", "The rotor turns", kSpeed, kShould, all_round, moves},
      {"azimuth", "Speed of the rotor", kSpeed, kObserved, turning_all_round, turns},
      {"azimuth", "The rotor is as fast as the model may be", kSpeed, kMust, turning_all_round,
       limits},
      {"azimuth", "The rotor is as fast as it is set", kSpeed, kMust, claimed_speed, as_claimed},
      {"azimuth", "One turn is as fast as the other", kSpeed, kShould, turning_all_round, steady},
      {"azimuth", "Firings of one return have azimuths of their own", kAzimuth, kMust,
       [](const Log& log, const Claims& claims) {
         const std::string missing = one_return(log, claims);
         return missing.empty() ? turning(log, claims) : missing;
       },
       differs},
      {"azimuth", "Within a packet it can be interpolated", kAzimuth, kMust, turning_all_round,
       steps},
      {"azimuth", "From packet to packet it goes with time", kAzimuth, kMust, turning_all_round,
       from_packet_to_packet},
      {"azimuth", "The whole circle is seen", kAzimuth, kShould, turning_all_round, covers},
      {"azimuth", "Only the view is seen", "63-9243 Rev. D, field of view", kMust, narrowed,
       in_view},
  };
}

}  // namespace rigwire::conform
