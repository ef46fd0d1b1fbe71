#include "drivers/line_readers.h"

#include <dirent.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cstring>
#include <fstream>
#include <memory>
#include <optional>
#include <string_view>

namespace rigwire::drivers {
namespace {

using Directory = std::unique_ptr<DIR, decltype([](DIR* directory) { ::closedir(directory); })>;

/// Name and parent out of "812 (gpsd) S 1 ...".
struct ProcessStatus {
  std::string program;
  pid_t parent = 0;
};

std::optional<ProcessStatus> status_of(pid_t process) {
  std::ifstream file("/proc/" + std::to_string(process) + "/stat");
  std::string text;
  std::getline(file, text);
  const std::size_t open = text.find('(');
  const std::size_t close = text.rfind(')');  // a name may have brackets of its own
  if (open == std::string::npos || close == std::string::npos || close + 4 >= text.size()) {
    return std::nullopt;
  }
  ProcessStatus status{text.substr(open + 1, close - open - 1), 0};
  const char* const parent = text.data() + close + 4;
  if (std::from_chars(parent, text.data() + text.size(), status.parent).ec != std::errc()) {
    return std::nullopt;
  }
  return status;
}

struct Holder {
  LineReader reader;
  pid_t parent = 0;
};

/// Without those that have it from an ancestor.
std::vector<LineReader> independent(const std::vector<Holder>& holders) {
  const auto holds = [&holders](pid_t process) {
    return std::ranges::any_of(holders,
                               [process](const Holder& h) { return h.reader.process == process; });
  };
  constexpr int kGenerations = 64;
  std::vector<LineReader> result;
  for (const Holder& holder : holders) {
    bool inherited = false;
    pid_t ancestor = holder.parent;
    for (int i = 0; i < kGenerations && ancestor > 1 && !inherited; ++i) {
      inherited = holds(ancestor);
      const auto status = status_of(ancestor);
      ancestor = status ? status->parent : 0;
    }
    if (!inherited) {
      result.push_back(holder.reader);
    }
  }
  return result;
}

}  // namespace

std::vector<std::vector<LineReader>> readers_of(std::span<const std::string> terminals) {
  std::vector<std::vector<Holder>> holders(terminals.size());
  const Directory processes(::opendir("/proc"));
  while (processes != nullptr) {
    const dirent* const entry = ::readdir(processes.get());
    if (entry == nullptr) {
      break;
    }
    const std::string_view name = entry->d_name;
    pid_t process = 0;
    if (std::from_chars(name.data(), name.data() + name.size(), process).ec != std::errc() ||
        process == ::getpid()) {
      continue;
    }
    const Directory descriptors(::opendir(("/proc/" + std::string(name) + "/fd").c_str()));
    while (descriptors != nullptr) {
      const dirent* const descriptor = ::readdir(descriptors.get());
      if (descriptor == nullptr) {
        break;
      }
      std::array<char, 64> target{};
      const ssize_t size = ::readlinkat(::dirfd(descriptors.get()), descriptor->d_name,
                                        target.data(), target.size());
      const auto held = std::ranges::find(
          terminals,
          std::string_view(target.data(), static_cast<std::size_t>(std::max<ssize_t>(size, 0))));
      if (size <= 0 || held == terminals.end()) {
        continue;
      }
      // Another instance of devpts has a terminal of that name, too.
      struct stat theirs {};
      struct stat ours {};
      auto& list = holders[static_cast<std::size_t>(held - terminals.begin())];
      if (::fstatat(::dirfd(descriptors.get()), descriptor->d_name, &theirs, 0) != 0 ||
          ::stat(held->c_str(), &ours) != 0 || theirs.st_dev != ours.st_dev ||
          theirs.st_ino != ours.st_ino ||
          (!list.empty() && list.back().reader.process == process)) {
        continue;
      }
      if (const auto status = status_of(process)) {
        list.push_back({{process, status->program}, status->parent});
      }
    }
  }
  std::vector<std::vector<LineReader>> result;
  result.reserve(holders.size());
  for (const auto& list : holders) {
    result.push_back(independent(list));
  }
  return result;
}

}  // namespace rigwire::drivers
