#include "conform/gige_vision/gige_vision_suite.h"

#include <charconv>
#include <iterator>

#include "conform/endpoint.h"

namespace rigwire::conform {

namespace boot = protocols::gige_vision::bootstrap;

namespace {

std::string missing(const GigeVisionCase& of, const GigeVisionClaims& claims,
                    std::uint32_t capability) {
  if ((of.capability & capability) != of.capability) {
    return "its capability (0x0934) does not have it";
  }
  return of.acquires && !(claims.start && claims.stop)
             ? "acquisition_start and acquisition_stop are not claimed"
             : "";
}

/// Reads the GVCP capability register; throws Unreachable when the camera does not answer.
std::uint32_t capability_of(GigeVisionDevice& device) {
  GigeVisionTrial trial({}, device);
  const auto found = trial.read(boot::kCapability);
  if (!found) {
    const CaseResult result = trial.result();
    throw Unreachable("udp:" + device.camera.address + ":" + std::to_string(device.camera.port) +
                      ": expected " + result.expected + ", got " + result.got);
  }
  return *found;
}

/// Returns the text between the tags of the first `element` in `node`; empty: there is none.
std::string text_of(const std::string& node, const std::string& element) {
  const std::string open = "<" + element + ">";
  const std::size_t begin = node.find(open);
  const std::size_t end =
      begin == std::string::npos ? begin : node.find("</" + element + ">", begin);
  return end == std::string::npos ? ""
                                  : node.substr(begin + open.size(), end - begin - open.size());
}

/// The element that has this name, with what it holds; empty: there is none.
std::string node_named(const std::string& xml, const std::string& name) {
  const std::size_t at = xml.find("Name=\"" + name + "\"");
  const std::size_t begin = at == std::string::npos ? at : xml.rfind('<', at);
  if (begin == std::string::npos) {
    return "";
  }
  const std::string element =
      xml.substr(begin + 1, xml.find_first_of(" \t\r\n", begin) - begin - 1);
  const std::size_t end = xml.find("</" + element + ">", at);
  return end == std::string::npos ? "" : xml.substr(begin, end - begin);
}

std::optional<std::uint32_t> number_of(const std::string& text) {
  const bool hexadecimal = text.starts_with("0x") || text.starts_with("0X");
  const char* const begin = text.data() + (hexadecimal ? 2 : 0);
  const char* const end = text.data() + text.size();
  std::uint32_t value = 0;
  const auto [after, error] = std::from_chars(begin, end, value, hexadecimal ? 16 : 10);
  return error == std::errc() && after == end ? std::optional(value) : std::nullopt;
}

/// The address of a feature's register, where it has one of its own.
std::optional<std::uint32_t> register_of(const std::string& xml, const std::string& feature) {
  std::string node = node_named(xml, feature);
  for (int steps = 0; steps < 4 && !node.empty(); ++steps) {
    if (const auto address = number_of(text_of(node, "Address"))) {
      const bool plain = node.find("<pAddress>") == std::string::npos &&
                         node.find("<IntSwissKnife") == std::string::npos;
      return plain ? address : std::nullopt;
    }
    node = node_named(xml, text_of(node, "pValue"));
  }
  return std::nullopt;
}

std::optional<GigeRegister> command_of(const std::string& xml, const std::string& feature) {
  const auto address = register_of(xml, feature);
  const auto value = number_of(text_of(node_named(xml, feature), "CommandValue"));
  return address ? std::optional(GigeRegister{*address, value.value_or(1)}) : std::nullopt;
}

}  // namespace

std::vector<GigeVisionCase> gige_vision_cases() {
  std::vector<GigeVisionCase> all;
  for (auto* chapter :
       {gige_control_cases, gige_privilege_cases, gige_stream_cases, gige_robustness_cases}) {
    std::ranges::move(chapter(), std::back_inserter(all));
  }
  return all;
}

SuiteResult run_gige_vision_suite(GigeVisionDevice& device, const SuiteOptions& options) {
  SuiteResult result;
  result.suite = "gige-vision";
  device.bounds->begin();
  const std::uint32_t capability = capability_of(device);
  for (const GigeVisionCase& each : gige_vision_cases()) {
    if (!is_wanted(each.identity.id, options.wanted)) {
      continue;
    }
    if (auto hindered =
            hindrance(each.identity, missing(each, device.claims, capability), options)) {
      result.cases.push_back(std::move(*hindered));
      continue;
    }
    result.cases.push_back(try_case(
        each.identity, *device.bounds, [&] { return GigeVisionTrial(each.identity, device); },
        [&](GigeVisionTrial& trial) { each.run(trial); }));
  }
  device.line.reset();
  return result;
}

GigeVisionClaims survey_gige_vision(GigeVisionDevice& device) {
  GigeVisionClaims claims = device.claims;
  device.bounds->begin();
  static_cast<void>(capability_of(device));
  GigeVisionTrial trial({}, device);
  if (const auto bytes = gige_description(trial)) {
    const std::string xml(bytes->begin(), bytes->end());
    claims.start = command_of(xml, "AcquisitionStart");
    claims.stop = command_of(xml, "AcquisitionStop");
    claims.payload_size = register_of(xml, "PayloadSize");
  }
  device.line.reset();
  return claims;
}

}  // namespace rigwire::conform
