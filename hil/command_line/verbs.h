// What each verb does, apart from parsing its options.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <ostream>
#include <string>
#include <vector>

#include "hil/control/replayed_rig.h"
#include "hil/control/run.h"
#include "hil/rig/picture.h"

namespace rigwire::hil {

/// Options that change what a rig file says.
struct RigArguments {
  std::string rig;                ///< Path or name.
  std::vector<std::string> sets;  ///< "key.path=value", later ones win.
};

struct Terminal {
  std::ostream& out;
  std::ostream& err;
};

/// Each returns an exit code. They may throw ConfigurationError and what run() throws.
[[nodiscard]] int run_verb(const RigArguments& rig, const RunOptions& options, bool dry_run,
                           Terminal terminal);
/// Writes one layer of a camera's picture as a PNG file; "-" is standard output.
[[nodiscard]] int picture_verb(const RigArguments& rig, const PictureRequest& request,
                               PictureLayer layer, bool raw, const std::string& file,
                               Terminal terminal);
[[nodiscard]] int check_verb(const RigArguments& rig, LogLevel log_level, bool print, bool json,
                             Terminal terminal);
[[nodiscard]] int list_verb(const std::string& kind, bool json, Terminal terminal);
/// The keys that `--set` takes of a rig, of one level, whose paths begin with `begin`: a key with
/// "=", its value and its meaning; a section with ".".
[[nodiscard]] int list_keys_verb(const std::string& rig, const std::string& begin, bool json,
                                 Terminal terminal);
[[nodiscard]] int describe_verb(const std::string& device, bool json, Terminal terminal);
/// The registers of a valve map's file (hil/files/valve_map_file.h), as the device pages print
/// them.
[[nodiscard]] int describe_valve_map_verb(const std::string& file, Terminal terminal);
/// The messages of a CAN device of the user's own (hil/files/dbc_node_file.h).
[[nodiscard]] int describe_dbc_node_verb(const std::string& file, Terminal terminal);
/// A JSON Schema of files: rig, machine, scene, valve-map, dbc-node. That of campaigns has the
/// program rigwire-campaign.
[[nodiscard]] int schema_verb(const std::string& of, Terminal terminal);
/// The DBC file of a bus; of the only one when `bus` is empty.
[[nodiscard]] int dbc_verb(const RigArguments& rig, const std::string& bus,
                           const std::string& units, Terminal terminal);
/// The EDS file of a CANopen node; of the only one when `device` is empty.
[[nodiscard]] int eds_verb(const RigArguments& rig, const std::string& device, Terminal terminal);
[[nodiscard]] int doctor_verb(bool json, Terminal terminal);
/// Becomes the program `name` beside this one; returns only when that is not possible.
[[nodiscard]] int become_program(const std::string& name, const std::vector<std::string>& arguments,
                                 Terminal terminal);
/// What `rigwire ctl` was asked to do.
struct CtlRequest {
  std::string verb;
  std::vector<std::string> keys;  ///< KEY=VALUE; the verb `record` takes its folder without a key.
  /// Wires, or "truth", that `record` is limited to; empty: everything.
  std::vector<std::string> only;
  bool follow = false;  ///< With `events`: keep printing new events.
  bool stop = false;    ///< With `record`: end the recording.
};
/// Asks a run's control server. The reply goes to `out`, also a refusal; events that are followed
/// go to standard output at once.
[[nodiscard]] int ctl_verb(const ControlEndpoint& endpoint, const std::string& token,
                           const CtlRequest& asked, Terminal terminal);
/// Prints a topic of a recording as CSV.
[[nodiscard]] int record_export_verb(const std::string& folder, const std::string& topic,
                                     const std::string& file, Terminal terminal);
/// Prints the contents of a recording.
[[nodiscard]] int record_info_verb(const std::string& folder, bool json, Terminal terminal);
/// Cuts a piece, [from, to), out of a recording.
[[nodiscard]] int record_cut_verb(const std::string& folder, SimTime from, SimTime to,
                                  const std::string& out, Terminal terminal);
/// Runs a recording again and compares: 0 equal, 5 different, 3 where it cannot be run.
[[nodiscard]] int verify_verb(const std::string& folder, bool json, LogLevel log_level,
                              Terminal terminal);
/// Plays a recording on the wires of its rig.
[[nodiscard]] int replay_verb(const std::string& folder, const ReplayedPiece& piece,
                              RunOptions options, Terminal terminal);
/// Shows a recording on a page, from that instant on.
[[nodiscard]] int show_verb(const std::string& folder, RunOptions options, SimTime from);
/// What `rigwire conform` was asked to do.
struct ConformRequest {
  std::string suite;
  /// "tcp:ADDRESS[:PORT]", "serial:PATH[@BAUD]", "rig:RIG#DEVICE[@BAUD]": a run of ours, started
  /// for it.
  std::string endpoint;
  std::string profile;  ///< File; of nmea may be empty.
  std::vector<std::string> wanted;
  bool writes = false;
  bool robustness = false;
  /// The endpoint again, in the same words: permits cases that move the machine behind it, or lose
  /// the device.
  std::optional<std::string> moves;
  bool allow_remote = false;
  bool list = false;                    ///< Print the selected cases without asking the device.
  bool make_profile = false;            ///< Print what the device answers to as a profile.
  unsigned addresses = 1000;            ///< With make_profile: lower addresses are searched.
  std::optional<std::uint8_t> address;  ///< With make_profile of j1939: the node to examine.
  /// How long to listen to a device that sends by itself.
  std::chrono::nanoseconds listen = std::chrono::seconds{10};
  /// Time limit of the whole suite; empty: the suite's own.
  std::optional<std::chrono::nanoseconds> limit;
  std::string expectations;  ///< File of known deviations.
  std::string json;          ///< Files; empty: not written, "-": standard output.
  std::string junit;
  std::string html;
  std::vector<std::string> beside;  ///< JSON files that the HTML page shows too.
  std::string captures;             ///< Folder of a pcapng file for each case.
};

/// What `rigwire campaign` was asked to do.
struct CampaignRequest {
  std::string action;  ///< expand, run, collect, report
  std::string target;  ///< The campaign's file or name; for collect and report its folder.
  std::string output;  ///< Folder.
  std::string index;   ///< Runs that the action `run` runs: "17" or "0-19".
  std::string html;
  std::vector<std::string> axes;
};
[[nodiscard]] int completion_verb(const std::string& shell, Terminal terminal);

/// One row per device: name, type, wire, what it sends by itself. For --dry-run.
[[nodiscard]] std::string plan_text(const RigConfiguration& configuration);

/// Reports that `word` is none of the `known` ones: "unknown kind". Returns the exit code.
[[nodiscard]] int refuse_word(const std::string& what, const std::string& word,
                              const std::vector<std::string>& known, Terminal terminal);

/// Columns padded to their widest cell, two spaces between.
[[nodiscard]] std::string table_text(const std::vector<std::vector<std::string>>& rows);

}  // namespace rigwire::hil
