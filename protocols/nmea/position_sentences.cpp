#include "protocols/nmea/position_sentences.h"

#include <algorithm>
#include <array>

#include "protocols/nmea/fields.h"

namespace rigwire::protocols::nmea {
namespace {

constexpr int kMostUsedInGga = 12;
constexpr int kMostUsedInGns = 99;

std::string_view status(const Epoch& epoch) {
  return has_fix(epoch) ? "A" : "V";
}

/// RMC alone tells carrier solutions apart.
void put_mode(Sentence& sentence, const Epoch& epoch, bool with_carrier) {
  if (epoch.version != Version::v21) {
    sentence.field(position_mode(epoch, with_carrier));
  }
}

/// "Equipment is not providing navigational status information".
void put_navigational_status(Sentence& sentence, const Epoch& epoch) {
  if (has_identifiers(epoch)) {
    sentence.field("V");
  }
}

void put_optional_course(Sentence& sentence, const Epoch& epoch) {
  if (epoch.course_deg) {
    put_course(sentence, *epoch.course_deg);
  } else {
    sentence.empty();
  }
}

}  // namespace

Sentence write_rmc(const Epoch& epoch) {
  Sentence sentence = begin_sentence(epoch.talker, "RMC");
  put_time(sentence, epoch.time);
  sentence.field(status(epoch));
  put_position(sentence, epoch);
  if (has_fix(epoch)) {
    sentence.number("%.3f", epoch.ground_speed_mps * kKnotsPerMps);
    put_optional_course(sentence, epoch);
  } else {
    sentence.empty().empty();
  }
  put_date(sentence, epoch.date);
  sentence.empty().empty();
  put_mode(sentence, epoch, true);
  put_navigational_status(sentence, epoch);
  return sentence;
}

Sentence write_vtg(const Epoch& epoch) {
  Sentence sentence = begin_sentence(epoch.talker, "VTG");
  if (has_fix(epoch)) {
    const double knots = epoch.ground_speed_mps * kKnotsPerMps;
    put_optional_course(sentence, epoch);
    sentence.field("T").empty().field("M");
    sentence.number("%.3f", knots).field("N");
    sentence.number("%.3f", knots * kKilometresPerHourPerKnot).field("K");
  } else {
    for (int i = 0; i < 8; ++i) {
      sentence.empty();
    }
  }
  put_mode(sentence, epoch, false);
  return sentence;
}

Sentence write_gga(const Epoch& epoch) {
  Sentence sentence = begin_sentence(epoch.talker, "GGA");
  put_time(sentence, epoch.time);
  put_position(sentence, epoch);
  sentence.number("%d", quality(epoch));
  sentence.number("%02d", std::min(epoch.satellites_used, kMostUsedInGga));
  put_dilution(sentence, epoch.horizontal_dilution);
  if (has_fix(epoch)) {
    put_altitude(sentence, epoch);
    sentence.field("M").number("%.1f", epoch.separation_m).field("M");
  } else {
    sentence.empty().empty().empty().empty();
  }
  put_corrections(sentence, epoch);
  return sentence;
}

Sentence write_gns(const Epoch& epoch) {
  Sentence sentence = begin_sentence(epoch.talker, "GNS");
  put_time(sentence, epoch.time);
  put_position(sentence, epoch);
  std::array<char, 4> modes{};
  const std::size_t told = has_identifiers(epoch) ? 4 : 2;
  constexpr std::array kOrder{System::gps, System::glonass, System::galileo, System::beidou};
  const unsigned systems = epoch.systems != 0     ? epoch.systems
                           : epoch.talker == "GL" ? system_bit(System::glonass)
                                                  : system_bit(System::gps);
  for (std::size_t i = 0; i < told; ++i) {
    const bool on = (systems & system_bit(kOrder[i])) != 0;
    modes[i] = on ? position_mode(epoch, true)[0] : 'N';
  }
  sentence.field({modes.data(), told});
  sentence.number("%02d", std::min(epoch.satellites_used, kMostUsedInGns));
  put_dilution(sentence, epoch.horizontal_dilution);
  if (has_fix(epoch)) {
    put_altitude(sentence, epoch);
    sentence.number("%.1f", epoch.separation_m);
  } else {
    sentence.empty().empty();
  }
  put_corrections(sentence, epoch);
  put_navigational_status(sentence, epoch);
  return sentence;
}

Sentence write_gll(const Epoch& epoch) {
  Sentence sentence = begin_sentence(epoch.talker, "GLL");
  put_position(sentence, epoch);
  put_time(sentence, epoch.time);
  sentence.field(status(epoch));
  put_mode(sentence, epoch, false);
  return sentence;
}

Sentence write_zda(const Epoch& epoch) {
  Sentence sentence = begin_sentence(epoch.talker, "ZDA");
  put_time(sentence, epoch.time);
  if (epoch.date) {
    sentence.number("%02d", epoch.date->day).number("%02d", epoch.date->month);
    sentence.number("%04d", epoch.date->year);
  } else {
    sentence.empty().empty().empty();
  }
  sentence.field("00").field("00");
  return sentence;
}

Sentence write_dtm(const Epoch& epoch) {
  Sentence sentence = begin_sentence(epoch.talker, "DTM");
  sentence.field("W84").empty();
  sentence.field("0.0").field("N").field("0.0").field("E").field("0.0").field("W84");
  return sentence;
}

Sentence write_txt(std::string_view talker, TextKind kind, std::string_view text) {
  Sentence sentence = begin_sentence(talker, "TXT");
  sentence.field("01").field("01").number("%02d", static_cast<int>(kind)).field(text);
  return sentence;
}

}  // namespace rigwire::protocols::nmea
