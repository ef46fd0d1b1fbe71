#include "hil/command_line/command_line.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <iostream>
#include <memory>
#include <new>
#include <optional>
#include <sstream>
#include <string_view>

#include "drivers/endpoints.h"
#include "fields/failure_text.h"
#include "fields/visitor.h"
#include "hil/command_line/arguments.h"
#include "hil/command_line/manual_page.h"
#include "hil/command_line/status_reporter.h"
#include "hil/command_line/verbs.h"
#include "hil/configuration/build_facts.h"
#include "hil/configuration/plain_text.h"
#include "hil/configuration/suggest.h"

namespace rigwire::hil {

namespace {

constexpr std::array kVerbs{"run",    "picture", "check",    "list",       "describe",
                            "schema", "doctor",  "bench",    "conform",    "ctl",
                            "record", "replay",  "campaign", "completion", "man"};

int usage(const std::string& message, std::ostream& err, const std::string& help = "") {
  err << "rigwire: " << message << "\n"
      << "Try: rigwire " << (help.empty() ? "" : help + " ") << "--help\n";
  return static_cast<int>(ExitCode::usage);
}

/// A mistyped verb or option, with the one that was probably meant.
std::optional<std::string> find_typo(const CLI::App& app,
                                     const std::vector<std::string>& arguments) {
  std::vector<std::string> verbs(kVerbs.begin(), kVerbs.end());
  if (arguments.empty()) {
    return "no verb, allowed " + join_words(verbs);
  }
  const std::string& verb = arguments.front();
  const CLI::App* used = &app;
  if (!verb.starts_with("-")) {
    if (std::find(verbs.begin(), verbs.end(), verb) == verbs.end()) {
      const std::string near = nearest_word(verb, verbs);
      return fmt::format("unknown verb, found \"{}\", allowed {}{}", verb, join_words(verbs),
                         near.empty() ? "" : ", did you mean " + near + "?");
    }
    used = app.get_subcommand(verb);
  }
  std::vector<std::string> options;
  for (const CLI::Option* option : used->get_options()) {
    for (const std::string& name : option->get_lnames()) {
      options.push_back("--" + name);
    }
  }
  for (const std::string& argument : arguments) {
    if (argument == "--") {
      break;
    }
    const std::string name = argument.substr(0, argument.find('='));
    if (name.starts_with("--") &&
        std::find(options.begin(), options.end(), name) == options.end()) {
      const std::string near = nearest_word(name, options);
      return fmt::format("unknown option, found \"{}\", allowed {}{}", name, join_words(options),
                         near.empty() ? "" : ", did you mean " + near + "?");
    }
  }
  return std::nullopt;
}

/// Returns the name of an option or argument with an empty value, such as an unset variable of a
/// script leaves behind; nullopt when there is none.
std::optional<std::string> find_empty(const CLI::App& used,
                                      const std::vector<std::string>& arguments) {
  for (const CLI::Option* option : used.get_options()) {
    const std::string name = option->get_name();
    if (std::ranges::find(option->results(), std::string()) != option->results().end()) {
      return name;
    }
    // CLI11 takes the next argument as the value of "--name=".
    for (const std::string& argument : arguments) {
      if (argument == "--") {
        break;
      }
      if (option->get_items_expected_max() > 0 && argument == name + "=") {
        return name;
      }
    }
  }
  return std::nullopt;
}

std::optional<Duration> parse_duration(const std::string& text) {
  const auto quantity = fields::split_quantity(text);
  if (!quantity) {
    return std::nullopt;
  }
  const fields::Unit* unit =
      fields::find_unit(quantity->unit.empty() ? "s" : quantity->unit, fields::Dimension::time);
  if (unit == nullptr) {
    return std::nullopt;
  }
  const double seconds = quantity->value * unit->numerator / unit->denominator;
  constexpr double kLongest_s = 9.0e9;
  if (!(seconds > 0.0) || seconds > kLongest_s) {
    return std::nullopt;
  }
  return from_seconds(seconds);
}

std::optional<LogLevel> parse_log_level(const std::string& text) {
  const auto it = std::ranges::find(kLogLevels, text);
  return it == kLogLevels.end() ? std::nullopt
                                : std::optional(static_cast<LogLevel>(it - kLogLevels.begin()));
}

int refuse_log_level(const std::string& found, Terminal terminal, const std::string& verb) {
  const std::vector<std::string> levels(kLogLevels.begin(), kLogLevels.end());
  const std::string near = nearest_word(found, levels);
  return usage(fmt::format("--log-level: unknown level, found \"{}\", allowed {}{}", found,
                           join_words(levels), near.empty() ? "" : ", did you mean " + near + "?"),
               terminal.err, verb);
}

int refuse_control(const std::string& found, const std::string& where, Terminal terminal,
                   const std::string& verb) {
  return usage(
      fmt::format("{}: not an address of a control server, found \"{}\", allowed unix:FILE, "
                  "or PORT of this host as 127.X.Y.Z:PORT (from another one: ssh -L)",
                  where, found),
      terminal.err, verb);
}

/// The token of requests to a control server at a port, from the environment and not from the
/// command line, where all users see it. Empty: there is none. Throws std::invalid_argument for one
/// that can be guessed, or that a header of HTTP cannot carry.
std::string token_of_environment() {
  constexpr std::size_t kShortest = 16;
  constexpr std::size_t kLongest = 256;
  const char* const variable = std::getenv("RIGWIRE_CONTROL_TOKEN");
  std::string token = variable == nullptr ? "" : variable;
  const bool printable = std::ranges::all_of(token, [](char c) { return c > ' ' && c <= '~'; });
  if (!token.empty() && (token.size() < kShortest || token.size() > kLongest || !printable)) {
    throw std::invalid_argument(fmt::format(
        "RIGWIRE_CONTROL_TOKEN: {}, allowed {} to {} printable characters of ASCII without spaces; "
        "without the variable a run makes one",
        printable ? fmt::format("found {} characters", token.size())
                  : "found a character that is a space or cannot be printed",
        kShortest, kLongest));
  }
  return token;
}

int dispatch_ctl(const Parsed& parsed, Terminal terminal) {
  const auto endpoint = parse_control_endpoint(parsed.control);
  if (!endpoint) {
    return refuse_control(parsed.control, "endpoint", terminal, "ctl");
  }
  return ctl_verb(*endpoint, token_of_environment(),
                  {parsed.word, parsed.request, parsed.record.only, parsed.follow, parsed.stop},
                  terminal);
}

/// Exit code of what is wrong with them; nothing when they are right.
std::optional<int> read_overrun(const Parsed& parsed, RunOptions& options, Terminal terminal) {
  if (!parsed.overrun) {
    return std::nullopt;
  }
  const std::vector<std::string> policies(kOverrunPolicies.begin(), kOverrunPolicies.end());
  const auto policy = std::find(policies.begin(), policies.end(), *parsed.overrun);
  if (policy == policies.end()) {
    const std::string near = nearest_word(*parsed.overrun, policies);
    return usage(fmt::format("--overrun: unknown policy, found \"{}\", allowed slip, warn, stop{}",
                             *parsed.overrun, near.empty() ? "" : ", did you mean " + near + "?"),
                 terminal.err, "run");
  }
  if (!options.clock.paced()) {
    return usage(fmt::format("--overrun: the clock {} waits for the host, allowed with real and "
                             "scaled:X",
                             to_string(options.clock)),
                 terminal.err, "run");
  }
  options.overrun = static_cast<OverrunPolicy>(policy - policies.begin());
  const auto limit =
      parsed.overrun_limit ? parse_duration(*parsed.overrun_limit) : options.overrun_limit;
  constexpr Duration kLeast = std::chrono::milliseconds{1};
  constexpr Duration kMost = std::chrono::hours{1};
  if (!limit || *limit < kLeast || *limit > kMost) {
    return usage(
        fmt::format("--overrun-limit: found \"{}\", allowed 1 ms .. 1 h", *parsed.overrun_limit),
        terminal.err, "run");
  }
  options.overrun_limit = *limit;
  return std::nullopt;
}

int dispatch_run(Parsed& parsed, Terminal terminal) {
  RunOptions options;
  const auto level = parse_log_level(parsed.log_level);
  if (!level) {
    return refuse_log_level(parsed.log_level, terminal, "run");
  }
  options.log_level = *level;
  const auto clock = parse_clock_mode(parsed.clock);
  if (!clock) {
    return usage(fmt::format("--clock: unknown clock, found \"{}\", allowed real, free, step, "
                             "drained, scaled:X with X = 0.01 .. 1000",
                             parsed.clock),
                 terminal.err, "run");
  }
  options.clock = *clock;
  if (parsed.patience) {
    const auto patience = parse_duration(*parsed.patience);
    if (!patience || clock->kind != ClockMode::Kind::drained) {
      return usage(fmt::format("--patience: found \"{}\" with the clock {}, allowed a time such as "
                               "500 ms, with the clock drained",
                               *parsed.patience, to_string(*clock)),
                   terminal.err, "run");
    }
    options.patience = *patience;
  }
  if (const auto refused = read_overrun(parsed, options, terminal)) {
    return *refused;
  }
  if (parsed.awake && !clock->paced()) {
    return usage(fmt::format("--awake: the clock {} waits for no instant, allowed with real and "
                             "scaled:X",
                             to_string(*clock)),
                 terminal.err, "run");
  }
  options.awake = parsed.awake;
  options.isolated_folder = parsed.isolated;
  if (!parsed.isolated.empty()) {
    const std::string folder = std::filesystem::absolute(parsed.isolated).string();
    parsed.control = parsed.control.empty() ? "unix:" + folder + "/control" : parsed.control;
    parsed.report = parsed.report.empty() ? folder + "/report.json" : parsed.report;
  }
  if (!parsed.control.empty()) {
    options.control = parse_control_endpoint(parsed.control);
    if (!options.control) {
      return refuse_control(parsed.control, "--control", terminal, "run");
    }
  } else if (clock->kind == ClockMode::Kind::step && !parsed.dashboard) {
    return usage("--clock step needs --control or --dashboard", terminal.err, "run");
  }
  options.control_token = token_of_environment();
  options.dashboard = parsed.dashboard;
  options.ready_descriptor = parsed.ready_fd;
  if (parsed.duration) {
    options.duration = parse_duration(*parsed.duration);
    if (!options.duration) {
      return usage(fmt::format("--duration: not a time above 0, found \"{}\", allowed for example "
                               "20s, 500 ms, 5min",
                               *parsed.duration),
                   terminal.err, "run");
    }
  }
  const bool terminal_out = ::isatty(STDOUT_FILENO) == 1;
  const char* no_colour = std::getenv("NO_COLOR");
  const bool colour = terminal_out && (no_colour == nullptr || *no_colour == '\0');
  const std::vector<std::string> styles{"live", "plain", "none"};
  // The report has standard output for itself, unless the table is asked for.
  const std::string usual = parsed.report == "-" ? "none" : terminal_out ? "live" : "plain";
  const std::string style = parsed.status.empty() ? usual : parsed.status;
  const auto it = std::find(styles.begin(), styles.end(), style);
  if (it == styles.end()) {
    const std::string near = nearest_word(style, styles);
    return usage(fmt::format("--status: unknown style, found \"{}\", allowed live, plain, none{}",
                             style, near.empty() ? "" : ", did you mean " + near + "?"),
                 terminal.err, "run");
  }
  if (style != "none") {
    options.onlooker = status_onlooker(style == "live" ? StatusStyle::live : StatusStyle::plain,
                                       colour, options.clock);
  }
  options.report_path = parsed.report;
  options.truth_path = parsed.truth;
  options.lidar_truth_path = parsed.lidar_truth;
  options.record = parsed.record;
  options.camera_truth_folder = parsed.camera_truth;
  if (parsed.seed) {
    parsed.rig.sets.push_back("seed=" + *parsed.seed);
  }
  return run_verb(parsed.rig, options, parsed.dry_run, terminal);
}

/// A speed, forward positive.
std::optional<double> parse_speed(const std::string& text) {
  const auto quantity = fields::split_quantity(text);
  if (!quantity) {
    return std::nullopt;
  }
  const fields::Unit* unit =
      fields::find_unit(quantity->unit.empty() ? "m/s" : quantity->unit, fields::Dimension::speed);
  if (unit == nullptr) {
    return std::nullopt;
  }
  constexpr double kFastest_mps = 100.0;
  const double speed_mps = quantity->value * unit->numerator / unit->denominator;
  return std::abs(speed_mps) <= kFastest_mps ? std::optional(speed_mps) : std::nullopt;
}

int dispatch_picture(const Parsed& parsed, Terminal terminal) {
  PictureRequest request;
  request.device = parsed.camera;
  const auto at = parse_duration(parsed.at);
  if (!at) {
    return usage(fmt::format("--at: not a time above 0, found \"{}\", allowed for example 12.5s, "
                             "500 ms, 5min",
                             parsed.at),
                 terminal.err, "picture");
  }
  request.at = kStart + *at;
  if (!parsed.travel.empty()) {
    request.travel_mps = parse_speed(parsed.travel);
    if (!request.travel_mps) {
      return usage(fmt::format("--travel: not a speed, found \"{}\", allowed for example 20km/h, "
                               "3 m/s, up to 100 m/s",
                               parsed.travel),
                   terminal.err, "picture");
    }
  }
  const auto layer = std::ranges::find(kPictureLayers, parsed.layer);
  if (layer == kPictureLayers.end()) {
    const std::vector<std::string> layers(kPictureLayers.begin(), kPictureLayers.end());
    const std::string near = nearest_word(parsed.layer, layers);
    return usage(
        fmt::format("--layer: unknown layer, found \"{}\", allowed {}{}", parsed.layer,
                    join_words(layers), near.empty() ? "" : ", did you mean " + near + "?"),
        terminal.err, "picture");
  }
  return picture_verb(parsed.rig, request,
                      static_cast<PictureLayer>(layer - kPictureLayers.begin()), parsed.raw,
                      parsed.output, terminal);
}

int dispatch_record(const Parsed& parsed, Terminal terminal) {
  if (parsed.word != "info" && parsed.word != "cut" && parsed.word != "export") {
    return refuse_word("action", parsed.word, {"info", "cut", "export"}, terminal);
  }
  if (parsed.word == "export") {
    if (parsed.output.empty() || parsed.json || !(parsed.from + parsed.to).empty()) {
      return usage("record export: allowed -o FILE and --topic", terminal.err, "record");
    }
    return record_export_verb(parsed.recording, parsed.topic.empty() ? "truth" : parsed.topic,
                              parsed.output, terminal);
  }
  if (!parsed.topic.empty()) {
    return usage("record " + parsed.word + ": --topic is of export", terminal.err, "record");
  }
  const bool cuts = parsed.word == "cut";
  if (cuts && (parsed.output.empty() || parsed.json)) {
    return usage("record cut: allowed -o FOLDER, --from and --to", terminal.err, "record");
  }
  if (!cuts && !(parsed.output + parsed.from + parsed.to).empty()) {
    return usage("record info: allowed --json", terminal.err, "record");
  }
  if (!cuts) {
    return record_info_verb(parsed.recording, parsed.json, terminal);
  }
  const auto from = parsed.from.empty() ? std::optional(Duration{0}) : parse_duration(parsed.from);
  const auto to =
      parsed.to.empty() ? std::optional<Duration>(kNever - kStart) : parse_duration(parsed.to);
  if (!from || !to || *from >= *to) {
    return usage(fmt::format("record cut: no span of time, found --from {} --to {}, allowed for "
                             "example --from 2s --to 2500ms",
                             parsed.from, parsed.to),
                 terminal.err, "record");
  }
  return record_cut_verb(parsed.recording, kStart + *from, kStart + *to, parsed.output, terminal);
}

/// `from`: of --from.
int dispatch_shown(const Parsed& parsed, RunOptions options, Duration from, Terminal terminal) {
  if (!parsed.control.empty()) {
    options.control = parse_control_endpoint(parsed.control);
    if (!options.control) {
      return refuse_control(parsed.control, "--control", terminal, "replay");
    }
  }
  options.control_token = token_of_environment();
  options.ready_descriptor = parsed.ready_fd;
  return show_verb(parsed.recording, std::move(options), kStart + from);
}

int dispatch_replay(const Parsed& parsed, Terminal terminal) {
  const auto level = parse_log_level(parsed.log_level);
  if (!level) {
    return refuse_log_level(parsed.log_level, terminal, "replay");
  }
  const bool plays = parsed.loop || !(parsed.to + parsed.speed).empty();
  const bool governed = !parsed.control.empty() || parsed.ready_fd;
  const bool all_else = plays || !parsed.from.empty() || parsed.dashboard || governed ||
                        parsed.clock != Parsed{}.clock;
  if (parsed.verify ? all_else : parsed.json || (parsed.dashboard ? plays : governed)) {
    return usage(
        "replay: allowed either --verify with --json, or --dashboard with --clock, --from, "
        "--control, --ready-fd, or --clock, --loop, --speed, --from, --to",
        terminal.err, "replay");
  }
  if (parsed.verify) {
    return verify_verb(parsed.recording, parsed.json, *level, terminal);
  }
  RunOptions options;
  options.log_level = *level;
  const auto clock = parse_clock_mode(parsed.clock);
  if (!clock || !(clock->paced() || (clock->kind == ClockMode::Kind::free && !parsed.dashboard))) {
    return usage(fmt::format("--clock: not a clock of a replay, found \"{}\", allowed real, {}"
                             "scaled:X with X = 0.01 .. 1000",
                             parsed.clock, parsed.dashboard ? "" : "free, "),
                 terminal.err, "replay");
  }
  options.clock = *clock;
  ReplayedPiece piece;
  piece.loop = parsed.loop;
  if (!parsed.speed.empty()) {
    char* end = nullptr;
    piece.speed = std::strtod(parsed.speed.c_str(), &end);
    if (*end != '\0' || !(piece.speed >= 0.001 && piece.speed <= 1000.0)) {
      return usage(fmt::format("--speed: found \"{}\", allowed 0.001 .. 1000", parsed.speed),
                   terminal.err, "replay");
    }
  }
  const auto from = parsed.from.empty() ? std::optional(Duration{0}) : parse_duration(parsed.from);
  const auto to = parsed.to.empty() ? std::optional(Duration{0}) : parse_duration(parsed.to);
  if (!from || !to || (!parsed.to.empty() && *from >= *to)) {
    return usage(fmt::format("replay: no span of time, found --from {} --to {}, allowed for "
                             "example --from 2s --to 2500ms",
                             parsed.from, parsed.to),
                 terminal.err, "replay");
  }
  if (parsed.dashboard) {
    return dispatch_shown(parsed, std::move(options), *from, terminal);
  }
  piece.from = *from;
  piece.to = *to;
  return replay_verb(parsed.recording, piece, std::move(options), terminal);
}

int dispatch_conform(Parsed& parsed, const CompanionVerbs& companions, Terminal terminal) {
  const std::vector<std::string> suites = companions.conformance_suites();
  if (std::ranges::find(suites, parsed.conform.suite) == suites.end()) {
    return refuse_word("suite", parsed.conform.suite, suites, terminal);
  }
  if (parsed.listen) {
    const auto listen = parse_duration(*parsed.listen);
    constexpr Duration kMost = std::chrono::hours{24};
    const bool listens = parsed.conform.suite == "nmea" || parsed.conform.suite == "velodyne";
    if (!listen || *listen > kMost || !listens) {
      return usage(fmt::format("--listen: found \"{}\", allowed a time up to 24 h, with nmea or "
                               "velodyne",
                               *parsed.listen),
                   terminal.err, "conform");
    }
    parsed.conform.listen = *listen;
  }
  if (parsed.limit) {
    const auto limit = parse_duration(*parsed.limit);
    if (!limit || *limit < std::chrono::seconds{1} || *limit > std::chrono::hours{24}) {
      return usage(
          fmt::format("--limit: found \"{}\", allowed a time from 1 s to 24 h", *parsed.limit),
          terminal.err, "conform");
    }
    parsed.conform.limit = *limit;
  }
  return companions.conform(parsed.conform, terminal.out, terminal.err);
}

/// The program that has the verb which was asked for, if it is not this one.
std::optional<std::string> program_of(const CLI::App& app, const Parsed& parsed,
                                      const CompanionVerbs& companions) {
  if (app.got_subcommand("conform") && companions.conform == nullptr) {
    return "rigwire-conform";
  }
  const bool campaigns =
      app.got_subcommand("campaign") || (app.got_subcommand("schema") && parsed.word == "campaign");
  if (campaigns && companions.campaign == nullptr) {
    return "rigwire-campaign";
  }
  return std::nullopt;
}

int dispatch(const CLI::App& app, Parsed& parsed, const CompanionVerbs& companions,
             Terminal terminal) {
  if (app.got_subcommand("picture")) {
    return dispatch_picture(parsed, terminal);
  }
  if (app.got_subcommand("run")) {
    return dispatch_run(parsed, terminal);
  }
  if (app.got_subcommand("record")) {
    return dispatch_record(parsed, terminal);
  }
  if (app.got_subcommand("replay")) {
    return dispatch_replay(parsed, terminal);
  }
  if (app.got_subcommand("check")) {
    const auto level = parse_log_level(parsed.log_level);
    return level ? check_verb(parsed.rig, *level, parsed.print, parsed.json, terminal)
                 : refuse_log_level(parsed.log_level, terminal, "check");
  }
  if (app.got_subcommand("list")) {
    if (parsed.word == "keys" && !parsed.rig.rig.empty()) {
      return list_keys_verb(parsed.rig.rig, parsed.from, parsed.json, terminal);
    }
    if (parsed.word == "keys" || !parsed.rig.rig.empty()) {
      return usage("list: allowed keys RIG [BEGIN], or another kind alone", terminal.err, "list");
    }
    return list_verb(parsed.word, parsed.json, terminal);
  }
  if (app.got_subcommand("describe")) {
    if (!parsed.eds.rig.empty()) {
      return eds_verb(parsed.eds, parsed.node, terminal);
    }
    if (!parsed.rig.rig.empty() && parsed.word.empty() && parsed.valve_map.empty()) {
      return dbc_verb(parsed.rig, parsed.bus, parsed.units, terminal);
    }
    if (!parsed.dbc_node.empty()) {
      return describe_dbc_node_verb(parsed.dbc_node, terminal);
    }
    if (parsed.word.empty() == parsed.valve_map.empty()) {
      return usage("describe: allowed a device, --valve-map FILE or --dbc-node FILE", terminal.err,
                   "describe");
    }
    return parsed.valve_map.empty() ? describe_verb(parsed.word, parsed.json, terminal)
                                    : describe_valve_map_verb(parsed.valve_map, terminal);
  }
  if (app.got_subcommand("ctl")) {
    return dispatch_ctl(parsed, terminal);
  }
  if (app.got_subcommand("schema")) {
    if (parsed.word == "campaign") {
      terminal.out << companions.campaign_schema();
      return static_cast<int>(ExitCode::done);
    }
    return schema_verb(parsed.word.empty() ? "rig" : parsed.word, terminal);
  }
  if (app.got_subcommand("doctor")) {
    return doctor_verb(parsed.json, terminal);
  }
  if (app.got_subcommand("conform")) {
    return dispatch_conform(parsed, companions, terminal);
  }
  if (app.got_subcommand("man")) {
    terminal.out << manual_page(app, version());
    return static_cast<int>(ExitCode::done);
  }
  if (app.got_subcommand("campaign")) {
    return companions.campaign(parsed.campaign, terminal);
  }
  if (app.got_subcommand("bench")) {
    return become_program("rigwire-bench", app.get_subcommand("bench")->remaining(), terminal);
  }
  return completion_verb(parsed.word, terminal);
}

int parse_and_dispatch(const std::vector<std::string>& arguments, const CompanionVerbs& companions,
                       Terminal terminal) {
  for (const std::string& argument : arguments) {
    if (const auto fault = find_fault(argument, TextShape::lines)) {
      return usage(
          fmt::format("argument {}: {}, found {}, allowed UTF-8 without control characters",
                      argument, fault->what, fault->found),
          terminal.err, "");
    }
  }
  CLI::App app("Rigwire makes simulated field machines speak the wire protocols of real devices.",
               "rigwire");
  Parsed parsed;
  declare(app, parsed);
  app.require_subcommand(1);
  const auto empty_value = [&]() -> std::optional<std::string> {
    const auto used = app.get_subcommands();
    return used.empty() || used.front()->get_name() == "bench"
               ? std::nullopt
               : find_empty(*used.front(), arguments);
  };
  const auto refuse_empty = [&](const std::string& name) {
    return usage(fmt::format("{}: empty, allowed a value; leave it out where none is meant", name),
                 terminal.err, app.get_subcommands().front()->get_name());
  };
  try {
    std::vector<std::string> reversed(arguments.rbegin(), arguments.rend());
    app.parse(reversed);
  } catch (const CLI::CallForVersion& version) {
    terminal.out << version.what() << "\n";
    return static_cast<int>(ExitCode::done);
  } catch (const CLI::CallForHelp&) {
    const auto used = app.get_subcommands();
    terminal.out << (used.empty() ? app.help() : used.front()->help("rigwire"));
    return static_cast<int>(ExitCode::done);
  } catch (const CLI::ParseError& error) {
    if (const auto name = empty_value()) {
      return refuse_empty(*name);
    }
    const auto used = app.get_subcommands();
    const std::string verb = used.empty() ? "" : used.front()->get_name();
    return usage(find_typo(app, arguments).value_or(error.what()), terminal.err, verb);
  }
  if (const auto name = empty_value()) {
    return refuse_empty(*name);
  }
  try {
    if (const auto program = program_of(app, parsed, companions)) {
      return become_program(*program, arguments, terminal);
    }
    return dispatch(app, parsed, companions, terminal);
  } catch (const ConfigurationError& error) {
    terminal.err << error.what() << "\n";
    const std::size_t count = error.problems().size();
    terminal.err << fmt::format("rigwire: {} {} in the configuration\n", count,
                                count == 1 ? "problem" : "problems");
    return static_cast<int>(ExitCode::usage);
  } catch (const drivers::EndpointError& error) {
    terminal.err << "rigwire: " << error.what() << "\n";
    return static_cast<int>(ExitCode::environment);
  } catch (const std::invalid_argument& error) {
    terminal.err << "rigwire: " << error.what() << "\n";
    return static_cast<int>(ExitCode::usage);
  } catch (const std::filesystem::filesystem_error& error) {
    terminal.err << fmt::format("rigwire: {}: {}\n", error.path1().string(),
                                error.code().message());
    return static_cast<int>(ExitCode::environment);
  } catch (const std::exception& error) {
    terminal.err << "rigwire: "
                 << fields::failure_text(
                        error, "`rigwire " + fmt::format("{}", fmt::join(arguments, " ")) + "`")
                 << "\n";
    return static_cast<int>(ExitCode::failure);
  }
}

}  // namespace

int run_command_line(const std::vector<std::string>& arguments, std::ostream& out,
                     std::ostream& err, const CompanionVerbs& companions) {
  constexpr std::string_view kLayout = "\n\t";
  constexpr std::string_view kFileLayout = "\r\n\t";  // what an EDS file must have
  std::ostringstream results;
  std::ostringstream complaints;
  int code = parse_and_dispatch(arguments, companions, {results, complaints});
  errno = 0;
  out << printable(results.str(), kFileLayout) << std::flush;
  const int error = errno;
  err << printable(complaints.str(), kLayout) << std::flush;
  if (!out) {
    err << "rigwire: standard output is not complete: " << std::strerror(error) << std::endl;
    code = code == static_cast<int>(ExitCode::done) ? static_cast<int>(ExitCode::failure) : code;
  }
  return code;
}

int run_program(int count, char** arguments, const CompanionVerbs& companions) {
  for (const int descriptor : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (::fcntl(descriptor, F_GETFD) < 0) {
      static_cast<void>(::open("/dev/null", O_RDWR));
    }
  }
  return run_command_line(std::vector<std::string>(arguments + 1, arguments + count), std::cout,
                          std::cerr, companions);
}

}  // namespace rigwire::hil
