#!/usr/bin/env bash
# A network in which a simulated lidar has a real sensor's address, for drivers that take packets
# from that address only. docs/lidar-network.md has the recipes.
#
#   lidar-namespace.sh run COMMAND [ARG...]   runs COMMAND in a network of its own where both the
#                                             sensor's and the computer's address exist; nothing
#                                             else reaches in or out. Needs no root where users may
#                                             make namespaces. Exit status: the command's.
#   lidar-namespace.sh up                     makes the namespace "rigwire" for the sensor, with a
#                                             cable (veth) to this computer. Root.
#   lidar-namespace.sh exec COMMAND [ARG...]  runs COMMAND beside the sensor. Root.
#   lidar-namespace.sh down                   takes it away again. Root.
#
# Environment:
#   SENSOR_ADDRESS     default 192.168.1.201
#   COMPUTER_ADDRESS   default 192.168.1.100, in the same /24 network
#
# Exit status 69: the system does not allow what was asked; the message says what is missing.
set -euo pipefail

sensor=${SENSOR_ADDRESS:-192.168.1.201}
computer=${COMPUTER_ADDRESS:-192.168.1.100}
namespace=rigwire
cable=lidar0

fail() {
  echo "lidar-namespace: $*" >&2
  exit 69
}

need_root() {
  [ "$(id -u)" = 0 ] || fail "'$1' needs root; without it, 'run' may do"
  command -v ip >/dev/null || fail "no 'ip'; install iproute2"
}

run() {
  local own=(unshare --net)
  [ "$(id -u)" = 0 ] || own=(unshare --map-root-user --net)
  command -v ip >/dev/null || fail "no 'ip'; install iproute2"
  "${own[@]}" true 2>/dev/null ||
    fail "'${own[*]}' is not permitted here: run as root with CAP_SYS_ADMIN, or allow user" \
      "namespaces (sysctl kernel.unprivileged_userns_clone, user.max_user_namespaces)"
  # Loopback carries both addresses: no kernel module is needed, and packets keep their source.
  exec "${own[@]}" bash -euc '
    ip link set lo up
    ip address add "$0/24" dev lo
    ip address add "$1/24" dev lo
    ip route add 255.255.255.255 dev lo
    shift
    exec "$@"' "$sensor" "$computer" "$@"
}

up() {
  need_root up
  ip netns add "$namespace" ||
    fail "cannot make the namespace $namespace; is it there already ('down' removes it)?"
  ip link add "$cable" type veth peer name "$cable" netns "$namespace" || {
    ip netns delete "$namespace"
    fail "cannot make a veth pair; is $cable taken, does the kernel have veth?"
  }
  ip address add "$computer/24" dev "$cable"
  ip link set "$cable" up
  ip -n "$namespace" link set lo up
  ip -n "$namespace" address add "$sensor/24" broadcast + dev "$cable"
  ip -n "$namespace" link set "$cable" up
  ip -n "$namespace" route add 255.255.255.255 dev "$cable"
  echo "sensor $sensor in the namespace $namespace, this computer $computer"
}

down() {
  need_root down
  ip netns delete "$namespace" || fail "there is no namespace $namespace"
}

case ${1:-} in
  run) [ $# -ge 2 ] || fail "run what?" && shift && run "$@" ;;
  up) up ;;
  exec) need_root exec && shift && exec ip netns exec "$namespace" "$@" ;;
  down) down ;;
  *) sed -n '2,/^set /s/^# \{0,1\}//p' "$0" >&2 && exit 64 ;;
esac
