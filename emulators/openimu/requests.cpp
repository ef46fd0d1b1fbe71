// The OpenIMU's ear: frames that reach it, and the requests that it answers.
#include <algorithm>

#include "emulators/openimu/openimu335ri.h"
#include "protocols/bytes.h"
#include "protocols/j1939/message.h"

namespace rigwire::emulators {

namespace j1939 = protocols::j1939;
namespace openimu = protocols::openimu;
using openimu::Command;
using protocols::can::Frame;

namespace {

constexpr std::uint32_t kEcuFormat = 253;  ///< The 300RI answers every group of this PDU format.

bool is_bank(std::uint32_t pgn) {
  return pgn == openimu::kBank0Pgn || pgn == openimu::kBank1Pgn || pgn == openimu::kBank2Pgn;
}
bool is_aiding(std::uint32_t pgn) {
  return pgn == openimu::kTransmissionPgn || pgn == openimu::kWheelSpeedPgn ||
         pgn == openimu::kVehicleSpeedPgn;
}

}  // namespace

void OpenImu::receive(SimTime now, const Frame& frame) {
  advance(now);
  if (frame.length > 8) {
    ++received_.malformed;
    return;
  }
  received_.bytes += frame.payload().size();
  const auto identifier = j1939::identify(frame);
  if (!identifier || !supply_.on()) {
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
  } else if (is_bank(identifier->pgn)) {
    receive_bank(identifier->pgn, frame.payload());
  } else if (openimu::setting_kind(identifier->pgn, configuration_.commands)) {
    receive_setting(now, frame);
  } else if (!is_300() && identifier->pgn == openimu::kClearTroublePgn) {
    clear_trouble(now, identifier->source);
  } else if (!is_300() && is_aiding(identifier->pgn)) {
    ++(frame.length == 8 ? received_.accepted : received_.malformed);
    aiding_messages_ += frame.length == 8 ? 1U : 0U;
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
  ++(answer(now, pgn, identifier.source) ? received_.accepted : received_.ignored);
}

bool OpenImu::answer(SimTime now, std::uint32_t pgn, std::uint8_t requester) {
  if (pgn == j1939::kAddressClaimedPgn) {
    address_.on_request(now);
    return true;
  }
  if (pgn == openimu::kEcuIdentificationPgn || (is_300() && ((pgn >> 8U) & 0xFFU) == kEcuFormat)) {
    std::array<std::uint8_t, 8> payload{};
    protocols::store_little<std::uint64_t>(payload, 0, address_.name());
    send(now, j1939::make_frame({openimu::kSettingsPriority, openimu::kEcuIdentificationPgn,
                                 j1939::kGlobalAddress, address_.address()},
                                payload));
    return true;
  }
  if (pgn == openimu::kSoftwareVersionPgn) {
    send(now, j1939::make_frame(
                  {openimu::kSettingsPriority, pgn, j1939::kGlobalAddress, address_.address()},
                  settings_.software_version));
    return true;
  }
  return answer_data(now, pgn) || answer_status(now, pgn) || answer_setting(now, pgn, requester);
}

bool OpenImu::answer_data(SimTime now, std::uint32_t pgn) {
  using Bit = openimu::PacketBit;
  std::uint16_t packet = 0;
  switch (pgn) {
    case openimu::kSlopePgn:
      packet = Bit::kSlope;
      break;
    case openimu::kAngularRatePgn:
      packet = Bit::kAngularRate;
      break;
    case openimu::kAccelerationPgn:
      packet = Bit::kAcceleration;
      break;
    case openimu::kSlope1Pgn:
      packet = Bit::kSlope1;
      break;
    case openimu::kMagneticRequestPgn:
    case openimu::kMagneticFieldPgn:
      packet = is_300() ? Bit::kMagneticField : std::uint16_t{0};
      break;
    default:
      if (!is_300() && pgn == pgn_of(configuration_.commands, Command::fine_rate)) {
        packet = Bit::kFineRate;
      }
  }
  packet &= packets_of(settings_.variant);
  if (packet != 0) {
    send_packets(now, packet);
  }
  return packet != 0;
}

bool OpenImu::answer_status(SimTime now, std::uint32_t pgn) {
  const auto command = openimu::command_of(configuration_.commands, pgn);
  std::array<std::uint8_t, 4> payload{};
  std::size_t length = 2;
  if (command == Command::master_status) {
    // The 335RI adds the checksum of its application, which is not there.
    protocols::store_little<std::uint16_t>(payload, 0, status_word());
    length = is_300() ? 2 : 4;
  } else if (command == Command::hardware_status && !is_300()) {
    payload[0] = memory_damaged_ ? 1 : 0;
  } else if (command == Command::software_status && !is_300()) {
    length = 4;
  } else {
    return false;
  }
  send(now, j1939::make_frame(
                {openimu::kSettingsPriority, pgn, j1939::kGlobalAddress, address_.address()},
                std::span(payload).first(length)));
  return true;
}

bool OpenImu::answer_setting(SimTime now, std::uint32_t pgn, std::uint8_t requester) {
  const auto kind = openimu::setting_kind(pgn, configuration_.commands);
  if (!kind) {
    return false;
  }
  const OpenImuConfiguration& c = configuration_;
  openimu::Setting setting;
  setting.kind = *kind;
  switch (*kind) {
    case Command::packet_rate:
      setting.first = c.rate_divider;
      break;
    case Command::packet_mask:
      setting.word = c.packet_mask;
      setting.first = static_cast<std::uint8_t>(c.rate_priority | (c.acceleration_priority << 2U) |
                                                (c.slope_priority << 4U));
      break;
    case Command::filters:
      setting.first = c.rate_cut_off_hz;
      setting.second = c.acceleration_cut_off_hz;
      break;
    case Command::orientation:
      setting.word = c.orientation;
      break;
    case Command::behaviour:
      setting.word = c.behaviour;
      break;
    case Command::trouble_code:
      if (is_300()) {
        return false;
      }
      setting.more = {c.trouble.lamps,
                      c.trouble.flashing,
                      static_cast<std::uint8_t>(c.trouble.parameter & 0xFFU),
                      static_cast<std::uint8_t>((c.trouble.parameter >> 8U) & 0xFFU),
                      static_cast<std::uint8_t>(c.trouble.parameter >> 16U),
                      c.trouble.first_failure,
                      c.trouble.second_failure};
      break;
    default:
      return false;
  }
  send(now, is_300() ? openimu::make_setting_answer_300(setting, address_.address(), c.commands)
                     : openimu::make_setting_answer_335(setting, address_.address(), requester,
                                                        c.commands));
  return true;
}

void OpenImu::clear_trouble(SimTime now, std::uint8_t requester) {
  if (!address_.held()) {
    ++received_.ignored;
    return;
  }
  ++received_.accepted;
  troubles_ = 0;
  // Aceinna's order is the standard's, with group function 0, sent to everybody.
  const j1939::Acknowledgement done{j1939::Acknowledge::positive, 0, requester,
                                    openimu::kClearTroublePgn};
  send(now, j1939::make_acknowledgement(address_.address(), j1939::kGlobalAddress, done));
}

}  // namespace rigwire::emulators
