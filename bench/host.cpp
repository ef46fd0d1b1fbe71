#include "bench/host.h"

#include <fmt/format.h>
#include <sched.h>
#include <sys/utsname.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>

namespace rigwire::bench {
namespace {

std::string processor_name() {
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);) {
    if (line.starts_with("model name")) {
      const std::size_t colon = line.find(": ");
      return colon == std::string::npos ? "unknown" : line.substr(colon + 2);
    }
  }
  return "unknown";
}

}  // namespace

HostFacts host_facts() {
  HostFacts facts;
  utsname name{};
  uname(&name);
  facts.kernel = fmt::format("{} {}", name.sysname, name.release);
  facts.processor = processor_name();
  cpu_set_t cores;
  CPU_ZERO(&cores);
  if (sched_getaffinity(0, sizeof cores, &cores) == 0) {
    facts.cores = static_cast<unsigned>(CPU_COUNT(&cores));
  }
  facts.compiler = RIGWIRE_COMPILER;
  facts.flags = RIGWIRE_COMPILER_FLAGS;
  return facts;
}

std::array<double, 3> load_average() {
  std::array<double, 3> load{};
  if (getloadavg(load.data(), static_cast<int>(load.size())) != static_cast<int>(load.size())) {
    load.fill(0.0);
  }
  return load;
}

double stolen_seconds() {
  constexpr int kStealField = 8;  // "cpu user nice system idle iowait irq softirq steal", proc(5)
  std::ifstream file("/proc/stat");
  std::string name;
  file >> name;
  double ticks = 0.0;
  for (int i = 0; i < kStealField; ++i) {
    file >> ticks;
  }
  const auto ticks_per_second = static_cast<double>(sysconf(_SC_CLK_TCK));
  return file && ticks_per_second > 0.0 ? ticks / ticks_per_second : 0.0;
}

}  // namespace rigwire::bench
