// A rig of tests/hil/streams/ run in this process without clients, with requests at their instants.
#pragma once

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/file.h>
#include <unistd.h>

#include <boost/asio/io_context.hpp>
#include <cstdint>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "hil/control/desk.h"
#include "hil/rig/rig.h"

namespace rigwire::hil::test {

using Json = nlohmann::json;

inline std::string file_of(const std::string& rig) {
  return RIGWIRE_SOURCE_DIR "/tests/hil/streams/" + rig + ".yaml";
}

/// A run without a client. What each wire carried, and what became of the requests.
struct Ran {
  std::map<std::string, std::uint64_t> streams;
  std::vector<Json> answers;
};

/// These rigs have the paths and ports of their files: one process at a time.
class OneAtATime {
 public:
  OneAtATime() : file_(::open("/tmp/rigwire-rig-faults-test", O_RDWR | O_CREAT | O_CLOEXEC, 0600)) {
    if (file_ < 0 || ::flock(file_, LOCK_EX) != 0) {
      throw std::runtime_error("no lock");
    }
  }
  ~OneAtATime() { ::close(file_); }
  OneAtATime(const OneAtATime&) = delete;
  OneAtATime& operator=(const OneAtATime&) = delete;

 private:
  int file_;
};

inline Ran run(const RigConfiguration& configuration, const std::vector<Request>& requests,
               Duration length) {
  boost::asio::io_context io;
  Rig rig(configuration, io, {});
  GovernedRun governed{configuration.name,
                       configuration.seed,
                       "",
                       {},
                       rig.truth().state_quantities(),
                       [&rig] { return rig.status(); },
                       rig.faults()};
  governed.hand = &rig.hand();
  governed.settings = &rig.settings();
  Desk desk(io, rig.executive(), governed);
  Ran ran;
  for (const Request& request : requests) {
    desk.carry_out(request,
                   [&ran](const Reply& reply) { ran.answers.push_back(Json::parse(reply.json)); });
  }
  EXPECT_EQ(rig.executive().run_free(kStart + length).fault, std::nullopt);
  for (const DeviceReport& device : rig.device_reports()) {
    ran.streams[device.name] = device.statistics.hash.value();
  }
  return ran;
}

}  // namespace rigwire::hil::test
