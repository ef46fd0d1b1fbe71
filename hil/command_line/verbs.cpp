#include "hil/command_line/verbs.h"

#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "drivers/endpoints.h"
#include "drivers/output.h"
#include "emulators/can/can_bus_faults.h"
#include "emulators/modbus/modbus_faults.h"
#include "fields/check.h"
#include "fields/failure_text.h"
#include "hil/command_line/config_files.h"
#include "hil/command_line/doctor.h"
#include "hil/command_line/text_table.h"
#include "hil/configuration/outline.h"
#include "hil/configuration/suggest.h"
#include "hil/control/control_client.h"
#include "hil/control/shown_recording.h"
#include "hil/control/verification.h"
#include "hil/devices/device_types.h"
#include "hil/devices/site.h"
#include "hil/record/output_file.h"
#include "hil/record/recording.h"
#include "hil/record/recording_export.h"
#include "hil/record/run_log.h"
#include "hil/rig/rig.h"

namespace rigwire::hil {

namespace {

using Json = nlohmann::ordered_json;

int code(ExitCode exit_code) {
  return static_cast<int>(exit_code);
}

Json problems_json(const std::vector<Problem>& problems) {
  Json list = Json::array();
  for (const Problem& problem : problems) {
    list.push_back({{"file", problem.where.source ? *problem.where.source : ""},
                    {"line", problem.where.line},
                    {"column", problem.where.column},
                    {"path", problem.path},
                    {"what", problem.what},
                    {"found", problem.found},
                    {"allowed", problem.allowed},
                    {"suggestion", problem.suggestion}});
  }
  return list;
}

/// Set-up with fewer would fail somewhere on its way, and each place would blame another thing.
void require_open_files() {
  constexpr rlim_t kNeeded = 32;  // a small rig's: files within files, event loop, wires
  rlimit limit{};
  if (::getrlimit(RLIMIT_NOFILE, &limit) == 0 && limit.rlim_cur < kNeeded) {
    throw drivers::EndpointError(
        fmt::format("open files permitted: found {}, allowed {} or more; raise the limit of open "
                    "files (ulimit -n)",
                    limit.rlim_cur, kNeeded));
  }
}

}  // namespace

int refuse_word(const std::string& what, const std::string& word,
                const std::vector<std::string>& known, Terminal terminal) {
  const std::string near = nearest_word(word, known);
  terminal.err << fmt::format("rigwire: unknown {}, found \"{}\", allowed {}{}\n", what, word,
                              join_words(known),
                              near.empty() ? "" : ", did you mean " + near + "?");
  return code(ExitCode::usage);
}

std::string table_text(const std::vector<std::vector<std::string>>& rows) {
  std::vector<std::size_t> widths;
  for (const auto& row : rows) {
    widths.resize(std::max(widths.size(), row.size()));
    for (std::size_t i = 0; i < row.size(); ++i) {
      widths[i] = std::max(widths[i], display_width(row[i]));
    }
  }
  std::string text;
  for (const auto& row : rows) {
    std::string line;
    for (std::size_t i = 0; i < row.size(); ++i) {
      line += row[i];
      if (i + 1 < row.size()) {
        line.append(widths[i] - display_width(row[i]) + 2, ' ');
      }
    }
    text += line.substr(0, line.find_last_not_of(' ') + 1) + "\n";
  }
  return text;
}

int run_verb(const RigArguments& arguments, const RunOptions& options, bool dry_run,
             Terminal terminal) {
  require_open_files();
  const LoadedRig rig = load_rig(find_rig(arguments.rig), arguments.sets);
  if (dry_run) {
    terminal.out << fmt::format("{}, seed {}, config {}, clock {}\n\n", rig.configuration.name,
                                rig.configuration.seed, config_hash(rig.configuration),
                                to_string(options.clock))
                 << plan_text(rig.configuration);
    return code(ExitCode::done);
  }
  RunOptions placed = options;
  placed.origins = &rig.origins;
  return run(rig.configuration, placed);
}

int picture_verb(const RigArguments& arguments, const PictureRequest& request, PictureLayer layer,
                 bool raw, const std::string& file, Terminal terminal) {
  require_open_files();
  const LoadedRig rig = load_rig(find_rig(arguments.rig), arguments.sets);
  const WholeFile output("the picture", file);
  const TakenPicture taken = [&] {
    try {
      return take_picture(rig.configuration, request);
    } catch (const fields::Refused& refused) {
      throw ConfigurationError(std::vector<Problem>{placed(refused, rig.origins)});
    }
  }();
  const Image image = layer_image(taken.kept, layer, raw);
  const std::vector<std::uint8_t> bytes = encode_png(image);
  output.write({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
  if (file == "-") {
    return code(ExitCode::done);
  }
  const Picture& picture = *taken.kept.picture;
  terminal.out << fmt::format(
      "{}: {} of {} at {:.3f} s, {} x {}, exposure {:.3f} ms, gain {:.1f} dB\n", file,
      kPictureLayers[static_cast<std::size_t>(layer)], taken.device,
      to_seconds(picture.exposure_start - kStart), image.columns, image.rows,
      1e3 * to_seconds(picture.exposure), picture.gain_db);
  if (layer == PictureLayer::labels) {
    std::vector<std::vector<std::string>> rows{{"number", "colour", "share", "label"}};
    const std::vector<LabelShare> shares = label_shares(taken.kept);
    for (std::size_t i = 0; i < shares.size(); ++i) {
      const auto& [red, green, blue] = shares[i].colour;
      rows.push_back({std::to_string(i + 1), fmt::format("#{:02x}{:02x}{:02x}", red, green, blue),
                      fmt::format("{:.1f} %", 100.0 * static_cast<double>(shares[i].pixels) /
                                                  static_cast<double>(image.columns * image.rows)),
                      shares[i].label});
    }
    terminal.out << table_text(rows);
  }
  return code(ExitCode::done);
}

int check_verb(const RigArguments& arguments, LogLevel log_level, bool print, bool json,
               Terminal terminal) {
  require_open_files();
  try {
    const LoadedRig rig = load_rig(find_rig(arguments.rig), arguments.sets);
    RunLog log(log_level);
    check_start(rig, &log);
    const std::string hash = config_hash(rig.configuration);
    if (json) {
      Json result{{"ok", true}, {"config_hash", hash}, {"devices", Json::array()}};
      for (const auto& [name, device] : rig.configuration.devices) {
        result["devices"].push_back({{"name", name}, {"type", device.type()}});
      }
      if (print) {
        result["yaml"] = print_rig(rig);
      }
      terminal.out << result.dump(2) << "\n";
    } else if (print) {
      terminal.out << print_rig(rig);
    } else {
      terminal.out << fmt::format("{}: good, {} devices, config {}\n", arguments.rig,
                                  rig.configuration.devices.size(), hash);
    }
    return code(ExitCode::done);
  } catch (const ConfigurationError& error) {
    if (!json) {
      throw;
    }
    const Json result{{"ok", false}, {"problems", problems_json(error.problems())}};
    terminal.out << result.dump(2, ' ', false, Json::error_handler_t::replace) << "\n";
    return code(ExitCode::usage);
  }
}

namespace {

/// Everything that faults can be of, and their kinds.
std::vector<std::pair<std::string, std::vector<fields::Named>>> faults_by_target() {
  std::vector<std::pair<std::string, std::vector<fields::Named>>> all;
  for (const DeviceType& type : device_types()) {
    all.emplace_back(type.named.name, type.fresh()->fault_kinds());
  }
  all.emplace_back("bus", fault_kinds<emulators::CanFault>());
  all.emplace_back("modbus", fault_kinds<emulators::ModbusFault>());
  all.emplace_back("air", fault_kinds<sim::AirFault>());
  all.emplace_back("machine.engine", fault_kinds<sim::EngineFault>());
  all.emplace_back("machine.pumps", fault_kinds<sim::PumpFault>());
  return all;
}

}  // namespace

int list_verb(const std::string& kind, bool json, Terminal terminal) {
  const std::vector<std::string> kinds{"devices",   "machines", "scenes", "rigs",
                                       "campaigns", "faults",   "keys"};
  if (std::find(kinds.begin(), kinds.end(), kind) == kinds.end()) {
    return refuse_word("kind", kind, kinds, terminal);
  }
  std::vector<std::vector<std::string>> rows;
  Json list = Json::array();
  if (kind == "devices") {
    for (const DeviceType& type : device_types()) {
      rows.push_back({std::string(type.named.name), std::string(type.named.text)});
      list.push_back({{"name", type.named.name}, {"text", type.named.text}});
    }
  } else if (kind == "faults") {
    for (const auto& [target, faults] : faults_by_target()) {
      for (const fields::Named& fault : faults) {
        rows.push_back({target, std::string(fault.name), std::string(fault.text)});
        list.push_back({{"on", target}, {"type", fault.name}, {"text", fault.text}});
      }
    }
  } else {
    for (const ConfigFile& file : config_files(kind)) {
      const std::string text = text_of(file);
      rows.push_back({file.name, text, file.path});
      list.push_back({{"name", file.name}, {"text", text}, {"path", file.path}});
    }
  }
  terminal.out << (json ? list.dump(2, ' ', false, Json::error_handler_t::replace) + "\n"
                        : table_text(rows));
  return code(ExitCode::done);
}

int list_keys_verb(const std::string& rig, const std::string& begin, bool json, Terminal terminal) {
  const OutlineNode tree = outline(load_rig(find_rig(rig), {}).configuration);
  // Down to the section that the last dot closes.
  const std::size_t dot = begin.rfind('.');
  const std::string path = dot == std::string::npos ? "" : begin.substr(0, dot + 1);
  const OutlineNode* section = &tree;
  for (std::size_t at = 0; section != nullptr && at < path.size(); at = path.find('.', at) + 1) {
    const auto child = std::ranges::find(
        section->children, path.substr(at, path.find('.', at) - at), &OutlineNode::key);
    section = child == section->children.end() ? nullptr : &*child;
  }
  std::vector<std::vector<std::string>> rows;
  Json list = Json::array();
  for (const OutlineNode& node :
       section != nullptr ? section->children : std::vector<OutlineNode>{}) {
    const bool deeper =
        node.kind == OutlineNode::Kind::section || node.kind == OutlineNode::Kind::named;
    const std::string key = path + node.key + (deeper ? "." : "=");
    if (key.starts_with(begin) && !(deeper && node.children.empty())) {
      rows.push_back({key, node.value, node.text});
      list.push_back({{"key", key}, {"value", node.value}, {"text", node.text}});
    }
  }
  terminal.out << (json ? list.dump(2, ' ', false, Json::error_handler_t::replace) + "\n"
                        : table_text(rows));
  return code(ExitCode::done);
}

int doctor_verb(bool json, Terminal terminal) {
  const std::vector<Finding> findings = examine_machine();
  std::vector<std::vector<std::string>> rows;
  Json list = Json::array();
  bool missing = false;
  for (const Finding& finding : findings) {
    missing = missing || finding.health == Health::missing;
    rows.push_back({finding.name, to_string(finding.health), finding.detail});
    if (!finding.fix.empty()) {
      rows.push_back({"", "", "-> " + finding.fix});
    }
    list.push_back({{"name", finding.name},
                    {"health", to_string(finding.health)},
                    {"detail", finding.detail},
                    {"fix", finding.fix}});
  }
  terminal.out << (json ? list.dump(2) + "\n" : table_text(rows));
  return code(missing ? ExitCode::environment : ExitCode::done);
}

namespace {

int ctl_code(const ControlAnswer& answer) {
  return code(answer.status == 200                           ? ExitCode::done
              : answer.status == 400                         ? ExitCode::usage
              : answer.status == 401 || answer.status == 403 ? ExitCode::environment
                                                             : ExitCode::failure);
}

/// Lines on standard output as they come; nothing else is written there.
int follow_events(const ControlEndpoint& endpoint, const std::string& token, Json request,
                  Terminal terminal) {
  const drivers::Output output(STDOUT_FILENO);
  constexpr std::chrono::hours kReader{24};
  bool known = false;
  bool lost = false;
  while (true) {
    request["wait"] = known;  // the first answer at once
    ControlAnswer answer;
    try {
      answer = ask_control(endpoint, token, request.dump());
    } catch (const drivers::EndpointError&) {
      if (lost) {
        return code(ExitCode::done);  // the run's server is gone: the run is over
      }
      if (!known) {
        throw;
      }
      lost = true;
      known = false;  // a connection can be lost while the run continues: try once more, at once
      continue;
    }
    if (answer.status == 410 && (known || lost)) {
      return code(ExitCode::done);
    }
    lost = false;
    if (answer.status != 200) {
      terminal.out << answer.body << "\n";
      return ctl_code(answer);
    }
    known = true;
    const Json reply = Json::parse(answer.body);
    std::string lines;
    if (reply.at("lost") != 0) {
      lines += Json{{"lost", reply.at("lost")}}.dump() + "\n";
    }
    for (const Json& event : reply.at("events")) {
      lines += event.dump() + "\n";
    }
    if (output.write(lines, std::chrono::steady_clock::now() + kReader).end !=
        drivers::WriteEnd::whole) {
      return code(ExitCode::failure);
    }
    request["since"] = reply.at("last");
  }
}

}  // namespace

int ctl_verb(const ControlEndpoint& endpoint, const std::string& token, const CtlRequest& asked,
             Terminal terminal) {
  Json request{{"verb", asked.verb}};
  const auto refuse = [&](const std::string& what) {
    terminal.err << "rigwire: ctl: " << what << "\n";
    return code(ExitCode::usage);
  };
  if (asked.follow && asked.verb != "events") {
    return refuse("--follow is of events, found " + asked.verb);
  }
  if ((asked.stop || !asked.only.empty()) && asked.verb != "record") {
    return refuse("--only and --stop are of record, found " + asked.verb);
  }
  std::string set;  // a map in YAML
  for (const std::string& key : asked.keys) {
    const std::size_t equals = key.find('=');
    if (asked.verb == "record" && equals == std::string::npos && !request.contains("folder")) {
      // At a port a name below the run's folder is meant.
      request["folder"] = endpoint.path.empty() ? key : std::filesystem::absolute(key).string();
      continue;
    }
    if (equals == std::string::npos || equals == 0) {
      return refuse(
          fmt::format("no key with its value, found \"{}\", allowed for example time=2s", key));
    }
    const std::string name = key.substr(0, equals);
    const std::string value = key.substr(equals + 1);
    if (asked.verb == "set" && name != "set" && name != "on" && name != "at") {
      const bool none = value.empty() || value == "null";
      const bool list = value.starts_with('[');
      set += fmt::format("{}{}: {}", set.empty() ? "" : ", ", Json(name).dump(),
                         none   ? "null"
                         : list ? value
                                : Json(value).dump(-1, ' ', false, Json::error_handler_t::replace));
    } else {
      request[name] = value;
    }
  }
  if (!set.empty()) {
    request["set"] = "{" + set + "}";
  }
  if (!asked.only.empty()) {
    request["only"] = asked.only;
  }
  if (asked.stop) {
    request["stop"] = true;
  }
  if (asked.follow) {
    return follow_events(endpoint, token, std::move(request), terminal);
  }
  const ControlAnswer answer =
      ask_control(endpoint, token, request.dump(-1, ' ', false, Json::error_handler_t::replace));
  terminal.out << answer.body << "\n";
  return ctl_code(answer);
}

int record_info_verb(const std::string& folder, bool json, Terminal terminal) {
  const RecordingContents contents = read_recording(folder);
  terminal.out << (json ? to_json(contents) : to_text(contents));
  return code(ExitCode::done);
}

int record_export_verb(const std::string& folder, const std::string& topic, const std::string& file,
                       Terminal terminal) {
  const auto found = std::ranges::find(kExportedTopics, topic);
  if (found == kExportedTopics.end()) {
    return refuse_word("topic", topic, {kExportedTopics.begin(), kExportedTopics.end()}, terminal);
  }
  const std::size_t rows =
      export_csv(folder, static_cast<TruthTrack>(found - kExportedTopics.begin()), file);
  terminal.out << fmt::format("{}: {} rows of {}\n", file, rows, topic);
  return code(ExitCode::done);
}

int record_cut_verb(const std::string& folder, SimTime from, SimTime to, const std::string& out,
                    Terminal terminal) {
  cut_recording(folder, from, to, out);
  return record_info_verb(out, false, terminal);
}

int verify_verb(const std::string& folder, bool json, LogLevel log_level, Terminal terminal) {
  Verification result;
  try {
    require_open_files();
    RunLog log(log_level);
    result = verify_recording(folder, &log);
  } catch (const std::exception& error) {  // whatever it is, nothing was compared
    terminal.err << "rigwire: replay: cannot be run: "
                 << fields::failure_text(error, "the replayed rig") << "\n";
    return code(ExitCode::environment);
  }
  const ExitCode end = result.equal() ? ExitCode::done : ExitCode::different;
  if (json) {
    Json object{{"equal", result.equal()},
                {"end_s", to_seconds(result.end)},
                {"client_acts", result.client_acts},
                {"remarks", result.remarks},
                {"streams", Json::array()}};
    for (const ComparedStream& stream : result.streams) {
      Json row{{"name", stream.wire},
               {"of_clients", stream.of_clients},
               {"equal", !stream.difference},
               {"units", stream.units},
               {"passed_over", stream.passed_over}};
      if (stream.difference) {
        row["at_ns"] = stream.difference->at.time_since_epoch().count();
        row["difference"] = stream.difference->what;
      }
      object["streams"].push_back(std::move(row));
    }
    terminal.out << object.dump(2, ' ', false, Json::error_handler_t::replace) << "\n";
    return code(end);
  }
  for (const std::string& remark : result.remarks) {
    terminal.out << "note: " << remark << "\n";
  }
  std::vector<std::vector<std::string>> rows{{"stream", "of", "equal units", ""}};
  for (const ComparedStream& stream : result.streams) {
    const std::string passed =
        stream.passed_over == 0
            ? ""
            : fmt::format(" ({} passed over that were not recorded)", stream.passed_over);
    rows.push_back({stream.wire,
                    stream.wire.starts_with("/") ? "truth"
                    : stream.of_clients          ? "clients"
                                                 : "devices",
                    std::to_string(stream.units),
                    (stream.difference ? "DIFFERENT" : "equal") + passed});
  }
  terminal.out << table_text(rows);
  for (const ComparedStream& stream : result.streams) {
    if (stream.difference) {
      terminal.out << fmt::format("{}: {:.9f} s: {}\n", stream.wire,
                                  to_seconds(stream.difference->at), stream.difference->what);
    }
  }
  terminal.out << fmt::format("{} to {:.9f} s, {} acts of clients given again\n",
                              result.equal() ? "equal" : "different", to_seconds(result.end),
                              result.client_acts);
  return code(end);
}

int replay_verb(const std::string& folder, const ReplayedPiece& piece, RunOptions options,
                Terminal terminal) {
  require_open_files();
  const ReplayedRig rig = replayed_rig(folder, piece);
  for (const std::string& remark : rig.remarks) {
    terminal.err << "rigwire: " << remark << "\n";
  }
  if (!piece.loop) {
    options.duration = rig.length;
  }
  return run(rig.configuration, options);
}

int show_verb(const std::string& folder, RunOptions options, SimTime from) {
  require_open_files();
  return show_recording(folder, std::move(options), from);
}

int become_program(const std::string& name, const std::vector<std::string>& arguments,
                   Terminal terminal) {
  const std::filesystem::path program =
      std::filesystem::read_symlink("/proc/self/exe").parent_path() / name;
  // argv as execv() takes it: the program's name first, a null pointer last.
  std::vector<std::string> words{program.string()};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> pointers;
  for (std::string& word : words) {
    pointers.push_back(word.data());
  }
  pointers.push_back(nullptr);
  terminal.out.flush();
  ::execv(words.front().c_str(), pointers.data());
  const int error = errno;
  terminal.err << fmt::format("rigwire: cannot start {}: {}", words.front(), std::strerror(error))
               << (error == ENOENT ? "; build it: scripts/build.sh release " + name + "\n" : "\n");
  return static_cast<int>(ExitCode::environment);
}

std::string plan_text(const RigConfiguration& configuration) {
  const RigView rig = view_of(configuration);
  std::vector<std::vector<std::string>> rows{{"device", "type", "wire", "sends", "bytes", "with"}};
  for (const auto& [name, device] : configuration.devices) {
    const DevicePlan plan = device->plan(rig);
    rows.push_back(
        {name, std::string(device.type()), plan.wire, plan.sends, plan.bytes, plan.with});
  }
  return table_text(rows);
}

}  // namespace rigwire::hil
