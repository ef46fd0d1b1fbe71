// A rig in a process of its own beside the benchmark, on wires of its own, as `rigwire run
// --isolated` starts it.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "bench/private_rig.h"
#include "drivers/descriptor.h"

namespace rigwire::bench {

class IsolatedRun {
 public:
  struct Ended {
    int exit_code = -1;
    double cpu_s = 0.0;        ///< User and system time of the process.
    double peak_rss_mb = 0.0;  ///< 1e6 bytes.
  };

  /// What the process has used since its start, and holds now.
  struct Usage {
    double cpu_s = 0.0;        ///< User and system time, in ticks of the kernel's clock.
    double resident_mb = 0.0;  ///< 1e6 bytes.
  };

  /// Starts `rig`, a name or a file, with `arguments`; its folder is `folder`, new or empty. Throws
  /// std::system_error.
  IsolatedRun(std::filesystem::path folder, const std::vector<std::string>& arguments,
              const std::string& rig = kBenchRig);
  /// Ends it whatever it does.
  ~IsolatedRun();
  IsolatedRun(const IsolatedRun&) = delete;
  IsolatedRun& operator=(const IsolatedRun&) = delete;

  /// Returns when every wire is open. Throws std::runtime_error when the process ended before.
  void wait_until_ready();
  Ended wait();
  /// While it runs. Throws std::runtime_error when the kernel does not say.
  [[nodiscard]] Usage usage() const;
  /// The line of --ready-fd, after wait_until_ready(). Throws what reading and parsing throws.
  [[nodiscard]] nlohmann::json told() const;

  [[nodiscard]] std::filesystem::path control() const { return folder_ / "control"; }
  /// After wait(). Throws what reading and parsing throws.
  [[nodiscard]] nlohmann::json report() const;

 private:
  struct Pipe {
    int read_end = -1;
    int write_end = -1;
  };
  static Pipe open_pipe();
  IsolatedRun(std::filesystem::path folder, const std::vector<std::string>& arguments,
              const std::string& rig, Pipe pipe);

  std::filesystem::path folder_;
  drivers::Descriptor ready_;
  pid_t process_ = -1;
};

/// One HTTP connection over a Unix socket that stays open.
class ControlConnection {
 public:
  /// Throws std::system_error.
  explicit ControlConnection(const std::filesystem::path& socket);

  /// Posts to /command; returns the body of the answer when all of it is here, whatever it says.
  /// Throws std::runtime_error when the connection ends.
  std::string ask(const std::string& body);

 private:
  drivers::Descriptor socket_;
  std::string received_;
};

}  // namespace rigwire::bench
