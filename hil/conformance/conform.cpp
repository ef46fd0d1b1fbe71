#include "hil/conformance/conform.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>

#include "conform/modbus/modbus_suite.h"
#include "conform/reports.h"
#include "drivers/endpoints.h"
#include "fields/visitor.h"
#include "hil/configuration/document.h"
#include "hil/configuration/reader.h"
#include "hil/conformance/profile_file.h"
#include "hil/conformance/rig_process.h"
#include "hil/control/run.h"
#include "hil/record/output_file.h"

namespace rigwire::hil {

using conform::ByteEndpoint;
using conform::CaseResult;
using conform::SuiteResult;
using conform::Verdict;

namespace {

constexpr std::uint16_t kModbusPort = 502;
constexpr std::uint32_t kModbusBaud = 19'200;

[[noreturn]] void refuse(const std::string& what, const std::string& found,
                         const std::string& allowed) {
  throw std::invalid_argument(fmt::format("{}: found \"{}\", allowed {}", what, found, allowed));
}

/// A device's place, and the run of a rig that has it.
struct Place {
  std::unique_ptr<RigProcess> rig;
  ByteEndpoint endpoint;
};

/// "tcp 127.0.0.1:1502" of run.json, or the path of a serial line with what stands behind it.
ByteEndpoint endpoint_of_wire(const std::string& wire, const std::string& device) {
  const std::string text = wire.starts_with("tcp ") ? "tcp:" + wire.substr(4)
                           : wire.starts_with("/")  ? "serial:" + wire.substr(0, wire.find(' '))
                                                    : "";
  const auto endpoint = conform::parse_byte_endpoint(text, kModbusPort, kModbusBaud);
  if (!endpoint) {
    refuse("rig device " + device, wire, "a device on TCP or a serial line of its own");
  }
  return *endpoint;
}

Place open_place(const ConformRequest& request) {
  Place place;
  if (request.endpoint.starts_with("rig:")) {
    const std::size_t mark = request.endpoint.rfind('#');
    if (mark == std::string::npos || mark == 4 || mark + 1 == request.endpoint.size()) {
      refuse("endpoint", request.endpoint, "rig:RIG#DEVICE");
    }
    const std::string device = request.endpoint.substr(mark + 1);
    place.rig = std::make_unique<RigProcess>(request.endpoint.substr(4, mark - 4));
    place.endpoint = endpoint_of_wire(place.rig->wire(device), device);
  } else {
    const auto endpoint = conform::parse_byte_endpoint(request.endpoint, kModbusPort, kModbusBaud);
    if (!endpoint) {
      refuse("endpoint", request.endpoint,
             "tcp:ADDRESS[:PORT], serial:PATH[@BAUD] or rig:RIG#DEVICE");
    }
    place.endpoint = *endpoint;
  }
  if (!place.endpoint.local() && !request.allow_remote) {
    refuse("endpoint", request.endpoint, "127.0.0.0/8 or ::1, others with --allow-remote");
  }
  const bool serial = request.suite == "modbus-rtu";
  if (serial != (place.endpoint.kind == ByteEndpoint::Kind::serial)) {
    refuse("endpoint of " + request.suite, request.endpoint,
           serial ? "a serial line" : "a server on TCP");
  }
  return place;
}

/// A known deviation.
struct Expectation {
  std::string id;
  std::string verdict;
  std::string reason;
};
void visit(fields::Visitor& v, Expectation& p) {
  v.required("id");
  v.text("id", p.id, "Of the case.");
  v.required("verdict");
  v.text("verdict", p.verdict, "What is found: lenient, fail or informational.");
  v.required("reason");
  v.text("reason", p.reason, "Why it is so, and is to stay so.");
}
void validate(const Expectation& p) {
  if (p.verdict != word(Verdict::fail) && p.verdict != word(Verdict::lenient)) {
    refuse("verdict", p.verdict, "fail, lenient");
  }
  if (p.reason.empty()) {
    refuse("reason", p.reason, "a sentence");
  }
}
struct Expectations {
  std::vector<Expectation> deviations;
};
void visit(fields::Visitor& v, Expectations& p) {
  v.list("deviations", p.deviations, "Cases that do not pass, and why.");
}

Expectations read_expectations(const std::string& file) {
  Problems problems;
  Origins origins;
  Expectations expectations;
  const Value document = load_document(file, problems);
  if (problems.empty()) {
    read(document, expectations, problems, origins);
  }
  problems.throw_if_any();
  const auto known = conform::modbus_cases();
  for (const Expectation& each : expectations.deviations) {
    if (std::ranges::none_of(known, [&](const auto& of) { return of.identity.id == each.id; })) {
      refuse(file + ": id", each.id, "a case of `rigwire conform SUITE --list`");
    }
  }
  return expectations;
}

/// What is otherwise than the file says; without a file every failure. A line each.
std::vector<std::string> surprises(const SuiteResult& result, const std::string& file) {
  std::map<std::string, std::string> expected;
  if (!file.empty()) {
    for (const Expectation& each : read_expectations(file).deviations) {
      expected[each.id] = each.verdict;
    }
  }
  std::vector<std::string> lines;
  for (const CaseResult& each : result.cases) {
    const std::string verdict(word(each.verdict));
    const auto known = expected.find(each.identity.id);
    const bool tried = each.verdict != Verdict::skipped && each.verdict != Verdict::not_applicable;
    if (known != expected.end() && tried && known->second != verdict) {
      lines.push_back(each.identity.id + ": expected to be " + known->second + ", is " + verdict);
    } else if (known == expected.end() &&
               (each.verdict == Verdict::fail || each.verdict == Verdict::error ||
                (each.verdict == Verdict::lenient && !file.empty()))) {
      lines.push_back(each.identity.id + ": " + verdict);
    }
  }
  return lines;
}

SuiteResult read_result(const std::string& file) {
  std::ifstream stream(file);
  if (!stream) {
    refuse("--beside", file, "a file of --json");
  }
  try {
    return conform::from_json(nlohmann::json::parse(stream));
  } catch (const std::exception& wrong) {
    throw std::invalid_argument("--beside: " + file + ": no result of --json: " + wrong.what());
  }
}

void write_captures(const SuiteResult& result, const ByteEndpoint& endpoint,
                    const std::string& folder) {
  std::filesystem::create_directories(folder);
  for (const CaseResult& each : result.cases) {
    if (each.steps.empty()) {
      continue;
    }
    std::string name = each.identity.id;
    std::ranges::replace(name, '/', '_');
    const auto bytes = conform::capture_of(each, endpoint.kind == ByteEndpoint::Kind::serial,
                                           endpoint.port == 0 ? kModbusPort : endpoint.port);
    const std::string path = folder + "/" + name + ".pcapng";
    std::ofstream file(path, std::ios::binary);
    file.write(reinterpret_cast<const char*>(bytes.data()),
               static_cast<std::streamsize>(bytes.size()));
    if (!file.flush()) {
      throw std::runtime_error(path + ": cannot be written");
    }
  }
}

void list_cases(const ConformRequest& request, std::ostream& out) {
  const bool serial = request.suite == "modbus-rtu";
  for (const conform::ModbusCase& each : conform::modbus_cases()) {
    if ((each.needs.tcp && serial) || (each.needs.serial && !serial) ||
        !conform::is_wanted(each.identity.id, request.wanted)) {
      continue;
    }
    out << fmt::format("{:24} {:9} {:7} {} ({})\n", each.identity.id, word(each.identity.strength),
                       word(each.identity.danger), each.identity.title, each.identity.source);
  }
}

}  // namespace

std::vector<std::string> conformance_suites() {
  return {"modbus-tcp", "modbus-rtu"};
}

int conform(const ConformRequest& request, std::ostream& out, std::ostream& err) {
  if (request.list) {
    list_cases(request, out);
    return static_cast<int>(ExitCode::done);
  }
  if (request.endpoint.empty()) {
    refuse("endpoint", "", "where the device is, or --list");
  }
  const std::vector<conform::ModbusCase> all = conform::modbus_cases();
  for (const std::string& wanted : request.wanted) {
    if (std::ranges::none_of(all, [&](const auto& each) {
          return conform::is_wanted(each.identity.id, {wanted});
        })) {
      refuse("id", wanted,
             "a case of `rigwire conform " + request.suite +
                 " --list`, or the "
                 "begin of some at a slash");
    }
  }
  conform::ModbusDevice device;
  ReadProfile profile;
  if (!request.make_profile) {
    if (request.profile.empty()) {
      refuse("--profile", "", "a file; --make-profile asks the device for one");
    }
    profile = read_modbus_profile(request.profile);
  }
  std::vector<SuiteResult> results(1);
  Place place;
  try {
    place = open_place(request);
    device.endpoint = place.endpoint;
    device.claims = profile.claims;
    if (request.make_profile) {
      out << profile_text(survey_modbus(device, request.addresses), request.endpoint);
      return static_cast<int>(ExitCode::done);
    }
    results[0] = run_modbus_suite(device, {.wanted = request.wanted,
                                           .writes = request.writes,
                                           .robustness = request.robustness,
                                           .ended = nullptr});
  } catch (const conform::Unreachable& lost) {
    throw drivers::EndpointError(lost.what());
  }
  SuiteResult& result = results.front();
  result.endpoint = request.endpoint;
  result.profile_hash = profile.hash;
  if (!request.captures.empty()) {
    write_captures(result, place.endpoint, request.captures);
  }
  if (!request.json.empty()) {
    WholeFile("the result", request.json).write(conform::to_json(result).dump(2) + "\n");
  }
  if (!request.junit.empty()) {
    WholeFile("the JUnit report", request.junit).write(conform::junit_text(result));
  }
  if (request.json != "-" && request.junit != "-" && request.html != "-") {
    for (const CaseResult& each : result.cases) {
      if (each.verdict != Verdict::not_applicable && each.verdict != Verdict::skipped) {
        out << text_line(each);
      }
    }
    out << result.suite << " " << result.endpoint << ": " << summary(result) << "\n";
  }
  const std::vector<std::string> surprising = surprises(result, request.expectations);
  for (const std::string& line : surprising) {
    if (!request.expectations.empty()) {
      err << "rigwire: not as expected: " << line << "\n";
    }
  }
  if (!request.html.empty()) {
    for (const std::string& file : request.beside) {
      results.push_back(read_result(file));
    }
    WholeFile("the page", request.html).write(conform::html_text(results));
  }
  return static_cast<int>(surprising.empty() ? ExitCode::done : ExitCode::different);
}

}  // namespace rigwire::hil
