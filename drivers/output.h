// Output that another program reads while this one runs: standard output and error, a FIFO, a
// terminal, a device. The reader may stall, close or vanish; a write waits no longer than its
// deadline.
//
// A pipe's or a terminal's file description is shared with other programs (the shell that started
// this one, the next one in the pipeline), so that O_NONBLOCK on it would change theirs. Where the
// system permits it (/proc/self/fd), a description of our own is opened and made non-blocking.
// Where it does not, every write waits for poll() and is no longer than what is then certain to be
// taken: PIPE_BUF bytes by a pipe (POSIX.1-2017, write() and poll()).
//
// The process must ignore SIGPIPE; WriteEnd::closed reports a reader that has closed.
#pragma once

#include <chrono>
#include <string>
#include <string_view>

#include "drivers/descriptor.h"

namespace rigwire::drivers {

/// Ends waits, from another thread or a handler, once and for all. Throws EndpointError when the
/// system has no descriptor left for it.
class Interrupt {
 public:
  Interrupt();
  void raise() const;
  [[nodiscard]] int descriptor() const { return event_.get(); }

 private:
  Descriptor event_;
};

/// How a write ended.
enum class WriteEnd {
  whole,        ///< Everything was taken.
  late,         ///< The reader did not read in time.
  interrupted,  ///< By Interrupt::raise().
  closed,       ///< The reader is gone.
  failed        ///< The system refused; see Written::error.
};

struct Written {
  WriteEnd end = WriteEnd::whole;
  std::size_t bytes = 0;  ///< Bytes that were taken, also after an error.
  int error = 0;          ///< errno of `failed`.
};

class Output {
 public:
  using Deadline = std::chrono::steady_clock::time_point;

  /// Writes to where `descriptor` leads, which is left as it is and may be closed afterwards. One
  /// that is not open fails with the first write.
  explicit Output(int descriptor);

  /// Writes until everything is taken, `until` is past or `interrupt` is raised. A past deadline
  /// takes what can be taken at once.
  [[nodiscard]] Written write(std::string_view bytes, Deadline until,
                              const Interrupt* interrupt = nullptr) const;

 private:
  enum class Kind { unready, plain, socket, pipe, terminal };
  Output(int descriptor, Kind kind);
  [[nodiscard]] std::size_t piece(std::size_t left) const;
  /// The bytes taken, or -1 with errno set.
  [[nodiscard]] std::ptrdiff_t put(std::string_view bytes) const;

  Kind kind_;
  bool own_ = false;  ///< A description of our own, which never blocks.
  Descriptor descriptor_;
};

/// Opens a file that is not a regular one for writing (a FIFO, a terminal, a device) without
/// blocking: waits for the reader of a FIFO until `until`. Returns a negative descriptor with errno
/// set on failure; ENXIO: it has no reader.
[[nodiscard]] int open_for_reader(const std::string& path, Output::Deadline until);

}  // namespace rigwire::drivers
