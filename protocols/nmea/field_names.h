// Names of the fields of a sentence, for viewers.
//
// Source: u-blox M8 receiver description, UBX-13003221 R28, sections 31.2.1 to 31.2.17; fields that
// came with version 4.10 (GSA and GSV: system and signal, RMC: status) are there too.
#pragma once

#include <cstddef>
#include <string_view>

namespace rigwire::protocols::nmea {

/// Returns the name of field `index` of a sentence of that type ("GGA"), counted from 0 after the
/// address. Empty for a type or a field that is not in the table. `count`: fields of the sentence;
/// GSV has a last one after one to four satellites.
[[nodiscard]] std::string_view field_name(std::string_view type, std::size_t index,
                                          std::size_t count);

}  // namespace rigwire::protocols::nmea
