// Texts of ClientRequest, by the protocol that the request came by.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "emulators/can/can_node.h"
#include "emulators/device.h"
#include "emulators/usb/usb_device.h"
#include "hil/wires/wire_statistics.h"

namespace rigwire::hil {

/// "18EAFFFE#DAFE00 (request of PGN 65242)", "60A#4000100000000000".
[[nodiscard]] std::optional<ClientRequest> client_request(
    const std::optional<emulators::CanRequest>& request);
/// "write multiple registers 30 .. 33", of the head of a PDU.
[[nodiscard]] std::optional<ClientRequest> modbus_request(const emulators::LastRequest& request);
/// "UBX CFG 0x08", "$PUBX,40".
[[nodiscard]] std::optional<ClientRequest> ublox_request(const emulators::LastRequest& request);
/// "control 21 0a 0000 0000 0": request type, request, value, index (hexadecimal) and length, in
/// the order of the SETUP packet (USB 2.0, 9.3).
[[nodiscard]] std::optional<ClientRequest> client_request(
    const std::optional<emulators::UsbRequest>& request);

/// "ReadReg 0x0A00", "WriteReg 0xA104 = 1", "ReadMem 0x10000 of 512", "PacketResend 17: 3 .. 5", of
/// a datagram to a GigE Vision device; nothing when it is no command that is known.
[[nodiscard]] std::optional<std::string> gvcp_request(std::span<const std::uint8_t> datagram);

}  // namespace rigwire::hil
