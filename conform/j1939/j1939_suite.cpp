#include "conform/j1939/j1939_suite.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>

namespace rigwire::conform {

using std::chrono::milliseconds;

namespace {

std::string missing(const J1939Case& of, const J1939Claims& claims) {
  const auto has = [&](std::uint32_t pgn) {
    return std::ranges::find(claims.requested, pgn) != claims.requested.end();
  };
  if (of.periodic != 0 && std::ranges::find(claims.periodic, of.periodic, &PeriodicGroup::pgn) ==
                              claims.periodic.end()) {
    return "group " + pgn_text(of.periodic) + " is not claimed to come by itself";
  }
  if (of.requested != 0 && !has(of.requested)) {
    return "group " + pgn_text(of.requested) + " is not claimed";
  }
  return of.long_group && !long_group_of(claims) ? "no group of more than eight bytes is claimed"
                                                 : "";
}

/// "0, 128"
template <class ByAddress>
std::string addresses_text(const ByAddress& heard) {
  std::string text;
  for (const auto& [address, groups] : heard) {
    text += (text.empty() ? "" : ", ") + std::to_string(address);
  }
  return text;
}

milliseconds rounded(double period_ms) {
  const double step = period_ms < 30 ? 1.0 : period_ms < 300 ? 10.0 : 50.0;
  return milliseconds(std::lround(step * std::round(period_ms / step)));
}

}  // namespace

std::vector<J1939Case> j1939_cases() {
  std::vector<J1939Case> all;
  // Last whose node may not be there behind them.
  for (auto* chapter :
       {j1939_network_cases, j1939_transport_cases, j1939_group_cases, j1939_loss_cases}) {
    std::ranges::move(chapter(), std::back_inserter(all));
  }
  return all;
}

SuiteResult run_j1939_suite(J1939Device& device, const SuiteOptions& options) {
  SuiteResult result;
  result.suite = "j1939";
  device.lost.clear();
  device.bounds->begin();
  prepare_suite([&] { open_line(device); });
  for (const J1939Case& each : j1939_cases()) {
    if (!is_wanted(each.identity.id, options.wanted)) {
      continue;
    }
    if (auto hindered = hindrance(each.identity, missing(each, device.claims), options)) {
      result.cases.push_back(std::move(*hindered));
      continue;
    }
    result.cases.push_back(try_case(
        each.identity, *device.bounds, [&] { return J1939Trial(each.identity, device); },
        [&](J1939Trial& trial) {
          if (device.lost.empty()) {
            each.run(trial);
          } else {
            trial.broken(device.lost);
          }
        }));
  }
  device.line.reset();
  return result;
}

J1939Claims survey_j1939(J1939Device& device, std::optional<std::uint8_t> address) {
  device.bounds->begin();
  open_line(device);
  J1939Claims claims = device.claims;
  claims.periodic.clear();
  claims.requested.clear();
  // Reception times by source address and group.
  std::map<std::uint8_t, std::map<std::uint32_t, std::vector<double>>> heard;
  const auto begin = device.line->now();
  constexpr std::chrono::seconds kSpan{6};
  while (const auto frame = device.line->receive(begin + kSpan)) {
    if (frame->extended && !frame->remote) {
      const std::uint32_t pgn = frame->id >> 8U & 0x3FFFFU;
      heard[static_cast<std::uint8_t>(frame->id)][pgn].push_back(
          std::chrono::duration<double, std::milli>(device.line->now() - begin).count());
    }
  }
  if (heard.empty()) {
    throw Unreachable("no node sends anything on the bus within 6 s");
  }
  const auto most = std::ranges::max_element(heard, {}, [](const auto& each) {
    std::size_t frames = 0;
    for (const auto& [pgn, times] : each.second) {
      frames += times.size();
    }
    return frames;
  });
  claims.address = address.value_or(most->first);
  if (!heard.contains(claims.address)) {
    throw Unreachable("address " + std::to_string(claims.address) + " says nothing in 6 s; found " +
                      addresses_text(heard));
  }
  for (const auto& [pgn, times] : heard[claims.address]) {
    if (times.size() >= 3 && (pgn >> 8U & 0xFFU) >= 240U) {
      std::vector<double> gaps;
      for (std::size_t i = 1; i < times.size(); ++i) {
        gaps.push_back(times[i] - times[i - 1]);
      }
      std::ranges::sort(gaps);
      claims.periodic.push_back({pgn, rounded(gaps[gaps.size() / 2])});
    }
  }
  device.claims = claims;
  for (const std::uint32_t pgn : groups_to_ask_for()) {
    J1939Case asked;
    for (J1939Case& each : j1939_cases()) {
      if (each.requested == pgn) {
        asked = std::move(each);
      }
    }
    J1939Trial trial({}, device);
    asked.run(trial);
    if (trial.fine()) {
      claims.requested.push_back(pgn);
    }
  }
  device.line.reset();
  device.claims = claims;
  return claims;
}

}  // namespace rigwire::conform
