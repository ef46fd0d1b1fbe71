#include "protocols/rinex/observation.h"

#include <algorithm>

#include "protocols/rinex/columns.h"

namespace rigwire::protocols::rinex {
namespace {

// Signal strength 1..9: steps of 6 dBHz.
int strength(double cn0_dbhz) {
  return static_cast<int>(std::clamp(cn0_dbhz / 6.0, 1.0, 9.0));
}

}  // namespace

void append_observation_header(std::string& out, const ObservationHeader& header) {
  append_header(out,
                padded("     3.04", 20) + padded("OBSERVATION DATA", 20) + padded("G: GPS", 20),
                "RINEX VERSION / TYPE");
  append_header(
      out,
      padded(header.origin.program, 20) + padded(header.origin.run_by, 20) + header.origin.date,
      "PGM / RUN BY / DATE");
  append_header(out, header.marker, "MARKER NAME");
  append_header(out, "GROUND_CRAFT", "MARKER TYPE");
  append_header(out, "", "OBSERVER / AGENCY");
  append_header(out,
                padded(header.receiver_number, 20) + padded(header.receiver_type, 20) +
                    header.receiver_version,
                "REC # / TYPE / VERS");
  append_header(out, "", "ANT # / TYPE");
  std::string line;
  append(line, "%14.4f%14.4f%14.4f", header.position_E_m[0], header.position_E_m[1],
         header.position_E_m[2]);
  append_header(out, line, "APPROX POSITION XYZ");
  line.clear();
  append(line, "%14.4f%14.4f%14.4f", 0.0, 0.0, 0.0);
  append_header(out, line, "ANTENNA: DELTA H/E/N");
  append_header(out, "G    4 C1C L1C D1C S1C", "SYS / # / OBS TYPES");
  append_header(out, "DBHZ", "SIGNAL STRENGTH UNIT");
  line.clear();
  append(line, "%10.3f", header.interval_s);
  append_header(out, line, "INTERVAL");
  const CalendarDate first = to_date(header.first);
  line.clear();
  append(line, "%6d%6d%6d%6d%6d%13.7f     GPS", first.year, first.month, first.day, first.hour,
         first.minute, first.second);
  append_header(out, line, "TIME OF FIRST OBS");
  append_header(out, "G L1C", "SYS / PHASE SHIFT");
  line.clear();
  append(line, "%6d", header.leap_seconds);
  append_header(out, line, "LEAP SECONDS");
  append_header(out, "", "END OF HEADER");
}

void append_observations(std::string& out, const Epoch& epoch,
                         std::span<const Observation> observations) {
  const CalendarDate date = to_date(epoch);
  append(out, "> %04d %02d %02d %02d %02d%11.7f  0%3d\n", date.year, date.month, date.day,
         date.hour, date.minute, date.second, static_cast<int>(observations.size()));
  for (const Observation& observation : observations) {
    const int level = strength(observation.cn0_dbhz);
    append(out, "G%02d%14.3f %d", int{observation.prn}, observation.pseudorange_m, level);
    if (observation.has_phase) {
      append(out, "%14.3f%c%d", observation.carrier_phase_cycles, observation.slipped ? '1' : ' ',
             level);
    } else {
      out.append(16, ' ');
    }
    append(out, "%14.3f  %14.3f\n", observation.doppler_hz, observation.cn0_dbhz);
  }
}

}  // namespace rigwire::protocols::rinex
