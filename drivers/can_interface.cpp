#include "drivers/can_interface.h"

#include <linux/can/netlink.h>
#include <linux/if_arp.h>
#include <linux/if_link.h>
#include <linux/netlink.h>
#include <linux/rtnetlink.h>
#include <sys/socket.h>

#include <algorithm>
#include <cstring>
#include <type_traits>

#include "drivers/descriptor.h"

namespace rigwire::drivers {
namespace {

using Bytes = std::span<const std::uint8_t>;

template <class T>
std::optional<T> load(Bytes bytes, std::size_t offset = 0) {
  static_assert(std::is_trivially_copyable_v<T>);
  if (bytes.size() < offset + sizeof(T)) {
    return std::nullopt;
  }
  T value;
  std::memcpy(&value, bytes.data() + offset, sizeof value);
  return value;
}

constexpr std::size_t aligned(std::size_t length) {
  return (length + 3U) & ~std::size_t{3};
}

/// The content of the first attribute of that type; empty when there is none.
Bytes attribute(Bytes attributes, unsigned type) {
  while (const auto head = load<rtattr>(attributes)) {
    if (head->rta_len < sizeof(rtattr) || head->rta_len > attributes.size()) {
      break;
    }
    if ((head->rta_type & NLA_TYPE_MASK) == type) {
      return attributes.subspan(sizeof(rtattr), head->rta_len - sizeof(rtattr));
    }
    attributes = attributes.subspan(std::min(aligned(head->rta_len), attributes.size()));
  }
  return {};
}

std::string text(Bytes bytes) {
  return {bytes.begin(), std::find(bytes.begin(), bytes.end(), std::uint8_t{0})};
}

std::optional<CanInterface> parse_link(Bytes message) {
  const auto link = load<ifinfomsg>(message);
  if (!link || link->ifi_type != ARPHRD_CAN) {
    return std::nullopt;
  }
  const Bytes attributes = message.subspan(std::min(aligned(sizeof(ifinfomsg)), message.size()));
  const Bytes information = attribute(attributes, IFLA_LINKINFO);
  CanInterface interface;
  interface.name = text(attribute(attributes, IFLA_IFNAME));
  interface.index = link->ifi_index;
  interface.up = (link->ifi_flags & IFF_UP) != 0;
  interface.kind = text(attribute(information, IFLA_INFO_KIND));
  const auto timing =
      load<can_bittiming>(attribute(attribute(information, IFLA_INFO_DATA), IFLA_CAN_BITTIMING));
  // slcan has an unknown rate, all ones, when its user set it by another way.
  interface.bit_rate_bps = timing && timing->bitrate <= 1'000'000 ? timing->bitrate : 0;
  return interface;
}

bool ask_for_links(int socket) {
  struct {
    nlmsghdr head;
    ifinfomsg link;
  } request{};
  request.head.nlmsg_len = sizeof request;
  request.head.nlmsg_type = RTM_GETLINK;
  request.head.nlmsg_flags = NLM_F_REQUEST | NLM_F_DUMP;
  request.link.ifi_family = AF_UNSPEC;
  return ::send(socket, &request, sizeof request, 0) == static_cast<ssize_t>(sizeof request);
}

/// Whether the answer's last message is the end of the dump (or says that it failed).
bool ends(Bytes answer) {
  while (const auto head = load<nlmsghdr>(answer)) {
    if (head->nlmsg_len < sizeof(nlmsghdr) || head->nlmsg_type == NLMSG_DONE ||
        head->nlmsg_type == NLMSG_ERROR) {
      return true;
    }
    answer = answer.subspan(std::min(aligned(head->nlmsg_len), answer.size()));
  }
  return false;
}

}  // namespace

std::vector<CanInterface> parse_links(Bytes answer) {
  std::vector<CanInterface> interfaces;
  while (const auto head = load<nlmsghdr>(answer)) {
    if (head->nlmsg_len < sizeof(nlmsghdr) || head->nlmsg_len > answer.size()) {
      break;
    }
    if (head->nlmsg_type == RTM_NEWLINK) {
      const std::size_t length = head->nlmsg_len - sizeof(nlmsghdr);
      if (auto interface = parse_link(answer.subspan(sizeof(nlmsghdr), length))) {
        interfaces.push_back(std::move(*interface));
      }
    }
    answer = answer.subspan(std::min(aligned(head->nlmsg_len), answer.size()));
  }
  return interfaces;
}

std::vector<CanInterface> can_interfaces() {
  std::vector<CanInterface> interfaces;
  const Descriptor socket(::socket(AF_NETLINK, SOCK_RAW | SOCK_CLOEXEC, NETLINK_ROUTE));
  if (!socket.open() || !ask_for_links(socket.get())) {
    return interfaces;
  }
  std::vector<std::uint8_t> buffer(64 * 1024);  // the kernel's dumps come in pieces of 32 KiB
  for (bool more = true; more;) {
    const ssize_t size = ::recv(socket.get(), buffer.data(), buffer.size(), 0);
    const Bytes answer = std::span(buffer).first(size > 0 ? static_cast<std::size_t>(size) : 0);
    for (CanInterface& interface : parse_links(answer)) {
      interfaces.push_back(std::move(interface));
    }
    more = size > 0 && !ends(answer);
  }
  return interfaces;
}

std::optional<CanInterface> find_can_interface(const std::string& name) {
  const auto all = can_interfaces();
  const auto found = std::find_if(all.begin(), all.end(), [&name](const CanInterface& interface) {
    return interface.name == name;
  });
  return found == all.end() ? std::nullopt : std::optional(*found);
}

}  // namespace rigwire::drivers
