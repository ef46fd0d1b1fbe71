#include "emulators/usb/ublox_usb.h"

#include <stdexcept>

namespace rigwire::emulators {

CdcAcmSettings ublox_usb(int generation) {
  CdcAcmSettings settings;
  settings.vendor = 0x1546;
  settings.manufacturer = "u-blox AG - www.u-blox.com";
  settings.product_name = "u-blox GNSS receiver";
  settings.union_descriptor = false;
  settings.data_protocol = 0xFF;
  switch (generation) {
    case 7:
      settings.product = 0x01A7;
      settings.product_name = "u-blox 7 - GPS/GNSS Receiver";
      break;
    case 8:
      settings.product = 0x01A8;
      settings.release = 0x0301;
      break;
    case 9:
      settings.product = 0x01A9;
      break;
    default:
      throw std::invalid_argument("u-blox generation: found " + std::to_string(generation) +
                                  ", allowed 7, 8, 9");
  }
  return settings;
}

}  // namespace rigwire::emulators
