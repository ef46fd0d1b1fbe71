// A file of a recording: it grows by whole blocks, and is good after each of them, whatever happens
// to the program or the disk.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "drivers/descriptor.h"

namespace rigwire::hil {

/// Told once when something cannot be written, and once when it can again.
using TellTrouble = std::function<void(const std::string& what, bool over)>;

class RecordingFile {
 public:
  /// Makes the file, which must not be there. Throws drivers::EndpointError with path and reason.
  RecordingFile(std::filesystem::path path, TellTrouble tell);

  /// Writes all of it. False: the disk took it in part or not at all; the file ends where it did
  /// before. Waits for the disk, as long as that takes.
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

/// Collects blocks, of which each belongs to a track, and hands them over many at a time.
class BlockFile {
 public:
  BlockFile(std::filesystem::path path, TellTrouble tell)
      : file_(std::move(path), std::move(tell)) {}

  /// To be filled with the next blocks.
  [[nodiscard]] std::vector<std::uint8_t>& bytes() { return waiting_; }
  /// What was just appended is one unit of that track.
  void end_unit(std::size_t track);
  /// Writes what waits. What the disk does not take is lost, and counted by track.
  void flush();
  /// How many units of the track were lost since the last call.
  [[nodiscard]] std::uint64_t take_lost(std::size_t track);

  static constexpr std::size_t kWorthWriting = 256 * 1024;

 private:
  RecordingFile file_;
  std::vector<std::uint8_t> waiting_;
  std::vector<std::uint64_t> units_;  ///< Waiting, by track.
  std::vector<std::uint64_t> lost_;   ///< By track.
};

}  // namespace rigwire::hil
