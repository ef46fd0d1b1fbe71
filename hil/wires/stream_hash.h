// The fingerprint of everything a device has emitted: due time, length and bytes of each unit of
// output.
//
// FNV-1a, 64 bit. Two runs with the same configuration and seed must agree in it; it is no
// protection against a forger.
#pragma once

#include <cstdint>
#include <span>

#include "sim/samples/time.h"

namespace rigwire::hil {

class StreamHash {
 public:
  void add(SimTime due, std::span<const std::uint8_t> bytes) {
    add_word(static_cast<std::uint64_t>(due.time_since_epoch().count()));
    add_word(bytes.size());
    for (const std::uint8_t byte : bytes) {
      add_byte(byte);
    }
  }
  [[nodiscard]] std::uint64_t value() const { return hash_; }

 private:
  void add_byte(std::uint8_t byte) { hash_ = (hash_ ^ byte) * 0x100000001B3ULL; }
  void add_word(std::uint64_t word) {
    for (unsigned i = 0; i < 8; ++i) {
      add_byte(static_cast<std::uint8_t>(word >> (8U * i)));
    }
  }
  std::uint64_t hash_ = 0xCBF29CE484222325ULL;
};

}  // namespace rigwire::hil
