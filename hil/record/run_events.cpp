#include "hil/record/run_events.h"

#include <algorithm>
#include <utility>

namespace rigwire::hil {

void RunEvents::tell(SimTime at, EventKind kind, LogLevel level, std::string where,
                     std::string text) {
  const std::scoped_lock lock(mutex_);
  add({0, at, kind, level, std::move(where), std::move(text)});
}

void RunEvents::tell_ahead(SimTime at, EventKind kind, LogLevel level, std::string where,
                           std::string text) {
  const std::scoped_lock lock(mutex_);
  ahead_.push_back({0, at, kind, level, std::move(where), std::move(text)});
  next_.store(ahead_.front().at, std::memory_order_release);
}

void RunEvents::advance(SimTime now) {
  const std::scoped_lock lock(mutex_);
  while (!ahead_.empty() && ahead_.front().at <= now) {
    add(std::move(ahead_.front()));
    ahead_.pop_front();
  }
  next_.store(ahead_.empty() ? kNever : ahead_.front().at, std::memory_order_release);
}

void RunEvents::add(RunEvent event) {
  event.number = ++last_;
  kept_.push_back(std::move(event));
  if (kept_.size() > kKept) {
    kept_.pop_front();
  }
  for (const Listener& listener : listeners_) {
    if (listener) {
      listener(kept_.back());
    }
  }
}

RunEvents::Excerpt RunEvents::since(std::uint64_t number) const {
  const std::scoped_lock lock(mutex_);
  Excerpt excerpt;
  excerpt.last = last_;
  // Numbers are consecutive.
  const std::uint64_t before = last_ - kept_.size();
  excerpt.lost = number < before ? before - number : 0;
  const std::uint64_t skipped = std::clamp<std::uint64_t>(number, before, last_) - before;
  excerpt.events.assign(kept_.begin() + static_cast<std::ptrdiff_t>(skipped), kept_.end());
  return excerpt;
}

std::uint64_t RunEvents::last() const {
  const std::scoped_lock lock(mutex_);
  return last_;
}

void RunEvents::inform(std::size_t who, Listener listener) {
  const std::scoped_lock lock(mutex_);
  listeners_.at(who) = std::move(listener);
}

}  // namespace rigwire::hil
