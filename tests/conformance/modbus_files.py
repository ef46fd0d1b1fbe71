"""A Modbus server of files and a queue alone, after the application protocol V1.1b3, 6.14, 6.15 and
6.18; no library at hand has more of them than their names.

    modbus_files.py PORT [DEFECT]

File 4 has the records 0 to 199, the queue at 1246 three registers. With one of the defects that are
named below it is wrong in that.
"""

import socketserver
import struct
import sys

PORT = int(sys.argv[1])
DEFECT = sys.argv[2] if len(sys.argv) > 2 else ""
READ, WRITE, QUEUE = 20, 21, 24
FILE, RECORDS, POINTER = 4, 200, 1246
ILLEGAL_FUNCTION, ILLEGAL_ADDRESS, ILLEGAL_VALUE = 1, 2, 3

records = [(7 * i + 1) % 65536 for i in range(RECORDS)]
queue = [11, 22, 33]


class Refused(Exception):
    pass


def require(holds, code):
    if not holds:
        raise Refused(code)


def place(kind, file, record, count):
    """Where in the records a group begins."""
    if DEFECT == "wraps_records":
        record %= RECORDS - count
    require(kind == 6 or DEFECT == "any_type", ILLEGAL_ADDRESS)
    require(file == FILE or DEFECT == "any_file", ILLEGAL_ADDRESS)
    require(record + count <= RECORDS, ILLEGAL_ADDRESS)
    return record


def read(body):
    length, groups = body[0], body[1:]
    if DEFECT != "any_length":
        require(7 <= length <= 0xF5 and length % 7 == 0, ILLEGAL_VALUE)
        require(len(groups) == length, ILLEGAL_VALUE)
    parts = []
    for at in range(0, len(groups), 7):
        group = groups[at : at + 7].ljust(7, b"\0")
        kind, file, record, count = struct.unpack(">BHHH", group)
        first = place(kind, file, record, count)
        if DEFECT == "changes":
            records[first] = (records[first] + 1) % 65536
        values = records[first : first + count]
        if DEFECT == "blocks_turned" and count > 1:
            values.reverse()
        size = count if DEFECT == "counts_registers" else 1 + 2 * count
        parts.append(struct.pack(f">BB{count}H", size, 6, *values))
    if DEFECT == "groups_turned":
        parts.reverse()
    answer = b"".join(parts)
    return bytes([len(answer) & 0xFF]) + answer


def write(body):
    length, groups = body[0], body[1:]
    if DEFECT != "any_length":
        require(9 <= length <= 0xFB, ILLEGAL_VALUE)
        require(len(groups) == length, ILLEGAL_VALUE)
    kind, file, record, count = struct.unpack(">BHHH", groups[:7])
    if DEFECT == "writes_what_it_refuses":
        records[0] ^= 1
    if DEFECT != "any_length":
        require(len(groups) == 7 + 2 * count, ILLEGAL_VALUE)
    first = place(kind, file, record, count)
    if DEFECT != "forgets":
        values = groups[7:].ljust(2 * count, b"\0")[: 2 * count]
        records[first : first + count] = struct.unpack(f">{count}H", values)
    return body[:1] if DEFECT == "does_not_repeat" else body


def read_queue(body):
    require(len(body) == 2 or DEFECT == "any_length", ILLEGAL_VALUE)
    pointer = int.from_bytes(body, "big")
    require(pointer == POINTER or DEFECT in ("queues_anywhere", "any_length"), ILLEGAL_ADDRESS)
    values = queue * 11 if DEFECT == "queue_too_long" else list(queue)
    count = len(values)
    size = 2 * count if DEFECT == "counts_values_alone" else 2 + 2 * count
    if DEFECT == "empties_the_queue":
        queue[:] = queue[1:]
    return struct.pack(f">HH{count}H", size, count, *values)


FUNCTIONS = {READ: read, WRITE: write, QUEUE: read_queue}


class Client(socketserver.StreamRequestHandler):
    def handle(self):
        while header := self.rfile.read(7):
            transaction, protocol, size, unit = struct.unpack(">HHHB", header)
            pdu = self.rfile.read(size - 1)
            try:
                require(pdu[0] in FUNCTIONS, ILLEGAL_FUNCTION)
                answer = pdu[:1] + FUNCTIONS[pdu[0]](pdu[1:])
            except Refused as refused:
                answer = bytes([pdu[0] | 0x80, refused.args[0]])
            self.wfile.write(
                struct.pack(">HHHB", transaction, protocol, len(answer) + 1, unit) + answer)


class Server(socketserver.ThreadingTCPServer):
    allow_reuse_address = True
    daemon_threads = True


Server(("127.0.0.1", PORT), Client).serve_forever()
