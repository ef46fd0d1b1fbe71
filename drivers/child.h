// A process beside this one, which ends with it.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "drivers/descriptor.h"

namespace rigwire::drivers {

class Child {
 public:
  /// Calls `work` in a new process, whose exit status is what it returns; standard output and error
  /// go to the file `log`. This process has one thread. Throws EndpointError.
  Child(const std::filesystem::path& log, const std::function<int()>& work);
  /// Kills what has not ended.
  ~Child();
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;

  /// Becomes readable, for poll(), when it has ended.
  [[nodiscard]] int descriptor() const { return descriptor_.get(); }
  /// Exit status, 128 + n after signal n; nothing while it runs.
  [[nodiscard]] std::optional<int> status();
  /// Ends it: `signal`, 0 for none, and after `patience` SIGKILL. Its status.
  int end(int signal, std::chrono::milliseconds patience);
  /// CPU time that it and its children took; 0 while it runs.
  [[nodiscard]] double cpu_s() const { return cpu_s_; }

 private:
  std::optional<int> reap(int options);

  pid_t process_ = -1;
  Descriptor descriptor_{-1};
  std::optional<int> status_;
  double cpu_s_ = 0.0;
};

/// For Child: replaces the process by a program, `words` its name and arguments. Returns 127 when
/// there is none.
[[nodiscard]] int become(const std::vector<std::string>& words);

}  // namespace rigwire::drivers
