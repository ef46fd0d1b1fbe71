#include "conform/velodyne/velodyne_suite.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "conform/bounds.h"
#include "conform/datagram_line.h"

namespace rigwire::conform {

using protocols::velodyne::ReturnMode;

namespace {

constexpr std::array<std::string_view, 4> kPulseStates{"absent", "synchronizing", "locked",
                                                       "error"};
constexpr std::uint8_t kPulseError = 3;

}  // namespace

std::string_view return_mode_name(ReturnMode mode) {
  switch (mode) {
    case ReturnMode::strongest:
      return "strongest";
    case ReturnMode::last:
      return "last";
    case ReturnMode::dual:
      return "dual";
  }
  return "";
}

std::string_view pulse_state_name(std::uint8_t state) {
  return state < kPulseStates.size() ? kPulseStates[state] : "unknown";
}

std::vector<VelodyneCase> velodyne_cases() {
  std::vector<VelodyneCase> all;
  Citations citations("velodyne", "");
  for (auto* chapter : {velodyne_data_rows, velodyne_azimuth_rows, velodyne_time_rows,
                        velodyne_return_rows, velodyne_position_rows, velodyne_status_rows}) {
    for (const VelodyneRow& row : chapter()) {
      all.push_back({citations.next_in(row.chapter, row.title, row.source, row.strength),
                     row.missing, row.run});
    }
  }
  return all;
}

VelodyneLog listen_velodyne(const Endpoint& endpoint, std::chrono::nanoseconds span,
                            const VelodyneClaims& claims) {
  std::vector<std::uint16_t> ports{endpoint.port};
  if (claims.position_port != 0) {
    ports.push_back(claims.position_port);
  }
  const auto line = open_datagrams(endpoint.address, ports);
  return listen_velodyne(*line, span, claims);
}

VelodyneLog listen_velodyne(DatagramLine& line, std::chrono::nanoseconds span,
                            const VelodyneClaims& claims) {
  // Twice what a VLS-128 sends of dual returns.
  constexpr std::size_t kPerSecond = 32U << 20U;
  const auto seconds = std::chrono::ceil<std::chrono::seconds>(span);
  const std::size_t most = kPerSecond * (1U + static_cast<std::size_t>(seconds.count()));
  std::size_t came = 0;
  VelodyneLog log;
  const auto begin = line.now();
  while (auto datagram = line.receive(begin + span)) {
    came += datagram->bytes.size() + kItem_bytes;
    if (came > most) {
      log.overflow(std::to_string(most >> 20U) + " MiB in " + std::to_string(seconds.count()) +
                   " s");
      break;
    }
    VelodyneDatagram heard{datagram->at - begin, std::move(datagram->from),
                           std::move(datagram->bytes)};
    if (datagram->at >= begin + span) {
      break;
    }
    if (datagram->at_port == 0) {
      log.add_data(std::move(heard));
    } else {
      log.add_position(std::move(heard));
    }
  }
  log.close(span, line.lost_here(), claims);
  return log;
}

SuiteResult run_velodyne_suite(const VelodyneLog& log, const VelodyneClaims& claims,
                               const SuiteOptions& options) {
  SuiteResult result;
  result.suite = "velodyne";
  for (const VelodyneCase& each : velodyne_cases()) {
    if (!is_wanted(each.identity.id, options.wanted)) {
      continue;
    }
    Trial trial(each.identity);
    if (!log.overflow().empty()) {
      trial.demand(false, "at most " + log.overflow(), "more");
    } else if (log.data_datagrams().empty()) {
      trial.broken("no data packet came");
    } else if (auto hindered = hindrance(each.identity, each.missing(log, claims), options)) {
      result.cases.push_back(std::move(*hindered));
      continue;
    } else if (log.data().empty() && !each.identity.id.starts_with("velodyne/data/")) {
      trial.not_applicable("no data packet had its length");
    } else {
      each.run(trial, log, claims);
    }
    result.cases.push_back(trial.result());
  }
  return result;
}

VelodyneClaims survey_velodyne(const VelodyneLog& log) {
  if (!log.overflow().empty()) {
    throw Unreachable("the device sends without end: more than " + log.overflow());
  }
  VelodyneClaims claims;
  if (log.model() == nullptr) {
    return claims;
  }
  claims.model = log.model()->name;
  claims.return_mode = return_mode_name(log.mode());
  // Rotors are set in whole steps of ten or more.
  claims.rotor_rpm = 10.0 * std::round(log.rotor_rpm().value_or(0.0) / 10.0);
  if (!log.positions().empty() && log.positions().back().pulse_state() < kPulseError) {
    claims.pulse = pulse_state_name(log.positions().back().pulse_state());
  }
  return claims;
}

}  // namespace rigwire::conform
