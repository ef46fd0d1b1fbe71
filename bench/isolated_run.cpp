#include "bench/isolated_run.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <system_error>
#include <utility>

namespace rigwire::bench {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(const char* what, int error) {
  throw std::system_error(error, std::generic_category(), what);
}

double seconds(const timeval& time) {
  return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
}

}  // namespace

IsolatedRun::Pipe IsolatedRun::open_pipe() {
  std::array<int, 2> ends{};
  if (::pipe2(ends.data(), O_CLOEXEC) != 0) {
    fail("a pipe", errno);
  }
  return {ends[0], ends[1]};
}

IsolatedRun::IsolatedRun(fs::path folder, const std::vector<std::string>& arguments,
                         const std::string& rig)
    : IsolatedRun(std::move(folder), arguments, rig, open_pipe()) {}

IsolatedRun::IsolatedRun(fs::path folder, const std::vector<std::string>& arguments,
                         const std::string& rig, Pipe pipe)
    : folder_(std::move(folder)), ready_(pipe.read_end) {
  const drivers::Descriptor told(pipe.write_end);
  constexpr int kTold = 3;  // what the child knows it as
  const fs::path program = fs::read_symlink("/proc/self/exe").parent_path() / "rigwire";
  std::vector<std::string> words{
      program.string(), "run",         rig,     "--isolated", folder_.string(),     "--status",
      "none",           "--log-level", "error", "--ready-fd", std::to_string(kTold)};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> pointers;
  for (std::string& word : words) {
    pointers.push_back(word.data());
  }
  pointers.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  ::posix_spawn_file_actions_init(&actions);
  ::posix_spawn_file_actions_adddup2(&actions, told.get(), kTold);
  const int error =
      ::posix_spawn(&process_, words.front().c_str(), &actions, nullptr, pointers.data(), environ);
  ::posix_spawn_file_actions_destroy(&actions);
  if (error != 0) {
    process_ = -1;
    fail(words.front().c_str(), error);
  }
}

IsolatedRun::~IsolatedRun() {
  if (process_ > 0) {
    ::kill(process_, SIGKILL);
    ::waitpid(process_, nullptr, 0);
  }
}

void IsolatedRun::wait_until_ready() {
  char first = 0;
  if (::read(ready_.get(), &first, 1) != 1) {
    throw std::runtime_error("the run ended before it was ready");
  }
}

IsolatedRun::Ended IsolatedRun::wait() {
  int status = 0;
  rusage usage{};
  ::wait4(std::exchange(process_, -1), &status, 0, &usage);
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -1,
          seconds(usage.ru_utime) + seconds(usage.ru_stime),
          static_cast<double>(usage.ru_maxrss) * 1024.0 * 1e-6};
}

IsolatedRun::Usage IsolatedRun::usage() const {
  // Field 3 of proc(5) follows the name of the program, which may hold any characters; user time is
  // 14, system time 15, resident pages 24.
  constexpr int kFirst = 3;
  std::ifstream file(fs::path("/proc") / std::to_string(process_) / "stat");
  std::string line;
  std::getline(file, line);
  std::istringstream fields(line.substr(std::min(line.size(), line.rfind(')') + 1)));
  double ticks = 0.0;
  std::string field;
  for (int number = kFirst; fields >> field; ++number) {
    if (number == 14 || number == 15) {
      ticks += std::stod(field);
    } else if (number == 24) {
      return {ticks / static_cast<double>(::sysconf(_SC_CLK_TCK)),
              1e-6 * std::stod(field) * static_cast<double>(::sysconf(_SC_PAGESIZE))};
    }
  }
  throw std::runtime_error("the kernel tells nothing of the run");
}

nlohmann::json IsolatedRun::told() const {
  std::ifstream file(folder_ / "run.json");
  return nlohmann::json::parse(file);
}

nlohmann::json IsolatedRun::report() const {
  std::ifstream file(folder_ / "report.json");
  return nlohmann::json::parse(file);
}

ControlConnection::ControlConnection(const fs::path& socket)
    : socket_(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  const std::string path = socket.string();
  if (path.size() >= sizeof address.sun_path) {
    fail(path.c_str(), ENAMETOOLONG);
  }
  std::copy(path.begin(), path.end(), address.sun_path);
  if (!socket_.open() ||
      ::connect(socket_.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
    fail(path.c_str(), errno);
  }
}

std::string ControlConnection::ask(const std::string& body) {
  const std::string request =
      fmt::format("POST /command HTTP/1.1\r\nHost: localhost\r\nContent-Length: {}\r\n\r\n{}",
                  body.size(), body);
  if (::send(socket_.get(), request.data(), request.size(), MSG_NOSIGNAL) !=
      static_cast<ssize_t>(request.size())) {
    throw std::runtime_error("the run took no request");
  }
  received_.clear();
  std::size_t head = 0;
  std::size_t whole = std::string::npos;
  while (received_.size() < whole) {
    std::array<char, 4096> piece{};
    const ssize_t count = ::recv(socket_.get(), piece.data(), piece.size(), 0);
    if (count <= 0) {
      throw std::runtime_error("the run gave no answer");
    }
    received_.append(piece.data(), static_cast<std::size_t>(count));
    const std::size_t end = received_.find("\r\n\r\n");
    const std::size_t length = received_.find("Content-Length: ");
    if (end != std::string::npos && length < end) {
      std::size_t body_bytes = 0;
      const char* digits = received_.data() + length + std::string_view("Content-Length: ").size();
      std::from_chars(digits, received_.data() + end, body_bytes);
      head = end + 4;
      whole = head + body_bytes;
    }
  }
  return received_.substr(head);
}

}  // namespace rigwire::bench
