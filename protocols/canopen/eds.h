// The electronic data sheet of a node: its object dictionary as a file that a master's tools load.
//
// Source: CiA 306-1 V1.3.0, 6 (sections and keys), 7 (objects). Lines end with CR LF. The file has
// all rows of the table, and limits where they are narrower than the type. The caller gives what is
// not constant of the file itself, so that the same device gives the same file.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>

#include "protocols/canopen/object_entry.h"

namespace rigwire::protocols::canopen {

struct EdsDevice {
  std::string file;         ///< Its name; "encoder.eds".
  std::string description;  ///< One line.
  std::string vendor_name;
  std::string product_name;
  std::uint32_t vendor = 0;
  std::uint32_t product = 0;
  std::uint32_t revision = 0;
};

/// The value of an entry at delivery: a number without the node-ID, or a text.
using EdsDefault = std::function<std::string(const ObjectEntry&)>;

/// Precondition: `table` is sorted.
[[nodiscard]] std::string make_eds(const EdsDevice& device, std::span<const ObjectEntry> table,
                                   const EdsDefault& at_delivery);

}  // namespace rigwire::protocols::canopen
