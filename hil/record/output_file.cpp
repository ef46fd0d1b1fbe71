#include "hil/record/output_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>

#include <cerrno>
#include <cstdio>
#include <stdexcept>
#include <system_error>

#include "drivers/descriptor.h"
#include "drivers/endpoints.h"

namespace rigwire::hil {
namespace {

namespace fs = std::filesystem;
using drivers::Descriptor;
using drivers::Output;
using drivers::WriteEnd;

constexpr mode_t kNewFileMode = 0666;  // less the process's umask
constexpr mode_t kPermissionBits = 07777;
constexpr int kMostLinks = 40;  // as the kernel's path walk (path_resolution(7))

std::string reason(int error) {
  return std::generic_category().message(error);
}

std::string why_not(const drivers::Written& written) {
  switch (written.end) {
    case WriteEnd::late:
      return "its reader does not read";
    case WriteEnd::closed:
      return "its reader has closed it";
    case WriteEnd::interrupted:
      return "interrupted";
    case WriteEnd::whole:
    case WriteEnd::failed:
      break;
  }
  return reason(written.error);
}

Output::Deadline after(std::chrono::milliseconds patience) {
  return std::chrono::steady_clock::now() + patience;
}

/// Standard output or error when it is that very file, else -1: replacing or emptying it would take
/// what the shell has redirected there.
int standard_descriptor_of(const struct stat& file) {
  for (const int descriptor : {STDOUT_FILENO, STDERR_FILENO}) {
    struct stat standard {};
    if (S_ISREG(file.st_mode) && ::fstat(descriptor, &standard) == 0 &&
        standard.st_dev == file.st_dev && standard.st_ino == file.st_ino) {
      return descriptor;
    }
  }
  return -1;
}

/// Follows links, also to a file that does not exist yet.
fs::path resolved(fs::path path) {
  std::error_code error;
  for (int i = 0; i < kMostLinks && fs::is_symlink(fs::symlink_status(path, error)); ++i) {
    const fs::path target = fs::read_symlink(path, error);
    if (error) {
      break;
    }
    path = target.is_absolute() ? target : path.parent_path() / target;
  }
  return path;
}

fs::path folder_of(const fs::path& file) {
  return file.has_parent_path() ? file.parent_path() : fs::path(".");
}

/// A name that no other running program chooses, in the file's folder.
fs::path beside(const fs::path& file) {
  return folder_of(file) / fmt::format(".rigwire-{}.tmp", ::getpid());
}

int make_file(const fs::path& path) {
  return ::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, kNewFileMode);
}

/// A temporary file; gone again unless it has taken its place.
class Temporary {
 public:
  explicit Temporary(fs::path path) : path_(std::move(path)), descriptor_(make_file(path_)) {}
  ~Temporary() {
    if (descriptor_.open() && !placed_) {
      ::unlink(path_.c_str());
    }
  }
  Temporary(const Temporary&) = delete;
  Temporary& operator=(const Temporary&) = delete;

  [[nodiscard]] bool open() const { return descriptor_.open(); }
  [[nodiscard]] int descriptor() const { return descriptor_.get(); }
  [[nodiscard]] bool take_place_of(const fs::path& file) {
    placed_ = ::rename(path_.c_str(), file.c_str()) == 0;
    return placed_;
  }

 private:
  fs::path path_;
  Descriptor descriptor_;
  bool placed_ = false;
};

[[noreturn]] void refuse(const std::string& what, const std::string& shown,
                         const std::string& why) {
  throw drivers::EndpointError(fmt::format("{} {}: {}", what, shown, why));
}

/// What no one can write to as a file.
void refuse_by_kind(const std::string& what, const std::string& shown, const struct stat& file) {
  if (S_ISDIR(file.st_mode)) {
    refuse(what, shown, "a directory is there; give a file in it");
  }
  if (S_ISSOCK(file.st_mode)) {
    refuse(what, shown, "a socket is there; give a file, a FIFO or a device");
  }
}

}  // namespace

WholeFile::WholeFile(std::string what, const std::string& path, FileReaders readers)
    : what_(std::move(what)), shown_(path), file_(path), readers_(readers) {
  if (path == "-") {
    way_ = Way::standard_output;
    shown_ = "on standard output";
    return;
  }
  struct stat there {};
  if (::stat(path.c_str(), &there) == 0) {
    refuse_by_kind(what_, shown_, there);
    if (::access(path.c_str(), W_OK) != 0) {
      refuse(what_, shown_, "cannot be written: " + reason(errno));
    }
    if (!S_ISREG(there.st_mode) || standard_descriptor_of(there) >= 0) {
      way_ = Way::through;
      return;
    }
  } else if (errno != ENOENT) {
    refuse(what_, shown_, "cannot be written: " + reason(errno));
  }
  const bool exists = S_ISREG(there.st_mode);
  file_ = resolved(path);
  const Temporary trial(beside(file_));
  if (!trial.open()) {
    if (!exists) {
      refuse(what_, shown_, "cannot be written: " + reason(errno));
    }
    way_ = Way::in_place;
  }
}

std::string WholeFile::cannot(const std::string& why) const {
  return fmt::format("{} {} is not written: {}", what_, shown_, why);
}

void WholeFile::write_through(const Output& output, std::string_view text) const {
  const drivers::Written written = output.write(text, after(kReaderPatience));
  if (written.end != WriteEnd::whole) {
    throw std::runtime_error(cannot(why_not(written)));
  }
}

void WholeFile::write_beside(std::string_view text) const {
  Temporary temporary(beside(file_));
  if (!temporary.open()) {
    throw std::runtime_error(cannot(reason(errno)));
  }
  struct stat there {};
  if (readers_ == FileReaders::owner) {
    static_cast<void>(!::fchmod(temporary.descriptor(), S_IRUSR | S_IWUSR));
  } else if (::stat(file_.c_str(), &there) == 0) {
    // Keep owner and mode of the old file; a user who may not change the owner becomes the owner.
    static_cast<void>(!::fchown(temporary.descriptor(), there.st_uid, there.st_gid));
    static_cast<void>(!::fchmod(temporary.descriptor(), there.st_mode & kPermissionBits));
  }
  write_through(Output(temporary.descriptor()), text);
  if (temporary.take_place_of(file_)) {
    return;
  }
  if (errno != EBUSY) {
    throw std::runtime_error(cannot(reason(errno)));
  }
  write_in_place(text);  // a file that is a mount point by itself, as containers are given some
}

void WholeFile::write_in_place(std::string_view text) const {
  const Descriptor opened(::open(file_.c_str(), O_WRONLY | O_TRUNC | O_CLOEXEC));
  if (!opened.open()) {
    throw std::runtime_error(cannot(reason(errno)));
  }
  write_through(Output(opened.get()), text);
}

void WholeFile::write(std::string_view text) const {
  switch (way_) {
    case Way::standard_output:
      write_through(Output(STDOUT_FILENO), text);
      return;
    case Way::replaced:
      write_beside(text);
      return;
    case Way::in_place:
      write_in_place(text);
      return;
    case Way::through:
      break;
  }
  struct stat there {};
  if (::stat(file_.c_str(), &there) == 0) {
    if (const int standard = standard_descriptor_of(there); standard >= 0) {
      write_through(Output(standard), text);
      return;
    }
  }
  const Descriptor opened(drivers::open_for_reader(file_, after(kReaderPatience)));
  if (!opened.open()) {
    throw std::runtime_error(cannot(errno == ENXIO ? "it has no reader" : reason(errno)));
  }
  write_through(Output(opened.get()), text);
}

GrowingFile::GrowingFile(std::string what, const std::string& path, OutputFailures* failures,
                         std::chrono::milliseconds patience)
    : what_(std::move(what)), shown_(path), failures_(failures), patience_(patience) {
  struct stat there {};
  const bool exists = ::stat(path.c_str(), &there) == 0;
  if (exists) {
    refuse_by_kind(what_, shown_, there);
    if (const int standard = standard_descriptor_of(there); standard >= 0) {
      output_.emplace(standard);
      return;
    }
  }
  const Descriptor opened(
      exists && !S_ISREG(there.st_mode)
          ? drivers::open_for_reader(path, after(kReaderPatience))
          : ::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, kNewFileMode));
  if (!opened.open()) {
    refuse(what_, shown_,
           errno == ENXIO ? "it has no reader" : "cannot be written: " + reason(errno));
  }
  output_.emplace(opened.get());
}

GrowingFile::~GrowingFile() {
  hand_over(after(kReaderPatience), 0);
}

void GrowingFile::write(std::string_view bytes) {
  if (failed_) {
    return;
  }
  waiting_ += bytes;
  if (waiting_.size() - taken_ >= kPieceBytes) {
    hand_over(after(std::chrono::milliseconds{0}), kBacklogBytes);
  }
}

void GrowingFile::hand_over(Output::Deadline until, std::size_t may_stay) {
  if (failed_) {
    return;
  }
  const auto offer = [&](Output::Deadline deadline) {
    const drivers::Written written =
        output_->write(std::string_view(waiting_).substr(taken_), deadline);
    taken_ += written.bytes;
    return written;
  };
  drivers::Written written = offer(until);
  // A reader who is slow and goes on reading is waited for again and again.
  while (written.end == WriteEnd::late && waiting_.size() - taken_ > may_stay && may_stay > 0) {
    written = offer(after(patience_));
    if (written.end == WriteEnd::late && written.bytes == 0) {
      break;
    }
  }
  const bool too_much = waiting_.size() - taken_ > may_stay;
  if (written.end != WriteEnd::whole && (written.end != WriteEnd::late || too_much)) {
    fail(why_not(written));
    return;
  }
  if (taken_ == waiting_.size()) {
    waiting_.clear();
    taken_ = 0;
  } else if (taken_ >= kBacklogBytes) {
    waiting_.erase(0, taken_);
    taken_ = 0;
  }
}

void GrowingFile::fail(const std::string& why) {
  failed_ = true;
  waiting_ = {};
  taken_ = 0;
  if (failures_ != nullptr) {
    failures_->report(fmt::format("{} {} is not complete: {}", what_, shown_, why));
  }
}

}  // namespace rigwire::hil
