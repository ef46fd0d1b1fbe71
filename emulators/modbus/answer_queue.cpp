#include "emulators/modbus/answer_queue.h"

#include <algorithm>
#include <cassert>
#include <tuple>

namespace rigwire::emulators {

AnswerQueue::AnswerQueue(std::size_t capacity) : capacity_(capacity) {
  items_.reserve(capacity);
  heap_.reserve(capacity);
  free_.reserve(capacity);
}

bool AnswerQueue::later(std::uint32_t a, std::uint32_t b) const {
  const Item& first = items_[a];
  const Item& second = items_[b];
  return std::tie(first.due, first.order) > std::tie(second.due, second.order);
}

bool AnswerQueue::push(SimTime due, ConnectionId connection, std::span<const std::uint8_t> bytes,
                       bool close) {
  if (free_.empty()) {
    if (items_.size() >= capacity_ && !close) {
      return false;
    }
    free_.push_back(static_cast<std::uint32_t>(items_.size()));
    items_.emplace_back();
  }
  const std::uint32_t index = free_.back();
  free_.pop_back();
  Item& item = items_[index];
  assert(bytes.size() <= item.bytes.size());
  item.due = due;
  item.order = next_order_++;
  item.connection = connection;
  item.close = close;
  item.size = bytes.size();
  std::ranges::copy(bytes, item.bytes.begin());
  heap_.push_back(index);
  std::ranges::push_heap(heap_, [this](auto a, auto b) { return later(a, b); });
  return true;
}

SimTime AnswerQueue::next_due() const {
  return heap_.empty() ? kNever : front().due;
}

void AnswerQueue::pop() {
  std::ranges::pop_heap(heap_, [this](auto a, auto b) { return later(a, b); });
  free_.push_back(heap_.back());
  heap_.pop_back();
}

}  // namespace rigwire::emulators
