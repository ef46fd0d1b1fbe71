// A classic pcap file of Ethernet, IPv4 and UDP, as a network card would have seen a lidar's
// packets.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <span>
#include <vector>

#include "emulators/device.h"

namespace rigwire {

class UdpCapture {
 public:
  explicit UdpCapture(const std::filesystem::path& file) : out_(file, std::ios::binary) {
    put32(0xA1B2C3D4U);
    put16(2);
    put16(4);
    for (const std::uint32_t word : {0U, 0U, 65535U, 1U}) {
      put32(word);
    }
  }

  /// From 192.168.1.201 to everybody, both ends on the same port unless a source is given.
  void add(std::int64_t time_us, std::uint16_t port, std::span<const std::uint8_t> payload,
           std::uint16_t source_port = 0) {
    const auto length = static_cast<std::uint32_t>(14 + 20 + 8 + payload.size());
    put32(static_cast<std::uint32_t>(time_us / 1000000));
    put32(static_cast<std::uint32_t>(time_us % 1000000));
    put32(length);
    put32(length);
    std::array<std::uint8_t, 42> head{};
    head[12] = 0x08;  // IPv4
    head[14] = 0x45;
    big16(head, 16, static_cast<std::uint16_t>(20 + 8 + payload.size()));
    head[22] = 64;  // time to live
    head[23] = 17;  // UDP
    const std::array<std::uint8_t, 8> addresses{192, 168, 1, 201, 255, 255, 255, 255};
    std::ranges::copy(addresses, head.begin() + 26);
    std::uint32_t sum = 0;
    for (std::size_t i = 14; i < 34; i += 2) {
      sum += static_cast<std::uint32_t>(head[i] << 8U) + head[i + 1];
    }
    sum = (sum & 0xFFFFU) + (sum >> 16U);
    sum = (sum & 0xFFFFU) + (sum >> 16U);
    big16(head, 24, static_cast<std::uint16_t>(~sum));
    big16(head, 34, source_port == 0 ? port : source_port);
    big16(head, 36, port);
    big16(head, 38, static_cast<std::uint16_t>(8 + payload.size()));
    write(head);
    write(payload);
  }

  void close() { out_.close(); }

 private:
  static void big16(std::span<std::uint8_t> bytes, std::size_t at, std::uint16_t value) {
    bytes[at] = static_cast<std::uint8_t>(value >> 8U);
    bytes[at + 1] = static_cast<std::uint8_t>(value & 0xFFU);
  }
  void put32(std::uint32_t value) {
    for (int shift = 0; shift < 32; shift += 8) {
      out_.put(static_cast<char>((value >> shift) & 0xFFU));
    }
  }
  void put16(std::uint16_t value) {
    out_.put(static_cast<char>(value & 0xFFU));
    out_.put(static_cast<char>(value >> 8U));
  }
  void write(std::span<const std::uint8_t> bytes) {
    out_.write(reinterpret_cast<const char*>(bytes.data()),
               static_cast<std::streamsize>(bytes.size()));
  }
  std::ofstream out_;
};

/// A lidar's output into the capture, to one port.
class CaptureOutput final : public emulators::ByteOutput {
 public:
  CaptureOutput(UdpCapture& capture, std::uint16_t port) : capture_(capture), port_(port) {}
  void send(SimTime due, std::span<const std::uint8_t> bytes) override {
    capture_.add(due.time_since_epoch().count() / 1000, port_, bytes);
    ++sent;
  }
  std::int64_t sent = 0;

 private:
  UdpCapture& capture_;
  std::uint16_t port_;
};

}  // namespace rigwire
