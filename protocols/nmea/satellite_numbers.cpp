#include "protocols/nmea/satellite_numbers.h"

namespace rigwire::protocols::nmea {
namespace {

constexpr int kLastTwoDigitSbas = 151;
constexpr int kSbasOffset = 87;  // PRN 120 is 33
constexpr int kGlonassOffset = 64;
constexpr int kQzssOffset = 192;

}  // namespace

std::optional<int> satellite_number(System system, int number, Version version,
                                    Numbering numbering) {
  const bool extended = numbering == Numbering::extended;
  switch (system) {
    case System::gps:
      return number;
    case System::sbas:
      if (number <= kLastTwoDigitSbas) {
        return number - kSbasOffset;
      }
      return extended ? std::optional(number) : std::nullopt;
    case System::galileo:
      if (version >= Version::v410) {
        return number;
      }
      return extended ? std::optional(300 + number) : std::nullopt;
    case System::beidou:
      if (version >= Version::v410) {
        return number;
      }
      return extended ? std::optional(400 + number) : std::nullopt;
    case System::qzss:
      if (version == Version::v411) {
        return number;
      }
      return extended ? std::optional(kQzssOffset + number) : std::nullopt;
    case System::glonass:
      return number >= 1 && number <= 32 ? number + kGlonassOffset : 0;
  }
  return std::nullopt;
}

int single_satellite_number(System system, int number) {
  switch (system) {
    case System::gps:
    case System::sbas:
      return number;
    case System::galileo:
      return 210 + number;
    case System::beidou:
      return number <= 5 ? 158 + number : number <= 37 ? 27 + number : 255;
    case System::qzss:
      return kQzssOffset + number;
    case System::glonass:
      return number >= 1 && number <= 32 ? number + kGlonassOffset : 255;
  }
  return 255;
}

System satellite_group(System system, Version version) {
  if (system == System::sbas || (system == System::qzss && version != Version::v411)) {
    return System::gps;
  }
  return system;
}

int system_identifier(System group) {
  switch (group) {
    case System::gps:
    case System::sbas:
      return 1;
    case System::glonass:
      return 2;
    case System::galileo:
      return 3;
    case System::beidou:
      return 4;
    case System::qzss:
      return 5;
  }
  return 0;
}

std::uint8_t first_signal(System system) {
  return system == System::galileo ? 7 : 1;
}

std::string_view group_talker(System group) {
  switch (group) {
    case System::gps:
    case System::sbas:
      return "GP";
    case System::glonass:
      return "GL";
    case System::galileo:
      return "GA";
    case System::beidou:
      return "GB";
    case System::qzss:
      return "GQ";
  }
  return "GN";
}

std::string_view main_talker(unsigned systems, Version version) {
  std::string_view found;
  for (const System system : {System::gps, System::sbas, System::galileo, System::beidou,
                              System::qzss, System::glonass}) {
    if ((systems & system_bit(system)) == 0) {
      continue;
    }
    const std::string_view talker = group_talker(satellite_group(system, version));
    if (!found.empty() && found != talker) {
      return "GN";
    }
    found = talker;
  }
  return found.empty() ? "GP" : found;
}

}  // namespace rigwire::protocols::nmea
