// How u-blox receivers present themselves on their USB socket.
//
// Generation 7 byte for byte as such a device was read. Generations 8 and 9 differ from it by what
// is commonly reported of them (product id, product name, release); their other descriptors were
// not read from a device and are taken to be the same.
//
// A receiver ignores the line coding: its USB port has no speed.
#pragma once

#include "emulators/usb/cdc_acm.h"

namespace rigwire::emulators {

/// `generation` is UbloxProfile::generation: 7, 8 or 9. Throws std::invalid_argument.
[[nodiscard]] CdcAcmSettings ublox_usb(int generation);

}  // namespace rigwire::emulators
