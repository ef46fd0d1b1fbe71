#include "hil/configuration/outside_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <limits>
#include <new>
#include <system_error>
#include <utility>

#include "hil/configuration/plain_text.h"

namespace rigwire::hil {

namespace fs = std::filesystem;

namespace {

std::string_view kind_of_file(mode_t mode) {
  switch (mode & S_IFMT) {
    case S_IFDIR:
      return "a directory";
    case S_IFIFO:
      return "a FIFO";
    case S_IFSOCK:
      return "a socket";
    case S_IFCHR:
      return "a character device";
    case S_IFBLK:
      return "a block device";
    default:
      return "something else";
  }
}

[[noreturn]] void fail_by_system(const fs::path& file, int error) {
  throw FileRefused(file, error, std::generic_category().message(error));
}

void require_regular(const fs::path& file, const struct stat& about) {
  if (!S_ISREG(about.st_mode)) {
    throw FileRefused(file, 0, "not a regular file", std::string(kind_of_file(about.st_mode)));
  }
}

[[noreturn]] void refuse_large(const fs::path& file, const std::string& found, FileLimit limit) {
  throw FileRefused(file, 0, "too large", found, "at most " + size_text(limit.bytes));
}

std::string text_of_refusal(const std::string& reason, const std::string& found,
                            const std::string& allowed) {
  return reason + (found.empty() ? "" : ", found " + found) +
         (allowed.empty() ? "" : ", allowed " + allowed);
}

}  // namespace

FileLimit limit_of(fields::FileKind kind) {
  using fields::FileKind;
  switch (kind) {
    case FileKind::data:
      break;
    case FileKind::mesh:
      return kMeshFile;
    case FileKind::geoid:
      return kGeoidFile;
    case FileKind::valve_map:
      return kValveMapFile;
    case FileKind::dbc_node:
      return kBindingFile;
    case FileKind::memory:
      return kSettingsFile;
    case FileKind::calibration:
      return kCalibrationFile;
    case FileKind::dbc:
      return kDbcFile;
    case FileKind::height_map:
      return kHeightMapFile;
    case FileKind::motion:
      return kMotionFile;
    case FileKind::replay:
      return kReplayFile;
    case FileKind::satellites:
      return kSatellitesFile;
    case FileKind::table:
      return kTableFile;
  }
  return kOtherFile;
}

std::string size_text(std::uint64_t bytes) {
  for (const auto& [unit, name] :
       {std::pair{kGibibyte, "GiB"}, {kMebibyte, "MiB"}, {kKibibyte, "KiB"}}) {
    if (bytes >= unit && bytes % unit == 0) {
      return fmt::format("{} {}", bytes / unit, name);
    }
  }
  return fmt::format("{} bytes", bytes);
}

FileRefused::FileRefused(const fs::path& file, int error, std::string reason, std::string found,
                         std::string allowed)
    : std::invalid_argument(printable(file.string()) + ": " +
                            text_of_refusal(reason, found, allowed)),
      file_(printable(file.string())),
      error_(error),
      reason_(std::move(reason)),
      found_(std::move(found)),
      allowed_(std::move(allowed)) {}

bool FileRefused::missing() const {
  return error_ == ENOENT || error_ == ENOTDIR;
}

std::string FileRefused::rest() const {
  return text_of_refusal(reason_, found_, allowed_);
}

OutsideFile::OutsideFile(fs::path file, FileLimit limit) : path_(std::move(file)), limit_(limit) {
  struct stat about {};
  if (::stat(path_.c_str(), &about) != 0) {
    fail_by_system(path_, errno);
  }
  require_regular(path_, about);
  // What takes the file's place in between is opened without waiting, and refused. Reading does not
  // wait either: some files of /proc would, for what the kernel has yet to say.
  descriptor_ = std::make_unique<drivers::Descriptor>(
      ::open(path_.c_str(), O_RDONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC));
  if (!descriptor_->open() || ::fstat(descriptor_->get(), &about) != 0) {
    fail_by_system(path_, errno);
  }
  require_regular(path_, about);
  size_ = static_cast<std::uint64_t>(about.st_size);
  if (size_ > limit_.bytes) {
    refuse_large(path_, fmt::format("{} bytes", size_), limit_);
  }
}

std::size_t OutsideFile::read(std::span<std::uint8_t> into) {
  constexpr auto kFarthest = static_cast<std::uint64_t>(std::numeric_limits<off_t>::max());
  std::size_t got = 0;
  while (got < into.size() && at_ < kFarthest) {
    const ssize_t count =
        ::pread(descriptor_->get(), into.data() + got, into.size() - got, static_cast<off_t>(at_));
    if (count == 0) {
      break;
    }
    if (count < 0) {
      if (errno == EINTR) {
        continue;
      }
      fail_by_system(path_, errno);
    }
    got += static_cast<std::size_t>(count);
    at_ += static_cast<std::uint64_t>(count);
    if (at_ > limit_.bytes) {
      refuse_large(path_, fmt::format("more than {} bytes", limit_.bytes), limit_);
    }
  }
  return got;
}

std::string OutsideFile::read_rest() {
  constexpr std::size_t kPiece = 256 * 1024;
  std::string text;
  try {
    if (size_ > at_) {
      text.reserve(static_cast<std::size_t>(size_ - at_) + kPiece);
    }
    while (true) {
      const std::size_t had = text.size();
      text.resize(had + kPiece);
      const std::size_t got = read({reinterpret_cast<std::uint8_t*>(text.data()) + had, kPiece});
      text.resize(had + got);
      if (got < kPiece) {
        return text;
      }
    }
  } catch (const std::bad_alloc&) {
    throw FileRefused(path_, ENOMEM, "no memory for its content",
                      fmt::format("{} bytes", std::max<std::uint64_t>(size_, at_)),
                      "as much as the process may have (ulimit -v)");
  }
}

std::string read_outside_file(const fs::path& file, FileLimit limit) {
  return OutsideFile(file, limit).read_rest();
}

bool LineReader::next(std::string& line) {
  constexpr std::size_t kPiece = 64 * 1024;
  line.clear();
  ++number_;
  while (true) {
    const auto rest = std::span<const std::uint8_t>(piece_).subspan(begin_);
    const auto end = std::ranges::find(rest, static_cast<std::uint8_t>('\n'));
    const auto length = static_cast<std::size_t>(end - rest.begin());
    if (line.size() + length > kMaxLineBytes) {
      throw FileRefused(file_.path(), 0, fmt::format("line {} is too long", number_),
                        fmt::format("more than {} bytes", kMaxLineBytes),
                        "at most " + size_text(kMaxLineBytes));
    }
    line.append(reinterpret_cast<const char*>(rest.data()), length);
    if (end != rest.end()) {
      begin_ += length + 1;
      whole_ = true;
      return true;
    }
    piece_.resize(kPiece);
    piece_.resize(file_.read(piece_));
    begin_ = 0;
    if (piece_.empty()) {
      whole_ = false;
      return !line.empty();
    }
  }
}

std::string resolved_path(const fs::path& file) {
  std::error_code error;
  const fs::path found = fs::canonical(file, error);
  if (!error && fs::equivalent(found, file, error) && !error) {
    return found.string();
  }
  const fs::path absolute = fs::absolute(file, error);
  return error ? file.string() : absolute.string();
}

}  // namespace rigwire::hil
