#include "drivers/child.h"

#include <fcntl.h>
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
#include <exception>

#include "drivers/endpoints.h"

namespace rigwire::drivers {
namespace {

[[noreturn]] void carry_out(const std::function<int()>& work, const std::filesystem::path& log) {
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

pid_t started(const std::filesystem::path& log, const std::function<int()>& work) {
  const pid_t parent = ::getpid();
  const pid_t process = ::fork();
  if (process < 0) {
    throw EndpointError(std::string("no process can be started: ") + std::strerror(errno));
  }
  if (process == 0) {
    ::prctl(PR_SET_PDEATHSIG, SIGTERM);
    if (::getppid() != parent) {
      ::_exit(128 + SIGTERM);
    }
    carry_out(work, log);
  }
  return process;
}

}  // namespace

// glibc 2.36 declares pidfd_open() for C alone.
Child::Child(const std::filesystem::path& log, const std::function<int()>& work)
    : process_(started(log, work)),
      descriptor_(static_cast<int>(::syscall(SYS_pidfd_open, process_, 0))) {
  if (!descriptor_.open()) {
    const int number = errno;
    static_cast<void>(end(SIGKILL, {}));
    throw EndpointError(std::string("a process cannot be watched (pidfd_open): ") +
                        std::strerror(number));
  }
}

Child::~Child() {
  static_cast<void>(end(SIGKILL, {}));
}

std::optional<int> Child::status() {
  return reap(WNOHANG);
}

std::optional<int> Child::reap(int options) {
  int state = 0;
  rusage usage{};
  if (!status_ && ::wait4(process_, &state, options, &usage) == process_) {
    status_ = WIFSIGNALED(state) ? 128 + WTERMSIG(state) : WEXITSTATUS(state);
    const auto seconds = [](const timeval& time) {
      return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
    };
    cpu_s_ = seconds(usage.ru_utime) + seconds(usage.ru_stime);
  }
  return status_;
}

int Child::end(int signal, std::chrono::milliseconds patience) {
  if (!status()) {
    ::kill(process_, signal);
    pollfd ended{descriptor(), POLLIN, 0};
    while (descriptor_.open() && ::poll(&ended, 1, static_cast<int>(patience.count())) < 0 &&
           errno == EINTR) {
    }
  }
  if (!status()) {
    ::kill(process_, SIGKILL);
  }
  while (!reap(0)) {  // interrupted by a signal
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

}  // namespace rigwire::drivers
