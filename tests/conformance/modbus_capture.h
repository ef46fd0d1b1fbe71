// Writes recorded segments as a pcap file of TCP over IPv4, server port 502, so that tshark reads
// them as a capture of the wire. (A live capture would need root.)
#pragma once

#include <cstdint>
#include <fstream>
#include <map>
#include <string>
#include <vector>

#include "modbus_rig.h"
#include "protocols/bytes.h"

namespace rigwire::conformance {

inline void write_capture(const std::string& path, const std::vector<Segment>& segments) {
  using protocols::store_big;
  using protocols::store_little;
  constexpr std::uint32_t kRawIp = 101;  // LINKTYPE_RAW
  constexpr std::size_t kIpHeader = 20;
  constexpr std::size_t kTcpHeader = 20;
  constexpr std::uint8_t kPushAndAcknowledge = 0x18;
  std::ofstream file(path, std::ios::binary);
  const auto put = [&file](const std::vector<std::uint8_t>& bytes) {
    file.write(reinterpret_cast<const char*>(bytes.data()),
               static_cast<std::streamsize>(bytes.size()));
  };
  std::vector<std::uint8_t> head(24);
  store_little<std::uint32_t>(head, 0, 0xA1B2C3D4);
  store_little<std::uint16_t>(head, 4, 2);
  store_little<std::uint16_t>(head, 6, 4);
  store_little<std::uint32_t>(head, 16, 65535);
  store_little<std::uint32_t>(head, 20, kRawIp);
  put(head);
  struct Sequence {
    std::uint32_t client = 1;
    std::uint32_t server = 1;
  };
  std::map<std::uint64_t, Sequence> sequences;
  for (const Segment& segment : segments) {
    auto& sequence = sequences[segment.connection];
    const auto size = static_cast<std::uint32_t>(kIpHeader + kTcpHeader + segment.bytes.size());
    std::vector<std::uint8_t> packet(16 + kIpHeader + kTcpHeader);
    store_little<std::uint32_t>(packet, 0,
                                static_cast<std::uint32_t>(segment.when.count() / 1'000'000'000));
    store_little<std::uint32_t>(
        packet, 4, static_cast<std::uint32_t>(segment.when.count() % 1'000'000'000 / 1000));
    store_little<std::uint32_t>(packet, 8, size);
    store_little<std::uint32_t>(packet, 12, size);
    const auto ip = std::span(packet).subspan(16);
    ip[0] = 0x45;
    store_big<std::uint16_t>(ip, 2, static_cast<std::uint16_t>(size));
    ip[8] = 64;
    ip[9] = 6;
    store_big<std::uint32_t>(ip, 12, 0x7F000001);
    store_big<std::uint32_t>(ip, 16, 0x7F000001);
    const auto tcp = ip.subspan(kIpHeader);
    const auto client_port = static_cast<std::uint16_t>(40000 + segment.connection);
    store_big<std::uint16_t>(tcp, 0, segment.from_client ? client_port : std::uint16_t{502});
    store_big<std::uint16_t>(tcp, 2, segment.from_client ? std::uint16_t{502} : client_port);
    store_big(tcp, 4, segment.from_client ? sequence.client : sequence.server);
    store_big(tcp, 8, segment.from_client ? sequence.server : sequence.client);
    tcp[12] = 0x50;
    tcp[13] = kPushAndAcknowledge;
    store_big<std::uint16_t>(tcp, 14, 65535);
    put(packet);
    put(segment.bytes);
    (segment.from_client ? sequence.client : sequence.server) +=
        static_cast<std::uint32_t>(segment.bytes.size());
  }
}

}  // namespace rigwire::conformance
