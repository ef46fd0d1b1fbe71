// What the receiver says.
#include <algorithm>

#include "emulators/ublox/receiver.h"
#include "protocols/nmea/position_sentences.h"
#include "protocols/nmea/pubx_sentences.h"
#include "protocols/nmea/satellite_sentences.h"
#include "protocols/ubx/information.h"
#include "protocols/ubx/monitor.h"
#include "protocols/ubx/raw_measurements.h"
#include "protocols/ubx/timing.h"

namespace rigwire::emulators {
namespace {

namespace nmea = protocols::nmea;
namespace ubx = protocols::ubx;

constexpr std::array kQuantities{
    Quantity{"latitude", "deg", -90.0, 90.0, 1e-7},
    Quantity{"longitude", "deg", -180.0, 180.0, 1e-7},
    Quantity{"height above ellipsoid", "m", -2'147'483.0, 2'147'483.0, 1e-3},
    Quantity{"velocity north, east, down", "m/s", -2'147'483.0, 2'147'483.0, 1e-3},
    Quantity{"heading of motion", "deg", 0.0, 360.0, 1e-5},
    Quantity{"horizontal accuracy", "m", 0.0, 4'294'967.0, 1e-3},
    Quantity{"dilution", "1", 0.0, 99.99, 0.01},
    Quantity{"latitude (NMEA)", "deg", -90.0, 90.0, 1e-5 / 60.0},
    Quantity{"longitude (NMEA)", "deg", -180.0, 180.0, 1e-5 / 60.0},
    Quantity{"height above mean sea level (NMEA)", "m", -99'999.9, 99'999.9, 0.1},
};

}  // namespace

bool UbloxReceiver::speaks(std::uint16_t protocol) const {
  return (configuration_.uart().output_protocols & protocol) != 0;
}

void UbloxReceiver::publish(SimTime now, bool navigated) {
  const auto messages = profile_.messages;
  for (std::size_t i = 0; i < messages.size(); ++i) {
    const std::uint8_t rate = configuration_.message_rate(i);
    const bool due = navigated ? rate != 0 && epoch_number_ % rate == 0
                               : rate == 1 && UbloxRawMessages::handles(messages[i].id);
    if (due && !waits_for_event(messages[i].id)) {
      send_message(now, messages[i]);
    }
  }
  mark_.fresh = mark_.rose = mark_.fell = false;
}

bool UbloxReceiver::waits_for_event(ubx::MessageId id) const {
  return (id == ubx::TimTm2::kId && !mark_.fresh) || id == ubx::MonRxr::kId ||
         id == ubx::RxmRtcm::kId;
}

UbloxMonitorView UbloxReceiver::monitor_view() const {
  return {navigator_.solution(), configuration_,       transmitter_, port_, antenna_, mark_,
          kInputBytes,           settings_.noise_seed, epoch_number_};
}

std::size_t UbloxReceiver::encode(ubx::MessageId id, std::span<std::uint8_t> out) {
  const UbloxSolution& solution = navigator_.solution();
  if (profile_.encode != nullptr) {
    if (const std::size_t size = profile_.encode(solution, id, out); size > 0) {
      return size;
    }
  }
  if (const std::size_t size = encode_solution(solution, profile_, id, out); size > 0) {
    return size;
  }
  const std::size_t size = encode_monitor(monitor_view(), id, out);
  if (id == ubx::MonTxbuf::kId) {
    port_.overflow = false;
  }
  return size;
}

void UbloxReceiver::send_message(SimTime now, const UbloxMessage& message) {
  if (message.sentence) {
    send_sentence(now, message.name);
  } else if (UbloxRawMessages::handles(message.id)) {
    send_raw(now, message.id);
  } else if (speaks(ubx::kProtocolUbx)) {
    std::array<std::uint8_t, kLongestSolutionFrame> frame{};
    const std::size_t size = encode(message.id, frame);
    send(now, std::span(frame).first(size));
  }
}

void UbloxReceiver::send_raw(SimTime now, ubx::MessageId id) {
  if (!speaks(ubx::kProtocolUbx)) {
    return;
  }
  std::array<std::uint8_t, kLongestRawFrame> frame{};
  for (std::size_t i = 0; i < raw_.count(id); ++i) {
    const std::size_t size = raw_.encode(id, i, frame);
    send(now, std::span(frame).first(size));
  }
}

void UbloxReceiver::send_sentence(SimTime now, std::string_view name) {
  if (!speaks(ubx::kProtocolNmea)) {
    return;
  }
  const nmea::Epoch epoch = nmea_epoch(navigator_.solution(), configuration_, in_view_);
  if (name == "PUBX,04") {
    send(now, nmea::write_pubx_time(epoch, pubx_time(navigator_.solution())).bytes());
    return;
  }
  using Counter = int (*)(const nmea::Epoch&);
  using PageWriter = nmea::Sentence (*)(const nmea::Epoch&, int);
  struct Paged {
    std::string_view type;
    Counter pages;
    PageWriter write;
  };
  constexpr std::array<Paged, 3> kPaged{{
      {"GSA", nmea::gsa_sentences, nmea::write_gsa},
      {"GSV", nmea::gsv_pages, nmea::write_gsv},
      {"GRS", nmea::grs_sentences, nmea::write_grs},
  }};
  for (const auto& [type, pages, write] : kPaged) {
    for (int page = 1; type == name && page <= pages(epoch); ++page) {
      send(now, write(epoch, page).bytes());
    }
  }
  using Writer = nmea::Sentence (*)(const nmea::Epoch&);
  constexpr std::array<std::pair<std::string_view, Writer>, 11> kWriters{{
      {"RMC", nmea::write_rmc},
      {"VTG", nmea::write_vtg},
      {"GGA", nmea::write_gga},
      {"GLL", nmea::write_gll},
      {"ZDA", nmea::write_zda},
      {"GST", nmea::write_gst},
      {"GBS", [](const nmea::Epoch& e) { return nmea::write_gbs(e); }},
      {"DTM", nmea::write_dtm},
      {"GNS", nmea::write_gns},
      {"PUBX,00", nmea::write_pubx_position},
      {"PUBX,03", nmea::write_pubx_satellites},
  }};
  for (const auto& [type, write] : kWriters) {
    if (type == name) {
      send(now, write(epoch).bytes());
    }
  }
}

void UbloxReceiver::send_text(SimTime now, nmea::TextKind kind, std::string_view text) {
  constexpr std::uint8_t kUbx = 0;
  constexpr std::uint8_t kNmea = 1;
  const auto bit = static_cast<unsigned>(kind);
  if (speaks(ubx::kProtocolUbx) && configuration_.text_enabled(kUbx, bit)) {
    std::array<std::uint8_t, ubx::kOverheadBytes + 128> frame{};
    const ubx::Information information{static_cast<ubx::InformationKind>(kind), text};
    send(now, std::span(frame).first(ubx::encode_information(information, frame)));
  }
  if (speaks(ubx::kProtocolNmea) && configuration_.text_enabled(kNmea, bit)) {
    send(now, nmea::write_txt(nmea_epoch(navigator_.solution(), configuration_, in_view_).talker,
                              kind, text)
                  .bytes());
  }
}

void UbloxReceiver::send(SimTime now, std::span<const std::uint8_t> message) {
  if (!message.empty() && !transmitter_.enqueue(now, message)) {
    overflow_to_report_ = true;
    port_.overflow = true;
  }
}

std::span<const Quantity> UbloxReceiver::quantities() const {
  return kQuantities;
}

double UbloxReceiver::nominal_rate_hz() const {
  if (plan_.first == kNever) {
    return 0.0;
  }
  double per_epoch = 0.0;
  const auto messages = profile_.messages;
  for (std::size_t i = 0; i < messages.size(); ++i) {
    const bool spoken = speaks(messages[i].sentence ? ubx::kProtocolNmea : ubx::kProtocolUbx);
    if (const std::uint8_t rate = configuration_.message_rate(i); rate > 0 && spoken) {
      per_epoch += sentences_per_epoch(messages[i]) / rate;
    }
  }
  return per_epoch / (to_seconds(plan_.period) * configuration_.rate().navigation_ratio);
}

double UbloxReceiver::sentences_per_epoch(const UbloxMessage& message) const {
  if (message.greatest_bytes == 0 || waits_for_event(message.id) ||
      (message.id == ubx::TimTm2::kId)) {
    return 0.0;
  }
  if (message.name == "GSA" || message.name == "GSV" || message.name == "GRS") {
    std::vector<nmea::SatelliteInView> list;
    const nmea::Epoch epoch = nmea_epoch(navigator_.solution(), configuration_, list);
    return message.name == "GSA"   ? nmea::gsa_sentences(epoch)
           : message.name == "GSV" ? nmea::gsv_pages(epoch)
                                   : nmea::grs_sentences(epoch);
  }
  if (!UbloxRawMessages::handles(message.id)) {
    return 1.0;
  }
  const double measurements = configuration_.rate().navigation_ratio;
  if (message.id == ubx::RxmRawHead::kId || message.id == ubx::RxmRawxHead::kId ||
      message.id == ubx::RxmSvsiHead::kId) {
    return measurements;
  }
  if (message.id != ubx::RxmSfrb::kId && message.id != ubx::RxmSfrbxHead::kId) {
    return 0.0;  // orbits, when they are new
  }
  constexpr double kSubframe_s = 6.0;
  constexpr double kSbasMessage_s = 1.0;
  double per_s = 0.0;
  for (const SatelliteView& view : navigator_.solution().satellites) {
    const bool gps = view.system == GnssSystem::gps;
    const bool sbas = view.system == GnssSystem::sbas;
    per_s += !view.tracked ? 0.0 : gps ? 1.0 / kSubframe_s : sbas ? 1.0 / kSbasMessage_s : 0.0;
  }
  return per_s * to_seconds(plan_.period) * measurements;
}

UbloxCounters UbloxReceiver::counters() const {
  UbloxCounters counters = counters_;
  counters.messages_sent = transmitter_.messages_sent();
  counters.messages_lost = transmitter_.messages_lost();
  return counters;
}

}  // namespace rigwire::emulators
