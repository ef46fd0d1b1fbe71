// Acceptance filter of the SJA1000: it selects the frames that an adapter passes to its client.
// LAWICEL's commands M (code), m (mask) and W (mode) set it.
//
// Sources: NXP SJA1000 data sheet, rev. 04, 6.4.15 (PeliCAN mode); LAWICEL AB, "CANUSB manual"
// 1.0D, commands M, m, W. Registers AC0..AC3 and AM0..AM3, AC0 in the highest byte; a mask bit of 1
// means "does not matter".
//
//   mode    format   register bits, from AC0 bit 7 on, compared with
//   single  11 bit   identifier 11, RTR, 4 unused, first data byte, second data byte
//           29 bit   identifier 29, RTR, 2 unused
//   dual    11 bit   filter 1: identifier 11, RTR, first data byte's upper half; its lower half
//                    is in AC3 bits 3..0.  filter 2, from AC2 on: identifier 11, RTR
//           29 bit   filters 1 and 2: the identifier's upper 16 bits
//
// Data bytes that a frame does not have are not compared. Dual: one of the two must accept.
#pragma once

#include <cstdint>

#include "protocols/can/frame.h"

namespace rigwire::protocols::slcan {

struct AcceptanceFilter {
  std::uint32_t code = 0;
  std::uint32_t mask = 0xFFFFFFFF;  ///< Accepts everything.
  bool single = false;              ///< W1; W0 is dual, as after power-up.

  [[nodiscard]] bool accepts(const can::Frame& frame) const;

  friend bool operator==(const AcceptanceFilter&, const AcceptanceFilter&) = default;
};

}  // namespace rigwire::protocols::slcan
