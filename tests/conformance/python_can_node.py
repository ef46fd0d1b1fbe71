"""A J1939 node made with python-can alone: what a device of others looks like to the suite j1939.

    python_can_node.py slcan LINK           an adapter's line for a client, a pseudo-terminal
    python_can_node.py socketcan INTERFACE

It claims address 40, sends two groups by themselves (wheel-based speed every 100 ms, coolant
temperature every second), answers requests for them and for its component identification, which
takes three packets, and says that it cannot claim when its address is taken by a lower NAME. A
commanded address moves it.
"""

import struct
import sys
import time

import can
from null_modem import null_modem

NAME = struct.pack("<Q", 0x0000_2100_F560_1234)  # not arbitrary, function 33, identity 1234 hex
PREFERRED = 40
NOBODY, EVERYBODY = 254, 255
REQUEST, CLAIM, ACKNOWLEDGEMENT = 0xEA00, 0xEE00, 0xE800
CONTROL, PACKETS = 0xEC00, 0xEB00
COMMANDED_ADDRESS = 0xFED8
SPEED, COOLANT, COMPONENT = 65265, 65262, 65259
TEXT = b"PYCAN*NODE*0001**"
GROUPS = {
    SPEED: bytes([0xFF, 0, 25, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF]),  # 25 km/h
    COOLANT: bytes([120, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF]),  # 80 degC
}
PERIODS_S = {SPEED: 0.1, COOLANT: 1.0}
CLEAR_TO_SEND_S = 1.25
BROADCAST_GAP_S = 0.06


class Node:
    def __init__(self, bus):
        self.bus = bus
        self.address = PREFERRED
        self.tasks = []
        self.outgoing = None  # destination, deadline of its next clear to send
        self.commanded = b""

    def send(self, group, data, destination=EVERYBODY, priority=6):
        specific = destination if group >> 8 & 0xFF < 240 else 0
        identifier = priority << 26 | (group | specific) << 8 | self.address
        self.bus.send(can.Message(arbitration_id=identifier, is_extended_id=True, data=data))

    def claim(self, address):
        self.be_silent()
        self.address = address
        self.send(CLAIM, NAME)
        for group, period in PERIODS_S.items():
            message = can.Message(
                arbitration_id=6 << 26 | group << 8 | address,
                is_extended_id=True,
                data=GROUPS[group],
            )
            self.tasks.append(self.bus.send_periodic(message, period))

    def be_silent(self):
        for task in self.tasks:
            task.stop()
        self.tasks = []
        self.outgoing = None

    def control(self, first, destination):
        self.send(CONTROL, bytes(first) + COMPONENT.to_bytes(3, "little"), destination, 7)

    def packet(self, number, destination):
        part = TEXT[7 * (number - 1) : 7 * number]
        self.send(PACKETS, bytes([number]) + part.ljust(7, b"\xff"), destination, 7)

    def send_text(self, destination):
        packets = -(-len(TEXT) // 7)
        size = len(TEXT).to_bytes(2, "little")
        if destination != EVERYBODY:
            self.control([16, *size, packets, 0xFF], destination)
            self.outgoing = (destination, time.monotonic() + CLEAR_TO_SEND_S)
            return
        self.control([32, *size, packets, 0xFF], EVERYBODY)
        for number in range(1, packets + 1):
            time.sleep(BROADCAST_GAP_S)
            self.packet(number, EVERYBODY)

    def take(self, message):
        if not message.is_extended_id or message.is_remote_frame:
            return
        group = message.arbitration_id >> 8 & 0x3FFFF
        source = message.arbitration_id & 0xFF
        destination = EVERYBODY
        if group >> 8 & 0xFF < 240:
            destination = group & 0xFF
            group &= 0x3FF00
        data = bytes(message.data)
        if group == CLAIM and len(data) == 8:
            self.take_claim(source, data)
        elif group == REQUEST and len(data) == 3 and destination in (self.address, EVERYBODY):
            self.answer(int.from_bytes(data, "little"), source, destination == EVERYBODY)
        elif group == CONTROL and len(data) == 8 and destination == self.address:
            self.take_control(source, data)
        elif group in (CONTROL, PACKETS) and len(data) == 8 and destination == EVERYBODY:
            self.take_broadcast(group, data)

    def take_claim(self, source, name):
        if source != self.address or source == NOBODY:
            return
        if int.from_bytes(name, "little") > int.from_bytes(NAME, "little"):
            self.send(CLAIM, NAME)
        else:
            self.be_silent()
            self.address = NOBODY
            self.send(CLAIM, NAME)

    def answer(self, group, source, global_request):
        if group == CLAIM:
            self.send(CLAIM, NAME)
        elif self.address == NOBODY:
            return
        elif group in GROUPS:
            self.send(group, GROUPS[group])
        elif group == COMPONENT:
            self.send_text(EVERYBODY if global_request else source)
        elif not global_request:
            refused = bytes([1, 0xFF, 0xFF, 0xFF, source]) + group.to_bytes(3, "little")
            self.send(ACKNOWLEDGEMENT, refused)

    def take_control(self, source, data):
        if data[0] == 16:  # nothing is taken by transport
            abort = bytes([255, 2, 0xFF, 0xFF, 0xFF]) + data[5:]
            self.send(CONTROL, abort, source, 7)
        elif self.outgoing is None or self.outgoing[0] != source:
            return
        elif data[0] == 17:
            for number in range(data[2], data[2] + data[1]):
                self.packet(number, source)
            self.outgoing = (source, time.monotonic() + CLEAR_TO_SEND_S)
        elif data[0] in (19, 255):
            self.outgoing = None

    def take_broadcast(self, group, data):
        if group == CONTROL:
            commands = data[0] == 32 and int.from_bytes(data[5:], "little") == COMMANDED_ADDRESS
            self.commanded = b"" if commands else None
        elif self.commanded is not None:
            self.commanded += data[1:]
            if len(self.commanded) >= 9:
                if self.commanded[:8] == NAME:
                    self.claim(self.commanded[8])
                self.commanded = None

    def live(self):
        self.claim(PREFERRED)
        print("claimed", flush=True)
        while True:
            if message := self.bus.recv(0.05):
                self.take(message)
            if self.outgoing and time.monotonic() > self.outgoing[1]:
                self.control([255, 3, 0xFF, 0xFF, 0xFF], self.outgoing[0])
                self.outgoing = None


def main():
    interface, where = sys.argv[1:]
    if interface == "slcan":
        bus = can.Bus(null_modem(where), interface="slcan", bitrate=250000, sleep_after_open=0)
    else:
        bus = can.Bus(where, interface=interface)
    Node(bus).live()


main()
