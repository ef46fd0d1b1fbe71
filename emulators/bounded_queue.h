// A queue of at most N items that never allocates: what a device's memory holds.
#pragma once

#include <array>
#include <cassert>
#include <cstddef>
#include <utility>

namespace rigwire::emulators {

template <class T, std::size_t N>
class BoundedQueue {
 public:
  /// False when it is full; the item is not taken then.
  [[nodiscard]] bool push(const T& item) {
    if (full()) {
      return false;
    }
    items_[(first_ + size_) % N] = item;
    ++size_;
    return true;
  }

  /// Precondition: not empty.
  [[nodiscard]] const T& front() const {
    assert(size_ > 0);
    return items_[first_];
  }
  /// Takes the oldest one out. Precondition: not empty.
  T pop() {
    assert(size_ > 0);
    T item = std::move(items_[first_]);
    first_ = (first_ + 1) % N;
    --size_;
    return item;
  }
  /// The one at `index` from the oldest. Precondition: index < size().
  [[nodiscard]] T& operator[](std::size_t index) {
    assert(index < size_);
    return items_[(first_ + index) % N];
  }
  /// Removes the oldest one that `condition` holds for; false when there is none.
  template <class Condition>
  bool remove_first(Condition condition) {
    for (std::size_t i = 0; i < size_; ++i) {
      if (condition((*this)[i])) {
        for (; i + 1 < size_; ++i) {
          (*this)[i] = std::move((*this)[i + 1]);
        }
        --size_;
        return true;
      }
    }
    return false;
  }

  void clear() { size_ = 0; }
  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] bool empty() const { return size_ == 0; }
  [[nodiscard]] bool full() const { return size_ == N; }

 private:
  std::array<T, N> items_{};
  std::size_t first_ = 0;
  std::size_t size_ = 0;
};

}  // namespace rigwire::emulators
