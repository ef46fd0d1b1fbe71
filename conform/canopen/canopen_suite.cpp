#include "conform/canopen/canopen_suite.h"

#include <algorithm>
#include <iterator>

namespace rigwire::conform {

using std::chrono::milliseconds;

namespace {

std::string missing(const CanopenCase& of, const CanopenClaims& claims) {
  for (const ObjectName object : of.needs) {
    if (!claims.has(object)) {
      return "object " + text_of(object) + " is not claimed";
    }
  }
  return "";
}

/// A node that has just been switched on boots first: it is given some seconds. Whether it answers
/// then is what cases find.
void wait_for_node(CanopenDevice& device) {
  const auto deadline = device.line->now() + std::chrono::seconds(3);
  while (device.line->now() < deadline) {
    CanopenTrial trial({}, device);
    if (!trial.request({0x40, 0x00, 0x10, 0}, "read 1000:0") ||
        trial.hear(trial.with_node(0x580), milliseconds(200))) {
      return;
    }
  }
}

}  // namespace

std::vector<CanopenCase> canopen_cases() {
  Citations cia301("canopen", "CiA 301 V4.2.0");
  std::vector<CanopenCase> all;
  for (auto* chapter :
       {canopen_sdo_cases, canopen_object_cases, canopen_network_cases, canopen_pdo_cases}) {
    std::ranges::move(chapter(cia301), std::back_inserter(all));
  }
  std::ranges::move(canopen_encoder_cases(), std::back_inserter(all));
  return all;
}

SuiteResult run_canopen_suite(CanopenDevice& device, const SuiteOptions& options) {
  SuiteResult result;
  result.suite = "canopen";
  device.bounds->begin();
  device.line = bounded(device.open(), device.bounds);
  prepare_suite([&] { wait_for_node(device); });
  for (const CanopenCase& each : canopen_cases()) {
    if (!is_wanted(each.identity.id, options.wanted)) {
      continue;
    }
    if (auto hindered = hindrance(each.identity, missing(each, device.claims), options)) {
      result.cases.push_back(std::move(*hindered));
      continue;
    }
    result.cases.push_back(try_case(
        each.identity, *device.bounds, [&] { return CanopenTrial(each.identity, device); },
        [&](CanopenTrial& trial) { each.run(trial); }));
  }
  device.line.reset();
  return result;
}

CanopenClaims survey_canopen(CanopenDevice& device) {
  device.bounds->begin();
  device.line = bounded(device.open(), device.bounds);
  CanopenClaims claims = device.claims;
  claims.objects.clear();
  constexpr std::uint8_t kNodes = 127;
  const auto answers = [&](std::uint8_t node) {
    device.claims.node = node;
    CanopenTrial trial({}, device);
    return trial.request({0x40, 0x00, 0x10, 0}, "") &&
           trial.hear(trial.with_node(0x580), milliseconds(30)).has_value();
  };
  std::uint8_t node = 1;
  // A node that has just been switched on boots first.
  const auto deadline = device.line->now() + std::chrono::seconds(10);
  while (!answers(node)) {
    node = node == kNodes ? std::uint8_t{1} : static_cast<std::uint8_t>(node + 1);
    if (device.line->now() > deadline) {
      throw Unreachable("no node of 1 to 127 answers to reading object 1000");
    }
  }
  claims.node = node;
  for (const CanopenCase& each : canopen_cases()) {
    for (const ObjectName object : each.needs) {
      CanopenTrial trial({}, device);
      const bool known = claims.has(object);
      const auto found = known ? std::nullopt : trial.upload(object);
      if (found && !found->abort) {
        claims.objects.push_back(object);
      }
    }
  }
  std::ranges::sort(claims.objects, [](ObjectName a, ObjectName b) {
    return a.index != b.index ? a.index < b.index : a.sub < b.sub;
  });
  device.line.reset();
  device.claims = claims;
  return claims;
}

}  // namespace rigwire::conform
