// GSA, GSV, GRS, GST and GBS: satellites and what they make of the fix, exactly as u-blox receivers
// print them.
//
// GSA, GRS and GSV come in several sentences, numbered from 1: one GSA and GRS for each group of
// satellites (satellite_numbers.h) when Epoch::systems names several; GSV in pages of four
// satellites, for each group and, from version 4.10 on, each signal. The order of satellites is
// that of the epoch, sentences of a group keep together.
//
// Source: u-blox M8 receiver description, UBX-13003221 R28, section 31.2; ZED-F9P interface
// description HPG 1.50, UBXDOC-963802114-12815, section 2.4 "NMEA multi-GNSS operation"; the last
// GSV page is not padded (recordings of a NEO-7P). GST with two significant digits as M8 and F9
// print it.
#pragma once

#include "protocols/nmea/epoch.h"
#include "protocols/nmea/sentence.h"

namespace rigwire::protocols::nmea {

[[nodiscard]] int gsa_sentences(const Epoch& epoch);
[[nodiscard]] Sentence write_gsa(const Epoch& epoch, int sentence);
/// The first one.
[[nodiscard]] Sentence write_gsa(const Epoch& epoch);

[[nodiscard]] int grs_sentences(const Epoch& epoch);
/// Residuals of the satellites of the GSA of the same number.
[[nodiscard]] Sentence write_grs(const Epoch& epoch, int sentence);

/// At most 5 pages of one set up to version 2.3, 9 later.
[[nodiscard]] int gsv_pages(const Epoch& epoch);
[[nodiscard]] Sentence write_gsv(const Epoch& epoch, int page);

/// Empty but for the time without error statistics.
[[nodiscard]] Sentence write_gst(const Epoch& epoch);

/// A satellite that integrity monitoring has found at fault.
struct FaultySatellite {
  int number = 0;
  double bias_m = 0.0;
  double deviation_m = 0.0;
  System system = System::gps;
  std::uint8_t signal = 1;
};
[[nodiscard]] Sentence write_gbs(const Epoch& epoch,
                                 const std::optional<FaultySatellite>& fault = std::nullopt);

}  // namespace rigwire::protocols::nmea
