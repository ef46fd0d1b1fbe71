#include "hil/rig/private_wires.h"

#include <fmt/format.h>

#include <system_error>

#include "hil/devices/velodyne.h"

namespace rigwire::hil {
namespace {

namespace fs = std::filesystem;

/// Leads paths of ptys and saved files elsewhere, and lets the system choose TCP ports.
class WireMover final : public fields::Visitor {
 public:
  explicit WireMover(const fs::path& folder) : folder_(folder) {}

  void required(std::string_view) override {}
  void refused(std::string_view, std::string_view) override {}
  void conditional(bool holds, std::string_view, std::string_view,
                   const fields::Part& keys) override {
    if (holds) {
      keys.show(*this);
    }
  }
  void check(bool, std::string_view, const std::string&, const std::string&,
             const std::string&) override {}
  void number(std::string_view, double&, const fields::NumberRule&, std::string_view) override {}
  void numbers(std::string_view, std::span<double>, const fields::NumberRule&,
               std::string_view) override {}
  void number_list(std::string_view, std::vector<double>&, const fields::NumberRule&,
                   std::string_view) override {}
  void whole(std::string_view key, std::int64_t& value, const fields::IntegerRule&, bool,
             std::string_view) override {
    if (key == "port") {
      value = 0;
    }
  }
  void boolean(std::string_view, bool&, std::string_view) override {}
  void text(std::string_view key, std::string& value, std::string_view) override {
    if (key == "path" && !value.empty()) {
      value = next_path().string();
    }
  }
  void texts(std::string_view, std::vector<std::string>&, std::string_view) override {}
  void file(std::string_view, std::string& value, fields::FileKind kind,
            std::string_view) override {
    if (kind == fields::FileKind::memory && !value.empty()) {
      const fs::path copy = next_path();
      std::error_code is_new;
      fs::copy_file(value, copy, is_new);
      value = copy.string();
    }
  }
  void duration(std::string_view, std::chrono::nanoseconds&, const fields::DurationRule&,
                std::string_view) override {}
  void rate(std::string_view, std::chrono::nanoseconds&, const fields::NumberRule&,
            std::string_view) override {}
  void spelled(std::string_view, const fields::Spelling&, std::string_view) override {}
  void pick(std::string_view, std::size_t&, std::span<const fields::Named>,
            std::string_view) override {}
  void part(std::string_view, const fields::Part& part, std::string_view) override {
    part.show(*this);
  }
  void elements(std::string_view, fields::Elements& list, std::string_view) override {
    for (std::size_t i = 0; i < list.size(); ++i) {
      list.at(i).show(*this);
    }
  }
  void members(std::string_view, fields::Members& map, std::string_view,
               std::string_view) override {
    for (const std::string& name : map.names()) {
      map.at(name).show(*this);
    }
  }
  void alternatives(std::string_view, fields::Alternatives& types, std::string_view) override {
    types.chosen().show(*this);
  }

 private:
  [[nodiscard]] fs::path next_path() { return folder_ / fmt::format("wire{}", ++count_); }

  fs::path folder_;
  int count_ = 0;
};

}  // namespace

void make_private(RigConfiguration& rig, const fs::path& folder,
                  std::vector<std::string>& remarks) {
  WireMover mover(folder);
  for (auto& [name, bus] : rig.buses) {
    if (bus.ports != 1 || bus.socketcand.port != 0) {
      remarks.push_back(fmt::format(
          "bus {}: what clients of further ports (ports, socketcand) sent stands as the devices', "
          "and is not given again",
          name));
    }
    bus.ports = 1;
    bus.socketcand.port = 0;
    bus.attach = false;
  }
  for (auto& [name, line] : rig.modbus) {
    fields::Part::of(line).show(mover);
  }
  fields::Part::of(rig.usb).show(mover);
  for (auto& [name, device] : rig.devices) {
    if (auto* lidar = dynamic_cast<VelodyneConfiguration*>(&*device)) {
      if (lidar->web.port != 0) {
        remarks.push_back(name + ": its web interface is not recorded, and not asked again");
      }
      lidar->web.port = 0;
      lidar->source_ports = SourcePorts::any;
    } else if (device.type() == "ntrip-caster") {
      remarks.push_back(name + ": clients of a caster are not recorded, and do not come again");
      fields::Part::of(*device).show(mover);
    } else if (device.type() != "replay") {
      fields::Part::of(*device).show(mover);
    }
  }
  rig.truth.path.clear();
  rig.truth.lidar_path.clear();
  rig.truth.camera_folder.clear();
}

}  // namespace rigwire::hil
