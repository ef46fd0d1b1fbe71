#include "drivers/line_watch.h"

#include <utility>

#include "drivers/line_readers.h"

namespace rigwire::drivers {
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
