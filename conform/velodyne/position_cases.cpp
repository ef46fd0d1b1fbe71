// Position packets: their bytes, their time, the state of the pulse and the sentence within.
#include <algorithm>
#include <array>
#include <cmath>

#include "conform/nmea/nmea_suite.h"
#include "conform/velodyne/velodyne_rows.h"

namespace rigwire::conform {

namespace velodyne = protocols::velodyne;
using velodyne::PositionLayout;

namespace {

using Log = VelodyneLog;
using Claims = VelodyneClaims;

constexpr const char* kPosition = "63-9113 Rev. H, Position packet; 63-9243 Rev. D, 9.4";
constexpr const char* kExtended = "63-9483 Rev. A, table 9-2";
constexpr std::uint32_t kHourOfPositions_us = 3'600'000'000;

std::string some_position(const Log& log, const Claims& claims) {
  const std::string none = position_packets(log, claims);
  return none.empty() && log.positions().empty() ? "no position packet came" : none;
}

void come(Trial& trial, const Log& log, const Claims&) {
  trial.expect(!log.position_datagrams().empty(), "position packets", "none");
}

void position_length(Trial& trial, const Log& log, const Claims&) {
  for (const VelodyneDatagram& datagram : log.position_datagrams()) {
    if (datagram.bytes.size() != velodyne::kPositionPacketSize) {
      trial.received(datagram.bytes, "of another length");
      trial.expect(false, "512 bytes in each position packet",
                   std::to_string(datagram.bytes.size()));
      return;
    }
  }
  trial.expect(true, "512 bytes in each position packet", "");
}

Wrong zeros(const VelodynePosition& packet, std::size_t from, std::size_t end) {
  for (std::size_t at = from; at < end; ++at) {
    if (packet.byte(at) != 0) {
      return byte_text(packet.byte(at)) + " at byte " + std::to_string(at);
    }
  }
  return {};
}

void head(Trial& trial, const Log& log, const Claims&) {
  each(trial, log.positions(), "zeros in the first 14 bytes",
       [](const VelodynePosition& packet) { return zeros(packet, 0, 14); });
}

template <PositionLayout layout>
std::string has_layout(const Log& log, const Claims& claims) {
  const std::string none = some_position(log, claims);
  const std::string doubt = none.empty() ? a_model(log, claims) : none;
  return doubt.empty() && log.model()->position_layout != layout ? "the model's layout is another"
                                                                 : doubt;
}

void plain(Trial& trial, const Log& log, const Claims&) {
  each(trial, log.positions(), "zeros up to the timestamp",
       [](const VelodynePosition& packet) { return zeros(packet, 14, 198); });
}

void inertial_gap(Trial& trial, const Log& log, const Claims&) {
  each(trial, log.positions(), "zeros between the inertial words and the timestamp",
       [](const VelodynePosition& packet) { return zeros(packet, 38, 198); });
}

/// Returns the low twelve bits as a two's complement number.
int twelve_bits(unsigned word) {
  const int low = static_cast<int>(word & 0xFFFU);
  return low >= 0x800 ? low - 0x1000 : low;
}

void temperatures(Trial& trial, const Log& log, const Claims&) {
  each(trial, log.positions(), "temperatures of -40 to 100 degrees",
       [](const VelodynePosition& packet) {
         for (const std::size_t group : std::array<std::size_t, 3>{14, 22, 30}) {
           const double found = velodyne::kTemperatureOrigin_c +
                                velodyne::kTemperatureUnit_c * twelve_bits(packet.u16(group + 2));
           if (found < -40.0 || found > 100.0) {
             return Wrong(number_text(found) + " degrees");
           }
         }
         return Wrong();
       });
}

void status(Trial& trial, const Log& log, const Claims&) {
  each(trial, log.positions(),
       "a reason of 0 to 4 of the last calibration, a thermal state of 0, 1",
       [](const VelodynePosition& packet) {
         return packet.byte(0xC4) > 4 || packet.byte(0xCB) > 1
                    ? Wrong(byte_text(packet.byte(0xC4)) + ", " + byte_text(packet.byte(0xCB)))
                    : Wrong();
       });
}

void board_temperatures(Trial& trial, const Log& log, const Claims&) {
  each(trial, log.positions(), "temperatures of at most 150 degrees",
       [](const VelodynePosition& packet) {
         for (const std::size_t at : std::array<std::size_t, 5>{0xBB, 0xBC, 0xBD, 0xCC, 0xCD}) {
           if (packet.byte(at) > 150) {
             return Wrong(std::to_string(packet.byte(at)) + " degrees");
           }
         }
         return Wrong();
       });
}

void extended_end(Trial& trial, const Log& log, const Claims&) {
  each(trial, log.positions(), "zeros behind the 128 bytes of the sentence",
       [](const VelodynePosition& packet) { return zeros(packet, 0x14E, 512); });
}

std::string classic(const Log& log, const Claims& claims) {
  const std::string none = some_position(log, claims);
  const std::string doubt = none.empty() ? a_model(log, claims) : none;
  return doubt.empty() && log.model()->position_layout == PositionLayout::extended
             ? "the model says more there"
             : doubt;
}

void before_sentence(Trial& trial, const Log& log, const Claims&) {
  each(trial, log.positions(), "zeros between the pulse's state and the sentence",
       [](const VelodynePosition& packet) { return zeros(packet, 203, 206); });
}

// --- time ---

void within_the_hour(Trial& trial, const Log& log, const Claims&) {
  each(trial, log.positions(), "timestamps below 3 600 000 000 us",
       [](const VelodynePosition& packet) {
         return packet.timestamp_us() < kHourOfPositions_us
                    ? Wrong()
                    : Wrong(std::to_string(packet.timestamp_us()));
       });
}

void position_forward(Trial& trial, const Log& log, const Claims&) {
  std::optional<std::uint32_t> before;
  each(trial, log.positions(), "timestamps that go forward", [&](const VelodynePosition& packet) {
    const bool back = before && timestamp_step_us(*before, packet.timestamp_us()) < 0;
    before = packet.timestamp_us();
    return back ? Wrong(std::to_string(*before) + " us") : Wrong();
  });
}

void repeated(Trial& trial, const Log& log, const Claims&) {
  std::optional<std::uint32_t> before;
  each(trial, log.positions(), "each position packet once", [&](const VelodynePosition& packet) {
    const bool again = before == packet.timestamp_us();
    before = packet.timestamp_us();
    return again ? Wrong("the same timestamp twice") : Wrong();
  });
}

void with_data(Trial& trial, const Log& log, const Claims&) {
  // They wait for their place between data packets, and for this machine.
  constexpr std::int64_t kApart_us = 50'000;
  each(trial, log.positions(), "the time of the data packets around it, within 50 ms",
       [&](const VelodynePosition& packet) {
         if (packet.data_before() == 0) {
           return Wrong();
         }
         const std::int64_t apart = timestamp_step_us(
             log.data()[packet.data_before() - 1].timestamp_us(), packet.timestamp_us());
         return std::abs(apart) > kApart_us ? Wrong(std::to_string(apart) + " us beside") : Wrong();
       });
}

void rate(Trial& trial, const Log& log, const Claims&) {
  std::vector<std::int64_t> steps;
  for (std::size_t i = 1; i < log.positions().size(); ++i) {
    steps.push_back(timestamp_step_us(log.positions()[i - 1].timestamp_us(),
                                      log.positions()[i].timestamp_us()));
  }
  if (steps.empty()) {
    return trial.not_applicable("only one came");
  }
  std::ranges::sort(steps);
  // One in 14 data packets of one return (VLP-16 manual); a public capture has 1.5 to 10.7 ms.
  const auto median_us = static_cast<double>(steps[steps.size() / 2]);
  const double most_us =
      20.0 * velodyne::packet_period_ns(*log.model(), velodyne::ReturnMode::strongest) / 1000.0;
  trial.expect(median_us > 0.0 && median_us <= most_us,
               "a position packet for every 20 data packets at least, by their timestamps",
               "one in " + number_text(median_us * 1e-3) + " ms");
}

std::string position_all_round(const Log& log, const Claims& claims) {
  const std::string none = some_position(log, claims);
  return none.empty() ? all_round(log, claims) : none;
}

std::string position_and_model(const Log& log, const Claims& claims) {
  const std::string none = some_position(log, claims);
  return none.empty() ? a_model(log, claims) : none;
}

// --- pulse ---

void known_pulse(Trial& trial, const Log& log, const Claims&) {
  each(trial, log.positions(), "a pulse's state of 0 to 3", [](const VelodynePosition& packet) {
    return packet.pulse_state() <= 3 ? Wrong() : byte_text(packet.pulse_state());
  });
}

void no_pulse_error(Trial& trial, const Log& log, const Claims&) {
  each(trial, log.positions(), "no error of the pulse (3)", [](const VelodynePosition& packet) {
    return packet.pulse_state() == 3 ? Wrong("3") : Wrong();
  });
}

std::string claimed_pulse(const Log& log, const Claims& claims) {
  return claims.pulse.empty() ? "no state of the pulse is claimed" : some_position(log, claims);
}

void pulse_as_claimed(Trial& trial, const Log& log, const Claims& claims) {
  each(trial, log.positions(), "the claimed state of the pulse",
       [&](const VelodynePosition& packet) {
         const std::string_view found = pulse_state_name(packet.pulse_state());
         return found == claims.pulse ? Wrong() : Wrong(std::string(found));
       });
}

// --- sentence ---

void padded(Trial& trial, const Log& log, const Claims&) {
  each(trial, log.positions(), "zeros behind the sentence", [](const VelodynePosition& packet) {
    return zeros(packet, 206 + packet.sentence().size(), 512);
  });
}

std::string a_sentence(const Log& log, const Claims& claims) {
  const std::string none = some_position(log, claims);
  return none.empty() && log.sentences().sentences().empty() ? "no position packet has a sentence"
                                                             : none;
}

void known_sentence(Trial& trial, const Log& log, const Claims&) {
  each(trial, log.positions(), "$GPRMC, $GPGGA or nothing", [](const VelodynePosition& packet) {
    const std::string text = packet.sentence();
    return text.empty() || text.starts_with("$GPRMC,") || text.starts_with("$GPGGA,") ? Wrong()
                                                                                      : Wrong(text);
  });
}

void with_pulse(Trial& trial, const Log& log, const Claims&) {
  each(trial, log.positions(), "a sentence where the pulse is locked",
       [](const VelodynePosition& packet) {
         return packet.pulse_state() == 2 && packet.sentence().empty() ? Wrong("none") : Wrong();
       });
}

/// What the suite nmea asks of a sentence.
template <int number>
void as_nmea(Trial& trial, const Log& log, const Claims&) {
  static const std::vector<NmeaCase> kCases = nmea_cases();
  const std::string id = number < 10 ? "nmea/sentence/" + std::to_string(number)
                                     : "nmea/field/" + std::to_string(number - 10);
  std::ranges::find(kCases, id, [](const NmeaCase& each) {
    return each.identity.id;
  })->run(trial, log.sentences(), {});
}

/// Seconds past the hour of a sentence's time; nothing without.
std::optional<double> seconds_of_hour(const std::string& sentence) {
  const std::size_t comma = sentence.find(',');
  if (comma == std::string::npos || sentence.size() < comma + 7 ||
      !std::all_of(sentence.begin() + static_cast<std::ptrdiff_t>(comma) + 1,
                   sentence.begin() + static_cast<std::ptrdiff_t>(comma) + 7,
                   [](char c) { return c >= '0' && c <= '9'; })) {
    return std::nullopt;
  }
  return std::stoi(sentence.substr(comma + 3, 2)) * 60.0 + std::stoi(sentence.substr(comma + 5, 2));
}

// Locked, the timestamp is past UTC's hour; the sentence names the pulse before it, or the one
// before that while the next sentence is on its way.
void time_of_sentence(Trial& trial, const Log& log, const Claims&) {
  each(trial, log.positions(), "the sentence's second, or up to two seconds later",
       [](const VelodynePosition& packet) {
         const auto second = seconds_of_hour(packet.sentence());
         if (packet.pulse_state() != 2 || !second) {
           return Wrong();
         }
         const double late_s = std::remainder(packet.timestamp_us() * 1e-6 - *second, 3600.0);
         return late_s < 0.0 || late_s > 2.0 ? Wrong(number_text(late_s) + " s later") : Wrong();
       });
}

void new_each_second(Trial& trial, const Log& log, const Claims&) {
  const std::string first = log.positions().front().sentence();
  const std::string last = log.positions().back().sentence();
  const double passed_s =
      static_cast<double>(timestamp_step_us(log.positions().front().timestamp_us(),
                                            log.positions().back().timestamp_us())) *
      1e-6;
  const auto from = seconds_of_hour(first);
  const auto to = seconds_of_hour(last);
  if (passed_s < 3.0 || !from) {
    return trial.not_applicable("less than three seconds with sentences");
  }
  const double told_s = to ? std::remainder(*to - *from, 3600.0) : 0.0;
  trial.expect(std::abs(told_s - passed_s) <= 2.0, "sentences that go with time, within 2 s",
               number_text(told_s) + " s in " + number_text(passed_s) + " s");
}

}  // namespace

std::vector<VelodyneRow> velodyne_position_rows() {
  return {
      {"position", "Position packets come", kPosition, kShould, position_packets, come},
      {"position", "A position packet has 512 bytes", kPosition, kMust, position_packets,
       position_length},
      {"position", "It begins with zeros", kPosition, kMust, some_position, head},
      {"position", "The plain layout is zeros up to the timestamp", "63-9243 Rev. D, 9.4", kMust,
       has_layout<PositionLayout::plain>, plain},
      {"position", "Behind the inertial words are zeros", "63-9113 Rev. H, Position packet", kMust,
       has_layout<PositionLayout::inertial>, inertial_gap},
      {"position", "Inertial units have temperatures that can be",
       "63-9113 Rev. H, Position packet", kShould, has_layout<PositionLayout::inertial>,
       temperatures},
      {"position", "States of the extended layout are such as there are", kExtended, kMust,
       has_layout<PositionLayout::extended>, status},
      {"position", "Temperatures of the extended layout can be", kExtended, kMust,
       has_layout<PositionLayout::extended>, board_temperatures},
      {"position", "The extended layout ends behind its sentence", kExtended, kMust,
       has_layout<PositionLayout::extended>, extended_end},
      {"position", "Three bytes before the sentence are zero", kPosition, kMust, classic,
       before_sentence},
      {"position", "Timestamps are within the hour", kPosition, kShould, some_position,
       within_the_hour},
      {"position", "Timestamps go forward", kPosition, kMust, some_position, position_forward},
      {"position", "No position packet comes twice", kPosition, kShould, some_position, repeated},
      {"position", "Timestamps are those of the data packets", kPosition, kMust, position_all_round,
       with_data},
      {"position", "They come often enough", "63-9243 Rev. D, 9.4", kShould, position_and_model,
       rate},
      {"pulse", "The state of the pulse is one that there is", "63-9243 Rev. D, 9.4", kMust,
       some_position, known_pulse},
      {"pulse", "The pulse is no error", "63-9243 Rev. D, 9.4", kShould, some_position,
       no_pulse_error},
      {"pulse", "The pulse is as claimed", "63-9243 Rev. D, 9.4", kMust, claimed_pulse,
       pulse_as_claimed},
      {"sentence", "Behind the sentence are zeros", kPosition, kMust, some_position, padded},
      {"sentence", "The sentence is one that there is", kPosition, kMust, some_position,
       known_sentence},
      {"sentence", "With a locked pulse there is a sentence", kPosition, kShould, some_position,
       with_pulse},
      {"sentence", "It ends with CR and LF", kPosition, kMust, a_sentence, as_nmea<1>},
      {"sentence", "It has a check", kPosition, kMust, a_sentence, as_nmea<2>},
      {"sentence", "Its check is right", kPosition, kMust, a_sentence, as_nmea<3>},
      {"sentence", "It has printable characters, and one begin", kPosition, kMust, a_sentence,
       as_nmea<4>},
      {"sentence", "It has the fields of its type", kPosition, kMust, a_sentence, as_nmea<7>},
      {"sentence", "Its time of day is hhmmss, or with a fraction", kPosition, kMust, a_sentence,
       as_nmea<11>},
      {"sentence", "Its place is degrees and minutes with their letters", kPosition, kMust,
       a_sentence, as_nmea<12>},
      {"sentence", "Its date is ddmmyy", kPosition, kMust, a_sentence, as_nmea<14>},
      {"sentence", "Its status is A or V", kPosition, kMust, a_sentence, as_nmea<15>},
      {"sentence", "Its second is that of the timestamp", kPosition, kMust, a_sentence,
       time_of_sentence},
      {"sentence", "It is a new one each second", kPosition, kShould, a_sentence, new_each_second},
  };
}

}  // namespace rigwire::conform
