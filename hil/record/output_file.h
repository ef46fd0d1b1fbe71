// Files that a run writes for people and scripts: its report, complete at the end, and its truth,
// while it runs. The kind of file at the path decides how:
//
//   regular file, nothing   report: a temporary file beside it takes its place (rename), so that a
//                           reader sees the old report or the new one, and the old one's
//                           permissions stay. Truth: the file itself, from its beginning, so that
//                           it can be followed and is there when the run is killed.
//   symbolic link           its target, whether that exists or not; the link stays.
//   FIFO, terminal, device  written through, never replaced. A FIFO needs a reader.
//   standard output's or    written through that, after what is there.
//   error's own file
//   directory, socket       refused.
//
// A regular file in a folder that takes no new file is written in place.
#pragma once

#include <atomic>
#include <chrono>
#include <cstddef>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "drivers/output.h"

namespace rigwire::hil {

/// Reports what a run promised to write and could not: once for each file, at once; the run
/// continues and ends with exit code 1.
class OutputFailures {
 public:
  /// `say` is called on the thread that failed and must not block.
  explicit OutputFailures(std::function<void(const std::string&)> say) : say_(std::move(say)) {}
  OutputFailures(const OutputFailures&) = delete;
  OutputFailures& operator=(const OutputFailures&) = delete;

  /// From any thread.
  void report(const std::string& what) {
    any_ = true;
    say_(what);
  }
  [[nodiscard]] bool any() const { return any_; }

 private:
  std::function<void(const std::string&)> say_;
  std::atomic<bool> any_{false};
};

/// Time limit for a reader to open a FIFO, and for any reader to read.
inline constexpr std::chrono::seconds kReaderPatience{2};

enum class FileReaders {
  as_usual,  ///< Mode of the replaced file, otherwise by the umask.
  owner      ///< The owner only: the text holds a secret.
};

/// Writes the report or another text at once.
class WholeFile {
 public:
  /// `path` "-" is standard output; `what` names the file in messages ("the report"). Checks that
  /// it can be written, and changes nothing. Throws drivers::EndpointError with path and reason.
  WholeFile(std::string what, const std::string& path, FileReaders readers = FileReaders::as_usual);

  /// Throws std::runtime_error with path and reason; no temporary file is left then.
  void write(std::string_view text) const;

 private:
  enum class Way { standard_output, replaced, in_place, through };
  void write_beside(std::string_view text) const;
  void write_in_place(std::string_view text) const;
  void write_through(const drivers::Output& output, std::string_view text) const;
  [[nodiscard]] std::string cannot(const std::string& why) const;

  std::string what_;
  std::string shown_;           ///< The path as the user wrote it.
  std::filesystem::path file_;  ///< With links resolved.
  Way way_ = Way::replaced;
  FileReaders readers_ = FileReaders::as_usual;
};

/// A truth file, which grows with the run. A write error is reported once; what follows is dropped.
class GrowingFile {
 public:
  /// Opens and empties it. `failures` may be null; it must outlive the file. Waits up to `patience`
  /// for a reader that stalls, when more than `kBacklogBytes` have not been taken. Throws
  /// drivers::EndpointError.
  GrowingFile(std::string what, const std::string& path, OutputFailures* failures,
              std::chrono::milliseconds patience);
  /// Gives the reader kReaderPatience for the rest.
  ~GrowingFile();
  GrowingFile(const GrowingFile&) = delete;
  GrowingFile& operator=(const GrowingFile&) = delete;

  void write(std::string_view bytes);

  static constexpr std::size_t kPieceBytes = 4096;  ///< Collected before the system is called.
  static constexpr std::size_t kBacklogBytes = 32 * 1024 * 1024;  ///< For a reader that is slow.

 private:
  void hand_over(drivers::Output::Deadline until, std::size_t may_stay);
  void fail(const std::string& why);

  std::string what_;
  std::string shown_;
  OutputFailures* failures_;
  std::chrono::milliseconds patience_;
  std::optional<drivers::Output> output_;
  std::string waiting_;  ///< From `taken_` on.
  std::size_t taken_ = 0;
  bool failed_ = false;
};

}  // namespace rigwire::hil
