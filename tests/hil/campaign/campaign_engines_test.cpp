// Campaigns in the hands of what runs them elsewhere: GNU parallel, and a Slurm cluster of one
// controller and two nodes on this machine, each killed in the middle and started again.
#include <arpa/inet.h>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <pwd.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <csignal>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "child_process.h"

namespace rigwire {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;
using test::ChildProcess;
using test::eventually;
using testing::HasSubstr;

std::string content(const fs::path& file) {
  std::ifstream stream(file);
  return {std::istreambuf_iterator<char>(stream), {}};
}

/// TCP ports of this machine that nobody has, different ones.
std::array<std::uint16_t, 3> free_ports() {
  std::array<int, 3> sockets{};
  std::array<std::uint16_t, 3> ports{};
  for (std::size_t i = 0; i < ports.size(); ++i) {
    sockets[i] = ::socket(AF_INET, SOCK_STREAM, 0);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    ::socklen_t length = sizeof(address);
    ::bind(sockets[i], reinterpret_cast<sockaddr*>(&address), length);
    ::getsockname(sockets[i], reinterpret_cast<sockaddr*>(&address), &length);
    ports[i] = ntohs(address.sin_port);
  }
  for (const int socket : sockets) {
    ::close(socket);
  }
  return ports;
}

class CampaignEngines : public testing::Test {
 protected:
  static constexpr std::size_t kRuns = 12;

  CampaignEngines() {
    std::string pattern = "/tmp/rigwire-test-XXXXXX";
    if (::mkdtemp(pattern.data()) == nullptr) {
      throw std::runtime_error("no folder");
    }
    folder_ = pattern;
    ::setenv("RIGWIRE", RIGWIRE_BINARY_DIR "/rigwire", 1);
    std::ofstream(folder_ / "rig.yaml")
        << "machine: {type: wheeled, wheeled: {level: kinematic}}\ndevices:\n"
           "  gnss: {type: ublox-neo-7p, path: /tmp/rigwire/g, baud: 115200, mount: {link: "
           "body}}\n";
    std::ofstream(campaign())
        << "rig: rig.yaml\nduration: 5 s\ndesign: random\nruns: " << kRuns
        << "\nparameters:\n  yaw: {type: uniform, from: 0 deg, to: 90 deg, keys: [machine.yaw]}\n"
           "criteria:\n  turned: {type: stays, quantity: heading_deg, above: false, value: 91}\n";
  }
  ~CampaignEngines() override { fs::remove_all(folder_); }

  [[nodiscard]] std::string campaign() const { return (folder_ / "campaign.yaml").string(); }
  [[nodiscard]] fs::path runs() const { return folder_ / "runs"; }
  /// When each run that is done was done.
  [[nodiscard]] std::map<std::string, fs::file_time_type> done() const {
    std::map<std::string, fs::file_time_type> times;
    std::error_code none;
    for (const auto& entry : fs::directory_iterator(runs() / "runs", none)) {
      if (fs::exists(entry.path() / "DONE")) {
        times[entry.path().filename()] = fs::last_write_time(entry.path() / "DONE");
      }
    }
    return times;
  }
  [[nodiscard]] std::unique_ptr<ChildProcess> engine(const std::string& script,
                                                     const std::string& more) const {
    return std::make_unique<ChildProcess>(
        std::vector<std::string>{RIGWIRE_SOURCE_DIR "/configs/campaigns/engines/" + script,
                                 campaign(), runs().string(), more},
        folder_ / "engine.txt");
  }
  /// Interrupts the engine when some runs are done, waits until `quiet`, and starts it again.
  void kill_and_resume(const std::string& script, const std::string& more,
                       const std::function<bool()>& quiet) {
    {
      const auto first = engine(script, more);
      ASSERT_TRUE(eventually([&] { return done().size() >= 2; }, 120s)) << first->output();
      first->signal(SIGINT);
      ASSERT_TRUE(first->wait(60s)) << first->output();
    }
    ASSERT_TRUE(eventually(quiet, 60s));
    const auto before = done();
    ASSERT_LT(before.size(), kRuns) << "nothing is left to resume";
    const auto second = engine(script, more);
    ASSERT_EQ(second->wait(300s).value_or(-1), 0) << second->output();
    EXPECT_THAT(
        second->output(),
        HasSubstr(fmt::format("{} passed, 0 failed, 0 crashed, 0 unfinished, 0 missing", kRuns)));
    const auto after = done();
    EXPECT_EQ(after.size(), kRuns);
    for (const auto& [run, time] : before) {
      EXPECT_EQ(after.at(run), time) << "run " << run << " was run again";
    }
    EXPECT_TRUE(fs::exists(runs() / "results.sqlite"));
  }

  fs::path folder_;
};

TEST_F(CampaignEngines, parallel_is_killed_and_resumed) {
  kill_and_resume("parallel.sh", "2", [] { return true; });
  EXPECT_THAT(content(runs() / "parallel.txt"), HasSubstr("Exitval"));
}

TEST_F(CampaignEngines, a_slurm_array_is_killed_and_resumed) {
  const auto ports = free_ports();
  const std::string user = ::getpwuid(::geteuid())->pw_name;
  const std::string conf = (folder_ / "slurm.conf").string();
  // Without what a container has not: munge, cgroups, systemd, accounting.
  std::ofstream(conf) << fmt::format(
      R"(ClusterName=rigwire
SlurmctldHost=localhost(127.0.0.1)
SlurmctldPort={1}
SlurmUser={4}
SlurmdUser={4}
AuthType=auth/none
CredType=cred/none
StateSaveLocation={0}/state
SlurmdSpoolDir={0}/spool.%n
SlurmctldPidFile={0}/slurmctld.pid
SlurmdPidFile={0}/slurmd.%n.pid
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SwitchType=switch/none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
JobCompType=jobcomp/filetxt
JobCompLoc={0}/jobs.txt
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
MpiDefault=none
ReturnToService=2
SchedulerType=sched/builtin
SchedulerParameters=batch_sched_delay=0,sched_min_interval=10000,sched_interval=1
NodeName=n[1-2] NodeHostname=localhost NodeAddr=127.0.0.1 Port=[{2},{3}] CPUs=1 RealMemory=100 State=UNKNOWN
PartitionName=main Nodes=ALL Default=YES MaxTime=INFINITE State=UP
)",
      folder_.string(), ports[0], ports[1], ports[2], user);
  std::ofstream(folder_ / "cgroup.conf") << "CgroupPlugin=cgroup/v1\n";
  fs::create_directories(folder_ / "state");
  ::setenv("SLURM_CONF", conf.c_str(), 1);
  ChildProcess controller({"/usr/sbin/slurmctld", "-D", "-f", conf}, folder_ / "slurmctld.txt");
  ChildProcess first({"/usr/sbin/slurmd", "-D", "-f", conf, "-N", "n1"}, folder_ / "slurmd1.txt");
  ChildProcess second({"/usr/sbin/slurmd", "-D", "-f", conf, "-N", "n2"}, folder_ / "slurmd2.txt");
  const auto told = [&](const std::vector<std::string>& words) {
    ChildProcess asked(words, folder_ / "asked.txt");
    return asked.wait(30s) == 0 ? asked.output() : "-";
  };
  ASSERT_TRUE(eventually(
      [&] {
        return told({"sinfo", "--noheader", "--states=idle", "--format=%D"}).starts_with("2");
      },
      60s))
      << controller.output() << first.output() << second.output();
  kill_and_resume("slurm.sh", "2", [&] { return told({"squeue", "--noheader"}).empty(); });
  const std::string jobs = content(folder_ / "jobs.txt");
  EXPECT_THAT(jobs, HasSubstr("NodeList=n1"));
  EXPECT_THAT(jobs, HasSubstr("NodeList=n2"));
  EXPECT_THAT(jobs, HasSubstr("JobState=CANCELLED"));
  static_cast<void>(told({"scontrol", "shutdown"}));
  EXPECT_TRUE(controller.wait(30s));
  EXPECT_TRUE(first.wait(30s));
  EXPECT_TRUE(second.wait(30s));
}

}  // namespace
}  // namespace rigwire
