// Modbus programs that are not ours, run and read: mbpoll, tshark, and what else a shell can start.
#pragma once

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cstdio>
#include <filesystem>
#include <map>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "modbus_capture.h"
#include "modbus_rig.h"

namespace rigwire::conformance {

struct ProgramResult {
  int exit_code = -1;
  std::string text;  ///< Both streams.
};

/// Runs a shell command. `seconds` end one that hangs.
inline ProgramResult run_program(const std::string& command, int seconds = 240) {
  ProgramResult result;
  FILE* pipe =
      ::popen(("timeout " + std::to_string(seconds) + " " + command + " 2>&1").c_str(), "r");
  if (pipe == nullptr) {
    return result;
  }
  std::array<char, 4096> buffer{};
  while (std::fgets(buffer.data(), static_cast<int>(buffer.size()), pipe) != nullptr) {
    result.text += buffer.data();
  }
  const int status = ::pclose(pipe);
  result.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  return result;
}

/// "[2]:  65286 (-250)" and "[0]:  1" to numbers, by reference.
inline std::map<int, int> mbpoll_values(const std::string& text) {
  std::map<int, int> values;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    int reference = 0;
    int counts = 0;
    int as_signed = 0;
    const int found = std::sscanf(line.c_str(), "[%d]: %d (%d)", &reference, &counts, &as_signed);
    if (found >= 2) {
      values[reference] = found == 3 ? as_signed : counts;
    }
  }
  return values;
}

/// Recorded segments as a capture file, for tshark; gone with the object.
class Capture {
 public:
  /// `dissector` is mbtcp, or mbrtu for frames of a serial line, one in each segment.
  explicit Capture(const std::vector<Segment>& segments, std::string dissector = "mbtcp")
      : dissector_(std::move(dissector)),
        path_((std::filesystem::temp_directory_path() /
               ("rigwire_modbus_" + std::to_string(::getpid()) + ".pcap"))
                  .string()) {
    write_capture(path_, segments);
  }
  ~Capture() { std::filesystem::remove(path_); }
  Capture(const Capture&) = delete;
  Capture& operator=(const Capture&) = delete;

  [[nodiscard]] ProgramResult tshark(const std::string& options) const {
    const std::string as =
        dissector_ == "mbrtu" ? "-d tcp.port==502,mbrtu -o mbrtu.crc_verification:TRUE " : "";
    return run_program("tshark -r " + path_ + " " + as + options);
  }
  /// Numbers of the frames that are not sound Modbus: malformed, or warned about.
  [[nodiscard]] std::vector<int> complaints() const {
    const auto result = tshark("-Y '_ws.malformed || !" + dissector_ +
                               " || _ws.expert.severity >= 0x600000' -T fields -e frame.number");
    EXPECT_EQ(result.exit_code, 0) << result.text;
    std::vector<int> frames;
    std::istringstream lines(result.text);
    for (std::string line; std::getline(lines, line);) {
      if (!line.empty() && line.find_first_not_of("0123456789") == std::string::npos) {
        frames.push_back(std::stoi(line));
      }
    }
    return frames;
  }

 private:
  std::string dissector_;
  std::string path_;
};

}  // namespace rigwire::conformance
