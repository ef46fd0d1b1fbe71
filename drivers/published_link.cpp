#include "drivers/published_link.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <optional>
#include <system_error>
#include <utility>

#include "drivers/descriptor.h"
#include "drivers/endpoints.h"

namespace rigwire::drivers {
namespace {

namespace fs = std::filesystem;

/// A folder that is this user's alone, for advice.
std::string own_folder() {
  const std::string user = std::to_string(::geteuid());
  const std::string runtime = "/run/user/" + user;
  return ::access(runtime.c_str(), W_OK) == 0 ? runtime + "/rigwire" : "/tmp/rigwire-" + user;
}

std::string elsewhere() {
  return "choose a path in a directory that this user can write, such as " + own_folder();
}

/// What `path` is, and how a real line is reached.
constexpr const char* kOwnTerminal =
    "the program makes a pseudo-terminal and puts a link to it at this path; a real serial line is "
    "joined to it by another program (socat PATH,raw,echo=0 /dev/ttyUSB0,raw,echo=0,b115200)";

std::string link_error(int error) {
  return std::generic_category().message(error);
}

fs::path folder_of(const fs::path& link) {
  return link.has_parent_path() ? link.parent_path() : fs::path(".");
}

/// Empty, or why there is none.
std::string create_folder_of(const fs::path& link) {
  std::error_code error;
  fs::create_directories(folder_of(link), error);
  return error ? "cannot create the directory " + folder_of(link).string() + ": " + error.message()
               : "";
}

/// An entry in the link's place that is not a leftover.
struct Obstacle {
  std::string what;
  std::string mend;
};

/// The user who called sudo: what belongs to him is as good as root's own.
uid_t user_behind_sudo() {
  const char* const text = ::geteuid() == 0 ? std::getenv("SUDO_UID") : nullptr;
  uid_t user = 0;
  if (text != nullptr) {
    std::from_chars(text, text + std::strlen(text), user);
  }
  return user;
}

/// In a user namespace the owners that it does not map, root of the host among them, all have this
/// number (user_namespaces(7), "Unmapped user and group IDs"). Nothing: every user is mapped.
std::optional<uid_t> unmapped_user() {
  constexpr std::uint64_t kEveryUser = 0xFFFFFFFF;
  std::ifstream map("/proc/self/uid_map");
  std::uint64_t inside = 0;
  std::uint64_t outside = 0;
  std::uint64_t count = 0;
  uid_t number = 65534;
  if (!(map >> inside >> outside >> count) || count == kEveryUser) {
    return std::nullopt;
  }
  std::ifstream("/proc/sys/kernel/overflowuid") >> number;
  return number;
}

bool is_trusted(uid_t user) {
  return user == 0 || user == ::geteuid() || user == user_behind_sudo() || user == unmapped_user();
}

/// Returns whether other users can replace an entry of `folder`: it is writable by everybody, or by
/// a group that is neither this user's nor root's. In a folder with the sticky bit, as /tmp, only
/// an entry's owner can replace it.
bool others_replace_in(const struct stat& folder) {
  const bool writable =
      (folder.st_mode & S_IWOTH) != 0 ||
      ((folder.st_mode & S_IWGRP) != 0 && folder.st_gid != ::getegid() && folder.st_gid != 0);
  return writable && (folder.st_mode & S_ISVTX) == 0;
}

/// Returns who else could replace the link: the owner of a folder above it, or of a link on the way
/// to it, or everybody where such a folder can be written.
std::optional<Obstacle> stranger_above(const fs::path& link) {
  constexpr const char* kThreat = ", who could put another terminal there";
  const std::string mend =
      "choose a path in a directory of this user's own, such as " + own_folder();
  std::error_code error;
  const fs::path named = fs::absolute(folder_of(link), error).lexically_normal();
  const fs::path real = error ? named : fs::canonical(named, error);
  if (error) {
    return std::nullopt;  // what cannot be reached is refused elsewhere
  }
  for (const fs::path& way : {named, real}) {
    fs::path folder;
    for (const fs::path& part : way) {
      folder /= part;
      struct stat own {};
      if (::lstat(folder.c_str(), &own) != 0) {
        continue;
      }
      const std::string name =
          (S_ISLNK(own.st_mode) ? "the link " : "the directory ") + folder.string();
      if (!is_trusted(own.st_uid)) {
        return Obstacle{name + " belongs to user " + std::to_string(own.st_uid) + kThreat, mend};
      }
      if (S_ISDIR(own.st_mode) && others_replace_in(own)) {
        return Obstacle{name + " can be written by other users" + kThreat, mend};
      }
    }
  }
  return std::nullopt;
}

/// Devices have their places below /dev: a link there would pass for one.
bool is_below_dev(const fs::path& link) {
  std::error_code error;
  fs::path folder = fs::weakly_canonical(folder_of(link), error);
  const std::string text = (error ? folder_of(link) : folder).string() + "/";
  return text.starts_with("/dev/") && !text.starts_with("/dev/shm/");
}

std::optional<Obstacle> obstacle_at(const fs::path& link) {
  struct stat own {};
  if (::lstat(link.c_str(), &own) != 0) {
    if (errno == ENOENT || errno == ENOTDIR) {
      return std::nullopt;
    }
    return Obstacle{"cannot look at it: " + link_error(errno),
                    "choose a path that this user can reach"};
  }
  if (S_ISCHR(own.st_mode) || S_ISBLK(own.st_mode)) {
    return Obstacle{"a device is there", "choose another path: " + std::string(kOwnTerminal)};
  }
  if (!S_ISLNK(own.st_mode)) {
    return Obstacle{S_ISDIR(own.st_mode) ? "a directory is there" : "a file is there",
                    "remove it or choose another path"};
  }
  std::error_code error;
  const fs::path target = fs::read_symlink(link, error);
  struct stat terminal {};
  if (::stat(link.c_str(), &terminal) != 0) {
    return std::nullopt;  // dangling
  }
  if (target.parent_path() != "/dev/pts") {
    return Obstacle{"a link to " + target.string() + " is there, which is no pseudo-terminal",
                    "remove it or choose another path"};
  }
  // The numbers of pseudo-terminals are used again. A terminal younger than the link belongs to
  // another program, and the link is a leftover.
  const auto earlier = [](const timespec& a, const timespec& b) {
    return std::pair(a.tv_sec, a.tv_nsec) < std::pair(b.tv_sec, b.tv_nsec);
  };
  if (!earlier(own.st_mtim, terminal.st_ctim)) {
    return Obstacle{"a running program publishes " + target.string() + " there",
                    "stop that program or choose another path"};
  }
  return std::nullopt;
}

/// Puts a link to `terminal` in the place of nothing, or of a leftover. Empty, or what failed.
std::string place(const fs::path& link, const std::string& terminal) {
  if (std::string failed = create_folder_of(link); !failed.empty()) {
    return failed;
  }
  if (::symlink(terminal.c_str(), link.c_str()) == 0) {
    return {};
  }
  if (errno != EEXIST) {
    return "cannot create the link: " + link_error(errno);
  }
  // A rename replaces the leftover at once.
  fs::path temporary = link;
  temporary += ".new-" + std::to_string(::getpid());
  std::error_code error;
  fs::remove(temporary, error);
  fs::create_symlink(terminal, temporary, error);
  if (!error) {
    fs::rename(temporary, link, error);
    if (error) {
      std::error_code ignored;
      fs::remove(temporary, ignored);
    }
  }
  return error ? "cannot create the link: " + error.message() : "";
}

bool same_file(const struct stat& a, const struct stat& b) {
  return a.st_dev == b.st_dev && a.st_ino == b.st_ino;
}

}  // namespace

std::string danger_of_link(const fs::path& link) {
  const auto stranger = stranger_above(link);
  return stranger ? stranger->what : "";
}

void refuse_line(const fs::path& path, const std::string& what, const std::string& mend) {
  throw EndpointError("pty " + path.string() + ": " + what + "; " + mend);
}

std::string mend_of(int error, const std::string& otherwise) {
  return error == EMFILE   ? "raise the limit of open files (ulimit -n)"
         : error == ENFILE ? "raise the machine's limit of open files (/proc/sys/fs/file-max)"
                           : otherwise;
}

/// The lock on the file beside the link. Who finds that the file which he has locked is no longer
/// the one of that name, because its owner removed it meanwhile, tries again.
class PublishedLink::NameLock {
 public:
  enum class Result { taken, held_by_another, failed };

  explicit NameLock(const fs::path& link)
      : path_(folder_of(link) / ("." + link.filename().string() + ".lock")) {}
  ~NameLock() { release(); }
  NameLock(const NameLock&) = delete;
  NameLock& operator=(const NameLock&) = delete;

  /// Locks the name. With Result::failed, errno has the reason.
  Result take() {
    constexpr int kTries = 100;
    for (int i = 0; i < kTries; ++i) {
      Descriptor file(open_file());
      if (!file.open()) {
        return Result::failed;
      }
      if (::flock(file.get(), LOCK_EX | LOCK_NB) != 0) {
        return errno == EWOULDBLOCK ? Result::held_by_another : Result::failed;
      }
      if (is_in_place(file.get())) {
        const Descriptor former(std::exchange(file_, file.release()));
        return Result::taken;
      }
    }
    return Result::held_by_another;
  }
  [[nodiscard]] bool in_place() const { return file_ >= 0 && is_in_place(file_); }

  void release() {
    if (file_ >= 0) {
      if (in_place()) {
        ::unlink(path_.c_str());
      }
      ::close(std::exchange(file_, -1));
    }
  }

 private:
  /// Another user's file can be locked without being written.
  [[nodiscard]] int open_file() const {
    constexpr int kFlags = O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK;
    const int file = ::open(path_.c_str(), O_RDWR | O_CREAT | kFlags, 0644);
    if (file >= 0 || errno != EACCES) {
      return file;
    }
    const int existing = ::open(path_.c_str(), O_RDONLY | kFlags);
    if (existing < 0) {
      errno = EACCES;  // that of the first try: whether a file is there does not matter
    }
    return existing;
  }
  [[nodiscard]] bool is_in_place(int file) const {
    struct stat held {};
    struct stat named {};
    return ::fstat(file, &held) == 0 && ::lstat(path_.c_str(), &named) == 0 &&
           same_file(held, named);
  }

  fs::path path_;
  int file_ = -1;
};

PublishedLink::PublishedLink(fs::path path)
    : path_(std::move(path)), lock_(std::make_unique<NameLock>(path_)) {
  std::error_code lost;
  if (path_.is_relative() && fs::current_path(lost).empty()) {
    refuse_line(path_, "the working folder is unknown: " + lost.message(),
                "change to a folder that exists, or give an absolute path");
  }
  if (is_below_dev(path_)) {
    refuse_line(path_, "the path is below /dev, where devices are",
                "choose a path elsewhere, such as " + own_folder() + "/gnss: " + kOwnTerminal);
  }
  if (const std::string failed = create_folder_of(path_); !failed.empty()) {
    refuse_line(path_, failed, elsewhere());
  }
  if (const auto stranger = stranger_above(path_)) {
    refuse_line(path_, stranger->what, stranger->mend);
  }
  switch (lock_->take()) {
    case NameLock::Result::taken:
      break;
    case NameLock::Result::held_by_another:
      refuse_line(path_, "another running rigwire publishes this path",
                  "stop that one or choose another path");
    case NameLock::Result::failed: {
      const int error = errno;
      refuse_line(path_, "cannot lock the path's name: " + link_error(error),
                  mend_of(error, elsewhere()));
    }
  }
  if (const auto obstacle = obstacle_at(path_)) {
    refuse_line(path_, obstacle->what, obstacle->mend);
  }
}

PublishedLink::~PublishedLink() {
  withdraw();
}

void PublishedLink::publish(const std::string& terminal) {
  const std::lock_guard guard(mutex_);
  if (const std::string failed = place(path_, terminal); !failed.empty()) {
    refuse_line(path_, failed, elsewhere());
  }
  terminal_ = terminal;
}

void PublishedLink::withdraw() {
  const std::lock_guard guard(mutex_);
  std::error_code error;
  if (!terminal_.empty() && fs::read_symlink(path_, error) == terminal_ && !error) {
    fs::remove(path_, error);
  }
  terminal_.clear();
  lock_->release();
}

std::string PublishedLink::terminal() const {
  const std::lock_guard guard(mutex_);
  return terminal_;
}

/// The lock file may have been removed together with the link.
bool PublishedLink::locked() {
  return lock_->in_place() ||
         (create_folder_of(path_).empty() && lock_->take() == NameLock::Result::taken);
}

std::string PublishedLink::news(State state, const std::string& what) {
  return std::exchange(state_, state) == state ? "" : "pty " + path_.string() + ": " + what;
}

std::string PublishedLink::look() try {
  const std::lock_guard guard(mutex_);
  if (terminal_.empty()) {
    return {};
  }
  const bool owned = locked();
  std::error_code error;
  if (fs::read_symlink(path_, error) == terminal_ && !error) {
    state_ = State::in_place;
    return {};
  }
  if (const auto obstacle = obstacle_at(path_)) {
    return news(State::taken, "the link was removed, and " + obstacle->what +
                                  "; it stays, clients find the device at " + terminal_);
  }
  if (!owned) {
    return news(State::missing,
                "the link was removed and cannot be put back: the path's name is "
                "not ours any more; clients find the device at " +
                    terminal_);
  }
  if (const std::string failed = place(path_, terminal_); !failed.empty()) {
    return news(State::missing, "the link was removed and cannot be put back: " + failed +
                                    "; clients find the device at " + terminal_);
  }
  state_ = State::in_place;
  return "pty " + path_.string() + ": the link was removed; it is there again";
} catch (const std::exception&) {
  return {};  // no memory: the next look is soon
}

}  // namespace rigwire::drivers
