#include "hil/command_line/arguments.h"

#include <CLI/CLI.hpp>

#include "hil/configuration/build_facts.h"

namespace rigwire::hil {
namespace {

constexpr const char* kFooter = R"(
Examples:
  rigwire run excavator_pit                         run a rig by name, or by path
  rigwire run excavator_pit --duration 20s --clock free --report report.json
  rigwire run excavator_pit --set devices.gnss.rate=5 --seed 7
  rigwire picture excavator_vision --device stereo -o pit.png   what a camera sees
  rigwire check my_rig.yaml --print                 every value and where it came from
  rigwire describe velodyne-hdl-32e                 messages, units, ranges, keys
  rigwire doctor                                    what this machine can offer

Exit codes: 0 done, 1 run-time failure, 2 usage or configuration, 3 environment or permission,
5 a replay that differs (replay --verify) or a device that does not conform (conform),
128 + n after signal n.)";

}  // namespace

void declare(CLI::App& app, Parsed& parsed) {
  app.set_version_flag("--version", "rigwire " + version(), "Print the version");
  app.set_help_flag("-h,--help", "Print this help");
  app.footer(kFooter);
  const auto rig = [&](CLI::App* verb) {
    verb->add_option("rig", parsed.rig.rig, "Rig file, or the name of one of `rigwire list rigs`")
        ->required();
    verb->add_option("--set", parsed.rig.sets, "KEY.PATH=VALUE: change a value; may be repeated")
        ->allow_extra_args(false);
  };

  const auto log_level = [&](CLI::App* verb) {
    verb->add_option("--log-level", parsed.log_level,
                     "Lowest level of messages on standard error: debug, info, warning or error")
        ->capture_default_str();
  };

  CLI::App* run_app = app.add_subcommand("run", "Run a rig until Ctrl-C or --duration");
  rig(run_app);
  run_app->add_option(
      "--clock", parsed.clock,
      "real, free (as fast as possible), scaled:X, step (time moves on request), or\n"
      "drained (as fast as clients take what they are sent)");
  run_app->add_option("--patience", parsed.patience,
                      "With --clock drained: how long clients are waited for, 1 s or another "
                      "time");
  CLI::Option* overrun =
      run_app->add_option("--overrun", parsed.overrun,
                          "When the host is too slow for the clock: slip (simulated time gives\n"
                          "way, the default), warn (wires are late) or stop");
  run_app
      ->add_option("--overrun-limit", parsed.overrun_limit,
                   "How far behind that is: 100 ms, the default, or another time")
      ->needs(overrun);
  run_app->add_flag("--awake", parsed.awake,
                    "Keep processors from sleeping, so that wires are served at once; with the\n"
                    "clocks real and scaled:X");
  run_app->add_option("--duration", parsed.duration, "Simulated time, for example 20s or 5min");
  run_app->add_option("--seed", parsed.seed, "Seed of every random stream; same as --set seed=N");
  run_app->add_option("--report", parsed.report,
                      "Write figures of the run as JSON; - is standard output");
  run_app->add_option("--truth", parsed.truth, "Write the ground truth to a file");
  run_app->add_option("--lidar-truth", parsed.lidar_truth,
                      "Write the ground truth of every lidar shot to a file");
  CLI::Option* record =
      run_app->add_option("--record", parsed.record.folder,
                          "Record wires, truth and events into a folder that is new or empty");
  run_app
      ->add_option("--only", parsed.record.only,
                   "Parts of the recording: names of wires, \"truth\"; WIRE,WIRE")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->needs(record);
  run_app->add_option("--camera-truth", parsed.camera_truth,
                      "Write every picture of the cameras, with depth and labels, to a folder");
  run_app->add_option("--status", parsed.status, "live, plain or none");
  run_app->add_option("--control", parsed.control,
                      "Where the run is governed from (rigwire ctl): unix:FILE or 127.0.0.1:PORT");
  run_app->add_flag("--dashboard", parsed.dashboard,
                    "A page that shows the run, for a browser; its address is in the log");
  run_app
      ->add_option("--isolated", parsed.isolated,
                   "Wires, addresses and files of its own, in a folder that is new or empty:\n"
                   "any number of runs may run side by side; run.json there lists them")
      ->check([](const std::string& folder) {
        return folder.empty() ? "found \"\", allowed the path of a folder" : "";
      });
  run_app->add_option("--ready-fd", parsed.ready_fd,
                      "Descriptor that is written a line of JSON when every wire is open");
  log_level(run_app);
  run_app->add_flag("--dry-run", parsed.dry_run, "Check and print the plan; open nothing");
  run_app->footer(
      "\nExamples:\n  rigwire run excavator_pit --duration 20s --report report.json\n"
      "  rigwire run excavator_pit --clock scaled:2 --set devices.gnss.rate=5");

  CLI::App* picture_app =
      app.add_subcommand("picture", "One picture of a rig's camera as PNG, without a client");
  rig(picture_app);
  picture_app->add_option("--device", parsed.camera, "Camera of the rig, when it has several");
  picture_app
      ->add_option("--at", parsed.at, "Simulated time at which the exposure begins: 12.5s, 1min")
      ->capture_default_str();
  picture_app
      ->add_option("--layer", parsed.layer,
                   "image, right, disparity, range or confidence, as the camera has them;\n"
                   "depth or labels, which are ground truth")
      ->capture_default_str();
  picture_app->add_flag("--raw", parsed.raw,
                        "Numbers instead of colours for a screen: as they leave the camera, depth\n"
                        "in mm, labels by number");
  picture_app->add_option("--travel", parsed.travel,
                          "Speed at which the machine drives straight ahead from the start, for\n"
                          "example 20km/h; without, it does not move");
  picture_app->add_option("-o,--output", parsed.output, "The PNG file; - is standard output")
      ->required();
  picture_app->footer(
      "\nExamples:\n  rigwire picture unimog_vision --device stereo -o forest.png\n"
      "  rigwire picture unimog_vision --device stereo --at 8s --travel 30km/h --layer depth --raw "
      "\\\n"
      "      -o depth.png");

  CLI::App* ctl_app = app.add_subcommand("ctl", "Govern a run that has --control");
  ctl_app->add_option("endpoint", parsed.control, "Endpoint that the run has as --control")
      ->required();
  ctl_app
      ->add_option("verb", parsed.word,
                   "state, read, pause, resume, run_until, seek, step, speed, wait, fault_add,\n"
                   "fault_clear, fault_list, events, record, set or stop")
      ->required();
  ctl_app->add_option("keys", parsed.request,
                      "KEY=VALUE of the verb, and at=TIME; of record the folder, of set\n"
                      "NAME=VALUE of the machine's set points, without a value: released");
  ctl_app->add_flag("--follow", parsed.follow,
                    "With events: prints each as it comes, a line of JSON, to the end of the run");
  ctl_app
      ->add_option("--only", parsed.record.only,
                   "With record: names of wires, \"truth\"; WIRE,WIRE")
      ->delimiter(',')
      ->allow_extra_args(false);
  ctl_app->add_flag("--stop", parsed.stop, "With record: ends the recording");
  ctl_app->footer(
      "\nExamples:\n  rigwire ctl unix:/tmp/control run_until time=2s\n"
      "  rigwire ctl unix:/tmp/control wait quantity=boom value=40 limit=20s\n"
      "  rigwire ctl unix:/tmp/control record /tmp/dig --only gnss,truth\n"
      "  rigwire ctl unix:/tmp/control set boom=0.5\n"
      "  rigwire ctl unix:/tmp/control events --follow\n"
      "The variable RIGWIRE_CONTROL_TOKEN has the token of a run at a port.");

  CLI::App* record_app =
      app.add_subcommand("record", "What a recording holds, a piece or a table of it");
  record_app->add_option("action", parsed.word, "info, cut or export")->required();
  record_app->add_option("folder", parsed.recording, "Folder that run --record had")->required();
  record_app->add_option(
      "--from", parsed.from,
      "Where the piece begins: simulated time, for example 2s; its start without");
  record_app->add_option("--to", parsed.to, "Where the piece ends, before that; its end without");
  record_app->add_option("-o,--output", parsed.output,
                         "Folder for the piece, new or empty; of export the CSV file");
  record_app->add_option(
      "--topic", parsed.topic,
      "With export: truth (the default), transforms, antenna, statistics, events, "
      "motion, joints or points");
  record_app->add_flag("--json", parsed.json, "What it holds as JSON");
  record_app->footer(
      "\nExamples:\n  rigwire record info /tmp/dig\n"
      "  rigwire record cut /tmp/dig --from 12s --to 15s -o /tmp/moment\n"
      "  rigwire record export /tmp/dig --topic truth -o truth.csv");

  CLI::App* replay_app = app.add_subcommand(
      "replay", "Play a recording on its wires, show it, or run it again and compare");
  replay_app->add_option("folder", parsed.recording, "Folder that run --record had")->required();
  replay_app->add_flag(
      "--verify", parsed.verify,
      "Run the recorded configuration with its clients again, on wires without\n"
      "listeners, and name the first byte of each wire that differs (exit code 5)");
  replay_app->add_flag("--json", parsed.json, "What --verify found, as JSON");
  replay_app->add_option("--clock", parsed.clock, "real, free, scaled:X");
  replay_app->add_flag("--loop", parsed.loop, "Begins again at its end");
  replay_app->add_option("--speed", parsed.speed, "How much faster than it was, 0.001 .. 1000");
  replay_app->add_flag(
      "--dashboard", parsed.dashboard,
      "Run the recorded configuration with its clients again, on wires without\n"
      "listeners, and show it on a page on which time goes to any instant; its address\n"
      "is in the log");
  replay_app->add_option("--control", parsed.control,
                         "With --dashboard: as of run; `seek` sends it to an instant");
  replay_app->add_option("--ready-fd", parsed.ready_fd, "With --dashboard: as of run");
  replay_app->add_option("--from", parsed.from, "Where the piece begins, simulated time");
  replay_app->add_option("--to", parsed.to, "Where it ends");
  log_level(replay_app);
  replay_app->footer(
      "\nExamples:\n  rigwire replay /tmp/dig --verify\n"
      "  rigwire replay /tmp/dig --dashboard --from 12s\n"
      "  rigwire replay /tmp/dig --loop");

  CLI::App* check_app = app.add_subcommand("check", "Check a rig; every finding in one pass");
  rig(check_app);
  check_app->add_flag("--print", parsed.print, "Print the effective configuration with origins");
  check_app->add_flag("--json", parsed.json, "Findings as JSON");
  log_level(check_app);
  check_app->footer("\nExample:\n  rigwire check excavator_pit --set devices.gnss.rate=5 --print");

  CLI::App* list_app = app.add_subcommand(
      "list", "List devices, machines, scenes, rigs, campaigns, faults or a rig's keys");
  list_app
      ->add_option("kind", parsed.word,
                   "devices, machines, scenes, rigs, campaigns, faults or keys")
      ->required();
  list_app->add_option("rig", parsed.rig.rig, "Rig whose keys are listed: name or file");
  list_app->add_option("begin", parsed.from, "With what they begin: devices.gnss.");
  list_app->add_flag("--json", parsed.json, "Print JSON");

  CLI::App* describe_app = app.add_subcommand("describe", "Messages, rates, units, ranges, keys");
  CLI::Option* device = describe_app->add_option(
      "device", parsed.word,
      "A type of `rigwire list devices`, a device's name in a rig (gnss), a topology of machines,\n"
      "a machine or a scene of `rigwire list`, or \"scene\"");
  CLI::Option* valve_map = describe_app
                               ->add_option("--valve-map", parsed.valve_map,
                                            "A valve driver's registers from a file, as tables")
                               ->excludes(device);
  CLI::Option* dbc_node =
      describe_app
          ->add_option("--dbc-node", parsed.dbc_node,
                       "The messages of a CAN device of your own from its binding, as a table")
          ->excludes(device)
          ->excludes(valve_map);
  CLI::Option* json = describe_app->add_flag("--json", parsed.json, "Print JSON");
  CLI::Option* dbc =
      describe_app->add_option("--dbc", parsed.rig.rig, "RIG: print the DBC file of its CAN bus")
          ->excludes(device)
          ->excludes(json)
          ->excludes(valve_map)
          ->excludes(dbc_node);
  describe_app->add_option("--bus", parsed.bus, "Bus of the rig, when it has several")->needs(dbc);
  describe_app
      ->add_option(
          "--units", parsed.units,
          "Units of the DBC file: si, or sae as SAE J1939 has them (rpm, %, kPa, km/h, deg)")
      ->check(CLI::IsMember({"si", "sae"}))
      ->capture_default_str()
      ->needs(dbc);
  CLI::Option* eds =
      describe_app
          ->add_option("--eds", parsed.eds.rig, "RIG: print the EDS file of its CANopen node")
          ->excludes(device)
          ->excludes(json)
          ->excludes(valve_map)
          ->excludes(dbc_node)
          ->excludes(dbc);
  describe_app->add_option("--device", parsed.node, "Node of the rig, when it has several")
      ->needs(eds);
  describe_app->footer(
      "\nExamples:\n  rigwire describe --dbc unimog_forest > unimog.dbc\n"
      "  rigwire describe --eds excavator_pit > encoder.eds");
  describe_app->require_option(1, 3);

  CLI::App* schema_app =
      app.add_subcommand("schema", "Print a JSON Schema, for editors and validators of YAML");
  schema_app->add_option("of", parsed.word,
                         "rig (the default), machine, scene, valve-map or dbc-node");
  schema_app->footer(
      "\nExample:\n  rigwire schema > rig.schema.json\n"
      "and in a rig's first line: # yaml-language-server: $schema=rig.schema.json");

  CLI::App* doctor_app = app.add_subcommand("doctor", "What this machine can offer, and the fixes");
  doctor_app->add_flag("--json", parsed.json, "Print JSON");

  CLI::App* conform_app =
      app.add_subcommand("conform", "Hold a device to its protocol's documents, case by case");
  ConformRequest& conform = parsed.conform;
  conform_app
      ->add_option(
          "suite", conform.suite,
          "modbus-tcp, modbus-rtu, nmea, ubx, canopen, j1939, iso11783-valves, velodyne or "
          "gige-vision")
      ->required();
  conform_app->add_option("endpoint", conform.endpoint,
                          "tcp:ADDRESS[:PORT], serial:PATH[@BAUD], can:INTERFACE, "
                          "slcan:PATH[@BITRATE], udp:[ADDRESS:]PORT, or "
                          "rig:RIG#DEVICE[@BAUD] of ours");
  conform_app->add_option("ids", conform.wanted,
                          "Cases, or the begin of some at a slash: modbus/6.3; all without");
  CLI::Option* listed = conform_app->add_flag("--list", conform.list,
                                              "Print the cases without connecting to a device");
  CLI::Option* profile =
      conform_app->add_option("--profile", conform.profile, "YAML file of what the device claims");
  CLI::Option* make = conform_app
                          ->add_flag("--make-profile", conform.make_profile,
                                     "Ask the device what it has, and print it as a profile")
                          ->excludes(profile)
                          ->excludes(listed);
  conform_app
      ->add_option("--addresses", conform.addresses, "With --make-profile: those below are tried")
      ->check(CLI::Range(1, 65536))
      ->capture_default_str()
      ->needs(make);
  conform_app
      ->add_option("--address", conform.address,
                   "With --make-profile of j1939: the node's address; without, who says most")
      ->check(CLI::Range(0, 253))
      ->needs(make);
  conform_app->add_option("--listen", parsed.listen,
                          "To a device that speaks by itself: 10 s or another time");
  conform_app
      ->add_option("--limit", parsed.limit,
                   "Longest time of all cases together: 20 min with ubx, 15 min with j1939, 10 min "
                   "with the others")
      ->excludes(listed);
  conform_app
      ->add_flag("--writes", conform.writes,
                 "Also cases that change what the profile says may be, and put it back")
      ->excludes(make);
  conform_app
      ->add_option("--moves", conform.moves,
                   "Also cases by which a machine may move, or a device be lost until it is "
                   "switched off and "
                   "on: the endpoint once more, word by word")
      ->excludes(make)
      ->excludes(listed);
  conform_app
      ->add_flag("--robustness", conform.robustness,
                 "Also garbage and floods, which are no conformance")
      ->excludes(make);
  conform_app->add_flag("--allow-remote", conform.allow_remote, "A device beyond this machine");
  const auto file = [&](const char* name, std::string& value, const char* text) {
    return conform_app->add_option(name, value, text)->excludes(make)->excludes(listed);
  };
  file("--expect", conform.expectations,
       "File of known deviations with their reasons: what differs from it is what fails");
  file("--json", conform.json, "The result with every exchange; - is standard output");
  file("--junit", conform.junit, "The result as JUnit XML");
  CLI::Option* html = file("--html", conform.html, "The result as a page");
  conform_app
      ->add_option("--beside", conform.beside, "With --html: earlier results (--json) beside this")
      ->allow_extra_args(false)
      ->needs(html);
  file("--captures", conform.captures, "Folder for a pcapng file of each case");
  conform_app->footer(
      "\nExamples:\n  rigwire conform modbus-tcp rig:excavator_pit#valves \\\n"
      "      --profile configs/profiles/valve_driver.yaml --writes\n"
      "  rigwire conform modbus-tcp tcp:127.0.0.1:502 --make-profile > device.yaml\n"
      "  rigwire conform modbus-rtu serial:/dev/ttyUSB0@19200 --profile device.yaml modbus/6.3\n"
      "  rigwire conform nmea rig:excavator_pit#gnss@115200 --listen 20s\n"
      "  rigwire conform ubx serial:/dev/ttyACM0 --make-profile > receiver.yaml\n"
      "  rigwire conform canopen can:can0 --profile encoder.yaml --writes");

  CLI::App* campaign_app =
      app.add_subcommand("campaign", "One rig many times with other values; what came out of it");
  CampaignRequest& campaign = parsed.campaign;
  campaign_app->add_option("action", campaign.action, "expand, run, collect or report")->required();
  campaign_app
      ->add_option("target", campaign.target,
                   "Campaign's file or name; of collect and report the folder of its runs")
      ->required();
  campaign_app->add_option("-o,--output", campaign.output,
                           "With expand and run: the campaign's folder, the same each time");
  campaign_app->add_option("--index", campaign.index,
                           "With run: number of the run, 17, or range, 0-19");
  campaign_app->add_option("--html", campaign.html, "With report: a page; - is standard output");
  campaign_app
      ->add_option("--axes", campaign.axes,
                   "With --html: two parameters to draw the runs over, X,Y")
      ->delimiter(',')
      ->allow_extra_args(false);
  campaign_app->footer(
      "\nExamples:\n  rigwire campaign expand forest_drive -o /tmp/drives\n"
      "  rigwire campaign run forest_drive --index 17 -o /tmp/drives\n"
      "  rigwire campaign collect /tmp/drives\n"
      "  rigwire campaign report /tmp/drives --html drives.html");

  // Whatever follows is for the other program, --help included.
  CLI::App* bench_app =
      app.add_subcommand("bench", "Measure speed and error (starts rigwire-bench)");
  bench_app->set_help_flag();
  bench_app->prefix_command();

  CLI::App* completion_app = app.add_subcommand("completion", "Print a completion script");
  completion_app->add_option("shell", parsed.word, "bash, zsh or fish")->required();
  completion_app->footer("\nExample:\n  source <(rigwire completion bash)");

  CLI::App* man_app = app.add_subcommand("man", "Print the manual page");
  man_app->footer("\nExample:\n  rigwire man | man -l -");
}

}  // namespace rigwire::hil
