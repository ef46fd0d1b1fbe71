// What a serial line does to bytes: nothing, or noise, or the garbage that a far end of another
// speed makes of them.
//
// A far end at another speed is computed bit by bit: it waits for a falling edge, samples eight
// bits in the middle of its own bit times, and takes what it finds; after a missing stop bit it
// waits for the line to rest. Each chunk of the transmitter is read by itself, so that the number
// of bytes is right to about one in eight.
#pragma once

#include <cstdint>
#include <span>

#include "emulators/device.h"
#include "emulators/random_bits.h"

namespace rigwire::emulators {

class UbloxLineQuality final : public ByteOutput {
 public:
  /// `output` must outlive it. Noise is drawn from `seed` alone.
  UbloxLineQuality(ByteOutput& output, std::uint64_t seed);

  void set_device_baud(std::uint32_t baud) { device_baud_ = baud; }
  /// 0 = not known: taken for the same.
  void set_client_baud(std::uint32_t baud) { client_baud_ = baud; }
  /// Probability that a bit is turned over, both ways, 0 .. 0.5.
  void set_bit_error_rate(double rate);

  [[nodiscard]] bool matched() const { return client_baud_ == 0 || client_baud_ == device_baud_; }
  [[nodiscard]] bool noisy() const { return bit_error_rate_ > 0.0; }

  /// At most 8 bytes at a time.
  void send(SimTime due, std::span<const std::uint8_t> bytes) override;
  /// Turns bits over in place, at the present rate.
  void disturb(std::span<std::uint8_t> bytes);

 private:
  void draw_gap();

  ByteOutput& output_;
  RandomBits random_;
  std::uint32_t device_baud_ = 0;
  std::uint32_t client_baud_ = 0;
  double bit_error_rate_ = 0.0;
  std::uint64_t good_bits_left_ = 0;  ///< Before the next error.
};

/// What a UART at `to_baud` reads of bytes sent without a gap at `from_baud`; returns their number,
/// at most out.size().
[[nodiscard]] std::size_t read_at_wrong_speed(std::span<const std::uint8_t> bytes,
                                              std::uint32_t from_baud, std::uint32_t to_baud,
                                              std::span<std::uint8_t> out);

}  // namespace rigwire::emulators
