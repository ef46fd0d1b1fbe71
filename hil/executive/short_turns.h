// A thread that works seldom and briefly, and should do so at once.
#pragma once

#include <sys/syscall.h>
#include <unistd.h>

#include <chrono>
#include <cstdint>

namespace rigwire::hil {

/// While it lives, the calling thread asks the kernel's scheduler for short turns: when it wakes
/// up, it need not wait until those with longer ones, a camera's renderers, have had theirs. Linux
/// heeds it from 6.12 on (EEVDF, the run time of normal threads in sched_setattr()) and before
/// takes no notice; no privilege is needed.
class ShortTurns {
 public:
  /// 100 us to 100 ms; of two such threads the one with the shorter turn goes first.
  explicit ShortTurns(std::chrono::nanoseconds turn) {
    known_ = ::syscall(SYS_sched_getattr, 0, &before_, sizeof before_, 0) == 0;
    set(static_cast<std::uint64_t>(turn.count()));
  }
  ~ShortTurns() { set(before_.sched_runtime); }
  ShortTurns(const ShortTurns&) = delete;
  ShortTurns& operator=(const ShortTurns&) = delete;

 private:
  /// The kernel's sched_attr, first version (sched_setattr(2)); its header clashes with <sched.h>.
  struct Attributes {
    std::uint32_t size = sizeof(Attributes);
    std::uint32_t sched_policy = 0;
    std::uint64_t sched_flags = 0;
    std::int32_t sched_nice = 0;
    std::uint32_t sched_priority = 0;
    std::uint64_t sched_runtime = 0;
    std::uint64_t sched_deadline = 0;
    std::uint64_t sched_period = 0;
  };
  void set(std::uint64_t turn_ns) const {
    if (!known_ || before_.sched_policy != 0) {  // of normal threads alone
      return;
    }
    Attributes attributes = before_;
    attributes.size = sizeof attributes;
    attributes.sched_runtime = turn_ns;
    (void)::syscall(SYS_sched_setattr, 0, &attributes, 0);
  }

  Attributes before_;
  bool known_ = false;
};

}  // namespace rigwire::hil
