// What a node sends on a CAN bus as a capture file, and what tshark's J1939 dissector, which shares
// no table with us, makes of it.
#pragma once

#include <gtest/gtest.h>

#include <array>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "emulators/device.h"

namespace rigwire::emulators {

using namespace std::chrono_literals;

/// A classic pcap file of link type 227: SocketCAN frames, identifier most significant byte first.
class CanCapture final : public FrameOutput {
 public:
  explicit CanCapture(const std::filesystem::path& file) : out_(file, std::ios::binary) {
    constexpr std::uint32_t kSocketCan = 227;
    for (const std::uint32_t word : {0xA1B2C3D4U, 0x00040002U, 0U, 0U, 65535U, kSocketCan}) {
      put32(word);
    }
  }
  void send(SimTime due, const protocols::can::Frame& frame) override {
    const auto us = due.time_since_epoch() / 1us;
    constexpr std::uint32_t kBytes = 4 + 1 + 3 + 8;  // identifier, length, reserved, data
    put32(static_cast<std::uint32_t>(us / 1000000));
    put32(static_cast<std::uint32_t>(us % 1000000));
    put32(kBytes);
    put32(kBytes);
    const std::uint32_t id = frame.id | (frame.extended ? 0x80000000U : 0U);
    for (int shift = 24; shift >= 0; shift -= 8) {
      out_.put(static_cast<char>((id >> shift) & 0xFFU));
    }
    out_.put(static_cast<char>(frame.length));
    out_.write("\0\0\0", 3);
    for (const std::uint8_t byte : frame.data) {
      out_.put(static_cast<char>(byte));
    }
    ++sent;
  }
  void close() { out_.close(); }
  int sent = 0;

 private:
  void put32(std::uint32_t value) {
    for (int shift = 0; shift < 32; shift += 8) {
      out_.put(static_cast<char>((value >> shift) & 0xFFU));
    }
  }
  std::ofstream out_;
};

/// One frame as tshark prints it.
struct Seen {
  double time_s = 0.0;
  unsigned priority = 0;
  unsigned pgn = 0;
  unsigned source = 0;
  unsigned destination = 0;  ///< 255 also where the group has none.
  std::vector<unsigned> bytes;

  [[nodiscard]] unsigned word(std::size_t first) const {
    return bytes.at(first) + 256U * bytes.at(first + 1);
  }
};

inline std::vector<Seen> tshark(const std::filesystem::path& file) {
  const std::string command =
      "tshark -r '" + file.string() +
      "' -d can.subdissector,j1939 -T fields -E separator=, -e frame.time_relative"
      " -e j1939.priority -e j1939.pgn -e j1939.src_addr -e j1939.dst_addr -e j1939.data 2>&1";
  std::string text;
  FILE* pipe = popen(command.c_str(), "r");
  std::array<char, 4096> piece{};
  while (pipe != nullptr &&
         std::fgets(piece.data(), static_cast<int>(piece.size()), pipe) != nullptr) {
    text += piece.data();
  }
  EXPECT_EQ(pipe == nullptr ? -1 : pclose(pipe), 0) << text;
  std::vector<Seen> frames;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    std::vector<std::string> words;
    std::istringstream columns(line);
    for (std::string word; std::getline(columns, word, ',');) {
      words.push_back(word);
    }
    if (words.size() != 6) {
      continue;  // its warning about running as root
    }
    Seen frame;
    frame.time_s = std::stod(words[0]);
    frame.priority = static_cast<unsigned>(std::stoul(words[1]));
    frame.pgn = static_cast<unsigned>(std::stoul(words[2]));
    frame.source = static_cast<unsigned>(std::stoul(words[3]));
    frame.destination = words[4].empty() ? 255U : static_cast<unsigned>(std::stoul(words[4]));
    std::string data = words[5];
    std::erase(data, ':');
    for (std::size_t i = 0; i + 1 < data.size(); i += 2) {
      frame.bytes.push_back(static_cast<unsigned>(std::stoul(data.substr(i, 2), nullptr, 16)));
    }
    frames.push_back(frame);
  }
  return frames;
}

}  // namespace rigwire::emulators
