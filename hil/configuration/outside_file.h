// The one place that opens files of others: those that a rig, a campaign, a recording or a command
// names.
//
// Opens only regular files, whatever links lead to them. A directory, a FIFO, a socket or a device
// is refused before it is opened, so that opening one never waits; the opened file is checked
// again, so that one cannot take its place. Each kind of file has a limit of size: a larger file is
// refused from the size that the file system reports, before a byte is read, and reading stops at
// the limit where that size is wrong (files of /proc, a file that grows).
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "drivers/descriptor.h"
#include "fields/visitor.h"

namespace rigwire::hil {

/// The maximum size, in bytes, of one kind of file.
struct FileLimit {
  std::string_view what;  ///< Name of the kind in docs/configuration.md.
  std::uint64_t bytes = 0;
};

inline constexpr std::uint64_t kKibibyte = 1024;
inline constexpr std::uint64_t kMebibyte = 1024 * kKibibyte;
inline constexpr std::uint64_t kGibibyte = 1024 * kMebibyte;

// Read whole.
inline constexpr FileLimit kSettingsFile{"settings that a device saved", 64 * kKibibyte};
inline constexpr FileLimit kCalibrationFile{"calibration of a lidar", kMebibyte};
inline constexpr FileLimit kConfigurationFile{"YAML of a rig, an include, a campaign, a profile",
                                              16 * kMebibyte};
inline constexpr FileLimit kValveMapFile{"valve map", 16 * kMebibyte};
inline constexpr FileLimit kBindingFile{"binding of a DBC file", 16 * kMebibyte};
inline constexpr FileLimit kMaterialFile{"material library (MTL)", 16 * kMebibyte};
inline constexpr FileLimit kDbcFile{"DBC", 32 * kMebibyte};
inline constexpr FileLimit kSatellitesFile{"RINEX navigation file or almanac", 64 * kMebibyte};
inline constexpr FileLimit kTableFile{"table (CSV)", 64 * kMebibyte};
inline constexpr FileLimit kResultFile{"result or description (JSON)", 64 * kMebibyte};
inline constexpr FileLimit kImageFile{"PNG of a texture or a height map", 512 * kMebibyte};
inline constexpr FileLimit kMeshFile{"mesh, buffer of a mesh", 512 * kMebibyte};
inline constexpr FileLimit kLogFile{"replayed log of NMEA or UBX", 512 * kMebibyte};
inline constexpr FileLimit kGeoidFile{"geoid (GTX)", kGibibyte};
inline constexpr FileLimit kOtherFile{"any other file", kGibibyte};
// Read in pieces.
inline constexpr FileLimit kHeightMapFile{"height map (GeoTIFF)", 4 * kGibibyte};
inline constexpr FileLimit kMotionFile{"recorded motion (CSV, MCAP)", 4 * kGibibyte};
inline constexpr FileLimit kReplayFile{"replayed capture, candump log, bytes with an index",
                                       64 * kGibibyte};
inline constexpr FileLimit kRecordingFile{"packets or truth of a recording", 1024 * kGibibyte};

/// All kinds, as in docs/configuration.md.
inline constexpr std::array<FileLimit, 19> kFileLimits{
    kSettingsFile,  kCalibrationFile, kConfigurationFile, kValveMapFile, kBindingFile,
    kMaterialFile,  kDbcFile,         kSatellitesFile,    kTableFile,    kResultFile,
    kImageFile,     kMeshFile,        kLogFile,           kGeoidFile,    kOtherFile,
    kHeightMapFile, kMotionFile,      kReplayFile,        kRecordingFile};

/// Longest line of a text file that is read line by line, bytes.
inline constexpr std::uint64_t kMaxLineBytes = 4 * kMebibyte;

/// Returns the maximum size of a file that a key of this kind may name.
[[nodiscard]] FileLimit limit_of(fields::FileKind kind);

/// "16 MiB"; in bytes where it is no whole number of them.
[[nodiscard]] std::string size_text(std::uint64_t bytes);

/// A file that is not opened, or not read on. what() is "FILE: REASON, found FOUND, allowed
/// ALLOWED".
class FileRefused : public std::invalid_argument {
 public:
  /// `error`: the system's number (errno), 0 where the system did not refuse it.
  FileRefused(const std::filesystem::path& file, int error, std::string reason,
              std::string found = {}, std::string allowed = {});

  /// There is no file of that name.
  [[nodiscard]] bool missing() const;
  [[nodiscard]] int error() const { return error_; }
  /// "too large", or the system's words ("Permission denied").
  [[nodiscard]] const std::string& reason() const { return reason_; }
  [[nodiscard]] const std::string& found() const { return found_; }
  [[nodiscard]] const std::string& allowed() const { return allowed_; }
  /// "FILE: too large", for who shows the rest by itself.
  [[nodiscard]] std::string path_and_reason() const { return file_ + ": " + reason_; }
  /// Reason, what was found and what is allowed, without the file.
  [[nodiscard]] std::string rest() const;

 private:
  std::string file_;
  int error_;
  std::string reason_;
  std::string found_;
  std::string allowed_;
};

/// A regular file that is open for reading.
class OutsideFile {
 public:
  /// Throws FileRefused.
  OutsideFile(std::filesystem::path file, FileLimit limit);

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  /// In bytes, when it was opened; 0 of files of /proc that have content.
  [[nodiscard]] std::uint64_t size() const { return size_; }

  /// Reads on until `into` is full or the file ends. Returns how many bytes it read. Throws
  /// FileRefused where the system fails, or where the file has more than its limit.
  std::size_t read(std::span<std::uint8_t> into);
  /// The next byte to read, from the beginning; may be behind the end.
  void seek(std::uint64_t offset) { at_ = offset; }
  /// Reads what is left. Throws FileRefused as read(), and where memory does not suffice.
  [[nodiscard]] std::string read_rest();

  /// Hands the descriptor over, for a library that closes it. The file cannot be read by this
  /// object any more.
  [[nodiscard]] int release() { return descriptor_->release(); }

 private:
  std::filesystem::path path_;
  FileLimit limit_;
  std::unique_ptr<drivers::Descriptor> descriptor_;
  std::uint64_t size_ = 0;
  std::uint64_t at_ = 0;
};

/// Returns all of a file. Throws FileRefused.
[[nodiscard]] std::string read_outside_file(const std::filesystem::path& file, FileLimit limit);

/// Lines of a text file, of which one is kept at a time.
class LineReader {
 public:
  /// Throws FileRefused as OutsideFile.
  LineReader(const std::filesystem::path& file, FileLimit limit) : file_(file, limit) {}

  /// Reads the next line, without its line feed. False at the end. Throws FileRefused naming the
  /// line that is longer than kMaxLineBytes.
  bool next(std::string& line);
  /// Whether the last line ended with a line feed, not with the file.
  [[nodiscard]] bool whole() const { return whole_; }

 private:
  OutsideFile file_;
  std::vector<std::uint8_t> piece_;
  std::size_t begin_ = 0;  ///< Index of the first unread byte in `piece_`.
  std::uint64_t number_ = 0;
  bool whole_ = false;
};

/// Returns the absolute path with links resolved. Where the links' text leads elsewhere, as that of
/// an open file without a name (/proc/self/fd/5), returns the absolute path as it is.
[[nodiscard]] std::string resolved_path(const std::filesystem::path& file);

}  // namespace rigwire::hil
