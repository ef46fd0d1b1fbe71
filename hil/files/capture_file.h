// A capture as tcpdump, Wireshark or `rigwire run --record` write it (pcap, pcapng), packet by
// packet: memory is that of one packet, whatever the file's size.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "hil/configuration/outside_file.h"
#include "protocols/pcapng/pcap.h"
#include "protocols/pcapng/pcapng.h"

namespace rigwire::hil {

struct CapturedPacket {
  protocols::pcapng::Packet packet;
  protocols::pcapng::Interface interface;
};

class CaptureFile {
 public:
  /// Throws drivers::EndpointError where the file cannot be read, std::invalid_argument where it is
  /// no capture. `limit`: of the file's size.
  explicit CaptureFile(const std::filesystem::path& path, FileLimit limit = kReplayFile);

  /// Whether a file begins as a capture. False: it cannot be read, too.
  [[nodiscard]] static bool is_one(const std::filesystem::path& path);

  /// The next packet in the order of the file, which is not always that of time; null at the end.
  /// Valid until the next call. Throws std::invalid_argument naming file and byte where it is
  /// malformed.
  [[nodiscard]] const CapturedPacket* next();
  /// After the end: the file ended in the middle of a packet. What was whole has been handed out.
  [[nodiscard]] bool truncated() const { return truncated_; }
  /// The program that wrote what was read last; empty where the file does not name it.
  [[nodiscard]] const std::string& application() const { return application_; }
  /// Packets so far that were passed over, since their blocks have no time.
  [[nodiscard]] std::uint64_t without_time() const { return without_time_; }
  [[nodiscard]] const std::filesystem::path& path() const { return file_.path(); }

 private:
  /// More of the file behind what is left of it; false: there is no more.
  bool read_more();
  void pass_over(const protocols::pcapng::Block& block);
  [[noreturn]] void refuse(const protocols::Malformed& fault) const;

  OutsideFile file_;
  std::vector<std::uint8_t> bytes_;
  std::size_t at_ = 0;        ///< Index of the next unread byte in `bytes_`.
  std::uint64_t offset_ = 0;  ///< Offset of `bytes_` in the file.
  bool truncated_ = false;
  std::optional<protocols::pcapng::PcapReader> pcap_;  ///< Nothing: it is pcapng.
  protocols::pcapng::Reader pcapng_;
  CapturedPacket packet_;
  std::string application_;
  std::uint64_t without_time_ = 0;
};

}  // namespace rigwire::hil
