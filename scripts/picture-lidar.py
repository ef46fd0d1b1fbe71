#!/usr/bin/env python3
"""Draws what the HDL-32E sees: a panorama shaded by range over a top view shaded by height.

  scripts/picture-lidar.py [--port 2368] [--skip 5] OUT.png     live, the revolution after SKIP ones
  scripts/picture-lidar.py --view cloud ... OUT.png             the points as seen from behind
  scripts/picture-lidar.py --file PACKETS OUT.png               PACKETS: data packets, end to end
  scripts/picture-lidar.py --save PACKETS ... OUT.png           keeps what it drew

Panorama: straight ahead in the middle, left on the left, each pixel one laser shot, near is bright
and warm, dark is no return. Top view: 100 m by 50 m around the sensor, ahead is up; the gaps are
in the shadow of machine, truck and boom (nearer than 1 m there are no returns).
Cloud: the same points from behind and above the sensor (--eye, --look: ahead, left, up in metres),
shaded by height and, where they are bright, by reflectivity.
Needs nothing but Python; the packet format is decoded here, apart from the program's own tables
(HDL-32E user's manual 63-9113 Rev. H, "Packet format").
"""
import argparse
import math
import socket
import struct
import sys
import zlib

PACKET_SIZE = 12 * 100 + 6
LASERS = 32
FIRING_US = 46.08
LASER_US = 1.152
# Lasers fire alternately from the lower and the upper half of the fan, 4/3 degrees apart.
ELEVATIONS_DEG = [(-30.67 + 4 / 3 * (j // 2)) if j % 2 == 0 else (-9.33 + 4 / 3 * (j // 2))
                  for j in range(LASERS)]
COLUMNS = 1800  # of the panorama, 0.2 degrees each
ROW_HEIGHT = 9  # pixels per laser
TOP_ROWS = 900
TOP_METRES = 50.0  # from its upper to its lower edge
CLOUD_SIZE = (1600, 900)
BACKGROUND = (20, 20, 26)


def blocks_of(packet):
    """Yields (azimuth in degrees, [(distance in m, reflectivity)]) of one data packet."""
    for b in range(12):
        flag, azimuth = struct.unpack_from("<HH", packet, 100 * b)
        if flag != 0xEEFF:
            raise ValueError(f"block flag {flag:04x}")
        shots = [struct.unpack_from("<HB", packet, 100 * b + 4 + 3 * j) for j in range(LASERS)]
        yield azimuth / 100.0, [(0.002 * distance, reflectivity) for distance, reflectivity in shots]


def packets_from_file(path):
    with open(path, "rb") as file:
        data = file.read()
    for start in range(0, len(data) - PACKET_SIZE + 1, PACKET_SIZE):
        yield data[start:start + PACKET_SIZE]


def packets_from_port(port, timeout_s):
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as receiver:
        receiver.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4 << 20)
        receiver.bind(("", port))
        receiver.settimeout(timeout_s)
        while True:
            packet = receiver.recv(2048)
            if len(packet) == PACKET_SIZE:
                yield packet


def one_revolution(packets, skip):
    """The packets of one revolution, after `skip` whole ones; -1: from the first packet on."""
    revolution, last, passed = [], None, -1
    for packet in packets:
        azimuth = struct.unpack_from("<H", packet, 2)[0]
        if last is not None and azimuth < last:
            passed += 1
            if passed > skip:
                revolution.append(packet)  # It may hold the last degrees before north.
                return revolution
        if passed == skip:
            revolution.append(packet)
        last = azimuth
    return revolution


def shots_of(revolution):
    """Yields (azimuth, elevation in radians, range in m, reflectivity, laser) of every shot."""
    firings = [block for packet in revolution for block in blocks_of(packet)]
    for i, (azimuth, shots) in enumerate(firings):
        following = firings[i + 1][0] if i + 1 < len(firings) else azimuth
        per_us = ((following - azimuth) % 360.0) / FIRING_US
        for j, (distance, reflectivity) in enumerate(shots):
            yield (math.radians(azimuth + per_us * LASER_US * j),
                   math.radians(ELEVATIONS_DEG[j]), distance, reflectivity, j)


def warm(share):
    """A ramp from dark blue over green to pale yellow, 0 .. 1."""
    stops = [(13, 8, 60), (40, 60, 150), (30, 140, 140), (90, 190, 90), (250, 225, 60),
             (255, 250, 210)]
    x = max(0.0, min(1.0, share)) * (len(stops) - 1)
    i = min(int(x), len(stops) - 2)
    return tuple(round(a + (x - i) * (b - a)) for a, b in zip(stops[i], stops[i + 1]))


class Image:
    def __init__(self, width, height):
        self.width, self.height = width, height
        self.pixels = bytearray(bytes(BACKGROUND) * (width * height))

    def rectangle(self, x, y, width, height, colour):
        x0, x1 = max(x, 0), min(x + width, self.width)
        if x0 < x1:
            for row in range(max(y, 0), min(y + height, self.height)):
                start = 3 * (row * self.width + x0)
                self.pixels[start:start + 3 * (x1 - x0)] = bytes(colour) * (x1 - x0)

    def write_png(self, path):
        def chunk(kind, data):
            body = kind + data
            return struct.pack(">I", len(data)) + body + struct.pack(">I", zlib.crc32(body))
        stride = 3 * self.width
        rows = b"".join(b"\0" + bytes(self.pixels[y * stride:(y + 1) * stride])
                        for y in range(self.height))
        with open(path, "wb") as file:
            file.write(b"\x89PNG\r\n\x1a\n"
                       + chunk(b"IHDR", struct.pack(">IIBBBBB", self.width, self.height, 8, 2,
                                                    0, 0, 0))
                       + chunk(b"IDAT", zlib.compress(rows, 9)) + chunk(b"IEND", b""))


def points_of(revolution):
    """Yields (ahead, left, up in m, distance, reflectivity) of every return."""
    for azimuth, elevation, distance, reflectivity, _ in shots_of(revolution):
        if distance > 0.0:
            flat = distance * math.cos(elevation)
            yield (flat * math.cos(azimuth), -flat * math.sin(azimuth),
                   distance * math.sin(elevation), distance, reflectivity)


def draw_panorama(revolution, path):
    panorama_height = LASERS * ROW_HEIGHT
    image = Image(COLUMNS, panorama_height + 10 + TOP_ROWS)
    row_of = {j: row for row, j in enumerate(sorted(range(LASERS),
                                                    key=lambda j: -ELEVATIONS_DEG[j]))}
    scale = TOP_ROWS / TOP_METRES
    points = []
    seen = near = 0
    for azimuth, elevation, distance, reflectivity, laser in shots_of(revolution):
        if distance == 0.0:
            continue
        seen += 1
        near += distance < 2.0
        share = 1.0 - math.log(max(distance, 1.0)) / math.log(70.0)
        light = 0.55 + 0.45 * min(1.0, reflectivity / 45.0)
        colour = [round(light * c) for c in warm(share)]
        x = round(COLUMNS * (azimuth / (2 * math.pi) + 0.5)) % COLUMNS
        image.rectangle(x, ROW_HEIGHT * row_of[laser], 2, ROW_HEIGHT, colour)
        flat = distance * math.cos(elevation)
        points.append((distance * math.sin(elevation), flat * math.cos(azimuth),
                       -flat * math.sin(azimuth)))
    for up, ahead, left in sorted(points):  # Higher points over lower ones.
        x = round(COLUMNS / 2 - scale * left)
        y = panorama_height + 10 + round(TOP_ROWS / 2 - scale * ahead)
        if y >= panorama_height + 10:
            image.rectangle(x, y, 3, 3, warm((up + 6.0) / 10.0))
    for x, y in ((-4, 0), (0, -4)):  # A cross where the sensor is.
        image.rectangle(COLUMNS // 2 + x, panorama_height + 10 + TOP_ROWS // 2 + y,
                        1 - 2 * x, 1 - 2 * y, (255, 60, 60))
    image.write_png(path)
    shots = len(revolution) * 12 * LASERS
    print(f"{path}: {len(revolution)} packets, {shots} shots, {seen} returns "
          f"({100 * seen / shots:.1f} %), {near} nearer than 2 m")


def normalised(vector):
    length = math.sqrt(sum(c * c for c in vector))
    return [c / length for c in vector]


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def draw_cloud(revolution, path, eye, look):
    """A perspective picture of 90 degrees, far points first."""
    image = Image(*CLOUD_SIZE)
    ahead = normalised([b - a for a, b in zip(eye, look)])
    right = normalised(cross(ahead, [0.0, 0.0, 1.0]))
    up = cross(right, ahead)
    focal = CLOUD_SIZE[0] / 2
    drawn = []
    for x, y, z, _, reflectivity in points_of(revolution):
        offset = (x - eye[0], y - eye[1], z - eye[2])
        depth = sum(a * b for a, b in zip(offset, ahead))
        if depth > 0.5:
            column = CLOUD_SIZE[0] / 2 + focal * sum(a * b for a, b in zip(offset, right)) / depth
            row = CLOUD_SIZE[1] / 2 - focal * sum(a * b for a, b in zip(offset, up)) / depth
            light = 0.6 + 0.4 * min(1.0, reflectivity / 60.0)
            colour = ((255, 255, 255) if reflectivity > 100 else
                      [round(light * c) for c in warm(max(0.18, (z + 8.0) / 18.0))])
            drawn.append((depth, round(column), round(row), colour))
    for depth, column, row, colour in sorted(drawn, key=lambda point: -point[0]):
        size = max(2, min(5, round(40.0 / depth)))
        image.rectangle(column, row, size, size, colour)
    image.write_png(path)
    print(f"{path}: {len(revolution)} packets, {len(drawn)} points in view")


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--port", type=int, default=2368)
    parser.add_argument("--view", choices=["panorama", "cloud"], default="panorama")
    parser.add_argument("--eye", type=float, nargs=3, default=[-14.0, 0.0, 9.0])
    parser.add_argument("--look", type=float, nargs=3, default=[12.0, 0.0, -2.0])
    parser.add_argument("--file", help="data packets, end to end, instead of the port")
    parser.add_argument("--save", help="keep the drawn packets here")
    parser.add_argument("--skip", type=int, default=5, help="revolutions to pass over (5)")
    parser.add_argument("--timeout", type=float, default=10.0, help="seconds without a packet (10)")
    parser.add_argument("out")
    arguments = parser.parse_args()
    packets = (packets_from_file(arguments.file) if arguments.file
               else packets_from_port(arguments.port, arguments.timeout))
    try:
        revolution = one_revolution(packets, -1 if arguments.file else arguments.skip)
        if not revolution:
            sys.exit("picture-lidar: no whole revolution")
        if arguments.view == "cloud":
            draw_cloud(revolution, arguments.out, arguments.eye, arguments.look)
        else:
            draw_panorama(revolution, arguments.out)
    except (OSError, ValueError) as error:
        sys.exit(f"picture-lidar: {error}")
    if arguments.save:
        with open(arguments.save, "wb") as file:
            file.write(b"".join(revolution))


if __name__ == "__main__":
    main()
