#include "hil/record/record_queue.h"

#include <algorithm>
#include <cstring>
#include <utility>

namespace rigwire::hil {
namespace {

/// In front of an entry's bytes; copied in and out, never read in place.
struct Head {
  std::int64_t at_ns = 0;
  std::uint32_t size = 0;
  std::uint16_t track = 0;
  std::uint8_t flags = 0;
};

/// The writer is woken when this much has come; less waits for its own period.
constexpr std::size_t kWorthWaking = 64 * 1024;

}  // namespace

RecordQueue::RecordQueue(std::size_t bytes, std::chrono::milliseconds patience)
    : room_(bytes), patience_(patience) {
  filling_.reserve(room_);
  taking_.reserve(room_);
}

bool RecordQueue::put(const RecordEntry& entry) {
  const std::size_t size = sizeof(Head) + entry.bytes.size();
  std::unique_lock lock(mutex_);
  if (closed_) {
    return true;
  }
  const auto fits = [&] { return filling_.size() + size <= room_ || filling_.empty(); };
  if (!fits() && patience_.count() > 0 && !out_of_patience_) {
    filled_.notify_one();
    out_of_patience_ = !taken_.wait_for(lock, patience_, fits);
  }
  if (!fits()) {
    lost_.resize(std::max<std::size_t>(lost_.size(), entry.track + 1U));
    ++lost_[entry.track];
    return false;
  }
  const Head head{entry.at.time_since_epoch().count(),
                  static_cast<std::uint32_t>(entry.bytes.size()), entry.track, entry.flags};
  const std::size_t before = filling_.size();
  const auto* head_bytes = reinterpret_cast<const std::uint8_t*>(&head);
  filling_.insert(filling_.end(), head_bytes, head_bytes + sizeof head);
  filling_.insert(filling_.end(), entry.bytes.begin(), entry.bytes.end());
  const bool wakes = before < kWorthWaking && filling_.size() >= kWorthWaking;
  lock.unlock();
  if (wakes) {
    filled_.notify_one();
  }
  return true;
}

const RecordQueue::Taken& RecordQueue::take(std::chrono::milliseconds until) {
  taking_.clear();
  row_.entries.clear();
  row_.lost.clear();
  {
    std::unique_lock lock(mutex_);
    filled_.wait_for(lock, until, [this] { return closed_ || filling_.size() >= kWorthWaking; });
    std::swap(taking_, filling_);
    std::swap(row_.lost, lost_);
    out_of_patience_ = false;
  }
  taken_.notify_all();
  for (std::size_t at = 0; at < taking_.size();) {
    Head head;
    std::memcpy(&head, taking_.data() + at, sizeof head);
    at += sizeof head;
    row_.entries.push_back({head.track, head.flags, SimTime{Duration{head.at_ns}},
                            std::span(taking_).subspan(at, head.size)});
    at += head.size;
  }
  return row_;
}

void RecordQueue::close() {
  {
    const std::scoped_lock lock(mutex_);
    closed_ = true;
  }
  filled_.notify_one();
}

void RecordQueue::open() {
  const std::scoped_lock lock(mutex_);
  filling_.clear();
  lost_.clear();
  closed_ = false;
  out_of_patience_ = false;
}

bool RecordQueue::closed() const {
  const std::scoped_lock lock(mutex_);
  return closed_;
}

}  // namespace rigwire::hil
