#include "hil/conformance/rig_process.h"

#include <fcntl.h>
#include <poll.h>
#include <stdlib.h>

#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "drivers/endpoints.h"
#include "drivers/temporary_folder.h"
#include "hil/configuration/plain_text.h"
#include "hil/control/ready.h"

namespace rigwire::hil {

namespace fs = std::filesystem;
using std::chrono::milliseconds;
using std::chrono::steady_clock;

namespace {

constexpr milliseconds kReadyPatience{30'000};
constexpr milliseconds kEndPatience{10'000};

std::string content_of(const fs::path& file) {
  std::ifstream stream(file);
  return {std::istreambuf_iterator<char>(stream), {}};
}

/// Throws drivers::EndpointError when it ends before, or the patience is over.
std::string line_of(ReadyPipe& pipe) {
  const auto end = steady_clock::now() + kReadyPatience;
  std::optional<std::string> line;
  while (!line) {
    const auto left = std::chrono::ceil<milliseconds>(end - steady_clock::now());
    pollfd waiting{pipe.descriptor(), POLLIN, 0};
    const int count = left.count() > 0 ? ::poll(&waiting, 1, static_cast<int>(left.count())) : 0;
    if (count == 0) {
      throw drivers::EndpointError("not ready within 30 s");
    }
    if (count > 0) {
      line = pipe.hear();
    }
  }
  return *line;
}

}  // namespace

RigProcess::RigProcess(const std::string& rig, const std::vector<std::string>& sets)
    : folder_(drivers::make_temporary_folder("a folder for the rig's wires", "conform")) {
  const fs::path log = folder_ / "log";
  ReadyPipe pipe;
  std::vector<std::string> words{"/proc/self/exe",
                                 "run",
                                 rig,
                                 "--isolated",
                                 folder_ / "run",
                                 "--status",
                                 "none",
                                 "--report",
                                 report(),
                                 "--ready-fd",
                                 std::to_string(pipe.written())};
  for (const std::string& set : sets) {
    words.insert(words.end(), {"--set", set});
  }
  try {
    process_.emplace(log, [&] {
      ::fcntl(pipe.written(), F_SETFD, 0);
      return drivers::become(words);
    });
    pipe.handed_over();
    const auto told = nlohmann::json::parse(line_of(pipe));
    wires_ = told.value("devices", wires_);
    replaced_ = told.value("replaced", replaced_);
  } catch (const drivers::EndpointError& error) {
    process_.reset();
    const std::string said = content_of(log);
    std::error_code ignored;
    fs::remove_all(folder_, ignored);
    throw drivers::EndpointError("rig " + rig + ": " + error.what() +
                                 (said.empty() ? "" : ":\n" + printable(said, "\n")));
  }
}

RigProcess::~RigProcess() {
  static_cast<void>(process_->end(SIGINT, kEndPatience));
  std::error_code ignored;
  fs::remove_all(folder_, ignored);
}

double RigProcess::finish() {
  static_cast<void>(process_->end(SIGINT, kEndPatience));
  const auto told = nlohmann::json::parse(content_of(report()), nullptr, false);
  return told.is_object() ? told.value("slipped_s", 0.0) : 0.0;
}

std::optional<std::string> RigProcess::replaced(const std::string& key) const {
  const auto found = replaced_.find(key);
  return found == replaced_.end() ? std::nullopt : std::optional(found->second);
}

std::string RigProcess::wire(const std::string& device) const {
  const auto found = wires_.find(device);
  if (found == wires_.end()) {
    std::string names;
    for (const auto& [name, wire] : wires_) {
      names += (names.empty() ? "" : ", ") + name;
    }
    throw std::invalid_argument("no such device in the rig, found \"" + device + "\", allowed " +
                                names);
  }
  return found->second;
}

}  // namespace rigwire::hil
