// A file descriptor that closes itself, for set-up that can fail half-way and for short probes.
// Asio's objects own the descriptors that live longer.
#pragma once

#include <unistd.h>

#include <utility>

namespace rigwire::drivers {

/// Owns one descriptor; a negative one stands for "none" and is left alone.
class Descriptor {
 public:
  explicit Descriptor(int value) : value_(value) {}
  ~Descriptor() {
    if (value_ >= 0) {
      ::close(value_);
    }
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;

  [[nodiscard]] bool open() const { return value_ >= 0; }
  [[nodiscard]] int get() const { return value_; }
  /// Hands the descriptor over; the caller closes it.
  [[nodiscard]] int release() { return std::exchange(value_, -1); }

 private:
  int value_;
};

}  // namespace rigwire::drivers
