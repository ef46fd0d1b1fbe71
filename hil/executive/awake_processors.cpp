#include "hil/executive/awake_processors.h"

#include <fmt/format.h>
#include <pthread.h>
#include <sched.h>

#include <algorithm>
#include <cerrno>
#include <ctime>
#include <fstream>
#include <stdexcept>
#include <string_view>
#include <system_error>

namespace rigwire::hil {
namespace {

namespace fs = std::filesystem;

constexpr const char* kWhat = "processors are not kept awake";

/// Returns the processors on which the calling thread may run.
cpu_set_t own_processors() {
  cpu_set_t own;
  if (::sched_getaffinity(0, sizeof own, &own) != 0) {
    throw std::system_error(errno, std::generic_category(), kWhat);
  }
  return own;
}

void rest() {
#if defined(__x86_64__) || defined(__i386__)
  __builtin_ia32_pause();
#elif defined(__aarch64__)
  asm volatile("isb");
#endif
}

void turn(const std::atomic<bool>& ended) {
  constexpr int kTurns = 64;
  while (!ended.load(std::memory_order_relaxed)) {
    for (int i = 0; i < kTurns; ++i) {
      rest();
    }
    ::sched_yield();  // to others of idle priority
  }
}

/// Returns the CPU limit of one control group, in processors; nullopt: no limit.
std::optional<double> limit_of(const fs::path& group) {
  std::ifstream file(group / "cpu.max");
  double quota_us = 0.0;  // "max" is no number
  double period_us = 0.0;
  if (!(file >> quota_us >> period_us) || period_us <= 0.0) {
    return std::nullopt;
  }
  return quota_us / period_us;
}

}  // namespace

std::optional<double> limit_of_processors(const fs::path& membership, const fs::path& root) {
  constexpr std::string_view kVersion2 = "0::/";
  std::ifstream file(membership);
  std::optional<double> least;
  for (std::string line; std::getline(file, line);) {
    if (!line.starts_with(kVersion2)) {
      continue;
    }
    for (fs::path group = line.substr(kVersion2.size());; group = group.parent_path()) {
      if (const auto limit = limit_of(root / group)) {
        least = std::min(*limit, least.value_or(*limit));
      }
      if (group.empty()) {
        break;
      }
    }
  }
  return least;
}

AwakeProcessors::AwakeProcessors() {
  const cpu_set_t own = own_processors();
  const int count = CPU_COUNT(&own);
  if (const auto limit = limit_of_processors("/proc/self/cgroup", "/sys/fs/cgroup");
      limit && *limit < count) {
    throw std::runtime_error(
        fmt::format("{}: the control group allows the time of {:g} processors (cpu.max), found {} "
                    "to keep awake, which would use it up",
                    kWhat, *limit, count));
  }
  try {
    for (int processor = 0; processor < CPU_SETSIZE; ++processor) {
      if (!CPU_ISSET(processor, &own)) {
        continue;
      }
      // A thread of idle priority (SCHED_IDLE, sched(7)) bound to this processor.
      threads_.emplace_back([this] { turn(ended_); });
      const pthread_t thread = threads_.back().native_handle();
      const sched_param none{};
      cpu_set_t one;
      CPU_ZERO(&one);
      CPU_SET(processor, &one);
      int refused = ::pthread_setschedparam(thread, SCHED_IDLE, &none);
      if (refused == 0) {
        refused = ::pthread_setaffinity_np(thread, sizeof one, &one);
      }
      if (refused != 0) {
        throw std::system_error(refused, std::generic_category(), kWhat);
      }
    }
  } catch (...) {
    end();
    throw;
  }
}

AwakeProcessors::~AwakeProcessors() {
  end();
}

void AwakeProcessors::end() {
  ended_ = true;
  for (std::thread& thread : threads_) {
    thread.join();
  }
}

double AwakeProcessors::cpu_seconds() const {
  double sum_s = 0.0;
  for (const std::thread& thread : threads_) {
    clockid_t clock{};
    timespec time{};
    if (::pthread_getcpuclockid(const_cast<std::thread&>(thread).native_handle(), &clock) == 0 &&
        ::clock_gettime(clock, &time) == 0) {
      sum_s += static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
    }
  }
  return sum_s;
}

}  // namespace rigwire::hil
