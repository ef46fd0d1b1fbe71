#include "emulators/ublox/receiver.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <optional>

#include "emulators/ublox/geodesy.h"
#include "emulators/ublox/navigation_messages.h"
#include "emulators/ublox/nmea_epoch.h"
#include "fields/constants.h"
#include "protocols/nmea/writers.h"
#include "protocols/ubx/aiding.h"
#include "protocols/ubx/identity.h"
#include "protocols/ubx/information.h"
#include "protocols/ubx/layout.h"
#include "protocols/ubx/monitor.h"
#include "protocols/ubx/navigation.h"
#include "protocols/ubx/raw_measurements.h"
#include "protocols/ubx/timing.h"
#include "protocols/ubx/version.h"

namespace rigwire::emulators {

namespace nmea = protocols::nmea;
namespace ubx = protocols::ubx;
using namespace std::chrono_literals;

namespace {

/// Broadcast orbits are good for so long: IS-GPS-200, section 20.3.4.4.
constexpr Duration kOrbitLife = 4h;

const UbloxSettings& validated(const UbloxSettings& settings) {
  validate(settings);
  return settings;
}

std::vector<std::uint8_t> version_of(const UbloxProfile& profile) {
  return ubx::version_payload({std::string(profile.software),
                               std::string(profile.hardware),
                               {profile.extensions.begin(), profile.extensions.end()}});
}

constexpr std::uint8_t kClassConfiguration = 0x06;

std::optional<std::uint32_t> to_unsigned(std::string_view text, int base) {
  std::uint32_t value = 0;
  const char* const end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value, base);
  return text.empty() || error != std::errc{} || stop != end ? std::nullopt : std::optional(value);
}

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

int one_page(const nmea::Epoch& /*epoch*/) {
  return 1;
}
template <nmea::Sentence (*kWrite)(const nmea::Epoch&)>
nmea::Sentence only_page(const nmea::Epoch& epoch, int /*page*/) {
  return kWrite(epoch);
}

/// How a sentence is written that comes in one or more pages, numbered from 1.
struct SentenceForm {
  std::string_view name;
  int (*pages)(const nmea::Epoch& epoch);
  nmea::Sentence (*write)(const nmea::Epoch& epoch, int page);
};
constexpr std::array<SentenceForm, 14> kSentenceForms{{
    {"RMC", one_page, only_page<nmea::write_rmc>},
    {"VTG", one_page, only_page<nmea::write_vtg>},
    {"GGA", one_page, only_page<nmea::write_gga>},
    {"GSA", nmea::gsa_sentences, nmea::write_gsa},
    {"GSV", nmea::gsv_pages, nmea::write_gsv},
    {"GLL", one_page, only_page<nmea::write_gll>},
    {"GST", one_page, only_page<nmea::write_gst>},
    {"ZDA", one_page, only_page<nmea::write_zda>},
    {"GBS", one_page, only_page<nmea::write_gbs>},
    {"GRS", nmea::grs_sentences, nmea::write_grs},
    {"DTM", one_page, only_page<nmea::write_dtm>},
    {"GNS", one_page, only_page<nmea::write_gns>},
    {"PUBX,00", one_page, only_page<nmea::write_pubx_position>},
    {"PUBX,03", one_page, only_page<nmea::write_pubx_satellites>},
}};
const SentenceForm* form_of(std::string_view name) {
  const auto* const found = std::ranges::find(kSentenceForms, name, &SentenceForm::name);
  return found == kSentenceForms.end() ? nullptr : found;
}

}  // namespace

ByteOutput& UbloxReceiver::nowhere() {
  static NullByteOutput output;
  return output;
}

UbloxReceiver::UbloxReceiver(const UbloxSettings& settings, const Calendar& calendar,
                             ByteOutput& output, ByteOutput& second)
    : settings_(validated(settings)),
      faults_(settings_.faults),
      profile_(*settings_.profile),
      calendar_(calendar),
      configuration_(settings_),
      quality_(output, settings_.noise_seed),
      transmitter_(quality_, settings_.transmit_buffer_bytes, settings_.baud),
      navigator_(settings_, calendar),
      raw_(calendar, profile_.generation),
      second_(second, settings_.transmit_buffer_bytes, configuration_.second_uart().baud),
      corrections_(calendar),
      version_(version_of(profile_)),
      supply_({.power_on = Duration{0}, .faults = settings_.supply_faults}) {
  if (supply_.next_change() <= kStart) {
    switch_supply(kStart);
  }
}

void UbloxReceiver::start(SimTime now, const UbloxMemory& memory) {
  running_ = false;
  navigating_ = true;
  ready_ = now + settings_.start_up;
  input_size_ = 0;
  in_garbage_ = false;
  overflow_to_report_ = false;
  port_ = {};
  antenna_ = supervise(AntennaState::ok, configuration_.present().antenna);
  mark_ = {};
  transmitter_.clear();
  second_.restart();
  set_baud(configuration_.uart().baud);
  navigator_.power_on(now);
  begin_navigation(now, memory);
  plan_from(ready_);
}

void UbloxReceiver::begin_navigation(SimTime now, const UbloxMemory& memory) {
  pending_count_ = 0;
  navigator_.begin(now, memory, configuration_);
  corrections_.forget();
  base_.restart();
  refresh_command();
  raw_.begin(memory.ephemerides, memory.almanac);
}

void UbloxReceiver::refresh_command() {
  command_ = navigator_.command(configuration_);
  if (profile_.carrier_solution) {
    command_.corrections = corrections_.newest();
  }
}

void UbloxReceiver::switch_supply(SimTime now) {
  supply_.change();
  if (!supply_.on()) {
    off_since_ = now;
    running_ = false;
    pending_count_ = 0;
    plan_ = {};
    transmitter_.clear();
    second_.restart();
    return;
  }
  UbloxMemory memory;
  if (!off_since_) {
    memory = settings_.time_to_first_fix == 0s ? UbloxMemory::everything() : UbloxMemory{};
  } else if (settings_.backup_battery) {
    memory = UbloxMemory::everything();
    memory.ephemerides = now - *off_since_ < kOrbitLife;
  } else {
    configuration_.forget();
  }
  configuration_.reload();
  start(now, memory);
}

void UbloxReceiver::set_client(SimTime now, const SerialClient& client) {
  advance(now);
  quality_.set_client_baud(client.present ? client.baud : 0);
}

void UbloxReceiver::set_baud(std::uint32_t baud) {
  if (const std::uint32_t second = configuration_.second_uart().baud; second > 0) {
    second_.line().set_baud(second);
  }
  transmitter_.set_baud(baud);
  quality_.set_device_baud(baud);
}

void UbloxReceiver::plan_from(SimTime now) {
  if (!navigating_ || !supply_.on()) {
    plan_ = {};
    return;
  }
  const Duration period = std::chrono::milliseconds{configuration_.rate().measurement_period_ms};
  constexpr std::uint16_t kUtc = 0;
  const Duration behind = configuration_.rate().time_reference == kUtc
                              ? std::chrono::seconds{calendar_.leap_seconds(now)}
                              : 0s;
  plan_ = {calendar_.align_to_gps(now - behind, period) + behind, period};
}

SimTime UbloxReceiver::next_event() const {
  return std::min(supply_.next_change(), next_work());
}

SimTime UbloxReceiver::next_work() const {
  if (!supply_.on()) {
    return kNever;
  }
  SimTime next = std::min(transmitter_.next_event(), second_.line().next_event());
  if (!running_) {
    next = std::min(next, ready_);
  }
  if (pending_count_ > 0) {
    next = std::min(next, pending_[pending_head_].time + settings_.solution_latency);
  }
  return next;
}

void UbloxReceiver::advance(SimTime now) {
  while (supply_.next_change() <= now) {
    const SimTime instant = supply_.next_change();
    live_until(instant);
    switch_supply(instant);
  }
  live_until(now);
}

void UbloxReceiver::live_until(SimTime now) {
  for (SimTime event = next_work(); event <= now; event = next_work()) {
    follow_line_noise(event);
    transmitter_.advance(event);
    second_.line().advance(event);
    if (overflow_to_report_ && transmitter_.room() * 2 >= transmitter_.capacity()) {
      overflow_to_report_ = false;
      send_text(event, nmea::TextKind::error, "txbuf alloc");
    }
    if (!running_ && ready_ <= event) {
      running_ = true;
      greet(event);
    }
    if (pending_count_ > 0 && pending_[pending_head_].time + settings_.solution_latency <= event) {
      solve(event);
    }
  }
}

void UbloxReceiver::update(const GnssSample& sample) {
  // What is measured at the very instant at which the supply goes is lost after it was taken.
  advance(sample.time - Duration{1});
  supply_.on() ? live_until(sample.time) : advance(sample.time);
  if (!running_ || !navigating_ || pending_count_ == kPending) {
    ++counters_.samples_refused;
    return;
  }
  pending_[(pending_head_ + pending_count_) % kPending] = sample;
  ++pending_count_;
  advance(sample.time);
}

void UbloxReceiver::greet(SimTime now) {
  if (settings_.start_banner) {
    for (const auto line : profile_.banner) {
      send_text(now, nmea::TextKind::notice, line);
    }
  }
  const std::size_t awake = message_index(profile_, ubx::MonRxr::kId);
  if (awake < profile_.messages.size() && configuration_.message_rate(awake) > 0) {
    send_message(now, profile_.messages[awake]);
  }
}

void UbloxReceiver::follow_line_noise(SimTime now) {
  const auto noise = faults_.first_grown<UartNoiseFault>(now);
  quality_.set_bit_error_rate(noise ? noise->bit_error_rate : 0.0);
}

// Processes the oldest pending measurement. It is a navigation epoch if its number within the week
// is a multiple of CFG-RATE's navRate; raw measurements are updated every time.
void UbloxReceiver::solve(SimTime now) {
  std::swap(latest_, pending_[pending_head_]);
  pending_head_ = (pending_head_ + 1) % kPending;
  --pending_count_;
  if (!has_time_for(latest_.time)) {
    return;
  }
  UbloxNavigationFaults faults;
  faults.frozen = faults_.first<FrozenFixFault>(latest_.time) != nullptr;
  if (const auto* leap = faults_.first<WrongLeapSecondFault>(latest_.time)) {
    faults.leap_error_s = leap->seconds;
  }
  const ubx::CfgRate& rate = configuration_.rate();
  const std::int64_t measurement = (calendar_.gps(latest_.time).time_of_week_ns + kMillisecond_ns) /
                                   (std::int64_t{rate.measurement_period_ms} * kMillisecond_ns);
  const bool navigates = measurement % rate.navigation_ratio == 0;
  if (navigates) {
    navigator_.take(latest_, configuration_, faults);
    navigator_.set_base(corrections_.base());
    base_.update(latest_.time, base_mode(configuration_.present()), navigator_.solution());
    if (base_.seems_wrong(navigator_.solution())) {
      send_text(now, nmea::TextKind::warning, "Base station position seems incorrect");
    }
    navigator_.set_own_place(base_.survey(), base_.place_E_m());
  }
  const UbloxSolution& s = navigator_.solution();
  raw_.update(latest_, {s.time_known, s.date_known, s.leap_known, s.leap_seconds, s.week_shift,
                        s.since_start_ms});
  watch_antenna(now);
  publish(now, navigates);
  if (navigates) {
    publish_corrections(now);
    ++counters_.epochs;
    ++epoch_number_;
  }
}

bool UbloxReceiver::has_time_for(SimTime epoch) {
  constexpr double kRounding = 1e-9;
  const auto slow = faults_.first_grown<SlowFixFault>(epoch);
  if (!slow) {
    epochs_owed_ = 0.0;
    return true;
  }
  epochs_owed_ += slow->share;
  if (epochs_owed_ < 1.0 - kRounding) {
    return false;
  }
  epochs_owed_ -= 1.0;
  return true;
}

void UbloxReceiver::watch_antenna(SimTime now) {
  const UbloxAntenna seen = supervise(latest_.radio.antenna, configuration_.present().antenna);
  if (seen.status != antenna_.status) {
    send_text(now, nmea::TextKind::notice, seen.text);
  }
  antenna_ = seen;
}

void UbloxReceiver::external_interrupt(SimTime now, bool rising) {
  advance(now);
  if (!running_) {
    return;
  }
  mark_.rose |= rising;
  mark_.fell |= !rising;
  mark_.fresh = true;
  (rising ? mark_.rising : mark_.falling) = calendar_.gps(now);
  mark_.count = static_cast<std::uint16_t>(mark_.count + (rising ? 1 : 0));
}

// What clients say in UBX.

void UbloxReceiver::receive(SimTime now, std::span<const std::uint8_t> bytes) {
  advance(now);
  received_.bytes += bytes.size();
  if (!running_) {
    return;
  }
  port_.bytes += static_cast<std::uint32_t>(bytes.size());
  if (!quality_.matched()) {
    port_.framing_errors = static_cast<std::uint16_t>(port_.framing_errors + bytes.size());
    ++received_.malformed;
    return;
  }
  follow_line_noise(now);
  if (!quality_.noisy()) {
    take_in(now, bytes);
  }
  std::array<std::uint8_t, 256> disturbed{};
  while (quality_.noisy() && !bytes.empty()) {
    const std::size_t taken = std::min(bytes.size(), disturbed.size());
    std::ranges::copy(bytes.first(taken), disturbed.begin());
    const auto piece = std::span(disturbed).first(taken);
    quality_.disturb(piece);
    take_in(now, piece);
    bytes = bytes.subspan(taken);
  }
  advance(now);
}

void UbloxReceiver::receive_second(SimTime now, std::span<const std::uint8_t> bytes,
                                   std::uint32_t baud) {
  advance(now);
  if (!running_ || !profile_.carrier_solution) {
    return;
  }
  if (baud != second_baud()) {
    second_.take_garbage(bytes.size());
    return;
  }
  const bool takes = (configuration_.second_uart().input_protocols & ubx::kProtocolRtcm3) != 0;
  second_.take_in(bytes, [&](const protocols::rtcm3::FrameView& frame) {
    if (takes) {
      handle(now, frame, second_.port());
    }
  });
}

void UbloxReceiver::take_in(SimTime now, std::span<const std::uint8_t> bytes) {
  while (!bytes.empty() && running_) {
    const std::size_t taken = std::min(bytes.size(), kInputBytes - input_size_);
    std::ranges::copy(bytes.first(taken),
                      input_.begin() + static_cast<std::ptrdiff_t>(input_size_));
    input_size_ += taken;
    port_.peak_bytes = std::max(port_.peak_bytes, input_size_);
    bytes = bytes.subspan(taken);
    parse(now);
  }
}

void UbloxReceiver::parse(SimTime now) {
  std::size_t at = 0;
  const auto garbage = [&]() {
    received_.malformed += in_garbage_ ? 0 : 1;
    in_garbage_ = true;
    ++port_.skipped;
    ++at;
  };
  while (at < input_size_) {
    const auto rest = std::span<const std::uint8_t>(input_).subspan(at, input_size_ - at);
    if (rest[0] == ubx::kSync1) {
      const auto frame = ubx::decode_frame(rest, kMaximumPayload);
      if (frame.incomplete()) {
        break;
      }
      if (frame.ok()) {
        in_garbage_ = false;
        at += frame.consumed();
        handle(now, *frame);
        if (!running_) {  // reset: the rest of the line is lost
          input_size_ = 0;
          return;
        }
        continue;
      }
    } else if (rest[0] == '$') {
      const auto sentence = nmea::decode_sentence(rest);
      if (sentence.incomplete()) {
        break;
      }
      if (sentence.ok()) {
        in_garbage_ = false;
        at += sentence.consumed();
        handle(now, *sentence);
        continue;
      }
    } else if (rest[0] == protocols::rtcm3::kPreamble &&
               (configuration_.uart().input_protocols & ubx::kProtocolRtcm3) != 0) {
      const auto frame = protocols::rtcm3::decode_frame(rest);
      if (frame.incomplete()) {
        break;
      }
      if (frame.ok()) {
        in_garbage_ = false;
        at += frame.consumed();
        handle(now, *frame, port_);
        continue;
      }
      if (frame.fault().offset >= protocols::rtcm3::kHeaderBytes) {
        // Complete, with a wrong checksum: RXM-RTCM reports its type, and its bytes are garbage.
        constexpr std::uint8_t kChecksumFailed = 1;
        tell_received(now, {rest.subspan(protocols::rtcm3::kHeaderBytes)}, kChecksumFailed);
      }
    } else if (rest[0] == '\r' || rest[0] == '\n') {
      ++at;
      continue;
    }
    garbage();
  }
  std::copy(input_.begin() + static_cast<std::ptrdiff_t>(at),
            input_.begin() + static_cast<std::ptrdiff_t>(input_size_), input_.begin());
  input_size_ -= at;
}

void UbloxReceiver::handle(SimTime now, const ubx::FrameView& frame) {
  if ((configuration_.uart().input_protocols & ubx::kProtocolUbx) == 0) {
    ++received_.ignored;
    return;
  }
  ++port_.messages[0];
  last_request_.note(now, std::array{frame.id.message_class, frame.id.message_id});
  if (frame.id.message_class == kClassConfiguration) {
    handle_configuration(now, frame);
    return;
  }
  if (handle_command(now, frame) || handle_aiding(now, frame) || answer_poll(now, frame)) {
    ++received_.accepted;
  } else {
    // Acknowledgements exist for configuration only (R28, 32.5.1). A ZED-F9P stays silent, too: in
    // u-center's log it leaves polls of 0A 05 and 0C 35 without any answer.
    ++received_.ignored;
  }
}

/// Commands of other classes that are acknowledged.
bool UbloxReceiver::handle_command(SimTime now, const ubx::FrameView& frame) {
  if (profile_.odometer && frame.id == ubx::kNavResetodo && frame.payload.empty()) {
    navigator_.reset_odometer();
    answer(now, frame.id, true);
    return true;
  }
  constexpr std::array kOfLogger{ubx::kLogErase, ubx::kLogCreate, ubx::kLogRetrieve};
  if (profile_.logger && std::ranges::find(kOfLogger, frame.id) != kOfLogger.end()) {
    answer(now, frame.id, false);  // no data logger is emulated
    return true;
  }
  return false;
}

void UbloxReceiver::handle(SimTime now, const protocols::rtcm3::FrameView& frame,
                           UbloxPortStatistics& port) {
  constexpr std::size_t kProtocol = 5;
  constexpr std::uint8_t kNotUsed = 1 << 1;
  constexpr std::uint8_t kUsed = 2 << 1;
  constexpr std::uint8_t kFloating = 2;
  ++port.messages[kProtocol];
  const UbloxConfigurationState& present = configuration_.present();
  const UbloxCorrectionRules rules{
      .filter = static_cast<UbloxCorrectionRules::Filter>(present.station_filter),
      .station = present.station_in,
      .largest_age = std::chrono::seconds{configuration_.navigation().differential_timeout_s},
      .floating_only = present.carrier_mode == kFloating};
  const bool used = profile_.carrier_solution && settings_.uses_corrections &&
                    corrections_.take(now, frame, rules);
  ++(used ? received_.accepted : received_.ignored);
  if (corrections_.newest() != command_.corrections) {
    refresh_command();
  }
  tell_received(now, frame, used ? kUsed : kNotUsed);
}

void UbloxReceiver::tell_received(SimTime now, const protocols::rtcm3::FrameView& frame,
                                  std::uint8_t flags) {
  const std::size_t index = message_index(profile_, ubx::RxmRtcm::kId);
  if (index == profile_.messages.size() || configuration_.message_rate(index) == 0 ||
      !speaks(ubx::kProtocolUbx)) {
    return;
  }
  constexpr std::uint16_t kProprietary = 4072;
  constexpr std::uint16_t kNoStation = 0xFFFF;
  const bool subtyped = frame.message() == kProprietary;
  const std::uint16_t second = frame.second_field();
  send(now, ubx::encode(ubx::RxmRtcm{.flags = flags,
                                     .subtype = subtyped ? second : std::uint16_t{0},
                                     .station = subtyped ? kNoStation : second,
                                     .message = frame.message()}));
}

bool UbloxReceiver::answer_raw(SimTime now, const ubx::FrameView& frame) {
  const std::size_t answers = raw_.answers(frame.id, frame.payload);
  std::array<std::uint8_t, kLongestRawFrame> answer{};
  for (std::size_t i = 0; i < answers && speaks(ubx::kProtocolUbx); ++i) {
    const std::size_t size = raw_.encode_answer(frame.id, frame.payload, i, answer);
    send(now, std::span(answer).first(size));
  }
  return answers > 0;
}

/// Only what the type has is answered: UbloxProfile::messages says it.
bool UbloxReceiver::answer_poll(SimTime now, const ubx::FrameView& frame) {
  const UbloxMessage* const message = polled_message(profile_, frame.id);
  if (message == nullptr) {
    return false;
  }
  if (UbloxRawMessages::handles(frame.id)) {
    return answer_raw(now, frame);
  }
  if (!frame.payload.empty()) {
    return false;
  }
  if (frame.id != ubx::MonVerHead::kId) {
    send_message(now, *message);
  } else if (speaks(ubx::kProtocolUbx)) {
    std::array<std::uint8_t, ubx::kOverheadBytes + 256> reply{};
    const std::size_t size = ubx::encode_frame(frame.id, version_, reply);
    send(now, std::span(reply).first(size));
  }
  return true;
}

bool UbloxReceiver::handle_aiding(SimTime now, const ubx::FrameView& frame) {
  const auto aid = ubx::decode<ubx::AidIni>(frame);
  if (!aid.ok() || polled_message(profile_, frame.id) == nullptr) {
    return false;
  }
  const auto has = [&](unsigned bit) { return (aid->flags >> bit & 1U) != 0; };
  if (has(0)) {
    const bool geodetic = has(5);
    const auto& p = aid->position;
    const Geodetic given = geodetic ? Geodetic{p[0] * 1e-7, p[1] * 1e-7, p[2] * 0.01}
                                    : geodetic_from_ecef({p[0] * 0.01, p[1] * 0.01, p[2] * 0.01});
    if (std::abs(given.latitude_deg) <= 90.0 && std::abs(given.longitude_deg) <= 180.0) {
      navigator_.aid_position(given, aid->position_accuracy_cm * 0.01);
    }
  }
  if (has(1)) {
    navigator_.aid_time(now, configuration_);
  }
  if (configuration_.expert().acknowledge_aiding != 0) {
    answer(now, frame.id, true);
  }
  return true;
}

void UbloxReceiver::handle_configuration(SimTime now, const ubx::FrameView& frame) {
  ++received_.accepted;
  if (refuses(now) && !configuration_.is_poll(frame)) {
    answer(now, frame.id, false);
    return;
  }
  if (const auto request = ubx::decode<ubx::CfgRst>(frame); request.ok()) {
    reset(now, *request);
    return;
  }
  if (configuration_.is_poll(frame)) {
    const auto payload = configuration_.poll(frame);
    if (payload && speaks(ubx::kProtocolUbx)) {
      std::array<std::uint8_t, ubx::kOverheadBytes + 1024> reply{};
      const std::size_t size = ubx::encode_frame(frame.id, *payload, reply);
      send(now, std::span(reply).first(size));
    }
    answer(now, frame.id, payload.has_value());
    return;
  }
  answer(now, frame.id, set(now, frame));
}

bool UbloxReceiver::set(SimTime now, const ubx::FrameView& frame) {
  const ubx::CfgRate before = configuration_.rate();
  const bool accepted = configuration_.set(frame);
  refresh_command();
  if (accepted) {
    set_baud(configuration_.uart().baud);
    if (configuration_.rate() != before) {
      plan_from(now + 1ns);
    }
  }
  return accepted;
}

void UbloxReceiver::answer(SimTime now, ubx::MessageId request, bool accepted) {
  accepted ? ++counters_.acknowledged : ++counters_.refused;
  if (!speaks(ubx::kProtocolUbx)) {
    return;
  }
  if (accepted) {
    send(now, ubx::encode(ubx::AckAck{request.message_class, request.message_id}));
  } else {
    send(now, ubx::encode(ubx::AckNak{request.message_class, request.message_id}));
  }
}

// Executes CFG-RST: resetMode 0, 1 and 4 restart the receiver, 2 only the navigation, 8 and 9 stop
// and start it; other modes are refused.
void UbloxReceiver::reset(SimTime now, const ubx::CfgRst& request) {
  constexpr std::uint8_t kGnssOnly = 2;
  constexpr std::uint8_t kStopGnss = 8;
  constexpr std::uint8_t kStartGnss = 9;
  const UbloxMemory memory = UbloxMemory::after_clearing(request.clear_mask);
  ++counters_.resets;
  switch (request.mode) {
    case 0:
    case 1:
    case 4:
      configuration_.reload();
      start(now, memory);
      return;
    case kGnssOnly:
      begin_navigation(now, memory);
      return;
    case kStopGnss:
      navigating_ = false;
      pending_count_ = 0;
      plan_ = {};
      return;
    case kStartGnss:
      navigating_ = true;
      begin_navigation(now, memory);
      plan_from(now + 1ns);
      return;
    default:
      --counters_.resets;
      answer(now, ubx::CfgRst::kId, false);
  }
}

// What clients say in NMEA: PUBX commands and queries.

void UbloxReceiver::handle(SimTime now, const nmea::SentenceView& sentence) {
  if ((configuration_.uart().input_protocols & ubx::kProtocolNmea) == 0) {
    ++received_.ignored;
    return;
  }
  ++port_.messages[1];
  note_request(now, sentence);
  const bool known =
      sentence.address == "PUBX" ? handle_proprietary(now, sentence) : handle_query(now, sentence);
  if (known) {
    ++received_.accepted;
  } else {
    ++received_.ignored;
    send_text(now, nmea::TextKind::warning, "NMEA unknown msg");
  }
}

void UbloxReceiver::note_request(SimTime now, const nmea::SentenceView& sentence) {
  std::array<std::uint8_t, LastRequest::kHeadBytes> head{'$'};
  std::size_t size = 1;
  for (const std::string_view part : {sentence.address, std::string_view(","), sentence.field(0)}) {
    const std::size_t count = std::min(part.size(), head.size() - size);
    std::copy_n(part.begin(), count, head.begin() + static_cast<std::ptrdiff_t>(size));
    size += count;
  }
  last_request_.note(now, std::span(head).first(size));
}

bool UbloxReceiver::handle_proprietary(SimTime now, const nmea::SentenceView& s) {
  const std::string_view number = s.field(0);
  if (number == "40") return !refuses(now) && handle_rate_command(s);
  if (number == "41") return !refuses(now) && handle_port_command(s);
  if (s.field_count == 1 && (number == "00" || number == "03" || number == "04")) {
    send_sentence(now, number == "00" ? "PUBX,00" : number == "03" ? "PUBX,03" : "PUBX,04");
    return true;
  }
  return false;
}

bool UbloxReceiver::handle_query(SimTime now, const nmea::SentenceView& s) {
  if (s.address.size() != 5 || s.type() != "GPQ") {
    return false;
  }
  const std::size_t index = message_index(profile_, s.field(0));
  if (index == profile_.messages.size() || !profile_.messages[index].sentence) {
    return false;
  }
  send_message(now, profile_.messages[index]);
  return true;
}

bool UbloxReceiver::handle_rate_command(const nmea::SentenceView& s) {
  const std::size_t index = message_index(profile_, s.field(1));
  constexpr std::size_t kFirstRate = 2;
  if (index == profile_.messages.size() || !profile_.messages[index].sentence ||
      s.field_count < kFirstRate + ubx::kPorts) {
    return false;
  }
  std::array<std::uint8_t, ubx::kPorts> rates{};
  for (std::size_t port = 0; port < rates.size(); ++port) {
    const auto rate = to_unsigned(s.field(kFirstRate + port), 10);
    if (!rate || *rate > 255) {
      return false;
    }
    rates[port] = static_cast<std::uint8_t>(*rate);
  }
  for (std::size_t port = 0; port < rates.size(); ++port) {
    configuration_.set_rate(index, port, rates[port]);
  }
  return true;
}

bool UbloxReceiver::handle_port_command(const nmea::SentenceView& s) {
  const auto port = to_unsigned(s.field(1), 10);
  const auto input = to_unsigned(s.field(2), 16);
  const auto output = to_unsigned(s.field(3), 16);
  const auto baud = to_unsigned(s.field(4), 10);
  if (!port || !input || !output || !baud || *port != ubx::kPortUart1) {
    return false;
  }
  ubx::CfgPrt wanted = configuration_.uart();
  wanted.baud = *baud;
  wanted.input_protocols = static_cast<std::uint16_t>(*input & 0xFFFFU);
  wanted.output_protocols = static_cast<std::uint16_t>(*output & 0xFFFFU);
  if (!configuration_.set_port(wanted)) {
    return false;
  }
  set_baud(configuration_.uart().baud);
  return true;
}

// What the receiver says.

bool UbloxReceiver::speaks(std::uint16_t protocol) const {
  return (configuration_.uart().output_protocols & protocol) != 0;
}

void UbloxReceiver::publish(SimTime now, bool navigated) {
  const auto messages = profile_.messages;
  std::optional<nmea::Epoch> told;  // the same for all sentences
  for (std::size_t i = 0; i < messages.size(); ++i) {
    const std::uint8_t rate = configuration_.message_rate(i);
    const bool due = navigated ? rate != 0 && epoch_number_ % rate == 0
                               : rate == 1 && UbloxRawMessages::handles(messages[i].id);
    if (!due || messages[i].rtcm || waits_for_event(messages[i].id)) {
      continue;
    }
    if (messages[i].sentence && speaks(ubx::kProtocolNmea)) {
      told = told ? told : nmea_epoch(navigator_.solution(), configuration_, in_view_);
      send_sentence(now, messages[i].name, *told);
    } else {
      send_message(now, messages[i]);
    }
  }
  mark_.fresh = mark_.rose = mark_.fell = false;
}

UbloxCorrectionContent UbloxReceiver::correction_content() const {
  const UbloxSolution& s = navigator_.solution();
  UbloxCorrectionContent content;
  if (!s.time_known || !s.date_known) {
    return content;
  }
  content.sample = &latest_;
  const SimTime told = latest_.time + latest_.clock_label_offset;
  content.measured = calendar_.gps(told);
  // At the epoch that is reported: a leap second may end between the measurement and it.
  content.leap_seconds = s.leap_seconds + calendar_.leap_seconds(told) -
                         calendar_.leap_seconds(latest_.time + latest_.measured_after);
  content.station = configuration_.present().station_out;
  content.place_E_m = base_.place_E_m();
  content.has_fix = s.fix_ok && s.dimensions == 3;
  content.position_E_m = ecef_position(s);
  content.velocity_E_mps = ecef_velocity(s);
  return content;
}

void UbloxReceiver::publish_corrections(SimTime now) {
  const UbloxCorrectionContent content = correction_content();
  const auto messages = profile_.messages;
  for (const std::size_t port : {ubx::kPortUart1, ubx::kPortUart2}) {
    if ((configuration_.present().ports[port].output_protocols & ubx::kProtocolRtcm3) == 0) {
      continue;
    }
    const auto is_due = [&](std::size_t i) {
      const std::uint8_t rate = configuration_.message_rate(i, port);
      return messages[i].rtcm && rate > 0 && epoch_number_ % rate == 0 &&
             has_correction(content, messages[i].id);
    };
    // All observations of an epoch but the last say that others follow.
    std::size_t last = messages.size();
    for (std::size_t i = 0; i < messages.size(); ++i) {
      last = is_due(i) && is_observation(messages[i].id) ? i : last;
    }
    for (std::size_t i = 0; i < messages.size(); ++i) {
      if (!is_due(i)) {
        continue;
      }
      std::array<std::uint8_t, protocols::rtcm3::kGreatestFrame> frame{};
      const std::size_t size = encode_correction(content, messages[i].id, i != last, frame);
      const auto bytes = std::span<const std::uint8_t>(frame).first(size);
      if (port == ubx::kPortUart1) {
        send(now, bytes);
      } else {
        second_.line().enqueue(now, bytes);
      }
    }
  }
}

bool UbloxReceiver::waits_for_event(ubx::MessageId id) const {
  return (id == ubx::TimTm2::kId && !mark_.fresh) || id == ubx::MonRxr::kId ||
         id == ubx::RxmRtcm::kId;
}

UbloxMonitorView UbloxReceiver::monitor_view() const {
  return {.solution = navigator_.solution(),
          .configuration = configuration_,
          .transmitter = transmitter_,
          .port = port_,
          .antenna = antenna_,
          .mark = mark_,
          .security = navigator_.security(),
          .second_line = profile_.carrier_solution ? &second_.line() : nullptr,
          .second_port = profile_.carrier_solution ? &second_.port() : nullptr,
          .receive_capacity = kInputBytes,
          .seed = settings_.noise_seed,
          .epoch = epoch_number_};
}

std::size_t UbloxReceiver::encode(ubx::MessageId id, std::span<std::uint8_t> out) {
  if (const std::size_t size = encode_navigation(navigator_.solution(), profile_, id, out);
      size > 0) {
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
    std::array<std::uint8_t, kLongestNavigationFrame> frame{};
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
  send_sentence(now, name, nmea_epoch(navigator_.solution(), configuration_, in_view_));
}

void UbloxReceiver::send_sentence(SimTime now, std::string_view name, const nmea::Epoch& epoch) {
  if (name == "PUBX,04") {
    send(now, nmea::write_pubx_time(epoch, pubx_time(navigator_.solution())).bytes());
    return;
  }
  if (const SentenceForm* const form = form_of(name)) {
    for (int page = 1; page <= form->pages(epoch); ++page) {
      send(now, form->write(epoch, page).bytes());
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
    const bool spoken = speaks(messages[i].sentence ? ubx::kProtocolNmea
                               : messages[i].rtcm   ? ubx::kProtocolRtcm3
                                                    : ubx::kProtocolUbx);
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
  if (message.sentence) {
    const SentenceForm* const form = form_of(message.name);
    std::vector<nmea::SatelliteInView> list;
    return form == nullptr || form->pages == one_page
               ? 1.0
               : form->pages(nmea_epoch(navigator_.solution(), configuration_, list));
  }
  using Kind = UbloxRawMessages::Kind;
  const double measurements = configuration_.rate().navigation_ratio;
  switch (UbloxRawMessages::kind(message.id)) {
    case Kind::other:
      return 1.0;
    case Kind::measurements:
      return measurements;
    case Kind::ephemeris:
    case Kind::almanac:
    case Kind::health:
      return 0.0;  // orbits, when they are new
    case Kind::subframes:
      break;
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
