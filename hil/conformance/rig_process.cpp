#include "hil/conformance/rig_process.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <thread>

#include "drivers/endpoints.h"
#include "hil/configuration/plain_text.h"

namespace rigwire::hil {

namespace {

using std::chrono::milliseconds;

std::string content_of(const std::string& file) {
  std::ifstream stream(file);
  return {std::istreambuf_iterator<char>(stream), {}};
}

}  // namespace

RigProcess::RigProcess(const std::string& rig, const std::vector<std::string>& sets) {
  std::string pattern =
      (std::filesystem::temp_directory_path() / "rigwire-conform-XXXXXX").string();
  if (::mkdtemp(pattern.data()) == nullptr) {
    throw drivers::EndpointError("rig " + rig + ": " + pattern + ": " + std::strerror(errno));
  }
  folder_ = pattern;
  const std::string run = folder_ + "/run";
  const std::string log = folder_ + "/log";
  std::vector<std::string> words{"rigwire", "run", rig, "--isolated", run, "--status", "none"};
  for (const std::string& set : sets) {
    words.insert(words.end(), {"--set", set});
  }
  std::vector<char*> arguments;
  for (std::string& word : words) {
    arguments.push_back(word.data());
  }
  arguments.push_back(nullptr);
  process_ = ::fork();
  if (process_ == 0) {
    const int file = ::open(log.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0600);
    ::dup2(file, STDOUT_FILENO);
    ::dup2(file, STDERR_FILENO);
    ::execv("/proc/self/exe", arguments.data());
    ::_exit(127);
  }
  for (int i = 0; i < 600 && process_ > 0; ++i) {
    if (std::filesystem::exists(run + "/run.json")) {
      return;
    }
    if (::waitpid(process_, nullptr, WNOHANG) == process_) {
      process_ = -1;
    }
    std::this_thread::sleep_for(milliseconds(50));
  }
  const std::string said = content_of(log);
  end();
  throw drivers::EndpointError("rig " + rig + " is not ready" +
                               (said.empty() ? "" : ":\n" + printable(said, "\n")));
}

RigProcess::~RigProcess() {
  end();
}

void RigProcess::end() {
  if (process_ > 0) {
    ::kill(process_, SIGINT);
    ::waitpid(process_, nullptr, 0);
    process_ = -1;
  }
  std::error_code ignored;
  std::filesystem::remove_all(folder_, ignored);
}

std::string RigProcess::wire(const std::string& device) const {
  const auto told = nlohmann::json::parse(content_of(folder_ + "/run/run.json"));
  const auto& devices = told.at("devices");
  if (!devices.contains(device)) {
    std::string names;
    for (const auto& [name, wire] : devices.items()) {
      names += (names.empty() ? "" : ", ") + name;
    }
    throw std::invalid_argument("no such device in the rig, found \"" + device + "\", allowed " +
                                names);
  }
  return devices.at(device).get<std::string>();
}

}  // namespace rigwire::hil
