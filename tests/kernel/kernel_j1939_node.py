"""A J1939 node made of the kernel's J1939 sockets alone: transport, addresses and NAMEs are the
kernel's. Its address is claimed by can-utils' j1939acd, of the same NAME.

    kernel_j1939_node.py INTERFACE NAME

It sends wheel-based speed every 100 ms, answers requests for that and for its component
identification, which takes three packets, and refuses others. Without an address it is silent.
"""

import select
import socket
import sys
import time

INTERFACE, NAME = sys.argv[1], int(sys.argv[2], 16)
SOL_CAN_J1939 = socket.SOL_CAN_BASE + socket.CAN_J1939
ADDRESS_LENGTH = socket.CMSG_SPACE(1) + socket.CMSG_SPACE(8)  # of address and NAME
EVERYBODY = socket.J1939_NO_ADDR
REQUEST, CLAIM, ACKNOWLEDGEMENT = 0xEA00, 0xEE00, 0xE800
SPEED, COMPONENT = 65265, 65259
GROUPS = {
    SPEED: bytes([0xFF, 0, 25, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF]),  # 25 km/h
    COMPONENT: b"LINUX*J1939*0001**",
}
PERIOD_S = 0.1


def open_node():
    node = socket.socket(socket.PF_CAN, socket.SOCK_DGRAM, socket.CAN_J1939)
    node.setsockopt(socket.SOL_SOCKET, socket.SO_BROADCAST, 1)
    node.setblocking(False)
    node.bind((INTERFACE, NAME, socket.J1939_NO_PGN, socket.J1939_NO_ADDR))
    return node


def send(node, group, data, destination=EVERYBODY):
    try:
        node.sendto(data, (INTERFACE, 0, group, destination))
    except OSError as error:  # no address, or the message before it is on its way
        print(f"{group}: {error}", flush=True)


def answer(node, data, source, destination):
    group = int.from_bytes(data, "little")
    if len(data) != 3 or group == CLAIM:  # claims are j1939acd's
        return
    everybody = destination == EVERYBODY
    if group in GROUPS:
        send(node, group, GROUPS[group], EVERYBODY if everybody else source)
    elif not everybody:
        send(node, ACKNOWLEDGEMENT, bytes([1, 0xFF, 0xFF, 0xFF, source]) + data)


def take(node):
    try:
        data, ancillary, _, sender = node.recvmsg(1785, ADDRESS_LENGTH)
    except OSError as error:  # what became of an answer
        print(f"receiving: {error}", flush=True)
        return
    _, _, group, source = sender
    destination = EVERYBODY
    for level, kind, what in ancillary:
        if (level, kind) == (SOL_CAN_J1939, socket.SCM_J1939_DEST_ADDR):
            destination = what[0]
    if group == REQUEST:
        answer(node, data, source, destination)


def live():
    # Messages of one socket wait for each other, and a long one waits for its receiver.
    answers, periodic = open_node(), open_node()
    due = time.monotonic()
    while True:
        if select.select([answers], [], [], max(0.0, due - time.monotonic()))[0]:
            take(answers)
        if time.monotonic() >= due:
            due += PERIOD_S
            send(periodic, SPEED, GROUPS[SPEED])


live()
