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
#include "hil/record/recorder.h"
#include "hil/rig/rig.h"
#include "wire_clients.h"

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

/// With `clients` they are alone on its wires.
inline Ran run(const RigConfiguration& configuration, const std::vector<Request>& requests,
               Duration length, WireClients* clients = nullptr) {
  boost::asio::io_context io;
  OutputFailures failures([](const std::string& what) { ADD_FAILURE() << what; });
  RunEvents events;
  std::optional<Recorder> recorder;
  if (clients != nullptr) {
    recorder.emplace(RecordedRun{}, std::chrono::minutes{10}, failures, events);
    recorder->on_outlet(
        [clients](const std::string& wire, QueuedOutlet& outlet) { clients->join(wire, outlet); });
  }
  Rig rig(configuration, io, {}, nullptr, {}, recorder ? &*recorder : nullptr);
  if (clients != nullptr) {
    clients->begin();
    rig.executive().add(*clients);
  }
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
