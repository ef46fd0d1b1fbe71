// Reports that every wire of a run is open, and receives that report.
#pragma once

#include <array>
#include <optional>
#include <string>

#include "drivers/descriptor.h"

namespace rigwire::hil {

/// Returns whether the descriptor is a file that users other than its owner may read.
[[nodiscard]] bool others_can_read(int descriptor);

/// Returns whether the descriptor is open for writing. To be called before anything is opened,
/// which could get its number.
[[nodiscard]] bool can_be_written(int descriptor);

/// Writes `line` and a line end to the descriptor and closes it; ignores a reader that has gone.
/// Precondition: can_be_written(descriptor).
void tell_ready(int descriptor, const std::string& line);

/// For a program that starts a run: a pipe that the run writes its line to.
class ReadyPipe {
 public:
  /// Throws drivers::EndpointError.
  ReadyPipe();

  /// Descriptor for the run to write to; programs that are started do not inherit it.
  [[nodiscard]] int written() const { return written_->get(); }
  /// Closes the written end on this side, once the run has it.
  void handed_over() { written_.reset(); }

  /// Descriptor for poll(): readable when something has arrived.
  [[nodiscard]] int descriptor() const { return heard_.get(); }
  /// Waits for something to read and reads it; returns the line, without its end, as soon as it is
  /// complete. Throws drivers::EndpointError when the run ended before.
  [[nodiscard]] std::optional<std::string> hear();

 private:
  explicit ReadyPipe(std::array<int, 2> ends);

  drivers::Descriptor heard_;
  std::optional<drivers::Descriptor> written_;
  std::string line_;
};

/// Notifies the service manager that the environment names (sd_notify(3), NOTIFY_SOCKET), if any.
void notify_service_manager();

}  // namespace rigwire::hil
