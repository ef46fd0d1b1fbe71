// The arguments of `rigwire`: every verb with its options and their help, and the structures that
// they are read into. Their meaning is checked where the verb is executed (command_line.cpp).
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "hil/command_line/verbs.h"
#include "hil/record/recorder.h"

namespace CLI {
class App;
}

namespace rigwire::hil {

/// The values of all options, as they were written.
struct Parsed {
  RigArguments rig;
  std::string clock = "real";
  std::optional<std::string> duration;
  std::optional<std::string> seed;
  std::string report;
  std::string truth;
  std::string lidar_truth;
  RecordOptions record;
  std::string camera_truth;
  std::string recording;
  std::string topic;
  bool verify = false;
  bool loop = false;
  bool follow = false;
  bool stop = false;
  std::string speed;
  std::string from;
  std::string to;
  std::string status;
  std::string log_level = "info";
  std::string control;
  std::string isolated;
  std::optional<std::string> overrun;
  std::optional<std::string> overrun_limit;
  bool awake = false;
  std::optional<std::string> patience;
  std::optional<int> ready_fd;
  std::vector<std::string> request;
  bool dashboard = false;
  bool dry_run = false;
  bool print = false;
  bool json = false;
  std::string word;  ///< Kind, device or shell.
  std::string bus;
  std::string units = "si";
  std::string node;  ///< Node whose electronic data sheet is printed.
  std::string valve_map;
  std::string dbc_node;
  RigArguments eds;
  std::string camera;
  std::string at = "1s";
  std::string travel;
  std::string layer = "image";
  bool raw = false;
  std::string output;
  ConformRequest conform;
  CampaignRequest campaign;
  std::optional<std::string> listen;
  std::optional<std::string> limit;
};

/// Verbs, options, help and examples; `parsed` must outlive the app.
void declare(CLI::App& app, Parsed& parsed);

}  // namespace rigwire::hil
