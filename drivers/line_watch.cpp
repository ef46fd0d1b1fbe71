#include "drivers/line_watch.h"

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
#include <utility>

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
namespace {

std::string several_readers(const WatchedLine& line, const std::vector<LineReader>& readers) {
  std::string names;
  for (const LineReader& reader : readers) {
    names +=
        (names.empty() ? "" : ", ") + reader.program + " (" + std::to_string(reader.process) + ")";
  }
  return "pty " + line.link.path().string() + ": " + std::to_string(readers.size()) +
         " programs have it open: " + names +
         "; each gets a part of the bytes only. Give the device or bus further ports (key `ports`) "
         "or end one of them";
}

}  // namespace

LineWatch::LineWatch(boost::asio::execution_context& context)
    : boost::asio::execution_context::service(context) {}

LineWatch::~LineWatch() {
  stop();
}

void LineWatch::shutdown() {
  stop();
}

std::shared_ptr<WatchedLine> LineWatch::add(const std::filesystem::path& path) {
  auto line = std::make_shared<WatchedLine>(path);
  const std::lock_guard guard(mutex_);
  std::erase_if(lines_, [](const auto& known) { return known.expired(); });
  lines_.push_back(line);
  return line;
}

void LineWatch::start(Teller teller) {
  stop();
  stopped_ = false;
  thread_ = std::thread([this, teller = std::move(teller)] { loop(teller); });
}

void LineWatch::stop() {
  {
    const std::lock_guard guard(mutex_);
    stopped_ = true;
  }
  stop_.notify_all();
  if (thread_.joinable()) {
    thread_.join();
  }
}

void LineWatch::loop(const Teller& teller) {
  std::unique_lock guard(mutex_);
  while (!stop_.wait_for(guard, kPeriod, [this] { return stopped_; })) {
    guard.unlock();
    for (const std::string& news : look()) {
      teller(news);
    }
    guard.lock();
  }
}

std::vector<std::shared_ptr<WatchedLine>> LineWatch::lines() {
  const std::lock_guard guard(mutex_);
  std::vector<std::shared_ptr<WatchedLine>> result;
  for (const auto& known : lines_) {
    if (auto line = known.lock()) {
      result.push_back(std::move(line));
    }
  }
  return result;
}

std::vector<std::string> LineWatch::look() {
  std::vector<std::string> news;
  std::vector<std::shared_ptr<WatchedLine>> used;
  std::vector<std::string> terminals;
  for (const auto& line : lines()) {
    if (std::string told = line->link.look(); !told.empty()) {
      news.push_back(std::move(told));
    }
    if (line->in_use) {
      used.push_back(line);
      terminals.push_back(line->link.terminal());
    } else {
      line->readers = 0;
    }
  }
  if (used.empty()) {
    return news;
  }
  const auto readers = readers_of(terminals);
  for (std::size_t i = 0; i < used.size(); ++i) {
    used[i]->readers = static_cast<unsigned>(readers[i].size());
    if (readers[i].size() > 1 && !used[i]->told_once.exchange(true)) {
      news.push_back(several_readers(*used[i], readers[i]));
    }
  }
  return news;
}

LineWatch& line_watch(boost::asio::io_context& context) {
  return boost::asio::use_service<LineWatch>(static_cast<boost::asio::execution_context&>(context));
}

}  // namespace rigwire::drivers
