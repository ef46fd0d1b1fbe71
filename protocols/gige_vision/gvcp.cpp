#include "protocols/gige_vision/gvcp.h"

#include <algorithm>

namespace rigwire::protocols::gige_vision {
namespace {

using Bytes = std::span<const std::uint8_t>;

// Offsets in the headers.
constexpr std::size_t kKeyAt = 0;
constexpr std::size_t kFlagsAt = 1;
constexpr std::size_t kStatusAt = 0;  // acknowledge
constexpr std::size_t kCodeAt = 2;
constexpr std::size_t kLengthAt = 4;
constexpr std::size_t kRequestAt = 6;

// Offsets in the payloads.
constexpr std::size_t kForceIpMacAt = 2;
constexpr std::size_t kForceIpAddressAt = kForceIpMacAt + 6 + 12;
constexpr std::size_t kForceIpMaskAt = kForceIpAddressAt + 4 + 12;
constexpr std::size_t kForceIpGatewayAt = kForceIpMaskAt + 4 + 12;
constexpr std::size_t kForceIpSize = kForceIpGatewayAt + 4;
static_assert(kForceIpSize == 56);

constexpr std::size_t kResendSize = 2 + 2 + 4 + 4;
constexpr std::size_t kResendExtendedSize = 2 + 2 + 4 + 4 + 8;
constexpr std::size_t kResendBlockAt = 2;
constexpr std::size_t kResendFirstAt = 4;
constexpr std::size_t kResendLastAt = 8;
constexpr std::size_t kResendExtendedBlockAt = 12;
constexpr std::uint32_t kPacketIdMask = 0x00FF'FFFF;

constexpr std::size_t kReadMemorySize = 4 + 2 + 2;
constexpr std::size_t kReadMemoryCountAt = 6;
constexpr std::size_t kCountSize = 2 + 2;

std::uint16_t half(Bytes bytes, std::size_t at) {
  return load_big<std::uint16_t>(bytes, at);
}
std::uint32_t word(Bytes bytes, std::size_t at) {
  return load_big<std::uint32_t>(bytes, at);
}
bool aligned(std::uint32_t value) {
  return value % 4 == 0;
}

using Interpreted = std::variant<Command, Status>;

Interpreted interpret_force_ip(Bytes payload) {
  if (payload.size() != kForceIpSize) {
    return Status::invalid_header;
  }
  ForceIp command;
  std::ranges::copy(payload.subspan(kForceIpMacAt, command.mac.size()), command.mac.begin());
  command.address = word(payload, kForceIpAddressAt);
  command.mask = word(payload, kForceIpMaskAt);
  command.gateway = word(payload, kForceIpGatewayAt);
  return command;
}

Interpreted interpret_resend(const CommandPacket& packet) {
  const Bytes payload = packet.payload;
  PacketResend command;
  command.extended_ids = (packet.flags & CommandFlag::kExtendedIds) != 0;
  if (payload.size() != (command.extended_ids ? kResendExtendedSize : kResendSize)) {
    return Status::invalid_header;
  }
  command.channel = half(payload, 0);
  command.first = word(payload, kResendFirstAt);
  command.last = word(payload, kResendLastAt);
  if (command.extended_ids) {
    command.block = load_big<std::uint64_t>(payload, kResendExtendedBlockAt);
  } else {
    command.block = half(payload, kResendBlockAt);
    command.first &= kPacketIdMask;
    command.last &= kPacketIdMask;
  }
  if (command.block == 0 || command.first > command.last) {
    return Status::invalid_parameter;
  }
  return command;
}

Interpreted interpret_read_registers(Bytes payload) {
  if (payload.empty() || payload.size() % 4 != 0) {
    return Status::invalid_header;
  }
  const ReadRegisters command{WordView(payload)};
  for (std::size_t i = 0; i < command.addresses.size(); ++i) {
    if (!aligned(command.addresses[i])) {
      return Status::bad_alignment;
    }
  }
  return command;
}

Interpreted interpret_write_registers(Bytes payload) {
  if (payload.empty() || payload.size() % 8 != 0) {
    return Status::invalid_header;
  }
  const WriteRegisters command{WordView(payload)};
  for (std::size_t i = 0; i < command.size(); ++i) {
    if (!aligned(command.address(i))) {
      return Status::bad_alignment;
    }
  }
  return command;
}

Interpreted interpret_read_memory(Bytes payload) {
  if (payload.size() != kReadMemorySize) {
    return Status::invalid_header;
  }
  const ReadMemory command{word(payload, 0), half(payload, kReadMemoryCountAt)};
  if (!aligned(command.address) || !aligned(command.count)) {
    return Status::bad_alignment;
  }
  if (command.count == 0 || command.count > kMemoryMaximum) {
    return Status::invalid_parameter;
  }
  return command;
}

Interpreted interpret_write_memory(Bytes payload) {
  if (payload.size() <= 4) {
    return Status::invalid_header;
  }
  const WriteMemory command{word(payload, 0), payload.subspan(4)};
  if (!aligned(command.address) || command.bytes.size() % 4 != 0) {
    return Status::bad_alignment;
  }
  return command;
}

GvcpPacket begin_command(CommandCode code, std::uint16_t request, std::uint8_t flags) {
  GvcpPacket packet;
  packet.half(static_cast<std::uint16_t>(kCommandKey << 8U | flags));
  packet.half(static_cast<std::uint16_t>(code));
  packet.half(0);
  packet.half(request);
  return packet;
}

}  // namespace

Decoded<CommandPacket> decode_command(std::span<const std::uint8_t> datagram) {
  if (datagram.size() < kGvcpHeaderSize) {
    return Incomplete{kGvcpHeaderSize, datagram.size()};
  }
  if (datagram[kKeyAt] != kCommandKey) {
    return Malformed{"a command begins with 0x42", kKeyAt};
  }
  const std::size_t size = kGvcpHeaderSize + half(datagram, kLengthAt);
  if (datagram.size() < size) {
    return Incomplete{size, datagram.size()};
  }
  if (datagram.size() > size) {
    return Malformed{"bytes beyond the command's length", size};
  }
  if (size > kGvcpSizeMaximum) {
    return Malformed{"a command has at most 548 bytes", kLengthAt};
  }
  if (half(datagram, kRequestAt) == 0) {
    return Malformed{"a request is numbered from 1", kRequestAt};
  }
  return {CommandPacket{datagram[kFlagsAt], half(datagram, kCodeAt), half(datagram, kRequestAt),
                        datagram.subspan(kGvcpHeaderSize)},
          size};
}

std::optional<CommandPacket> peek_header(std::span<const std::uint8_t> datagram) {
  if (datagram.size() < kGvcpHeaderSize || datagram[kKeyAt] != kCommandKey ||
      half(datagram, kRequestAt) == 0) {
    return std::nullopt;
  }
  return CommandPacket{datagram[kFlagsAt], half(datagram, kCodeAt), half(datagram, kRequestAt), {}};
}

std::variant<Command, Status> interpret(const CommandPacket& packet) {
  switch (static_cast<CommandCode>(packet.command)) {
    case CommandCode::discovery:
      return packet.payload.empty()
                 ? Interpreted(Discovery{(packet.flags & CommandFlag::kBroadcastAnswer) != 0})
                 : Interpreted(Status::invalid_header);
    case CommandCode::force_ip:
      return interpret_force_ip(packet.payload);
    case CommandCode::packet_resend:
      return interpret_resend(packet);
    case CommandCode::read_registers:
      return interpret_read_registers(packet.payload);
    case CommandCode::write_registers:
      return interpret_write_registers(packet.payload);
    case CommandCode::read_memory:
      return interpret_read_memory(packet.payload);
    case CommandCode::write_memory:
      return interpret_write_memory(packet.payload);
  }
  return Status::not_implemented;
}

void GvcpPacket::append(std::span<const std::uint8_t> bytes) {
  std::ranges::copy(bytes, extend(bytes.size()).begin());
}

std::span<std::uint8_t> GvcpPacket::extend(std::size_t count) {
  assert(size_ + count <= bytes_.size());
  const std::span<std::uint8_t> room = std::span(bytes_).subspan(size_, count);
  size_ += count;
  return room;
}

void GvcpPacket::finish() {
  store_big(std::span(bytes_), kLengthAt, static_cast<std::uint16_t>(size_ - kGvcpHeaderSize));
}

GvcpPacket encode_discovery(std::uint16_t request, bool broadcast_answer) {
  return begin_command(CommandCode::discovery, request,
                       broadcast_answer ? static_cast<std::uint8_t>(CommandFlag::kAcknowledge |
                                                                    CommandFlag::kBroadcastAnswer)
                                        : CommandFlag::kAcknowledge);
}

GvcpPacket encode_force_ip(std::uint16_t request, const ForceIp& command) {
  GvcpPacket packet = begin_command(CommandCode::force_ip, request, CommandFlag::kAcknowledge);
  const std::span<std::uint8_t> payload = packet.extend(kForceIpSize);
  std::ranges::copy(command.mac, payload.subspan(kForceIpMacAt).begin());
  store_big(payload, kForceIpAddressAt, command.address);
  store_big(payload, kForceIpMaskAt, command.mask);
  store_big(payload, kForceIpGatewayAt, command.gateway);
  packet.finish();
  return packet;
}

GvcpPacket encode_packet_resend(std::uint16_t request, const PacketResend& command) {
  GvcpPacket packet =
      begin_command(CommandCode::packet_resend, request,
                    command.extended_ids ? CommandFlag::kExtendedIds : std::uint8_t{0});
  packet.half(command.channel);
  packet.half(command.extended_ids ? std::uint16_t{0} : static_cast<std::uint16_t>(command.block));
  packet.word(command.first);
  packet.word(command.last);
  if (command.extended_ids) {
    store_big(packet.extend(8), 0, command.block);
  }
  packet.finish();
  return packet;
}

GvcpPacket encode_read_registers(std::uint16_t request, std::span<const std::uint32_t> addresses) {
  assert(!addresses.empty() && addresses.size() <= kReadRegistersMaximum);
  GvcpPacket packet =
      begin_command(CommandCode::read_registers, request, CommandFlag::kAcknowledge);
  for (const std::uint32_t address : addresses) {
    packet.word(address);
  }
  packet.finish();
  return packet;
}

GvcpPacket encode_write_registers(std::uint16_t request, std::span<const RegisterValue> registers) {
  assert(!registers.empty() && registers.size() <= kWriteRegistersMaximum);
  GvcpPacket packet =
      begin_command(CommandCode::write_registers, request, CommandFlag::kAcknowledge);
  for (const RegisterValue& pair : registers) {
    packet.word(pair.address);
    packet.word(pair.value);
  }
  packet.finish();
  return packet;
}

GvcpPacket encode_read_memory(std::uint16_t request, std::uint32_t address, std::uint16_t count) {
  GvcpPacket packet = begin_command(CommandCode::read_memory, request, CommandFlag::kAcknowledge);
  packet.word(address);
  packet.half(0);
  packet.half(count);
  packet.finish();
  return packet;
}

GvcpPacket encode_write_memory(std::uint16_t request, std::uint32_t address,
                               std::span<const std::uint8_t> bytes) {
  assert(bytes.size() <= kMemoryMaximum);
  GvcpPacket packet = begin_command(CommandCode::write_memory, request, CommandFlag::kAcknowledge);
  packet.word(address);
  packet.append(bytes);
  packet.finish();
  return packet;
}

GvcpPacket begin_acknowledge(Status status, std::uint16_t acknowledge, std::uint16_t request) {
  GvcpPacket packet;
  packet.half(static_cast<std::uint16_t>(status));
  packet.half(acknowledge);
  packet.half(0);
  packet.half(request);
  return packet;
}

GvcpPacket encode_acknowledge(Status status, std::uint16_t acknowledge, std::uint16_t request) {
  return begin_acknowledge(status, acknowledge, request);
}

GvcpPacket encode_written(Status status, CommandCode command, std::uint16_t request,
                          std::uint16_t written) {
  GvcpPacket packet =
      begin_acknowledge(status, acknowledge_code(static_cast<std::uint16_t>(command)), request);
  packet.half(0);
  packet.half(written);
  packet.finish();
  return packet;
}

GvcpPacket encode_pending(std::uint16_t request, std::uint16_t milliseconds) {
  GvcpPacket packet = begin_acknowledge(Status::success, kPendingAcknowledge, request);
  packet.half(0);
  packet.half(milliseconds);
  packet.finish();
  return packet;
}

Decoded<Acknowledge> decode_acknowledge(std::span<const std::uint8_t> datagram) {
  if (datagram.size() < kGvcpHeaderSize) {
    return Incomplete{kGvcpHeaderSize, datagram.size()};
  }
  const std::size_t size = kGvcpHeaderSize + half(datagram, kLengthAt);
  if (datagram.size() < size) {
    return Incomplete{size, datagram.size()};
  }
  if (datagram.size() > size) {
    return Malformed{"bytes beyond the acknowledge's length", size};
  }
  return {Acknowledge{static_cast<Status>(half(datagram, kStatusAt)), half(datagram, kCodeAt),
                      half(datagram, kRequestAt), datagram.subspan(kGvcpHeaderSize)},
          size};
}

Decoded<WordView> decode_register_values(const Acknowledge& acknowledge) {
  if (acknowledge.payload.size() % 4 != 0) {
    return Malformed{"registers are whole words", kGvcpHeaderSize};
  }
  return {WordView(acknowledge.payload), acknowledge.payload.size()};
}

Decoded<MemoryContent> decode_memory(const Acknowledge& acknowledge) {
  if (acknowledge.payload.size() < 4) {
    return Incomplete{4, acknowledge.payload.size()};
  }
  return {MemoryContent{word(acknowledge.payload, 0), acknowledge.payload.subspan(4)},
          acknowledge.payload.size()};
}

Decoded<std::uint16_t> decode_count(const Acknowledge& acknowledge) {
  if (acknowledge.payload.size() < kCountSize) {
    return Incomplete{kCountSize, acknowledge.payload.size()};
  }
  return {half(acknowledge.payload, 2), kCountSize};
}

}  // namespace rigwire::protocols::gige_vision
