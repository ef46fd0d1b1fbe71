#include "emulators/ublox/configuration.h"

#include <algorithm>

namespace rigwire::emulators {
namespace {

using namespace protocols::ubx;
using Payload = std::span<const std::uint8_t>;

}  // namespace

UbloxConfiguration::UbloxConfiguration(const UbloxSettings& settings)
    : profile_(settings.profile),
      keys_(profile_->make_keys == nullptr ? nullptr : profile_->make_keys(*profile_)),
      default_(default_state(settings)),
      saved_(default_),
      present_(default_) {}

bool UbloxConfiguration::is_poll(const FrameView& frame) const {
  const std::size_t length = frame.payload.size();
  if (keys_ && keys_->handles(frame.id)) {
    return keys_->is_poll(frame);
  }
  if (frame.id == CfgMsg::kId) {
    return length == 2;
  }
  if (frame.id == CfgInf::kId) {
    return length == 1;
  }
  if (frame.id == CfgPrt::kId || frame.id == CfgTp5::kId) {
    return length <= 1;
  }
  return length == 0;
}

template <class Message>
Payload UbloxConfiguration::reply(const Message& message) {
  const auto payload = std::span(reply_).first(Message::kLength);
  write_payload(message, payload);
  return payload;
}

Payload UbloxConfiguration::reply_systems() {
  const std::span<std::uint8_t> all = reply_;
  write_payload(present_.gnss, all.first(CfgGnssHead::kLength));
  std::size_t at = CfgGnssHead::kLength;
  for (const auto& block : std::span(present_.systems).first(profile_->systems.size())) {
    write_payload(block, all.subspan(at, CfgGnssBlock::kLength));
    at += CfgGnssBlock::kLength;
  }
  return all.first(at);
}

Payload UbloxConfiguration::reply_sentences() {
  const std::span<std::uint8_t> all = reply_;
  write_payload(present_.nmea, all.first(CfgNmea::kLength));
  if (profile_->cfg_nmea_bytes > CfgNmea::kLength) {
    all[CfgNmea::kLength - 1] = 1;  // version of the longer form
  }
  std::ranges::copy(present_.nmea_tail, all.subspan(CfgNmea::kLength).begin());
  return all.first(profile_->cfg_nmea_bytes);
}

std::optional<Payload> UbloxConfiguration::poll(const FrameView& frame) {
  const MessageId id = frame.id;
  if (keys_) {
    if (keys_->handles(id)) {
      const std::size_t size = keys_->poll(*this, frame, reply_);
      return size == 0 ? std::nullopt : std::optional(Payload(reply_).first(size));
    }
    keys_->interrupt();
  }
  const std::uint8_t selector = frame.payload.empty() ? 0 : frame.payload[0];
  if (id == CfgPrt::kId) {
    const std::size_t port = frame.payload.empty() ? kPortUart1 : selector;
    return port < present_.ports.size() ? std::optional(reply(present_.ports[port])) : std::nullopt;
  }
  if (id == CfgMsg::kId) {
    const std::size_t index =
        message_index(*profile_, MessageId{frame.payload[0], frame.payload[1]});
    if (index == profile_->messages.size() || !profile_->messages[index].periodic) {
      return std::nullopt;
    }
    return reply(CfgMsg{frame.payload[0], frame.payload[1], present_.rates[index]});
  }
  if (id == CfgInf::kId) {
    const auto found = std::ranges::find(present_.information, selector, &CfgInf::protocol);
    return found == present_.information.end() ? std::nullopt : std::optional(reply(*found));
  }
  if (id == CfgTp5::kId) {
    return selector < present_.pulses.size() ? std::optional(reply(present_.pulses[selector]))
                                             : std::nullopt;
  }
  if (id == CfgRate::kId) return reply(present_.rate);
  if (id == CfgNav5::kId) return reply(present_.nav5);
  if (id == CfgNavx5::kId) return reply(present_.navx5);
  if (id == CfgOdo::kId && profile_->odometer) return reply(present_.odometer);
  if (id == CfgPms::kId && profile_->power_modes) return reply(CfgPms{});
  if (id == CfgNmea::kId) return reply_sentences();
  if (id == CfgGnssHead::kId) return reply_systems();
  if (id == kCfgDat) return Payload(present_.datum);
  if (id == kCfgRinv) {
    return Payload(present_.remote_inventory).first(present_.remote_inventory_bytes);
  }
  if (const auto bytes = opaque(id); !bytes.empty()) return Payload(bytes);
  if (id == CfgSbas::kId) return reply(present_.sbas);
  if (id == CfgAnt::kId) return reply(present_.antenna);
  if (id == CfgRxm::kId) return reply(present_.power);
  return std::nullopt;
}

bool UbloxConfiguration::set(const FrameView& frame) {
  const MessageId id = frame.id;
  if (keys_) {
    if (keys_->handles(id)) {
      return keys_->set(*this, frame);
    }
    keys_->interrupt();
  }
  if (id == CfgPrt::kId) return set_ports(frame.payload);
  if (id == CfgMsg::kId) return set_message(frame.payload);
  if (id == CfgInf::kId) return set_information(frame.payload);
  if (id == CfgGnssHead::kId) return set_systems(frame.payload);
  if (id == CfgNmea::kId) return set_sentences(frame.payload);
  if (id == CfgCfg::kId) return set_store(frame.payload);
  if (id == kCfgDat) return set_datum(frame.payload);
  if (id == kCfgRinv) return set_inventory(frame.payload);
  if (const auto wanted = decode<CfgRate>(frame); wanted.ok()) return set_rate(*wanted);
  if (const auto wanted = decode<CfgNav5>(frame); wanted.ok()) return set_navigation(*wanted);
  if (const auto wanted = decode<CfgNavx5>(frame); wanted.ok()) return set_expert(*wanted);
  if (const auto wanted = decode<CfgTp5>(frame); wanted.ok()) return set_pulse(*wanted);
  if (const auto wanted = decode<CfgOdo>(frame); wanted.ok()) return set_odometer(*wanted);
  if (const auto wanted = decode<CfgPms>(frame); wanted.ok()) {
    return profile_->power_modes && *wanted == CfgPms{};  // no power saving is emulated
  }
  if (const auto wanted = decode<CfgSbas>(frame); wanted.ok()) {
    present_.sbas = *wanted;
    return true;
  }
  if (const auto wanted = decode<CfgAnt>(frame); wanted.ok()) {
    present_.antenna = *wanted;
    return true;
  }
  if (const auto wanted = decode<CfgRxm>(frame); wanted.ok()) {
    if (wanted->low_power_mode != 0) {  // power save is not emulated
      return false;
    }
    present_.power = *wanted;
    return true;
  }
  return set_opaque(frame);
}

void UbloxConfiguration::reload() {
  if (keys_) {
    keys_->reload(*this);
  } else {
    present_ = saved_;
  }
}

void UbloxConfiguration::forget() {
  saved_ = default_;
  if (keys_) {
    keys_->forget();
  }
}

bool UbloxConfiguration::text_enabled(std::uint8_t protocol, unsigned kind_bit) const {
  const auto found = std::ranges::find(present_.information, protocol, &CfgInf::protocol);
  return found != present_.information.end() && (found->masks[kPortUart1] >> kind_bit & 1U) != 0;
}

bool UbloxConfiguration::enabled(GnssSystem system) const {
  const auto systems = std::span(present_.systems).first(profile_->systems.size());
  const auto found =
      std::ranges::find(systems, static_cast<std::uint8_t>(system), &CfgGnssBlock::system);
  return found != systems.end() && (found->flags & 1U) != 0;
}

}  // namespace rigwire::emulators
