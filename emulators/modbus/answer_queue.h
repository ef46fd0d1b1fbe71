// Answers of a Modbus TCP server that wait for their instants, over all connections, in order of
// time. The memory of answers is reserved at construction; an answer that does not fit is refused.
// The end of a connection, which comes once for each, is never.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "emulators/device.h"
#include "protocols/modbus/constants.h"
#include "sim/samples/time.h"

namespace rigwire::emulators {

class AnswerQueue {
 public:
  struct Item {
    SimTime due{};
    std::uint64_t order = 0;  ///< Of equal instants the one that was put in first leaves first.
    ConnectionId connection = 0;
    bool close = false;  ///< Ends the connection; has no bytes.
    std::size_t size = 0;
    std::array<std::uint8_t, protocols::modbus::kTcpAduMaximum> bytes{};

    [[nodiscard]] std::span<const std::uint8_t> view() const {
      return std::span(bytes).first(size);
    }
  };

  explicit AnswerQueue(std::size_t capacity);

  /// At most one data unit of bytes. False when the queue is full of answers.
  bool push(SimTime due, ConnectionId connection, std::span<const std::uint8_t> bytes, bool close);
  [[nodiscard]] bool empty() const { return heap_.empty(); }
  /// kNever when empty.
  [[nodiscard]] SimTime next_due() const;
  /// Precondition: not empty. Valid until push() or pop().
  [[nodiscard]] const Item& front() const { return items_[heap_.front()]; }
  void pop();

 private:
  [[nodiscard]] bool later(std::uint32_t a, std::uint32_t b) const;

  std::size_t capacity_;
  std::vector<Item> items_;
  std::vector<std::uint32_t> heap_;  ///< Indices of waiting items, the earliest in front.
  std::vector<std::uint32_t> free_;  ///< Indices of the others.
  std::uint64_t next_order_ = 0;
};

}  // namespace rigwire::emulators
