// The second UART of a ZED-F9P, as it is delivered: RTCM 3 in and out, no UBX, no NMEA. Between two
// receivers it is the wire that carries corrections.
//
// Source: ZED-F9P integration manual UBX-18010802, section 3.2 "UART2"; interface description HPG
// 1.50, "Configuration defaults", CFG-UART2.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "emulators/device.h"
#include "emulators/ublox/monitor.h"
#include "emulators/ublox/transmitter.h"
#include "protocols/rtcm3/frame.h"

namespace rigwire::emulators {

class UbloxSecondPort {
 public:
  /// `output` must outlive it.
  UbloxSecondPort(ByteOutput& output, std::size_t capacity_bytes, std::uint32_t baud)
      : line_(output, capacity_bytes, baud) {}

  /// Finds frames in what comes in; take(frame) for each.
  template <class Take>
  void take_in(std::span<const std::uint8_t> bytes, Take take) {
    port_.bytes += static_cast<std::uint32_t>(bytes.size());
    for (const std::uint8_t byte : bytes) {
      input_[size_++] = byte;
      find(take);
    }
    port_.peak_bytes = std::max(port_.peak_bytes, size_);
  }
  /// Bytes at another speed than the port's.
  void take_garbage(std::size_t bytes) {
    port_.framing_errors = static_cast<std::uint16_t>(port_.framing_errors + bytes);
  }
  /// Power-on or reset.
  void restart() {
    size_ = 0;
    port_ = {};
    line_.clear();
  }

  [[nodiscard]] UbloxTransmitter& line() { return line_; }
  [[nodiscard]] const UbloxTransmitter& line() const { return line_; }
  [[nodiscard]] UbloxPortStatistics& port() { return port_; }
  [[nodiscard]] const UbloxPortStatistics& port() const { return port_; }

 private:
  template <class Take>
  void find(Take take) {
    while (size_ > 0) {
      const auto frame = protocols::rtcm3::decode_frame(std::span(input_).first(size_));
      if (frame.incomplete()) {
        return;
      }
      std::size_t used = 1;
      if (frame.ok()) {
        take(*frame);
        used = frame.consumed();
      } else {
        ++port_.skipped;
      }
      std::copy(input_.begin() + static_cast<std::ptrdiff_t>(used),
                input_.begin() + static_cast<std::ptrdiff_t>(size_), input_.begin());
      size_ -= used;
    }
  }

  UbloxTransmitter line_;
  UbloxPortStatistics port_;
  std::array<std::uint8_t, protocols::rtcm3::kGreatestFrame> input_{};
  std::size_t size_ = 0;
};

}  // namespace rigwire::emulators
