// A program started by a test, with its output in a file; ended with the object, every wait
// bounded.
#pragma once

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <functional>
#include <optional>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

namespace rigwire::test {

/// How long a test waits for what must come. It ends a test that hangs, and judges nothing: a busy
/// machine may take its time.
inline constexpr std::chrono::seconds kPatience{240};

/// Looks at `condition` until it holds or the patience ends.
inline bool eventually(const std::function<bool()>& condition,
                       std::chrono::seconds patience = kPatience) {
  const auto end = std::chrono::steady_clock::now() + patience;
  while (!condition()) {
    if (std::chrono::steady_clock::now() > end) {
      return false;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds{5});
  }
  return true;
}

class ChildProcess {
 public:
  /// Standard output and error go to the file `output`; with `standard_output` only error does.
  ChildProcess(const std::vector<std::string>& command, std::filesystem::path output,
               int standard_output = -1)
      : output_(std::move(output)) {
    std::vector<char*> arguments;
    for (const auto& argument : command) {
      arguments.push_back(const_cast<char*>(argument.c_str()));
    }
    arguments.push_back(nullptr);
    // Emptied before the program starts, so that nobody reads what an earlier one wrote.
    ::close(::open(output_.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600));
    process_ = ::fork();
    if (process_ == 0) {
      const int log = ::open(output_.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
      const int nothing = ::open("/dev/null", O_RDONLY);
      ::dup2(nothing, 0);
      ::dup2(standard_output >= 0 ? standard_output : log, 1);
      ::dup2(log, 2);
      ::execvp(arguments[0], arguments.data());
      ::_exit(127);
    }
  }
  ~ChildProcess() {
    if (!code_) {
      ::kill(process_, SIGKILL);
      ::waitpid(process_, nullptr, 0);
    }
  }
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  void signal(int number) const { ::kill(process_, number); }

  /// The exit code (128 + n after signal n), or nullopt when the patience ended first.
  std::optional<int> wait(std::chrono::seconds patience = kPatience) {
    eventually(
        [this] {
          int status = 0;
          if (!code_ && ::waitpid(process_, &status, WNOHANG) == process_) {
            code_ = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
          }
          return code_.has_value();
        },
        patience);
    return code_;
  }

  [[nodiscard]] std::string output() const {
    std::ifstream file(output_);
    std::ostringstream text;
    text << file.rdbuf();
    return text.str();
  }

 private:
  std::filesystem::path output_;
  pid_t process_ = -1;
  std::optional<int> code_;
};

}  // namespace rigwire::test
