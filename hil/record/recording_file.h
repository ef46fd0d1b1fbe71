// A file of a recording: it grows by whole blocks, and is valid after each of them, whatever
// happens to the program or the disk.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "drivers/descriptor.h"

namespace rigwire::hil {

/// Called once when something cannot be written, and once when it can again (`over`).
using TellTrouble = std::function<void(const std::string& what, bool over)>;

class RecordingFile {
 public:
  /// Makes the file, which must not be there. Throws drivers::EndpointError with path and reason.
  RecordingFile(std::filesystem::path path, TellTrouble tell);

  /// Writes all of it. Returns false when the disk took only a part or nothing; the file then ends
  /// where it did before. Waits for the disk, as long as that takes.
  bool write(std::span<const std::uint8_t> bytes);

  [[nodiscard]] std::uint64_t size() const { return size_; }
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
  TellTrouble tell_;
  drivers::Descriptor descriptor_;
  std::uint64_t size_ = 0;
  bool troubled_ = false;
};

/// Collects blocks, each of one track, and writes many at a time.
class BlockFile {
 public:
  BlockFile(std::filesystem::path path, TellTrouble tell)
      : file_(std::move(path), std::move(tell)) {}

  /// Buffer to which the next blocks are appended.
  [[nodiscard]] std::vector<std::uint8_t>& bytes() { return waiting_; }
  /// Ends a unit of that track: the bytes appended since the last call.
  void end_unit(std::size_t track);
  /// Writes the waiting blocks. Those that the disk does not take are lost, and counted by track.
  void flush();
  /// Returns how many units of the track were lost since the last call.
  [[nodiscard]] std::uint64_t take_lost(std::size_t track);

  static constexpr std::size_t kWorthWriting = 256 * 1024;

 private:
  RecordingFile file_;
  std::vector<std::uint8_t> waiting_;
  std::vector<std::uint64_t> units_;  ///< Waiting, by track.
  std::vector<std::uint64_t> lost_;   ///< By track.
};

}  // namespace rigwire::hil
