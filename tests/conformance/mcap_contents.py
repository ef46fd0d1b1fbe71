"""What is in an MCAP file, read with nothing of ours, by the format's specification (mcap.dev).

    mcap_contents.py FILE

Follows the footer to the summary and its indices to the chunks, as a viewer that seeks does, and reads
the file once more from its front, as one that recovers does. Both must find the same. Prints one JSON
object: messages by topic, the last message of each, the schemas, the names of attachments.
"""
import json
import struct
import sys
import zlib

MAGIC = b"\x89MCAP0\r\n"
HEADER, FOOTER, SCHEMA, CHANNEL, MESSAGE, CHUNK, INDEX, CHUNK_INDEX, ATTACHMENT = range(1, 10)
STATISTICS, DATA_END = 0x0B, 0x0F


class Fields:
    def __init__(self, data):
        self.data, self.at = data, 0

    def take(self, size):
        piece = self.data[self.at:self.at + size]
        assert len(piece) == size, "cut off"
        self.at += size
        return piece

    def number(self, code):
        return struct.unpack("<" + code, self.take(struct.calcsize(code)))[0]

    def text(self):
        return self.take(self.number("I")).decode()

    def pairs(self, key, value):
        inner = Fields(self.take(self.number("I")))
        while inner.at < len(inner.data):
            yield inner.number(key), inner.number(value)


def records(data, at=0):
    """(place, opcode, content), as far as they are whole."""
    while at + 9 <= len(data):
        opcode, length = struct.unpack_from("<BQ", data, at)
        if at + 9 + length > len(data):
            return
        yield at, opcode, data[at + 9:at + 9 + length]
        at += 9 + length


def message(content):
    fields = Fields(content)
    channel, sequence = fields.number("H"), fields.number("I")
    stamp, published = fields.number("Q"), fields.number("Q")
    assert stamp == published
    return channel, sequence, stamp, content[fields.at:]


def chunk(content):
    fields = Fields(content)
    fields.take(16)
    size, crc, compression = fields.number("Q"), fields.number("I"), fields.text()
    assert compression == ""
    data = fields.take(fields.number("Q"))
    assert len(data) == size and zlib.crc32(data) == crc
    return data


class Contents:
    def __init__(self):
        self.schemas, self.channels, self.messages, self.attachments = {}, {}, [], []

    def add(self, opcode, content):
        fields = Fields(content)
        if opcode == SCHEMA:
            number, name, encoding = fields.number("H"), fields.text(), fields.text()
            assert encoding == "jsonschema"
            self.schemas[number] = name
            assert json.loads(fields.text())["type"] == "object"
        elif opcode == CHANNEL:
            number, schema, topic = fields.number("H"), fields.number("H"), fields.text()
            assert fields.text() == "json"
            self.channels[number] = (topic, self.schemas[schema])
        elif opcode == MESSAGE:
            self.messages.append(message(content))
        elif opcode == ATTACHMENT:
            fields.take(16)
            name = fields.text()
            fields.text()
            fields.take(fields.number("Q"))
            assert zlib.crc32(content[:fields.at]) == fields.number("I")
            self.attachments.append(name)


def from_the_front(data):
    contents = Contents()
    for _, opcode, content in records(data, len(MAGIC)):
        if opcode == DATA_END:
            break
        for _, inner, inside in records(chunk(content)) if opcode == CHUNK else [(0, opcode, content)]:
            contents.add(inner, inside)
    return contents


def by_the_indices(data):
    """Also holds the indices against what they lead to."""
    assert data.endswith(MAGIC)
    foot = len(data) - len(MAGIC) - 9 - 20
    summary = struct.unpack_from("<BQQQI", data, foot)[2]
    contents, counts = Contents(), {}
    for _, opcode, content in records(data, summary):
        fields = Fields(content)
        if opcode == STATISTICS:
            total = fields.number("Q")
            fields.take(2 + 4 + 4 + 4 + 4 + 8 + 8)
            counts = dict(fields.pairs("H", "Q"))
            assert sum(counts.values()) == total
        elif opcode == CHUNK_INDEX:
            first, last, place, length = (fields.number("Q") for _ in range(4))
            indices = dict(fields.pairs("H", "Q"))
            _, kind, found = next(records(data, place))
            assert kind == CHUNK and len(found) + 9 == length
            inside = chunk(found)
            for channel, at in indices.items():
                _, kind, index = next(records(data, at))
                index = Fields(index)
                assert kind == INDEX and index.number("H") == channel
                for stamp, offset in index.pairs("Q", "Q"):
                    _, kind, one = next(records(inside, offset))
                    assert kind == MESSAGE and first <= stamp <= last
                    contents.messages.append(message(one))
                    assert contents.messages[-1][0] == channel and contents.messages[-1][2] == stamp
        else:
            contents.add(opcode, content)
    for channel, count in counts.items():
        assert count == sum(1 for one in contents.messages if one[0] == channel)
    return contents


def main():
    with open(sys.argv[1], "rb") as file:
        data = file.read()
    assert data.startswith(MAGIC)
    contents = from_the_front(data)
    whole = data.endswith(MAGIC)
    if whole:
        indexed = by_the_indices(data)
        assert sorted(indexed.messages) == sorted(contents.messages)
        assert indexed.channels == contents.channels
    result = {"whole": whole, "attachments": contents.attachments, "topics": {}}
    for number, (topic, schema) in contents.channels.items():
        own = [one for one in contents.messages if one[0] == number]
        assert [one[1] for one in own] == list(range(len(own)))
        result["topics"][topic] = {"schema": schema, "messages": len(own),
                                   "last": json.loads(own[-1][3]) if own else None}
    print(json.dumps(result))


main()
