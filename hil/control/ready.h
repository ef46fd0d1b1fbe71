// Telling whoever started a run that every wire is open, and hearing it.
#pragma once

#include <array>
#include <optional>
#include <string>

#include "drivers/descriptor.h"

namespace rigwire::hil {

/// Returns whether the descriptor is a file that users other than its owner may read.
[[nodiscard]] bool others_can_read(int descriptor);

/// Whether a descriptor is there to be written. Asked before anything is opened, which could get
/// its number.
[[nodiscard]] bool can_be_written(int descriptor);

/// Writes `line` and its end to the descriptor and closes it; a reader that has gone is no fault of
/// the run. Precondition: can_be_written(descriptor).
void tell_ready(int descriptor, const std::string& line);

/// For who starts a run: a pipe that the run writes its line to.
class ReadyPipe {
 public:
  /// Throws drivers::EndpointError.
  ReadyPipe();

  /// The run's end; programs that are started do not inherit it.
  [[nodiscard]] int written() const { return written_->get(); }
  /// The run has its end: it is closed on this side.
  void handed_over() { written_.reset(); }

  /// Becomes readable, for poll(), when there is something to hear.
  [[nodiscard]] int descriptor() const { return heard_.get(); }
  /// Reads what is there, waiting for something: the line, without its end, as soon as it is whole.
  /// Throws drivers::EndpointError when the run ended before.
  [[nodiscard]] std::optional<std::string> hear();

 private:
  explicit ReadyPipe(std::array<int, 2> ends);

  drivers::Descriptor heard_;
  std::optional<drivers::Descriptor> written_;
  std::string line_;
};

/// Tells a service manager, where the environment names one (sd_notify(3), NOTIFY_SOCKET).
void notify_service_manager();

}  // namespace rigwire::hil
