// The faults of a running rig: what the file has is numbered, and what is begun while it runs acts
// as if the file had had it.
#include "hil/rig/rig_faults.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <boost/asio/io_context.hpp>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

#include "governed_run.h"
#include "hil/configuration/document.h"
#include "hil/rig/rig.h"
#include "wire_content.h"

namespace rigwire::hil {
namespace {

using namespace std::chrono_literals;
using test::file_of;
using test::Json;
using test::OneAtATime;
using test::Ran;
using test::run;
using testing::HasSubstr;
using testing::UnorderedElementsAreArray;

Json json_of(const Value& value) {
  if (value.kind == Value::Kind::list) {
    Json list = Json::array();
    for (const Value& item : value.items) {
      list.push_back(json_of(item));
    }
    return list;
  }
  if (value.kind == Value::Kind::map) {
    Json map = Json::object();
    for (const Value::Entry& entry : value.entries) {
      map[entry.key] = json_of(entry.value);
    }
    return map;
  }
  return value.scalar;
}

/// take(path, on, part) for each part of a rig's file that can have faults.
template <class Take>
void each_part(const Value& document, const Take& take) {
  for (const auto& [section, prefix] :
       {std::pair{"devices", ""}, {"buses", "bus "}, {"modbus", "modbus "}}) {
    if (const Value* parts = document.find(section)) {
      for (const Value::Entry& part : parts->entries) {
        take(std::string(section) + "." + part.key, prefix + part.key, part.value);
      }
    }
  }
  if (const Value* around = document.find(kSurroundings)) {
    for (const SurroundingsTarget& target : kSurroundingsTargets) {
      if (const Value* part = around->find(target.key)) {
        take(std::string(kSurroundings) + "." + std::string(target.key), std::string(target.name),
             *part);
      }
    }
  }
}

class RigFaultsOf : public testing::TestWithParam<std::string> {
  OneAtATime alone_;
};

TEST_P(RigFaultsOf, TheFilesFaultsAreNumberedAndAreItsWindows) {
  const RigConfiguration configuration = load_rig(file_of(GetParam()), {}).configuration;
  boost::asio::io_context io;
  const Rig rig(configuration, io, {});
  EXPECT_THAT(rig.faults().windows(), UnorderedElementsAreArray(fault_windows(configuration)));
  RigFaults::Id number = 0;
  for (const RigFaults::Numbered& fault : rig.faults().list()) {
    EXPECT_EQ(fault.id, ++number);
  }
}

/// What `rigwire list faults` tells of a type is what a running device of it can have.
TEST_P(RigFaultsOf, ItsPortsHaveTheKindsThatTheTypesTell) {
  const RigConfiguration configuration = load_rig(file_of(GetParam()), {}).configuration;
  boost::asio::io_context io;
  const Rig rig(configuration, io, {});
  const auto names = [](const std::vector<fields::Named>& kinds) {
    std::set<std::string> all;
    for (const fields::Named& kind : kinds) {
      all.emplace(kind.name);
    }
    return all;
  };
  const std::vector<RigFaults::Target> targets = rig.faults().targets();
  for (const RigFaults::Target& target : targets) {
    const auto device = configuration.devices.find(target.name);
    if (device != configuration.devices.end()) {
      EXPECT_EQ(names(target.kinds), names(device->second->fault_kinds())) << target.name;
    }
  }
  for (const auto& [name, line] : configuration.modbus) {
    const auto target = std::ranges::find(targets, "modbus " + name, &RigFaults::Target::name);
    ASSERT_NE(target, targets.end()) << name;
    EXPECT_EQ(names(target->kinds), names(emulators::modbus_fault_kinds(line.wire))) << name;
  }
  for (const auto& [name, device] : configuration.devices) {
    EXPECT_EQ(device->fault_kinds().empty(),
              std::ranges::count(targets, name, &RigFaults::Target::name) == 0)
        << name;
  }
}

/// Every kind that there is happens in these rigs (streams_test.cpp).
TEST_P(RigFaultsOf, WhatIsBegunWhileItRunsActsAsIfTheFileHadHadIt) {
  Problems problems;
  const Value document = load_document(file_of(GetParam()), problems);
  std::vector<std::string> emptied;
  std::vector<Request> requests;
  each_part(document, [&](const std::string& path, const std::string& on, const Value& part) {
    if (const Value* faults = part.find("faults")) {
      emptied.push_back(path + ".faults=[]");
      for (const Value& fault : faults->items) {
        requests.push_back({FaultAddCommand{on, json_of(fault).dump()}, 100ms});
      }
    }
  });
  ASSERT_FALSE(requests.empty());
  const Duration length = 20s;
  const Ran written = run(load_rig(file_of(GetParam()), {}).configuration, {}, length);
  const Ran begun = run(load_rig(file_of(GetParam()), emptied).configuration, requests, length);
  EXPECT_EQ(begun.answers.size(), requests.size());
  for (const Json& answer : begun.answers) {
    EXPECT_TRUE(answer["ok"].get<bool>()) << answer;
  }
  EXPECT_EQ(begun.streams, written.streams);
}

INSTANTIATE_TEST_SUITE_P(, RigFaultsOf, testing::Values("can", "gnss", "lidar", "modbus", "usb"),
                         [](const auto& test) { return test.param; });

class RigFaultsTest : public testing::Test {
  OneAtATime alone_;

 protected:
  Json ask(const Command& command, Duration at = 1s) {
    const RigConfiguration configuration =
        load_rig(file_of("gnss"), {"devices.gnss.faults=[]", "devices.starfire.faults=[]"})
            .configuration;
    return run(configuration, {{command, at}}, 1500ms).answers.at(0);
  }
};

TEST_F(RigFaultsTest, AnUnknownPairIsRefusedWithWhatThereIs) {
  const Json nobody = ask(FaultAddCommand{"gns", "{type: jamming}"});
  EXPECT_EQ(nobody["path"], "on");
  EXPECT_EQ(nobody["allowed"], "gnss, starfire, bus can, air, machine.engine");
  const Json kind = ask(FaultAddCommand{"starfire", "{type: noise}"});
  EXPECT_EQ(kind["path"], "fault.type");
  EXPECT_THAT(std::string(kind["allowed"]), HasSubstr("jamming"));
  const Json node = ask(FaultAddCommand{"bus can", "{type: unplugged, device: nobody}"});
  EXPECT_FALSE(node["ok"].get<bool>()) << node;
}

TEST_F(RigFaultsTest, KeysThatAreNoneAndABeginningThatIsOverAreRefused) {
  EXPECT_THAT(std::string(ask(FaultAddCommand{"gnss", "{type: jamming, los: 3 dB}"})["what"]),
              HasSubstr("loss"));
  EXPECT_THAT(std::string(ask(FaultAddCommand{"gnss", "{type: jamming, at: 0.5 s}"})["what"]),
              HasSubstr("later"));
  for (const char* receiver : {"gnss", "starfire"}) {
    const Json band = ask(FaultAddCommand{receiver, "{type: jamming, band: l2}"});
    EXPECT_THAT(std::string(band["what"]), HasSubstr("one band")) << receiver;
  }
  EXPECT_FALSE(ask(FaultAddCommand{"gnss", "jamming"})["ok"].get<bool>());
  EXPECT_FALSE(ask(FaultAddCommand{"gnss", "{type: [jamming]}"})["ok"].get<bool>());
  EXPECT_FALSE(ask(FaultAddCommand{"gnss", "{type: jamming"})["ok"].get<bool>());
  EXPECT_FALSE(ask(FaultClearCommand{1})["ok"].get<bool>()) << "there is none";
}

TEST_F(RigFaultsTest, AStreamShowsIt) {
  const RigConfiguration none =
      load_rig(file_of("gnss"), {"devices.gnss.faults=[]", "devices.starfire.faults=[]"})
          .configuration;
  const Ran without = run(none, {}, 3s);
  const Ran with = run(none, {{FaultAddCommand{"gnss", "{type: jamming, loss: 30 dB}"}, 1s}}, 3s);
  EXPECT_NE(with.streams.at("gnss"), without.streams.at("gnss"));
  EXPECT_EQ(with.streams.at("starfire"), without.streams.at("starfire"));
}

TEST_F(RigFaultsTest, WithoutAnInstantItBeginsAtOnceAndIsTold) {
  const Json told = ask(FaultAddCommand{"gnss", "{type: frozen, for: 3 s}"});
  EXPECT_EQ(told["fault"]["id"], 1);
  EXPECT_EQ(told["fault"]["begin_ns"], 1'000'000'000);
  EXPECT_EQ(told["fault"]["end_ns"], 4'000'000'000);
}

/// Ended at an instant, it is the fault that the file says ends there.
TEST_F(RigFaultsTest, WhatIsClearedEndsThere) {
  const std::string file = "devices.gnss.faults=[{type: jamming, at: 1 s, for: ";
  const std::string none = "devices.starfire.faults=[]";
  const auto configured = [&](const std::string& length) {
    return load_rig(file_of("gnss"), {file + length + ", loss: 40 dB}]", none}).configuration;
  };
  const Ran cleared = run(configured("10 s"), {{FaultClearCommand{1}, 3s}}, 6s);
  const std::int64_t end_ns = cleared.answers.at(0)["fault"]["end_ns"];
  EXPECT_GE(end_ns, 3'000'000'000);
  EXPECT_LE(end_ns, 3'002'000'001) << "later than the next slice";
  const Ran known = run(configured(std::to_string(end_ns - 1'000'000'000) + " ns"), {}, 6s);
  EXPECT_EQ(cleared.streams, known.streams);
}

/// A boom that the hand of nobody moves stays where it is; what is waited for is there at once, or
/// never.
TEST_F(RigFaultsTest, AFaultWaitsForAQuantityOfTheMachineAndBeginsThen) {
  const RigConfiguration none =
      load_rig(file_of("gnss"), {"devices.gnss.faults=[]", "devices.starfire.faults=[]"})
          .configuration;
  const std::string quantity = [&] {
    boost::asio::io_context io;
    const Rig rig(none, io, {});
    return rig.truth().state_quantities().front().name;
  }();
  const auto waits = [&](const std::string& value) {
    return Request{FaultAddCommand{"gnss", "{type: outage, for: 1 s, when: {quantity: " + quantity +
                                               ", above: true, value: " + value + "}}"},
                   1s};
  };
  const Ran without = run(none, {}, 3s);
  const Ran met = run(none, {waits("-1e9"), {FaultListCommand{}, 2500ms}}, 3s);
  EXPECT_NE(met.streams.at("gnss"), without.streams.at("gnss"));
  EXPECT_EQ(met.answers.at(0)["fault"]["begin_ns"], nullptr);
  EXPECT_THAT(std::string(met.answers.at(0)["fault"]["waits_for"]), HasSubstr(quantity + " above"));
  const Json& begun = met.answers.at(1)["faults"].at(0);
  EXPECT_EQ(begun["id"], 1);
  EXPECT_GE(begun["begin_ns"].get<std::int64_t>(), 1'000'000'000);
  EXPECT_LE(begun["begin_ns"].get<std::int64_t>(), 1'010'000'000);
  EXPECT_EQ(run(none, {waits("-1e9")}, 3s).streams, met.streams) << "it does not repeat";

  const Ran in_vain = run(none, {waits("1e9"), {FaultListCommand{}, 2500ms}}, 3s);
  EXPECT_EQ(in_vain.streams, without.streams);
  EXPECT_EQ(in_vain.answers.at(1)["faults"].at(0)["begin_ns"], nullptr);
  const Ran cleared = run(none, {waits("1e9"), {FaultClearCommand{1}, 2s}}, 3s);
  EXPECT_TRUE(cleared.answers.at(1)["ok"].get<bool>()) << cleared.answers.at(1);
}

TEST_F(RigFaultsTest, AQuantityThatTheMachineDoesNotHaveIsRefused) {
  const Json nobody =
      ask(FaultAddCommand{"gnss", "{type: outage, when: {quantity: sped, value: 1}}"});
  EXPECT_FALSE(nobody["ok"].get<bool>());
  EXPECT_EQ(nobody["path"], "fault.when.quantity");
  EXPECT_THAT(nobody["allowed"].get<std::string>(), HasSubstr("speed (km/h)"));
  EXPECT_THAT(nobody["allowed"].get<std::string>(), HasSubstr("did you mean speed?"));
}

TEST_F(RigFaultsTest, TheSeedDecidesWhichRepetitionsHappen) {
  const auto with_seed = [](const std::string& seed) {
    return load_rig(file_of("gnss"),
                    {"devices.starfire.faults=[]", "seed=" + seed,
                     "devices.gnss.faults=[{type: noise, every: 1 s, for: 0.5 s, probability: "
                     "50 %, bit_error_rate: 0.01}]"})
        .configuration;
  };
  std::map<std::string, std::uint64_t> first;
  EXPECT_EQ(run(with_seed("1"), {}, 5s).streams, run(with_seed("1"), {}, 5s).streams);
  EXPECT_NE(run(with_seed("1"), {}, 5s).streams, run(with_seed("2"), {}, 5s).streams);
}

// Every pair of a device, bus or line and a kind that it can have, with clients on the wires. A USB
// plug and a camera are walked where their clients are: tests/hil/wires/rig_usb_test.cpp,
// tests/emulators/gige_camera, tests/conformance.

using test::Content;
using test::WireClients;

/// When a fault holds, and when what follows it is looked at.
struct Walk {
  SimTime fault = kStart + 4s;
  Duration length = 3s;
  SimTime from = kStart + 17s;  ///< The device has recovered by its own rules.
  SimTime to = kStart + 19s;
};

class MatrixOf : public testing::TestWithParam<std::string> {
  OneAtATime alone_;

 protected:
  [[nodiscard]] static Walk walk() {
    // A lidar is dear: it starts in a second here and has its rotor again in a few. Its fault is
    // over the hour's end, at the second 5. Valves have nothing to acquire.
    return GetParam() == "lidar"    ? Walk{kStart + 4s, 1500ms, kStart + 12s, kStart + 13s}
           : GetParam() == "modbus" ? Walk{kStart + 2s, 1500ms, kStart + 8s, kStart + 9s}
                                    : Walk{};
  }
  /// What is compared: where valves fail the machine goes elsewhere.
  [[nodiscard]] static Content compared(const RigConfiguration& rig, const WireClients& clients) {
    Content content = test::content_of(rig, clients, walk().from, walk().to);
    if (GetParam() == "modbus") {
      std::erase_if(content, [](const auto& entry) {
        return !entry.first.starts_with("tcp") && !entry.first.starts_with("rtu");
      });
    }
    return content;
  }
  /// Keys of the rig that make what happens visible in that time.
  [[nodiscard]] static std::vector<std::string> sets() {
    if (GetParam() == "gnss") {  // that three seconds without corrections show
      return {"devices.gnss.sensor.corrections.largest_age=2 s"};
    }
    return GetParam() == "lidar" ? std::vector<std::string>{"devices.lidar.start_up=1 s"}
                                 : std::vector<std::string>{};
  }
  [[nodiscard]] static Ran run_with(const RigConfiguration& healthy, WireClients& clients,
                                    std::vector<Request> requests) {
    const Walk at = walk();
    if (GetParam() == "can") {
      test::ask_nodes(clients, at.fault + 1s);
    } else if (GetParam() == "gnss") {
      test::ask_receiver(clients, at.fault + 1s);
    } else if (GetParam() == "modbus") {
      test::work_valves(clients, at.fault, at.length, at.to);
    }
    requests.push_back({ReadCommand{}, at.from - kStart});
    requests.push_back({ReadCommand{}, at.to - kStart});
    return run(healthy, requests, at.to - kStart + 100ms, &clients);
  }
};

/// What a fault does shows on a wire. After its end and what the device does to recover it sends as
/// much as one that had none, and the same: values within their noise, states alike.
TEST_P(MatrixOf, EachKindShowsAndTheDeviceRecovers) {
  // The second lidar and the second valve driver have the kinds of the first.
  const std::set<std::string> twins{"roof", "valves_rtu"};
  const Walk at = walk();
  Problems problems;
  const Value document = load_document(file_of(GetParam()), problems);
  std::vector<std::string> changes = sets();
  std::vector<std::pair<std::string, Json>> pairs;
  each_part(document, [&](const std::string& path, const std::string& on, const Value& part) {
    const Value* faults = part.find("faults");
    if (faults == nullptr) {
      return;
    }
    changes.push_back(path + ".faults=[]");
    std::set<std::string> seen;
    for (const Value& fault : faults->items) {
      Json keys = json_of(fault);
      for (const char* when : {"at", "for", "until", "every", "duty", "probability", "ramp"}) {
        keys.erase(when);
      }
      keys["for"] = std::to_string(at.length.count()) + " ns";
      // A block on CAN does not tell its temperature, and is not too hot in so short a time.
      if (!twins.contains(on) && !(on == "valves_can" && keys["type"] == "ambient") &&
          seen.insert(keys["type"]).second) {
        pairs.emplace_back(on, keys);
      }
    }
  });
  RigConfiguration healthy = load_rig(file_of(GetParam()), changes).configuration;
  healthy.devices.erase("roof");
  WireClients clients;
  const Ran without = run_with(healthy, clients, {});
  const Content usual = compared(healthy, clients);
  EXPECT_FALSE(usual.empty());
  const auto sent = [](const Ran& ran, const std::string& device) {
    const std::size_t last = ran.answers.size() - 1;
    return ran.answers.at(last)["devices"][device]["frames"].get<double>() -
           ran.answers.at(last - 1)["devices"][device]["frames"].get<double>();
  };
  for (const auto& [on, keys] : pairs) {
    SCOPED_TRACE(on + " " + keys.dump());
    WireClients theirs;
    const Ran with =
        run_with(healthy, theirs, {{FaultAddCommand{on, keys.dump()}, at.fault - kStart}});
    ASSERT_TRUE(with.answers.at(0)["ok"].get<bool>()) << with.answers.at(0);
    EXPECT_NE(with.streams, without.streams) << "nobody can see it";
    for (const auto& [device, hash] : with.streams) {
      const double frames = sent(without, device);
      EXPECT_NEAR(sent(with, device), frames, std::max(2.0, 0.1 * frames))
          << device << " has not recovered";
    }
    // A node that has lost its address to a lower NAME says the same from another one, and stays
    // there.
    if (keys["type"] != "masquerade") {
      test::expect_alike(compared(healthy, theirs), usual);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(, MatrixOf, testing::Values("can", "gnss", "lidar", "modbus"),
                         [](const auto& test) { return test.param; });

}  // namespace
}  // namespace rigwire::hil
