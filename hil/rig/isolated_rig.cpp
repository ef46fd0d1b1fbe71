#include "hil/rig/isolated_rig.h"

#include <arpa/inet.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <set>
#include <string_view>
#include <system_error>

#include "drivers/endpoints.h"
#include "hil/configuration/document.h"
#include "hil/configuration/outline.h"
#include "hil/configuration/reader.h"

namespace rigwire::hil {
namespace {

namespace fs = std::filesystem;

/// UDP ports that a client binds: by the beginning of the device's type.
struct ClientPort {
  std::string_view type;
  std::string_view key;
};
constexpr std::array<ClientPort, 3> kClientPorts{
    {{"velodyne-", "port"}, {"velodyne-", "position_port"}, {"replay", "port"}}};
/// IPv4 addresses of wires: what is bound, listened at, sent from or to.
constexpr std::array<std::string_view, 2> kAddresses{"address", "source_address"};

/// Files of ground truth.
constexpr std::array<std::string_view, 3> kTruthFiles{"path", "lidar_path", "camera_folder"};

std::optional<std::array<std::uint8_t, 4>> ipv4(const std::string& text) {
  std::array<std::uint8_t, 4> parts{};
  return ::inet_pton(AF_INET, text.c_str(), parts.data()) == 1 ? std::optional(parts)
                                                               : std::nullopt;
}

class Isolation {
 public:
  Isolation(const Origins& origins, const fs::path& folder, drivers::LoopbackClaims& claims,
            RemoteAddresses remote)
      : origins_(origins), folder_(folder), claims_(claims), remote_(remote) {}

  void rig(const RigConfiguration& configuration) {
    for (const OutlineNode& section : outline(configuration).children) {
      for (const OutlineNode& node : section.children) {
        const std::string at = section.key + "." + node.key;
        if (section.key == "buses") {
          bus(at, node);
        } else if (section.key == "modbus" || section.key == "devices") {
          line(at, node);
          client_ports(at, node);
          memory(at, node);
        } else if (section.key == "truth") {
          truth(at, node);
        }
      }
      addresses(section.key, section);
    }
    problems_.throw_if_any();
  }

  [[nodiscard]] std::vector<Replacement> take() && { return std::move(replacements_); }

 private:
  void replace(std::string key, std::string value) {
    replacements_.push_back({std::move(key), std::move(value)});
  }
  [[nodiscard]] static const OutlineNode* find(const OutlineNode& node, std::string_view key) {
    const auto found = std::find_if(node.children.begin(), node.children.end(),
                                    [&](const OutlineNode& child) { return child.key == key; });
    return found == node.children.end() ? nullptr : &*found;
  }
  /// A link in the folder: of its owner's name, or where two have it with the kind in front.
  [[nodiscard]] std::string link(const std::string& at, const std::string& name) {
    const std::string chosen = links_.insert(name).second ? name : at;
    return (folder_ / "wires" / chosen).string();
  }

  void bus(const std::string& at, const OutlineNode& node) {
    const OutlineNode* wire = find(node, "wire");
    if (wire != nullptr && wire->canonical == "gs_usb") {
      replace(at + ".attach", "false");
      return;
    }
    replace(at + ".wire", "slcan");
    replace(at + ".path", link(at, node.key));
  }

  void line(const std::string& at, const OutlineNode& node) {
    const OutlineNode* path = find(node, "path");
    if (path != nullptr && path->type == "text" && !path->canonical.empty()) {
      replace(at + ".path", link(at, node.key));
    }
  }

  void client_ports(const std::string& at, const OutlineNode& node) {
    const OutlineNode* type = find(node, "type");
    for (const ClientPort& port : kClientPorts) {
      const OutlineNode* found = find(node, port.key);
      if (type != nullptr && type->canonical.starts_with(port.type) && found != nullptr &&
          found->canonical != "0") {
        replace(fmt::format("{}.{}", at, port.key), std::to_string(claims_.datagram_port()));
      }
    }
  }

  void memory(const std::string& at, const OutlineNode& node) {
    for (const OutlineNode& child : node.children) {
      if (child.file != fields::FileKind::memory || child.canonical.empty()) {
        continue;
      }
      const fs::path copy = folder_ / "memory" / node.key;
      std::error_code error;
      fs::create_directories(copy.parent_path(), error);
      if (!error && fs::exists(child.canonical, error)) {
        fs::copy_file(child.canonical, copy, error);
      }
      if (error) {
        throw drivers::EndpointError(fmt::format("{}: cannot be copied from {}: {}", copy.string(),
                                                 child.canonical, error.message()));
      }
      replace(at + "." + child.key, copy.string());
    }
  }

  void truth(const std::string& at, const OutlineNode& node) {
    const bool is_file =
        std::find(kTruthFiles.begin(), kTruthFiles.end(), node.key) != kTruthFiles.end();
    if (is_file && !node.canonical.empty()) {
      replace(at, (folder_ / fs::path(node.canonical).filename()).string());
    }
  }

  void addresses(const std::string& at, const OutlineNode& node) {
    for (const OutlineNode& child : node.children) {
      const std::string key = at + "." + child.key;
      const bool is_address =
          child.type == "text" &&
          std::find(kAddresses.begin(), kAddresses.end(), child.key) != kAddresses.end();
      const auto parts = is_address ? ipv4(child.canonical) : std::nullopt;
      if (!parts) {
        addresses(key, child);
      } else if ((*parts)[0] == 127) {
        replace(key, claims_.address(host(*parts)));
      } else if (remote_ == RemoteAddresses::refused) {
        problems_.add({origins_.nearest(key), key,
                       "an isolated run has addresses of this machine's loopback alone",
                       child.canonical, "127.0.0.0 .. 127.255.255.255", ""});
      }
    }
  }
  /// Its last byte, or where another address has that, the next that is free.
  [[nodiscard]] unsigned host(const std::array<std::uint8_t, 4>& address) {
    const auto known = hosts_.find(address);
    if (known != hosts_.end()) {
      return known->second;
    }
    constexpr unsigned kHosts = 254;
    if (taken_.size() == kHosts) {
      throw drivers::EndpointError(
          fmt::format("an isolated run has {} addresses, the rig names more", kHosts));
    }
    unsigned host = std::clamp<unsigned>(address[3], 1, kHosts);
    while (!taken_.insert(host).second) {
      host = host % kHosts + 1;
    }
    return hosts_[address] = host;
  }

  const Origins& origins_;
  const fs::path& folder_;
  drivers::LoopbackClaims& claims_;
  RemoteAddresses remote_;
  std::set<std::string> links_;
  std::map<std::array<std::uint8_t, 4>, unsigned> hosts_;
  std::set<unsigned> taken_;
  std::vector<Replacement> replacements_;
  Problems problems_;
};

}  // namespace

std::vector<Replacement> isolating(const RigConfiguration& configuration, const Origins& origins,
                                   const fs::path& folder, drivers::LoopbackClaims& claims,
                                   RemoteAddresses remote) {
  Isolation isolation(origins, folder, claims, remote);
  isolation.rig(configuration);
  return std::move(isolation).take();
}

RigConfiguration with(const RigConfiguration& configuration,
                      const std::vector<Replacement>& replacements) {
  Problems problems;
  Value document = parse_document(print_rig(configuration), "the rig", "/", problems);
  for (const Replacement& replacement : replacements) {
    apply_set(document, replacement.key + "=" + replacement.value, problems);
  }
  LoadedRig rig;
  read(document, rig.configuration, problems, rig.origins);
  check_rig(rig.configuration, rig.origins, problems);
  problems.throw_if_any();
  return rig.configuration;
}

}  // namespace rigwire::hil
