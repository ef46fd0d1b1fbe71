#include "hil/record/recording_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <functional>
#include <system_error>
#include <utility>

#include "drivers/endpoints.h"

namespace rigwire::hil {
namespace {

constexpr mode_t kMode = 0666;  // less the process's umask

std::string text_of_error(int error) {
  return std::generic_category().message(error);
}

}  // namespace

RecordingFile::RecordingFile(std::filesystem::path path, TellTrouble tell)
    : path_(std::move(path)),
      tell_(std::move(tell)),
      descriptor_(::open(path_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, kMode)) {
  if (!descriptor_.open()) {
    throw drivers::EndpointError(fmt::format("the recording {}: cannot be written: {}",
                                             path_.string(), text_of_error(errno)));
  }
}

bool RecordingFile::write(std::span<const std::uint8_t> bytes) {
  int error = 0;
  std::size_t taken = 0;
  while (taken < bytes.size()) {
    const ::ssize_t count = ::write(descriptor_.get(), bytes.data() + taken, bytes.size() - taken);
    if (count >= 0) {
      taken += static_cast<std::size_t>(count);
    } else if (errno != EINTR) {
      error = errno;
      break;
    }
  }
  if (error == 0) {
    size_ += bytes.size();
    if (std::exchange(troubled_, false)) {
      tell_(fmt::format("{} can be written again", path_.string()), true);
    }
    return true;
  }
  // A block that was taken in part would hide all that follow.
  const auto end = static_cast<::off_t>(size_);
  static_cast<void>(::ftruncate(descriptor_.get(), end) == 0 &&
                    ::lseek(descriptor_.get(), end, SEEK_SET) == end);
  if (!std::exchange(troubled_, true)) {
    tell_(fmt::format("{} loses what passes: {}", path_.string(), text_of_error(error)), false);
  }
  return false;
}

void BlockFile::end_unit(std::size_t track) {
  units_.resize(std::max(units_.size(), track + 1));
  ++units_[track];
  if (waiting_.size() >= kWorthWriting) {
    flush();
  }
}

void BlockFile::flush() {
  if (waiting_.empty()) {
    return;
  }
  if (!file_.write(waiting_)) {
    lost_.resize(std::max(lost_.size(), units_.size()));
    std::ranges::transform(units_, lost_, lost_.begin(), std::plus{});
  }
  std::ranges::fill(units_, 0U);
  waiting_.clear();
}

std::uint64_t BlockFile::take_lost(std::size_t track) {
  return track < lost_.size() ? std::exchange(lost_[track], 0) : 0;
}

}  // namespace rigwire::hil
