#include "hil/conformance/conform.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>

#include "conform/modbus/modbus_suite.h"
#include "conform/nmea/nmea_suite.h"
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

/// A suite, and where its devices are when nobody says otherwise.
struct Suite {
  std::string_view name;
  std::uint16_t port;  ///< Of TCP; 0: devices are on serial lines.
  std::uint32_t baud;  ///< 0: devices are on TCP.
};
constexpr std::array<Suite, 3> kSuites{
    {{"modbus-tcp", 502, 0}, {"modbus-rtu", 0, 19'200}, {"nmea", 10'110, 9600}}};

const Suite& suite_of(const ConformRequest& request) {
  return *std::ranges::find(kSuites, request.suite, &Suite::name);
}

/// All cases that a device of the suite may meet.
std::vector<conform::CaseIdentity> identities(const std::string& suite) {
  std::vector<conform::CaseIdentity> all;
  if (suite == "nmea") {
    for (conform::NmeaCase& each : conform::nmea_cases()) {
      all.push_back(std::move(each.identity));
    }
    return all;
  }
  for (conform::ModbusCase& each : conform::modbus_cases()) {
    if (suite == "modbus-rtu" ? !each.needs.tcp : !each.needs.serial) {
      all.push_back(std::move(each.identity));
    }
  }
  return all;
}

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
std::string endpoint_of_wire(const std::string& wire, const std::string& baud,
                             const std::string& device) {
  if (wire.starts_with("tcp ") && baud.empty()) {
    return "tcp:" + wire.substr(4);
  }
  if (!wire.starts_with("/")) {
    refuse("rig device " + device, wire, "a device on TCP or a serial line of its own");
  }
  return "serial:" + wire.substr(0, wire.find(' ')) + baud;
}

Place open_place(const ConformRequest& request) {
  const Suite& suite = suite_of(request);
  Place place;
  std::string where = request.endpoint;
  if (where.starts_with("rig:")) {
    const std::size_t mark = where.rfind('#');
    if (mark == std::string::npos || mark == 4 || mark + 1 == where.size()) {
      refuse("endpoint", where, "rig:RIG#DEVICE, rig:RIG#DEVICE@BAUD");
    }
    const std::size_t at = std::min(where.size(), where.find('@', mark));
    const std::string device = where.substr(mark + 1, at - mark - 1);
    place.rig = std::make_unique<RigProcess>(where.substr(4, mark - 4));
    where = endpoint_of_wire(place.rig->wire(device), where.substr(at), device);
  }
  const auto endpoint = conform::parse_byte_endpoint(where, suite.port, suite.baud);
  if (!endpoint) {
    refuse("endpoint", request.endpoint,
           "tcp:ADDRESS[:PORT], serial:PATH[@BAUD] or rig:RIG#DEVICE");
  }
  if (!endpoint->local() && !request.allow_remote) {
    refuse("endpoint", request.endpoint, "127.0.0.0/8 or ::1, others with --allow-remote");
  }
  const bool serial = endpoint->kind == ByteEndpoint::Kind::serial;
  if (serial ? suite.baud == 0 : suite.port == 0) {
    refuse("endpoint of " + request.suite, request.endpoint,
           serial ? "a server on TCP" : "a serial line");
  }
  place.endpoint = *endpoint;
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

Expectations read_expectations(const std::string& file, const std::string& suite) {
  Problems problems;
  Origins origins;
  Expectations expectations;
  const Value document = load_document(file, problems);
  if (problems.empty()) {
    read(document, expectations, problems, origins);
  }
  problems.throw_if_any();
  const auto known = identities(suite);
  for (const Expectation& each : expectations.deviations) {
    if (std::ranges::find(known, each.id, &conform::CaseIdentity::id) == known.end()) {
      refuse(file + ": id", each.id, "a case of `rigwire conform SUITE --list`");
    }
  }
  return expectations;
}

/// What is otherwise than the file says; without a file every failure. A line each.
std::vector<std::string> surprises(const SuiteResult& result, const std::string& file) {
  std::map<std::string, std::string> expected;
  if (!file.empty()) {
    for (const Expectation& each : read_expectations(file, result.suite).deviations) {
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
    const auto bytes =
        conform::capture_of(each, endpoint.kind == ByteEndpoint::Kind::serial, endpoint.port);
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
  for (const conform::CaseIdentity& each : identities(request.suite)) {
    if (conform::is_wanted(each.id, request.wanted)) {
      out << fmt::format("{:24} {:9} {:7} {} ({})\n", each.id, word(each.strength),
                         word(each.danger), each.title, each.source);
    }
  }
}

/// Asks the device, or listens to it. With `request.make_profile` prints its claims to `out`, and
/// the result is empty.
SuiteResult ask(const ConformRequest& request, const ByteEndpoint& endpoint, std::ostream& out) {
  const conform::SuiteOptions options{request.wanted, request.writes, request.robustness};
  SuiteResult result;
  if (request.suite == "nmea") {
    const conform::NmeaClaims claims =
        request.profile.empty() ? conform::NmeaClaims() : read_nmea_profile(request.profile);
    const conform::NmeaLog log = conform::listen_nmea(endpoint, request.listen);
    if (request.make_profile) {
      out << profile_text(survey_nmea(log), request.endpoint);
      return result;
    }
    result = run_nmea_suite(log, claims, options);
    result.profile_hash = hash_of(profile_text(claims, ""));
    return result;
  }
  conform::ModbusDevice device;
  device.endpoint = endpoint;
  if (request.make_profile) {
    out << profile_text(survey_modbus(device, request.addresses), request.endpoint);
    return result;
  }
  device.claims = read_modbus_profile(request.profile);
  result = run_modbus_suite(device, options);
  result.profile_hash = hash_of(profile_text(device.claims, ""));
  return result;
}

}  // namespace

std::vector<std::string> conformance_suites() {
  std::vector<std::string> names;
  for (const Suite& suite : kSuites) {
    names.emplace_back(suite.name);
  }
  return names;
}

int conform(const ConformRequest& request, std::ostream& out, std::ostream& err) {
  const auto all = identities(request.suite);
  for (const std::string& wanted : request.wanted) {
    if (std::ranges::none_of(
            all, [&](const auto& each) { return conform::is_wanted(each.id, {wanted}); })) {
      refuse("id", wanted,
             "a case of `rigwire conform " + request.suite +
                 " --list`, or the begin of some at a slash");
    }
  }
  if (request.list) {
    list_cases(request, out);
    return static_cast<int>(ExitCode::done);
  }
  if (request.endpoint.empty()) {
    refuse("endpoint", "", "where the device is, or --list");
  }
  // Who speaks by itself can be looked through without claims.
  if (request.profile.empty() && !request.make_profile && request.suite != "nmea") {
    refuse("--profile", "", "a file; --make-profile asks the device for one");
  }
  if (request.suite == "nmea" && (request.writes || request.robustness)) {
    refuse(request.writes ? "--writes" : "--robustness", request.suite,
           "a suite that sends something");
  }
  std::vector<SuiteResult> results(1);
  Place place;
  try {
    place = open_place(request);
    results[0] = ask(request, place.endpoint, out);
  } catch (const conform::Unreachable& lost) {
    throw drivers::EndpointError(lost.what());
  }
  if (request.make_profile) {
    return static_cast<int>(ExitCode::done);
  }
  SuiteResult& result = results.front();
  result.endpoint = request.endpoint;
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
