// The OpenIMU's ear: frames that reach it, requests that it answers, settings that it takes.
#include <algorithm>

#include "emulators/openimu/openimu335ri.h"
#include "protocols/bytes.h"
#include "protocols/j1939/message.h"

namespace rigwire::emulators {

namespace j1939 = protocols::j1939;
namespace openimu = protocols::openimu;
using openimu::SettingKind;
using protocols::can::Frame;

void OpenImu::receive(SimTime now, const Frame& frame) {
  advance(now);
  if (frame.length > 8) {
    ++received_.malformed;
    return;
  }
  received_.bytes += frame.payload().size();
  const auto identifier = j1939::identify(frame);
  if (!identifier) {
    ++received_.ignored;
  } else if (identifier->pgn == j1939::kAddressClaimedPgn) {
    const auto name = j1939::decode_address_claim(frame);
    if (!name.ok()) {
      ++received_.malformed;
      return;
    }
    ++received_.accepted;
    address_.on_claim(now, identifier->source, *name);
  } else if (identifier->pgn == j1939::kRequestPgn) {
    receive_request(now, frame);
  } else if (openimu::setting_kind(identifier->pgn)) {
    receive_setting(now, frame);
  } else {
    ++received_.ignored;
  }
}

void OpenImu::receive_request(SimTime now, const Frame& frame) {
  const auto request = j1939::decode_request(frame);
  if (!request.ok()) {
    ++received_.malformed;
    return;
  }
  const j1939::Identifier identifier = *j1939::identify(frame);
  const bool global = identifier.destination == j1939::kGlobalAddress;
  if (!address_.held() || (!global && identifier.destination != address_.address())) {
    ++received_.ignored;
    return;
  }
  std::uint32_t pgn = *request;
  if ((configuration_.behaviour & openimu::Behaviour::kSwapRequestPgn) == 0) {
    // Legacy order: page, PDU format, PDU specific.
    pgn = ((frame.data[0] & 3U) << 16U) | (static_cast<std::uint32_t>(frame.data[1]) << 8U) |
          frame.data[2];
  }
  if (answer(now, pgn)) {
    ++received_.accepted;
    return;
  }
  ++received_.ignored;
  if (!global && settings_.variant == OpenImuVariant::openimu335ri) {
    // Aceinna's order: control, 0, FF, FF, address, PDU specific, PDU format, page.
    const j1939::Acknowledgement refusal{j1939::Acknowledge::negative, 0, identifier.source, pgn};
    send(now, j1939::make_acknowledgement(address_.address(), j1939::kGlobalAddress, refusal));
  }
}

bool OpenImu::answer(SimTime now, std::uint32_t pgn) {
  const std::uint8_t source = address_.address();
  const auto reply = [&](std::span<const std::uint8_t> payload) {
    send(now, j1939::make_frame({openimu::kSettingsPriority, pgn, j1939::kGlobalAddress, source},
                                payload));
  };
  const bool is_300 = settings_.variant == OpenImuVariant::openimu300ri;
  if (pgn == openimu::kEcuIdentificationPgn || (is_300 && ((pgn >> 8U) & 0xFFU) == 253)) {
    std::array<std::uint8_t, 8> payload{};
    protocols::store_little<std::uint64_t>(payload, 0, address_.name());
    send(now, j1939::make_frame({openimu::kSettingsPriority, openimu::kEcuIdentificationPgn,
                                 j1939::kGlobalAddress, source},
                                payload));
    return true;
  }
  switch (pgn) {
    case j1939::kAddressClaimedPgn:
      address_.on_request(now);
      return true;
    case openimu::kSlopePgn:
      send_packets(now, openimu::PacketBit::kSlope);
      return true;
    case openimu::kAngularRatePgn:
      send_packets(now, openimu::PacketBit::kAngularRate);
      return true;
    case openimu::kAccelerationPgn:
      send_packets(now, openimu::PacketBit::kAcceleration);
      return true;
    case openimu::kSoftwareVersionPgn: {
      std::array<std::uint8_t, 8> payload{};
      payload.fill(0xFF);
      std::copy(settings_.software_version.begin(), settings_.software_version.end(),
                payload.begin());
      reply(std::span(payload).first(is_300 ? settings_.software_version.size() : payload.size()));
      return true;
    }
    case openimu::kStatusPgn: {
      std::array<std::uint8_t, 2> payload{};
      protocols::store_little<std::uint16_t>(payload, 0, status_word());
      reply(payload);
      return true;
    }
    default:
      break;
  }
  const auto kind = openimu::setting_kind(pgn);
  if (!kind) {
    return false;
  }
  openimu::Setting setting;
  setting.kind = *kind;
  switch (*kind) {
    case SettingKind::reset_algorithm:
    case SettingKind::save_configuration:
      return false;
    case SettingKind::packet_rate:
      setting.first = configuration_.rate_divider;
      break;
    case SettingKind::packet_mask:
      setting.word = configuration_.packet_mask;
      break;
    case SettingKind::filters:
      setting.first = configuration_.rate_cut_off_hz;
      setting.second = configuration_.acceleration_cut_off_hz;
      break;
    case SettingKind::orientation:
      setting.word = configuration_.orientation;
      break;
    case SettingKind::behaviour:
      setting.word = configuration_.behaviour;
      break;
  }
  send(now, openimu::make_setting_answer(setting, source));
  return true;
}

void OpenImu::receive_setting(SimTime now, const Frame& frame) {
  const auto setting = openimu::decode_setting(frame);
  if (!setting.ok()) {
    ++received_.malformed;
    return;
  }
  const bool meant = address_.held() && setting->address == address_.address();
  if (meant && apply(now, *setting, j1939::identify(frame)->source)) {
    ++received_.accepted;
  } else {
    ++received_.ignored;
  }
}

bool OpenImu::apply(SimTime now, const openimu::Setting& setting, std::uint8_t requester) {
  switch (setting.kind) {
    case SettingKind::reset_algorithm:
      tilt_.reset();
      send(now, openimu::make_outcome(setting.kind, address_.address(), requester, true));
      return true;
    case SettingKind::save_configuration:
      saved_ = configuration_;
      send(now, openimu::make_outcome(setting.kind, address_.address(), requester, true));
      return true;
    case SettingKind::packet_rate:
      if (!openimu::is_rate_divider(setting.first)) {
        return false;
      }
      configuration_.rate_divider = setting.first;
      return true;
    case SettingKind::packet_mask:
      configuration_.packet_mask = setting.word & openimu::PacketBit::kAll;
      return true;
    case SettingKind::filters:
      if (!openimu::is_cut_off(setting.first) || !openimu::is_cut_off(setting.second)) {
        return false;
      }
      configuration_.rate_cut_off_hz = setting.first;
      configuration_.acceleration_cut_off_hz = setting.second;
      rebuild_filters();
      return true;
    case SettingKind::orientation:
      if (!openimu::orientation_axes(setting.word)) {
        return false;
      }
      configuration_.orientation = setting.word;
      rebuild_filters();
      tilt_.reset();
      return true;
    case SettingKind::behaviour:
      configuration_.behaviour =
          static_cast<std::uint16_t>((setting.word & kChangeableBehaviour) |
                                     (openimu::Behaviour::kDefault & ~kChangeableBehaviour));
      return true;
  }
  return false;
}

}  // namespace rigwire::emulators
