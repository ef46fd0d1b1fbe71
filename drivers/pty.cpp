#include "drivers/pty.h"

#include <fcntl.h>
#include <grp.h>
#include <poll.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <system_error>
#include <utility>

#include "drivers/descriptor.h"
#include "drivers/terminal.h"

namespace rigwire::drivers {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kReadSize = 4096;
/// Reads per wake-up, so that a client that floods cannot keep the loop.
constexpr int kReadsPerTurn = 8;

std::string reason(int error) {
  return std::generic_category().message(error);
}

/// Gives the slave the group and mode of a real serial line, so that daemons which have dropped
/// their privileges can open it again. Only a member of the group, or root, may; others keep the
/// terminal to themselves as before.
void share_with_serial_group(int master) {
  std::array<char, 64> slave{};
  std::array<char, 1024> room{};
  group entry{};
  group* found = nullptr;
  if (::ptsname_r(master, slave.data(), slave.size()) == 0 &&
      ::getgrnam_r("dialout", &entry, room.data(), room.size(), &found) == 0 && found != nullptr &&
      ::chown(slave.data(), static_cast<uid_t>(-1), found->gr_gid) == 0) {
    (void)::chmod(slave.data(), S_IRUSR | S_IWUSR | S_IRGRP | S_IWGRP);
  }
}

/// ENOSPC: all terminals that the mount permits are taken (pts(4)); ENOENT: there is none.
std::string mend_of_master(int error) {
  return mend_of(error, error == ENOSPC
                            ? "raise /proc/sys/kernel/pty/max, or the max= of the mount /dev/pts"
                            : "mount devpts on /dev/pts");
}

int open_master(const fs::path& link) {
  Descriptor master(::posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC));
  if (!master.open()) {
    refuse_line(link, "cannot open a pseudo-terminal: " + reason(errno), mend_of_master(errno));
  }
  if (::grantpt(master.get()) != 0 || ::unlockpt(master.get()) != 0) {
    refuse_line(link, "cannot unlock the pseudo-terminal: " + reason(errno), "check /dev/pts");
  }
  share_with_serial_group(master.get());
  return master.release();
}

std::string name_of_slave(int master) {
  char name[128] = {};
  return ::ptsname_r(master, name, sizeof(name)) == 0 ? name : "";
}

/// Opens the slave for a moment, empties it and makes it raw. False with errno set.
bool clean_slave(const std::string& name, std::optional<std::uint32_t> baud = {}) {
  const Descriptor slave(::open(name.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC));
  if (!slave.open() || !make_terminal_raw(slave.get(), baud)) {
    return false;
  }
  std::uint8_t waste[kReadSize];
  // Bounded: no program writes meanwhile, and the kernel holds less than this.
  for (int i = 0; i < 64 && ::read(slave.get(), waste, sizeof(waste)) > 0; ++i) {
  }
  return true;
}

}  // namespace

Pty::Pty(boost::asio::io_context& context, fs::path link, std::optional<std::uint32_t> baud)
    : link_(std::move(link)),
      watched_(link_.empty() ? nullptr : line_watch(context).add(link_)),
      master_(context),
      presence_timer_(context),
      buffer_(kReadSize) {
  descriptor_ = open_master(link_);
  master_.assign(descriptor_);
  slave_name_ = name_of_slave(descriptor_);
  // Opening and closing it once also makes the kernel report that no program has it open.
  if (slave_name_.empty() || !clean_slave(slave_name_, baud)) {
    refuse_line(link_, "cannot open the slave " + slave_name_ + ": " + reason(errno),
                mend_of(errno, "check the permissions of /dev/pts"));
  }
  if (watched_ != nullptr) {
    watched_->link.publish(slave_name_);
  }
}

Pty::~Pty() {
  if (watched_ != nullptr) {
    watched_->link.withdraw();  // at once, even while the watch still looks at it
  }
}

void Pty::start(Receiver receiver) {
  receiver_ = std::move(receiver);
  wait_presence();
}

std::size_t Pty::write(std::span<const std::uint8_t> bytes) {
  note_presence(!hung_up());
  if (!present_) {
    return bytes.size();
  }
  std::size_t taken = 0;
  while (taken < bytes.size()) {
    const ssize_t count = ::write(descriptor_, bytes.data() + taken, bytes.size() - taken);
    if (count > 0) {
      taken += static_cast<std::size_t>(count);
    } else if (count == 0 || errno != EINTR) {
      break;
    }
  }
  return taken;
}

EndpointStatus Pty::status() const {
  EndpointStatus status{link_.empty() ? slave_name_ : link_.string(), !hung_up()};
  status.readers = watched_ != nullptr ? watched_->readers.load() : 0;
  return status;
}

std::uint32_t Pty::client_baud() const {
  return terminal_baud(descriptor_).value_or(0);
}

bool Pty::hung_up() const {
  pollfd state{descriptor_, 0, 0};
  return ::poll(&state, 1, 0) == 1 && (state.revents & POLLHUP) != 0;
}

void Pty::note_presence(bool present) {
  if (present_ && !present) {
    prepare_for_next_client();
  }
  present_ = present;
  if (watched_ != nullptr) {
    watched_->in_use = present;
  }
  if (present_ && receiver_ && !reading_) {
    wait_readable();
  }
}

void Pty::prepare_for_next_client() {
  // What the client left unread would be the next one's first bytes.
  if (!clean_slave(slave_name_) && errno == EBUSY && hung_up()) {
    replace_pair();
  }
}

void Pty::replace_pair() {
  const std::uint32_t baud = client_baud();
  try {
    Descriptor fresh(open_master(link_));
    const std::string name = name_of_slave(fresh.get());
    if (name.empty() || !clean_slave(name, baud)) {
      return;  // tried again when the next client has left
    }
    boost::system::error_code ignored;
    master_.close(ignored);  // ends the pending wait
    reading_ = false;
    descriptor_ = fresh.release();
    master_.assign(descriptor_);
    slave_name_ = name;
    if (watched_ != nullptr) {
      watched_->link.publish(slave_name_);
    }
  } catch (const std::exception&) {
    // Out of terminals or the directory has gone: the line stays as a dead one.
  }
}

bool Pty::tell_client(bool present) {
  const LineClient now{present, present ? client_baud() : 0};
  if (now == told_ || !watcher_ || !receiver_) {
    return true;
  }
  told_ = now;
  const std::weak_ptr<char> alive = alive_;
  watcher_(now);
  return !alive.expired();
}

void Pty::drain_master() {
  for (int turn = 0; turn < kReadsPerTurn; ++turn) {
    const ssize_t count = ::read(descriptor_, buffer_.data(), buffer_.size());
    if (count > 0) {
      if (!tell_client(true)) {
        return;
      }
      const std::weak_ptr<char> alive = alive_;
      receiver_(std::span(buffer_).first(static_cast<std::size_t>(count)));
      if (alive.expired()) {
        return;  // the receiver has destroyed this object
      }
      continue;
    }
    if (count < 0 && errno == EINTR) {
      continue;
    }
    // EIO: everything is read and no program has the slave open.
    const bool present = !(count < 0 && errno == EIO);
    note_presence(present);
    (void)tell_client(present);
    return;
  }
  note_presence(true);
}

void Pty::wait_readable() {
  reading_ = true;
  master_.async_wait(boost::asio::posix::stream_descriptor::wait_read,
                     [this, alive = std::weak_ptr<char>(alive_)](boost::system::error_code error) {
                       if (error || alive.expired()) {
                         return;  // also: the wait belonged to a pair that was replaced
                       }
                       reading_ = false;
                       drain_master();
                     });
}

void Pty::wait_presence() {
  presence_timer_.expires_after(kPresencePeriod);
  presence_timer_.async_wait(
      [this, alive = std::weak_ptr<char>(alive_)](boost::system::error_code error) {
        if (error || alive.expired()) {
          return;
        }
        // The kernel reports the departure of a client as something to read, its arrival not at
        // all, and on a busy machine its bytes late: a read fetches them at once.
        drain_master();
        if (!alive.expired()) {
          wait_presence();
        }
      });
}

}  // namespace rigwire::drivers
