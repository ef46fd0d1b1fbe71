// Work beside the loop, which takes what time the loop leaves.
#pragma once

#include <sched.h>
#include <sys/resource.h>
#include <unistd.h>

namespace rigwire::hil {

/// Makes the calling thread, and threads that it starts, nicer to others than the rest of the
/// program: on a busy machine its work waits, and wires do not. Real-time priority (`chrt`) is for
/// the wires alone.
inline void yield_to_the_loop() {
  const int policy = ::sched_getscheduler(0) & ~SCHED_RESET_ON_FORK;
  if (policy == SCHED_FIFO || policy == SCHED_RR) {
    const sched_param none{};
    (void)::sched_setscheduler(0, SCHED_OTHER, &none);
  }
  constexpr int kNiceness = 10;
  const auto self = static_cast<id_t>(::gettid());
  (void)::setpriority(PRIO_PROCESS, self, ::getpriority(PRIO_PROCESS, self) + kNiceness);
}

}  // namespace rigwire::hil
