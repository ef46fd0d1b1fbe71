#include "hil/devices/client_request.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string_view>

#include "protocols/can/frame_text.h"
#include "protocols/gige_vision/gvcp.h"
#include "protocols/j1939/identifier.h"
#include "protocols/j1939/message.h"
#include "protocols/modbus/function_names.h"

namespace rigwire::hil {
namespace {

using protocols::modbus::Addressed;

/// Class numbers of UBX messages (u-blox receiver description, section "UBX class IDs").
struct ClassRow {
  std::uint8_t number;
  std::string_view name;
};
constexpr std::array<ClassRow, 13> kUbxClasses{{{0x01, "NAV"},
                                                {0x02, "RXM"},
                                                {0x04, "INF"},
                                                {0x05, "ACK"},
                                                {0x06, "CFG"},
                                                {0x09, "UPD"},
                                                {0x0A, "MON"},
                                                {0x0B, "AID"},
                                                {0x0D, "TIM"},
                                                {0x10, "ESF"},
                                                {0x13, "MGA"},
                                                {0x21, "LOG"},
                                                {0x27, "SEC"}}};

std::string modbus_text(std::span<const std::uint8_t> pdu) {
  const auto* const row = protocols::modbus::find_function_name(pdu[0]);
  if (row == nullptr) {
    return fmt::format("function {}", pdu[0]);
  }
  const auto word = [&](std::size_t at) {
    return static_cast<unsigned>(pdu[at] << 8 | pdu[at + 1]);
  };
  const std::size_t needed = row->addressed == Addressed::many  ? 5
                             : row->addressed == Addressed::one ? 3
                                                                : 1;
  if (row->addressed == Addressed::nothing || pdu.size() < needed) {
    return fmt::format("{}{}{}", row->verb, row->items.empty() ? "" : " ", row->items);
  }
  const unsigned first = word(1);
  if (row->addressed == Addressed::one || word(3) <= 1) {
    return fmt::format("{} {} {}", row->verb, row->items, first);
  }
  return fmt::format("{} {} {} .. {}", row->verb, row->items, first, first + word(3) - 1);
}

}  // namespace

std::optional<ClientRequest> client_request(const std::optional<emulators::CanRequest>& request) {
  if (!request) {
    return std::nullopt;
  }
  std::string text = protocols::can::frame_text(request->frame);
  if (request->frame.extended) {
    const std::uint32_t pgn = protocols::j1939::unpack(request->frame.id).pgn;
    const auto asked = protocols::j1939::decode_request(request->frame);
    text += pgn == protocols::j1939::kRequestPgn && asked.ok()
                ? fmt::format(" (request of PGN {})", *asked)
                : fmt::format(" (PGN {})", pgn);
  }
  return ClientRequest{request->at, std::move(text)};
}

std::optional<ClientRequest> modbus_request(const emulators::LastRequest& request) {
  if (request.at == kNever || request.size == 0) {
    return std::nullopt;
  }
  return ClientRequest{request.at, modbus_text(request.bytes())};
}

std::optional<ClientRequest> ublox_request(const emulators::LastRequest& request) {
  if (request.at == kNever || request.size < 2) {
    return std::nullopt;
  }
  const auto bytes = request.bytes();
  if (bytes[0] == '$') {
    return ClientRequest{request.at, std::string(bytes.begin(), bytes.end())};
  }
  const auto row = std::find_if(kUbxClasses.begin(), kUbxClasses.end(),
                                [&](const ClassRow& r) { return r.number == bytes[0]; });
  const std::string of =
      row == kUbxClasses.end() ? fmt::format("0x{:02X}", bytes[0]) : std::string(row->name);
  return ClientRequest{request.at, fmt::format("UBX {} 0x{:02X}", of, bytes[1])};
}

std::optional<ClientRequest> client_request(const std::optional<emulators::UsbRequest>& request) {
  if (!request) {
    return std::nullopt;
  }
  const protocols::usb::Setup& setup = request->setup;
  return ClientRequest{request->at,
                       fmt::format("control {:02x} {:02x} {:04x} {:04x} {}", setup.request_type,
                                   setup.request, setup.value, setup.index, setup.length)};
}

namespace {

namespace gev = protocols::gige_vision;

std::string words_of(const gev::Discovery& /*command*/) {
  return "Discovery";
}
std::string words_of(const gev::ForceIp& command) {
  return fmt::format("ForceIp {}.{}.{}.{}", command.address >> 24U, command.address >> 16U & 0xFFU,
                     command.address >> 8U & 0xFFU, command.address & 0xFFU);
}
std::string words_of(const gev::PacketResend& command) {
  return fmt::format("PacketResend {}: {} .. {}", command.block, command.first, command.last);
}
std::string words_of(const gev::ReadRegisters& command) {
  return fmt::format("ReadReg 0x{:04X}{}", command.addresses[0],
                     command.addresses.size() > 1 ? " ..." : "");
}
std::string words_of(const gev::WriteRegisters& command) {
  return fmt::format("WriteReg 0x{:04X} = {}{}", command.address(0), command.value(0),
                     command.size() > 1 ? " ..." : "");
}
std::string words_of(const gev::ReadMemory& command) {
  return fmt::format("ReadMem 0x{:04X} of {}", command.address, command.count);
}
std::string words_of(const gev::WriteMemory& command) {
  return fmt::format("WriteMem 0x{:04X} of {}", command.address, command.bytes.size());
}

}  // namespace

std::optional<std::string> gvcp_request(std::span<const std::uint8_t> datagram) {
  const auto packet = gev::decode_command(datagram);
  if (!packet.ok()) {
    return std::nullopt;
  }
  const auto command = gev::interpret(packet.value());
  const auto* const known = std::get_if<gev::Command>(&command);
  return known == nullptr
             ? std::nullopt
             : std::optional(std::visit([](const auto& one) { return words_of(one); }, *known));
}

}  // namespace rigwire::hil
