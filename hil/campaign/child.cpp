#include "hil/campaign/child.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>

#include "drivers/endpoints.h"

namespace rigwire::hil {

Child::Child(const std::filesystem::path& log, const std::function<int()>& work) {
  const pid_t parent = ::getpid();
  process_ = ::fork();
  if (process_ < 0) {
    throw drivers::EndpointError(
        fmt::format("no process can be started: {}", std::strerror(errno)));
  }
  if (process_ == 0) {
    ::prctl(PR_SET_PDEATHSIG, SIGTERM);
    if (::getppid() != parent) {
      ::_exit(128 + SIGTERM);
    }
    sigset_t none;
    ::sigemptyset(&none);
    ::sigprocmask(SIG_SETMASK, &none, nullptr);
    const int nothing = ::open("/dev/null", O_RDONLY | O_CLOEXEC);
    const int file = ::open(log.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0644);
    ::dup2(nothing, STDIN_FILENO);
    ::dup2(file, STDOUT_FILENO);
    ::dup2(file, STDERR_FILENO);
    int status = 1;
    try {
      status = work();
    } catch (const std::exception& error) {
      static_cast<void>(std::fprintf(stderr, "rigwire: %s\n", error.what()));
    }
    ::_exit(status);
  }
  // glibc 2.36 declares pidfd_open() for C alone.
  descriptor_ = static_cast<int>(::syscall(SYS_pidfd_open, process_, 0));
  if (descriptor_ < 0) {
    const int number = errno;
    static_cast<void>(end(SIGKILL, {}));
    throw drivers::EndpointError(
        fmt::format("a process cannot be watched (pidfd_open): {}", std::strerror(number)));
  }
}

Child::~Child() {
  static_cast<void>(end(SIGKILL, {}));
  if (descriptor_ >= 0) {
    ::close(descriptor_);
  }
}

std::optional<int> Child::status() {
  if (!status_) {
    int state = 0;
    rusage usage{};
    if (::wait4(process_, &state, WNOHANG, &usage) == process_) {
      status_ = WIFSIGNALED(state) ? 128 + WTERMSIG(state) : WEXITSTATUS(state);
      const auto seconds = [](const timeval& time) {
        return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
      };
      cpu_s_ = seconds(usage.ru_utime) + seconds(usage.ru_stime);
    }
  }
  return status_;
}

int Child::end(int signal, std::chrono::milliseconds patience) {
  if (status()) {
    return *status_;
  }
  ::kill(process_, signal);
  const auto wait = [this](int milliseconds) {
    pollfd ended{descriptor_, POLLIN, 0};
    while (descriptor_ >= 0 && ::poll(&ended, 1, milliseconds) < 0 && errno == EINTR) {
    }
  };
  wait(static_cast<int>(patience.count()));
  if (!status()) {
    ::kill(process_, SIGKILL);
    wait(-1);
  }
  while (!status()) {
    ::usleep(1000);
  }
  return *status_;
}

int become(const std::vector<std::string>& words) {
  std::vector<std::string> copy = words;
  std::vector<char*> pointers;
  for (std::string& word : copy) {
    pointers.push_back(word.data());
  }
  pointers.push_back(nullptr);
  ::execvp(pointers.front(), pointers.data());
  static_cast<void>(std::fprintf(stderr, "rigwire: cannot start %s: %s\n", words.front().c_str(),
                                 std::strerror(errno)));
  return 127;
}

}  // namespace rigwire::hil
