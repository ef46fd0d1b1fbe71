#include "conform/ubx/ubx_suite.h"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace rigwire::conform {

namespace {

std::string missing(const UbxCase& of, const UbxClaims& claims) {
  for (const std::string_view message : of.needs) {
    if (!claims.has(message)) {
      return std::string(message) + " is not claimed";
    }
  }
  return "";
}

CaseResult run_case(const UbxCase& of, UbxDevice& device) {
  return try_case(
      of.identity, *device.bounds, [&] { return UbxTrial(of.identity, device); },
      [&](UbxTrial& trial) {
        of.run(trial);
        if (!trial.fine()) {  // What is late of this case is not of the next.
          static_cast<void>(trial.listen(std::chrono::milliseconds(300)));
        }
      });
}

/// Opens the line and asks for the version a few times, which gives a receiver that has just been
/// switched on the time to start. Returns whether it has answered. Throws Unreachable.
bool open_line(UbxDevice& device) {
  constexpr int kTries = 3;
  device.line = bounded(device.open(), device.bounds);
  device.arrived.clear();
  device.synchronized = false;
  for (int i = 0; i < kTries; ++i) {
    UbxTrial trial({}, device);
    if (trial.until_version()) {
      return true;
    }
  }
  return false;
}

}  // namespace

std::vector<UbxCase> ubx_cases() {
  UbxCitations citations;
  std::vector<UbxCase> all;
  for (auto* chapter : {ubx_framing_cases, ubx_poll_cases, ubx_field_cases, ubx_epoch_cases,
                        ubx_setting_cases, ubx_item_cases, ubx_rate_cases, ubx_robustness_cases}) {
    std::ranges::move(chapter(citations), std::back_inserter(all));
  }
  return all;
}

SuiteResult run_ubx_suite(UbxDevice& device, const SuiteOptions& options) {
  SuiteResult result;
  result.suite = "ubx";
  device.bounds->begin();
  prepare_suite([&] { static_cast<void>(open_line(device)); });
  for (const UbxCase& each : ubx_cases()) {
    if (is_wanted(each.identity.id, options.wanted)) {
      const auto hindered = hindrance(each.identity, missing(each, device.claims), options);
      result.cases.push_back(hindered ? *hindered : run_case(each, device));
    }
  }
  device.line.reset();
  return result;
}

// Polls every message of the tables, each followed by a poll of MON-VER: a message without an
// answer before that of MON-VER is not claimed. The rate is that of CFG-RATE.
UbxClaims survey_ubx(UbxDevice& device) {
  UbxClaims claims = device.claims;
  claims.messages.clear();
  device.bounds->begin();
  if (open_line(device)) {
    claims.messages.emplace_back("MON-VER");
  }
  for (const UbxMessage& message : ubx_messages()) {
    if (message.poll == UbxPoll::none || message.name == "MON-VER") {
      continue;
    }
    UbxTrial trial({}, device);
    const UbxBytes selector(message.selector.begin(), message.selector.end());
    if (!trial.send(UbxTrial::framed(message.id, selector), "")) {
      break;
    }
    const auto before = trial.until_version();
    const bool answered = before && std::ranges::any_of(*before, [&](const UbxHeard& heard) {
                            return heard.id == message.id;
                          });
    if (!answered) {
      continue;
    }
    claims.messages.emplace_back(message.name);
    if (message.name == "CFG-RATE") {
      const auto rate = trial.poll("CFG-RATE");
      const double period = rate ? rate->value("measRate") * rate->value("navRate") : 0.0;
      claims.rate_hz = period > 0.0 ? std::round(1e6 / period) / 1000.0 : 0.0;
    }
  }
  device.line.reset();
  return claims;
}

}  // namespace rigwire::conform
