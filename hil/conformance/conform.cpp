#include "hil/conformance/conform.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "conform/bounds.h"
#include "conform/canopen/canopen_suite.h"
#include "conform/gige_vision/gige_vision_suite.h"
#include "conform/iso_valves/iso_valves_suite.h"
#include "conform/j1939/j1939_suite.h"
#include "conform/modbus/modbus_suite.h"
#include "conform/nmea/nmea_suite.h"
#include "conform/reports.h"
#include "conform/ubx/ubx_suite.h"
#include "conform/velodyne/velodyne_suite.h"
#include "drivers/endpoints.h"
#include "fields/visitor.h"
#include "hil/configuration/outside_file.h"
#include "hil/conformance/profile_file.h"
#include "hil/conformance/read_structure.h"
#include "hil/conformance/rig_process.h"
#include "hil/control/run.h"
#include "hil/record/output_file.h"

namespace rigwire::hil {

using conform::CaseResult;
using conform::Endpoint;
using conform::SuiteResult;
using conform::Verdict;

namespace {

[[noreturn]] void refuse(const std::string& what, const std::string& found,
                         const std::string& allowed) {
  throw std::invalid_argument(fmt::format("{}: found \"{}\", allowed {}", what, found, allowed));
}

using Kind = Endpoint::Kind;
using Identities = std::vector<conform::CaseIdentity>;

template <class Case>
Identities identities_of(std::vector<Case> cases) {
  Identities all;
  for (Case& each : cases) {
    all.push_back(std::move(each.identity));
  }
  return all;
}

Identities modbus_identities(bool tcp) {
  auto cases = conform::modbus_cases();
  std::erase_if(cases, [&](const conform::ModbusCase& each) {
    return tcp ? each.needs.serial : each.needs.tcp;
  });
  return identities_of(std::move(cases));
}

/// Where the device is; `rig` is the run that simulates it, null for another device.
struct Place {
  std::unique_ptr<RigProcess> rig;
  std::string device;  ///< Name of the device in the rig.
  Endpoint endpoint;
};

/// Tests a device or listens to it. With `request.make_profile` prints the device's claims to
/// `out`, and the result is empty.
using Ask = SuiteResult (*)(const ConformRequest& request, const Place& place, std::ostream& out);

/// What is known of a suite before a device is asked.
struct Suite {
  std::string_view name;
  std::vector<Kind> kinds;  ///< Kinds of endpoint that it accepts.
  std::string_view places;  ///< Text of `kinds` for messages.
  conform::EndpointDefaults defaults;
  bool needs_profile = true;  ///< False: it can test without claims.
  bool sends = true;          ///< False: it only listens.
  /// Limit without --limit: about five times what the suite takes with a device that answers. 0: it
  /// only listens, and ends with --listen.
  std::chrono::minutes limit{10};
  Identities (*identities)();
  Ask ask;
};

/// The bounds of a suite that asks.
std::shared_ptr<conform::Bounds> bounds_of(const ConformRequest& request);

conform::SuiteOptions options_of(const ConformRequest& request) {
  return {request.wanted, request.writes, request.robustness, request.moves.has_value()};
}

SuiteResult ask_modbus(const ConformRequest& request, const Place& place, std::ostream& out) {
  conform::ModbusDevice device;
  device.bounds = bounds_of(request);
  device.endpoint = place.endpoint;
  if (request.make_profile) {
    out << profile_text(survey_modbus(device, request.addresses), request.endpoint);
    return {};
  }
  device.claims = read_modbus_profile(request.profile);
  SuiteResult result = run_modbus_suite(device, options_of(request));
  result.profile_hash = hash_of(profile_text(device.claims, ""));
  return result;
}

SuiteResult ask_nmea(const ConformRequest& request, const Place& place, std::ostream& out) {
  const conform::NmeaClaims claims =
      request.profile.empty() ? conform::NmeaClaims() : read_nmea_profile(request.profile);
  const conform::NmeaLog log = conform::listen_nmea(place.endpoint, request.listen);
  if (request.make_profile) {
    out << profile_text(survey_nmea(log), request.endpoint);
    return {};
  }
  SuiteResult result = run_nmea_suite(log, claims, options_of(request));
  result.profile_hash = hash_of(profile_text(claims, ""));
  return result;
}

SuiteResult ask_ubx(const ConformRequest& request, const Place& place, std::ostream& out) {
  conform::UbxDevice device;
  device.bounds = bounds_of(request);
  device.open = [&place] { return conform::open_bytes(place.endpoint); };
  if (request.make_profile) {
    out << profile_text(survey_ubx(device), request.endpoint);
    return {};
  }
  device.claims = read_ubx_profile(request.profile);
  SuiteResult result = run_ubx_suite(device, options_of(request));
  result.profile_hash = hash_of(profile_text(device.claims, ""));
  return result;
}

SuiteResult ask_canopen(const ConformRequest& request, const Place& place, std::ostream& out) {
  conform::CanopenDevice device;
  device.bounds = bounds_of(request);
  device.open = [&place] { return conform::open_can(place.endpoint); };
  if (request.make_profile) {
    out << profile_text(survey_canopen(device), request.endpoint);
    return {};
  }
  device.claims = read_canopen_profile(request.profile);
  SuiteResult result = run_canopen_suite(device, options_of(request));
  result.profile_hash = hash_of(profile_text(device.claims, ""));
  return result;
}

SuiteResult ask_j1939(const ConformRequest& request, const Place& place, std::ostream& out) {
  conform::J1939Device device;
  device.bounds = bounds_of(request);
  device.open = [&place] { return conform::open_can(place.endpoint); };
  if (request.make_profile) {
    out << profile_text(survey_j1939(device, request.address), request.endpoint);
    return {};
  }
  device.claims = read_j1939_profile(request.profile);
  SuiteResult result = run_j1939_suite(device, options_of(request));
  result.profile_hash = hash_of(profile_text(device.claims, ""));
  return result;
}

SuiteResult ask_iso_valves(const ConformRequest& request, const Place& place, std::ostream& out) {
  conform::IsoValveDevice device;
  device.bounds = bounds_of(request);
  device.open = [&place] { return conform::open_can(place.endpoint); };
  if (request.make_profile) {
    out << profile_text(survey_iso_valves(device), request.endpoint);
    return {};
  }
  device.claims = read_iso_valve_profile(request.profile);
  SuiteResult result = run_iso_valve_suite(device, options_of(request));
  result.profile_hash = hash_of(profile_text(device.claims, ""));
  return result;
}

SuiteResult ask_velodyne(const ConformRequest& request, const Place& place, std::ostream& out) {
  conform::VelodyneClaims claims =
      request.profile.empty() ? conform::VelodyneClaims() : read_velodyne_profile(request.profile);
  const std::string hash = hash_of(profile_text(claims, ""));
  const auto port =
      place.rig ? place.rig->replaced("devices." + place.device + ".position_port") : std::nullopt;
  if (port && claims.position_port != 0) {
    claims.position_port = static_cast<std::uint16_t>(std::stoul(*port));
  }
  const conform::VelodyneLog log = conform::listen_velodyne(place.endpoint, request.listen, claims);
  if (request.make_profile) {
    out << profile_text(survey_velodyne(log), request.endpoint);
    return {};
  }
  SuiteResult result = run_velodyne_suite(log, claims, options_of(request));
  result.profile_hash = hash;
  return result;
}

SuiteResult ask_gige_vision(const ConformRequest& request, const Place& place, std::ostream& out) {
  conform::GigeVisionDevice device;
  device.bounds = bounds_of(request);
  device.camera = {place.endpoint.address, place.endpoint.port};
  device.own_address = conform::own_address_towards(device.camera);
  device.open = [&device] {
    constexpr std::array<std::uint16_t, 3> kOfTheSystemsChoice{};
    return conform::open_datagrams(device.own_address, kOfTheSystemsChoice);
  };
  if (request.make_profile) {
    out << profile_text(survey_gige_vision(device), request.endpoint);
    return {};
  }
  device.claims = read_gige_vision_profile(request.profile);
  SuiteResult result = run_gige_vision_suite(device, options_of(request));
  result.profile_hash = hash_of(profile_text(device.claims, ""));
  return result;
}

const std::vector<Suite>& suites() {
  static const std::vector<Suite> all{
      {"modbus-tcp",
       {Kind::tcp},
       "a server on TCP",
       {.port = 502},
       true,
       true,
       std::chrono::minutes{10},
       [] { return modbus_identities(true); },
       ask_modbus},
      {"modbus-rtu",
       {Kind::serial},
       "a serial line",
       {.rate = 19'200},
       true,
       true,
       std::chrono::minutes{10},
       [] { return modbus_identities(false); },
       ask_modbus},
      {"nmea",
       {Kind::serial, Kind::tcp},
       "a serial line, or a server on TCP",
       {.port = 10'110, .rate = 9600},
       false,
       false,
       std::chrono::minutes{0},
       [] { return identities_of(conform::nmea_cases()); },
       ask_nmea},
      {"ubx",
       {Kind::serial, Kind::tcp},
       "a serial line, or a server on TCP",
       {.port = 2947, .rate = 9600},
       true,
       true,
       std::chrono::minutes{20},
       [] { return identities_of(conform::ubx_cases()); },
       ask_ubx},
      {"canopen",
       {Kind::can, Kind::slcan},
       "an interface of the kernel, or an adapter",
       {.rate = 250'000},
       true,
       true,
       std::chrono::minutes{10},
       [] { return identities_of(conform::canopen_cases()); },
       ask_canopen},
      {"j1939",
       {Kind::can, Kind::slcan},
       "an interface of the kernel, or an adapter",
       {.rate = 250'000},
       true,
       true,
       std::chrono::minutes{15},
       [] { return identities_of(conform::j1939_cases()); },
       ask_j1939},
      {"iso11783-valves",
       {Kind::can, Kind::slcan},
       "an interface of the kernel, or an adapter",
       {.rate = 250'000},
       true,
       true,
       std::chrono::minutes{10},
       [] { return identities_of(conform::iso_valve_cases()); },
       ask_iso_valves},
      {"velodyne",
       {Kind::udp},
       "ports of this machine that it sends to",
       {.port = 2368},
       false,
       false,
       std::chrono::minutes{0},
       [] { return identities_of(conform::velodyne_cases()); },
       ask_velodyne},
      {"gige-vision",
       {Kind::udp},
       "a camera's address and port",
       {.port = 3956},
       true,
       true,
       std::chrono::minutes{10},
       [] { return identities_of(conform::gige_vision_cases()); },
       ask_gige_vision},
  };
  return all;
}

const Suite& suite_of(const std::string& name) {
  return *std::ranges::find(suites(), name, &Suite::name);
}

std::shared_ptr<conform::Bounds> bounds_of(const ConformRequest& request) {
  return std::make_shared<conform::Bounds>(request.limit.value_or(suite_of(request.suite).limit));
}

/// Whether a suite of these cases does anything else with an option of SuiteOptions.
bool asks_for_any(const Identities& identities, bool conform::SuiteOptions::*option) {
  conform::SuiteOptions without{{}, true, true, true};
  without.*option = false;
  return std::ranges::any_of(identities, [&](const conform::CaseIdentity& each) {
    return conform::hindrance(each, "", without).has_value();
  });
}

/// Refuses options for cases that the suite does not have, --limit for a suite that only listens,
/// and --moves for another endpoint.
void check_options(const ConformRequest& request) {
  struct Option {
    std::string_view name;
    bool given;
    bool conform::SuiteOptions::*option;
  };
  const std::array options{
      Option{"--writes", request.writes, &conform::SuiteOptions::writes},
      Option{"--moves", request.moves.has_value(), &conform::SuiteOptions::moves},
      Option{"--robustness", request.robustness, &conform::SuiteOptions::robustness}};
  for (const Option& each : options) {
    if (each.given && !asks_for_any(suite_of(request.suite).identities(), each.option)) {
      std::string allowed;
      for (const Suite& suite : suites()) {
        if (asks_for_any(suite.identities(), each.option)) {
          allowed += fmt::format("{}{}", allowed.empty() ? "" : ", ", suite.name);
        }
      }
      refuse(std::string(each.name), request.suite, "a suite with cases for it: " + allowed);
    }
  }
  if (request.limit && suite_of(request.suite).limit.count() == 0) {
    refuse("--limit", request.suite, "a suite that asks; this one listens for --listen");
  }
  if (request.moves && *request.moves != request.endpoint) {
    refuse("--moves", *request.moves,
           "\"" + request.endpoint + "\", the endpoint itself: its machine may move");
  }
}

/// Returns the endpoint of a wire as run.json describes it: "tcp 127.0.0.1:1502", "slcan PATH +1",
/// "udp 127.0.0.1:2368", or the path of a serial line with its settings behind it.
std::string endpoint_of_wire(const std::string& wire, const std::string& rate,
                             const std::string& device) {
  const std::string scheme = wire.starts_with("/") ? "serial" : wire.substr(0, wire.find(' '));
  const std::string behind = wire.starts_with("/") ? wire : wire.substr(scheme.size() + 1);
  std::string endpoint = scheme + ":" + behind.substr(0, behind.find(' ')) + rate;
  if (!conform::parse_endpoint(endpoint, {1, 1})) {
    refuse("rig device " + device, wire, "a device with its own TCP, UDP, CAN or serial endpoint");
  }
  return endpoint;
}

Place open_place(const ConformRequest& request) {
  const Suite& suite = suite_of(request.suite);
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
    place.device = device;
  }
  const auto endpoint = conform::parse_endpoint(where, suite.defaults);
  if (!endpoint) {
    refuse("endpoint", request.endpoint,
           "tcp:ADDRESS[:PORT], serial:PATH[@BAUD], can:INTERFACE, slcan:PATH[@BITRATE], "
           "udp:[ADDRESS:]PORT or rig:RIG#DEVICE");
  }
  // A listener on UDP receives what is sent to this machine and contacts no other one.
  const bool listens = endpoint->kind == Kind::udp && !suite.sends;
  if (!listens && !endpoint->local() && !request.allow_remote) {
    refuse("endpoint", request.endpoint, "127.0.0.0/8 or ::1, others with --allow-remote");
  }
  if (std::ranges::find(suite.kinds, endpoint->kind) == suite.kinds.end()) {
    refuse("endpoint of " + request.suite, request.endpoint, std::string(suite.places));
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
  v.text("id", p.id, "Identity of the case.");
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
  auto expectations = read_structure<Expectations>(file);
  const Identities known = suite_of(suite).identities();
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
                each.verdict == Verdict::not_reached ||
                (each.verdict == Verdict::lenient && !file.empty()))) {
      lines.push_back(each.identity.id + ": " + verdict);
    }
  }
  return lines;
}

SuiteResult read_result(const std::string& file) {
  try {
    return conform::from_json(nlohmann::json::parse(read_outside_file(file, kResultFile)));
  } catch (const FileRefused& refused) {
    if (refused.missing()) {
      refuse("--beside", file, "a file of --json");
    }
    throw std::invalid_argument(std::string("--beside: ") + refused.what());
  } catch (const std::exception& wrong) {
    throw std::invalid_argument("--beside: " + file + ": no result of --json: " + wrong.what());
  }
}

void write_captures(const SuiteResult& result, const Endpoint& endpoint,
                    const std::string& folder) {
  std::filesystem::create_directories(folder);
  for (const CaseResult& each : result.cases) {
    if (each.steps.empty()) {
      continue;
    }
    std::string name = each.identity.id;
    std::ranges::replace(name, '/', '_');
    const auto bytes = conform::capture_of(each, endpoint);
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
  for (const conform::CaseIdentity& each : suite_of(request.suite).identities()) {
    if (conform::is_wanted(each.id, request.wanted)) {
      out << fmt::format("{:24} {:9} {:7} {} ({})\n", each.id, word(each.strength),
                         word(each.danger), each.title, each.source);
    }
  }
}

}  // namespace

std::vector<std::string> conformance_suites() {
  std::vector<std::string> names;
  for (const Suite& suite : suites()) {
    names.emplace_back(suite.name);
  }
  return names;
}

int conform(const ConformRequest& request, std::ostream& out, std::ostream& err) {
  const auto all = suite_of(request.suite).identities();
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
  const Suite& suite = suite_of(request.suite);
  if (request.profile.empty() && !request.make_profile && suite.needs_profile) {
    refuse("--profile", "", "a file; --make-profile asks the device for one");
  }
  if (request.address && request.suite != "j1939") {
    refuse("--address", std::to_string(*request.address), "with --make-profile of j1939");
  }
  check_options(request);
  std::vector<SuiteResult> results(1);
  Place place;
  try {
    place = open_place(request);
    results[0] = suite.ask(request, place, out);
  } catch (const conform::Unreachable& lost) {
    throw drivers::EndpointError(lost.what());
  } catch (const conform::BoundReached& bound) {
    throw drivers::EndpointError(request.endpoint + ": " + bound.what());
  }
  constexpr double kNoticeable_s = 0.05;
  if (const double slipped_s = place.rig ? place.rig->finish() : 0.0; slipped_s > kNoticeable_s) {
    err << fmt::format(
        "rigwire: the rig fell {:.1f} s behind the clock on this machine: its periods and "
        "time-outs were longer, and may not be its devices'\n",
        slipped_s);
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
  if (const std::size_t missed = result.count(Verdict::not_reached); missed > 0) {
    err << fmt::format("rigwire: {} cases not reached: the time is up; --limit allows more\n",
                       missed);
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
