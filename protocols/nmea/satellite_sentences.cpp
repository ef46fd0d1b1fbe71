#include "protocols/nmea/satellite_sentences.h"

#include <algorithm>
#include <array>

#include "protocols/nmea/fields.h"
#include "protocols/nmea/satellite_numbers.h"

namespace rigwire::protocols::nmea {
namespace {

constexpr int kSatellitesPerPage = 4;
constexpr int kMostPages = 5;
constexpr int kMostPagesFrom40 = 9;
constexpr int kUsedSlots = 12;
constexpr int kSignals = 16;

/// Satellites that share a talker and, from 4.10 on, a signal.
struct Set {
  std::optional<System> group;  ///< Empty: all satellites, with the main talker.
  std::optional<int> signal;    ///< Empty: whatever the signal.
};

bool belongs(const Epoch& epoch, const SatelliteInView& satellite, const Set& set) {
  return (!set.group || satellite_group(satellite.system, epoch.version) == *set.group) &&
         (!set.signal || satellite.signal == *set.signal);
}

bool group_is_on(const Epoch& epoch, System group) {
  for (const System system : {System::gps, System::sbas, System::galileo, System::beidou,
                              System::qzss, System::glonass}) {
    if ((epoch.systems & system_bit(system)) != 0 &&
        satellite_group(system, epoch.version) == group) {
      return true;
    }
  }
  return false;
}

/// Group of the n-th GSA, n from 1; empty when there is but one for all.
std::optional<System> nth_group(const Epoch& epoch, int n) {
  for (const System group : kSatelliteGroups) {
    if (group_is_on(epoch, group) && --n == 0) {
      return group;
    }
  }
  return std::nullopt;
}

/// Version 4.10: system of the group, or of the satellites when there is but one for all.
int identifier(const Epoch& epoch, const std::optional<System>& group) {
  if (group) {
    return system_identifier(*group);
  }
  return epoch.talker == "GL" ? 2 : epoch.talker == "GA" ? 3 : epoch.talker == "GB" ? 4 : 1;
}

int satellites_in(const Epoch& epoch, const Set& set) {
  int count = 0;
  for (const auto& satellite : epoch.satellites) {
    count += belongs(epoch, satellite, set) ? 1 : 0;
  }
  const int pages = epoch.version >= Version::v40 ? kMostPagesFrom40 : kMostPages;
  const int limit = epoch.maximum_satellites > 0 ? epoch.maximum_satellites : count;
  return std::min({count, limit, pages * kSatellitesPerPage});
}

int pages_of(const Epoch& epoch, const Set& set) {
  return std::max(1, (satellites_in(epoch, set) + kSatellitesPerPage - 1) / kSatellitesPerPage);
}

/// Calls visit(set) for each set that is printed, in order, until it returns true.
template <class Visit>
bool visit_group(const Epoch& epoch, const std::optional<System>& group, Visit&& visit) {
  if (!has_identifiers(epoch)) {
    return visit(Set{group, std::nullopt});
  }
  bool any = false;
  for (int i = 1; i <= kSignals; ++i) {  // the unknown signal, 0, last
    const Set set{group, i % kSignals};
    if (satellites_in(epoch, set) > 0) {
      any = true;
      if (visit(set)) {
        return true;
      }
    }
  }
  return !any && visit(Set{group, 0});
}

template <class Visit>
void visit_sets(const Epoch& epoch, Visit&& visit) {
  if (epoch.systems == 0) {
    visit_group(epoch, std::nullopt, visit);
    return;
  }
  for (const System group : kSatelliteGroups) {
    if (group_is_on(epoch, group) && visit_group(epoch, group, visit)) {
      return;
    }
  }
}

std::string_view gsv_talker(const Epoch& epoch, const Set& set) {
  if (!set.group || epoch.gsv_main_talker) {
    return epoch.talker;
  }
  return *set.group == System::beidou ? epoch.beidou_talker : group_talker(*set.group);
}

void put_number(Sentence& sentence, int number) {
  number > 0 ? sentence.number("%02d", number) : sentence.empty();
}

void put_optional(Sentence& sentence, const char* format, const std::optional<int>& value) {
  value ? sentence.number(format, *value) : sentence.empty();
}

Sentence gsv_page(const Epoch& epoch, const Set& set, int page) {
  Sentence sentence = begin_sentence(gsv_talker(epoch, set), "GSV");
  const int listed = satellites_in(epoch, set);
  sentence.number("%d", pages_of(epoch, set)).number("%d", page).number("%02d", listed);
  const int first = (page - 1) * kSatellitesPerPage;
  const int last = std::min(first + kSatellitesPerPage, listed);
  int at = 0;
  for (const auto& satellite : epoch.satellites) {
    if (!belongs(epoch, satellite, set)) {
      continue;
    }
    if (at >= first && at < last) {
      put_number(sentence, satellite.number);
      put_optional(sentence, "%02d", satellite.elevation_deg);
      put_optional(sentence, "%03d", satellite.azimuth_deg);
      put_optional(sentence, "%02d", satellite.cn0_dbhz);
    }
    ++at;
  }
  if (has_identifiers(epoch)) {
    sentence.number("%X", set.signal.value_or(0));
  }
  return sentence;
}

/// Calls put(satellite) for the used satellites of a group, 12 at most, and fills up with empty
/// fields. A satellite with several signals counts once.
template <class Put>
void put_used(Sentence& sentence, const Epoch& epoch, const std::optional<System>& group,
              Put&& put) {
  int slots = 0;
  const SatelliteInView* before = nullptr;
  for (const auto& satellite : epoch.satellites) {
    const bool again = before != nullptr && before->system == satellite.system &&
                       before->number == satellite.number;
    if (satellite.used && !again && slots < kUsedSlots &&
        belongs(epoch, satellite, {group, std::nullopt})) {
      put(satellite);
      ++slots;
      before = &satellite;
    }
  }
  for (; slots < kUsedSlots; ++slots) {
    sentence.empty();
  }
}

}  // namespace

int gsa_sentences(const Epoch& epoch) {
  int count = 0;
  for (const System group : kSatelliteGroups) {
    count += group_is_on(epoch, group) ? 1 : 0;
  }
  return std::max(1, count);
}

Sentence write_gsa(const Epoch& epoch, int n) {
  Sentence sentence = begin_sentence(epoch.talker, "GSA");
  const auto group = nth_group(epoch, n);
  sentence.field("A");
  sentence.number("%d", has_fix(epoch) ? epoch.fix_dimensions : 1);
  put_used(sentence, epoch, group, [&](const auto& s) { put_number(sentence, s.number); });
  put_dilution(sentence, epoch.position_dilution);
  put_dilution(sentence, epoch.horizontal_dilution);
  put_dilution(sentence, epoch.vertical_dilution);
  if (has_identifiers(epoch)) {
    sentence.number("%X", identifier(epoch, group));
  }
  return sentence;
}

Sentence write_gsa(const Epoch& epoch) {
  return write_gsa(epoch, 1);
}

int grs_sentences(const Epoch& epoch) {
  return gsa_sentences(epoch);
}

Sentence write_grs(const Epoch& epoch, int n) {
  Sentence sentence = begin_sentence(epoch.talker, "GRS");
  const auto group = nth_group(epoch, n);
  put_time(sentence, epoch.time);
  sentence.field("1");
  put_used(sentence, epoch, group, [&](const auto& s) {
    s.residual_m ? sentence.number("%.1f", *s.residual_m) : sentence.empty();
  });
  if (has_identifiers(epoch)) {
    sentence.number("%X", identifier(epoch, group));
    sentence.number("%X", static_cast<int>(first_signal(group.value_or(System::gps))));
  }
  return sentence;
}

int gsv_pages(const Epoch& epoch) {
  int pages = 0;
  visit_sets(epoch, [&](const Set& set) {
    pages += pages_of(epoch, set);
    return false;
  });
  return pages;
}

Sentence write_gsv(const Epoch& epoch, int page) {
  std::optional<Sentence> found;
  visit_sets(epoch, [&](const Set& set) {
    const int pages = pages_of(epoch, set);
    if (page > pages) {
      page -= pages;
      return false;
    }
    found = gsv_page(epoch, set, page);
    return true;
  });
  return found.value_or(gsv_page(epoch, {}, page));
}

Sentence write_gst(const Epoch& epoch) {
  Sentence sentence = begin_sentence(epoch.talker, "GST");
  put_time(sentence, epoch.time);
  if (!epoch.errors) {
    for (int i = 0; i < 7; ++i) {
      sentence.empty();
    }
    return sentence;
  }
  put_deviation(sentence, epoch.errors->range_m);
  if (const auto& ellipse = epoch.errors->ellipse) {
    put_deviation(sentence, ellipse->major_m);
    put_deviation(sentence, ellipse->minor_m);
    sentence.number("%.0f", ellipse->orientation_deg);
  } else {
    sentence.empty().empty().empty();
  }
  put_deviation(sentence, epoch.errors->latitude_m);
  put_deviation(sentence, epoch.errors->longitude_m);
  put_deviation(sentence, epoch.errors->altitude_m);
  return sentence;
}

Sentence write_gbs(const Epoch& epoch, const std::optional<FaultySatellite>& fault) {
  Sentence sentence = begin_sentence(epoch.talker, "GBS");
  put_time(sentence, epoch.time);
  if (epoch.errors && has_fix(epoch)) {
    sentence.number("%.1f", epoch.errors->latitude_m).number("%.1f", epoch.errors->longitude_m);
    sentence.number("%.1f", epoch.errors->altitude_m);
  } else {
    sentence.empty().empty().empty();
  }
  if (fault) {
    put_number(sentence, fault->number);
    sentence.empty().number("%.1f", fault->bias_m).number("%.1f", fault->deviation_m);
  } else {
    sentence.empty().empty().empty().empty();
  }
  if (has_identifiers(epoch)) {
    if (fault) {
      const System group = satellite_group(fault->system, epoch.version);
      sentence.number("%X", system_identifier(group));
      sentence.number("%X", static_cast<int>(fault->signal));
    } else {
      sentence.empty().empty();
    }
  }
  return sentence;
}

}  // namespace rigwire::protocols::nmea
