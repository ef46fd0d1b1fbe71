#!/usr/bin/env python3
"""Velodyne packets to points, written from the manuals; it shares no table with protocols/velodyne.

    velodyne_points.py capture.pcap

reads a classic pcap of Ethernet, IPv4 and UDP and prints one line for each measured return:

    packet firing laser echo time_us azimuth_deg elevation_deg range_m reflectivity x_m y_m z_m

firing counts within its packet; echo is last, strongest or both; time is past the hour; x forward,
y left, z up. An HDL-64E is read with the calibration that its own status bytes carry, after the code
in appendix F of its manual. Whatever is against the manuals ends the program with a message.

Elevations stand as the manuals draw them: by column of the laser map, from the top down.
"""
import math
import struct
import sys

STRONGEST, LAST, DUAL = 0x37, 0x38, 0x39
BANKS = {0xEEFF: 0, 0xDDFF: 1, 0xCCFF: 2, 0xBBFF: 3}


class Model:
    """lasers: number -> (elevation deg, azimuth offset deg, height mm)."""

    def __init__(self, unit_m, lasers, period_us, fires_us, firings_per_block=1, blocks_per_firing=1):
        self.unit_m = unit_m
        self.lasers = lasers
        self.period_us = period_us
        self.fires_us = fires_us
        self.firings_per_block = firings_per_block
        self.blocks_per_firing = blocks_per_firing


def focused(elevations, focus_mm, offset=0.0):
    return {
        laser: (deg, offset, focus_mm * math.tan(math.radians(-deg)))
        for laser, deg in elevations.items()
    }


def columns(by_offset, focus_mm):
    lasers = {}
    for offset, elevations in by_offset.items():
        lasers.update(focused(elevations, focus_mm, offset))
    return lasers


def hdl_32e():
    # Even lasers climb from -30.67 degrees, odd ones from -9.33, both by 4/3.
    elevations = {}
    for step in range(16):
        elevations[2 * step] = round(-92 / 3 + step * 4 / 3, 2)
        elevations[2 * step + 1] = round(-28 / 3 + step * 4 / 3, 2)
    return focused(elevations, 28.83)


def vlp_16():
    # Even lasers climb from -15 degrees, odd ones from +1, both by 2.
    return focused({laser: laser - 15 if laser % 2 == 0 else laser for laser in range(16)}, 41.91)


def puck_hi_res():
    # As the VLP-16, a third narrower; heights printed by rank.
    heights_mm = (0.9, 1.8, 2.7, 3.7, 4.6, 5.5, 6.5, 7.4)
    lasers = {}
    for laser in range(16):
        deg = round((laser - 15 if laser % 2 == 0 else laser) * 2 / 3, 3)
        height = heights_mm[(int(round(abs(deg) * 1.5)) - 1) // 2]
        lasers[laser] = (deg, 0.0, math.copysign(height, -deg))
    return lasers


VLP_32C_MAP = {
    4.2: {14: 0.667, 6: -0.667, 28: -2, 20: -3.333, 12: -5.333},
    1.4: {30: 10.333, 26: 4.667, 22: 2.333, 18: 1, 10: -0.333, 2: -1.667,
          24: -3, 16: -4.667, 8: -7.254, 4: -11.31, 0: -25},
    -1.4: {29: 15, 25: 7, 21: 3.333, 13: 1.333, 5: 0, 31: -1.333,
           23: -2.667, 15: -4, 11: -6.148, 7: -8.843, 3: -15.639},
    -4.2: {17: 1.667, 9: 0.333, 1: -1, 27: -2.333, 19: -3.667},
}

VLS_128_MAP = {
    6.354: {120: 8.43, 112: 4.98, 56: 4.06, 48: 3.18, 104: 2.3, 96: 1.42, 40: 0.54,
            32: -0.34, 88: -1.22, 80: -2.1, 24: -2.98, 16: -3.86, 72: -4.74, 64: -5.62,
            8: -6.5, 0: -11.742},
    4.548: {41: 9.7, 33: 5.18, 89: 4.17, 81: 3.29, 25: 2.41, 17: 1.53, 73: 0.65,
            65: -0.23, 9: -1.11, 1: -1.99, 121: -2.87, 113: -3.75, 57: -4.63, 49: -5.51,
            105: -6.39, 97: -10.346},
    2.732: {74: 11.75, 66: 5.43, 10: 4.28, 2: 3.4, 122: 2.52, 114: 1.64, 58: 0.76,
            50: -0.12, 106: -1, 98: -1.88, 42: -2.76, 34: -3.64, 90: -4.52, 82: -5.4,
            26: -6.28, 18: -9.244},
    0.911: {59: 15, 51: 5.73, 107: 4.39, 99: 3.51, 43: 2.63, 35: 1.75, 91: 0.87,
            83: -0.01, 27: -0.89, 19: -1.77, 75: -2.65, 67: -3.53, 11: -4.41, 3: -5.29,
            123: -6.17, 115: -8.352},
    -0.911: {92: 6.08, 84: 4.5, 28: 3.62, 20: 2.74, 76: 1.86, 68: 0.98, 12: 0.1,
             4: -0.78, 124: -1.66, 116: -2.54, 60: -3.42, 52: -4.3, 108: -5.18, 100: -6.06,
             44: -7.65, 36: -25},
    -2.732: {13: 6.48, 5: 4.61, 125: 3.73, 117: 2.85, 61: 1.97, 53: 1.09, 109: 0.21,
             101: -0.67, 45: -1.55, 37: -2.43, 93: -3.31, 85: -4.19, 29: -5.07, 21: -5.95,
             77: -7.15, 69: -19.582},
    -4.548: {110: 6.98, 102: 4.72, 46: 3.84, 38: 2.96, 94: 2.08, 86: 1.2, 30: 0.32,
             22: -0.56, 78: -1.44, 70: -2.32, 14: -3.2, 6: -4.08, 126: -4.96, 118: -5.84,
             62: -6.85, 54: -16.042},
    -6.354: {31: 7.58, 23: 4.83, 79: 3.95, 71: 3.07, 15: 2.19, 7: 1.31, 127: 0.43,
             119: -0.45, 63: -1.33, 55: -2.21, 111: -3.09, 103: -3.97, 47: -4.85, 39: -5.73,
             95: -6.65, 87: -13.565},
}

MODELS = {
    0x21: Model(0.002, hdl_32e(), 46.08, lambda laser: 1.152 * laser),
    0x22: Model(0.002, vlp_16(), 55.296, lambda laser: 2.304 * laser, firings_per_block=2),
    0x24: Model(0.002, puck_hi_res(), 55.296, lambda laser: 2.304 * laser, firings_per_block=2),
    0x28: Model(0.004, columns(VLP_32C_MAP, 42.4), 55.296, lambda laser: 2.304 * (laser // 2)),
    0xA1: Model(
        0.004,
        columns(VLS_128_MAP, 58.63),
        57.78,  # since firmware 5.2.3.0; 53.3 and 2.665 before
        lambda laser: 2.889 * (laser // 8 + laser // 64) - 8.7,
        blocks_per_firing=4,
    ),
}
HDL_64E_S2 = Model(
    0.002,
    None,
    48.0,
    lambda laser: 6.0 * (laser % 32 // 4) + (0, 1.26, 2.46, 3.66)[laser % 4],
    blocks_per_firing=2,
)
HDL_64E_S3 = Model(
    0.002,
    None,
    57.6,
    lambda laser: 7.2 * (laser % 32 // 4) + (0, 1.3, 2.5, 3.7)[laser % 4],
    blocks_per_firing=2,
)


class Packet:
    CHANNELS = struct.Struct("<HH" + 32 * "HB")

    def __init__(self, payload):
        if len(payload) != 1206:
            sys.exit(f"a data packet of {len(payload)} bytes")
        self.blocks = [self.CHANNELS.unpack_from(payload, 100 * b) for b in range(12)]
        self.stamp_us, self.mode, self.product = struct.unpack_from("<LBB", payload, 1200)
        for block in self.blocks:
            if block[1] >= 36000:
                sys.exit("an azimuth of 36000 or more")


def payloads(path, port):
    with open(path, "rb") as file:
        head = file.read(24)
        if head[:4] != b"\xd4\xc3\xb2\xa1":
            sys.exit("not a little-endian pcap")
        while record := file.read(16):
            frame = file.read(struct.unpack("<LLLL", record)[2])
            if frame[12:14] == b"\x08\x00" and frame[23] == 17:
                if struct.unpack_from(">H", frame, 36)[0] == port:
                    yield frame[42:]


class Calibration:
    """What the status bytes of a whole round of 4160 packets say."""

    def __init__(self, packets):
        pieces = bytearray()
        self.is_s3 = False
        for packet in packets:
            if chr(packet.mode) not in "HMSDNYGTV":
                pieces.append(packet.product)
                self.is_s3 |= packet.mode == ord("W")
        start = pieces.find(b"UNIT#")
        record = pieces[start : start + 1820]
        if start < 0 or len(record) < 1820:
            sys.exit("no whole calibration in the status bytes")
        self.check(record)
        self.mode = LAST if record[1815] == 1 else STRONGEST
        self.lasers = {}
        for number in range(64):
            at = 7 + 28 * number
            values = struct.unpack_from("<B9h2B", record, at)
            if values[0] != number:
                sys.exit(f"laser {number} calls itself {values[0]}")
            self.lasers[number] = values[1:]

    def check(self, record):
        said = struct.unpack("<H", record[-2:])[0]
        if not self.is_s3:
            if said != 1820:
                sys.exit("an S2 whose length is not 1820")
            return
        rest = 0
        for number in range(64):
            for byte in record[8 + 28 * number : 28 + 28 * number]:
                for bit in range(7, -1, -1):
                    top = (rest >> 15) ^ (byte >> bit & 1)
                    rest = (rest << 1 & 0xFFFF) ^ (0x8005 if top else 0)
        if rest != said:
            sys.exit("the calibration's CRC is wrong")

    def point(self, laser, counts, intensity, rotor_deg):
        """Appendix F, in centimetres as there; then the range along the beam."""
        vert, rot, far, near_x, near_y, up, side, focus, slope, low, high = self.lasers[laser]
        elevation = math.radians(vert / 100)
        azimuth_deg = (rotor_deg - rot / 100) % 360
        sin_r, cos_r = math.sin(math.radians(azimuth_deg)), math.cos(math.radians(azimuth_deg))
        sin_v, cos_v = math.sin(elevation), math.cos(elevation)
        far, near_x, near_y, up, side = far / 10, near_x / 10, near_y / 10, up / 10, side / 10
        raw = counts * 0.2
        level = (raw + far) * cos_v
        xx = abs(level * sin_r - side * cos_r)
        yy = abs(level * cos_r + side * sin_r)
        by_x = (far - near_x) * (xx - 240) / (2504 - 240) + near_x
        by_y = (far - near_y) * (yy - 193) / (2504 - 193) + near_y
        right = (raw + by_x) * cos_v * sin_r - side * cos_r
        forward = (raw + by_y) * cos_v * cos_r + side * sin_r
        above = (raw + by_y) * sin_v
        along = (
            (right + side * cos_r) * cos_v * sin_r
            + (forward - side * sin_r) * cos_v * cos_r
            + above * sin_v
        )
        focal = 256 * slope / 10 * abs((1 - focus / 131000) ** 2 - (1 - counts / 65535) ** 2)
        seen = min(max(intensity + focal, low), high)
        xyz = (forward / 100, -right / 100, (above + up) / 100)
        return azimuth_deg, vert / 100, along / 100, seen, xyz


def plain_point(model, laser, counts, intensity, rotor_deg):
    deg, offset, height_mm = model.lasers[laser]
    azimuth_deg = (rotor_deg + offset) % 360
    range_m = counts * model.unit_m
    level = range_m * math.cos(math.radians(deg))
    xyz = (
        level * math.cos(math.radians(azimuth_deg)),
        -level * math.sin(math.radians(azimuth_deg)),
        range_m * math.sin(math.radians(deg)) + height_mm / 1000,
    )
    return azimuth_deg, deg, range_m, intensity, xyz


def firings(packet, model, dual, is_hdl_64e):
    """For each firing of blocks: its azimuth and, bank by bank, (first echo, block) pairs."""
    per_firing = model.blocks_per_firing * (2 if dual else 1)
    for start in range(0, 12 - per_firing + 1, per_firing):
        group = packet.blocks[start : start + per_firing]
        if dual and model.blocks_per_firing == 4 and start > 0:
            break
        if len({block[1] for block in group}) != 1:
            sys.exit("blocks of one firing disagree in azimuth")
        banks = []
        for bank in range(model.blocks_per_firing):
            if not dual:
                pair = [(None, group[bank])]
            elif is_hdl_64e:
                pair = [("strongest", group[bank]), ("last", group[bank + 2])]
            else:
                pair = [("last", group[2 * bank]), ("strongest", group[2 * bank + 1])]
            for _, block in pair:
                if BANKS.get(block[0]) != bank:
                    sys.exit(f"flag {block[0]:04x} for bank {bank}")
            banks.append(pair)
        yield group[0][1], banks


def returns_of(pair, channel, mode):
    found = [(echo, block[2 + 2 * channel], block[3 + 2 * channel]) for echo, block in pair]
    if len(found) == 1:
        return [("last" if mode == LAST else "strongest",) + found[0][1:]]
    if found[0][1:] == found[1][1:]:
        return [("both",) + found[0][1:]]
    return found


def main(path):
    packets = [Packet(payload) for payload in payloads(path, 2368)]
    is_hdl_64e = packets[0].blocks[1][0] == 0xDDFF and packets[0].blocks[2][0] != 0xCCFF
    if packets[0].mode == DUAL and packets[0].product == 0xA1:
        is_hdl_64e = False
    calibration = Calibration(packets) if is_hdl_64e else None
    before = None
    lines = []
    for index, packet in enumerate(packets):
        if is_hdl_64e:
            model = HDL_64E_S3 if calibration.is_s3 else HDL_64E_S2
            dual = packet.blocks[0][1] == packet.blocks[2][1]
            mode = DUAL if dual else calibration.mode
        else:
            if packet.product not in MODELS or packet.mode not in (STRONGEST, LAST, DUAL):
                sys.exit(f"factory bytes {packet.mode:02x} {packet.product:02x}")
            model, mode = MODELS[packet.product], packet.mode
        groups = list(firings(packet, model, mode == DUAL, is_hdl_64e))
        block_us = model.period_us * model.firings_per_block
        for number, (azimuth, banks) in enumerate(groups):
            if number + 1 < len(groups):
                step = (groups[number + 1][0] - azimuth) % 36000
            elif number > 0:
                step = (azimuth - groups[number - 1][0]) % 36000
            else:
                step = 0 if before is None else (azimuth - before) % 36000
            for bank, pair in enumerate(banks):
                if not any(any(block[2::2]) for _, block in pair):
                    continue
                for channel in range(32):
                    laser = 32 * bank + channel
                    firing = number
                    if model.firings_per_block == 2:
                        laser, firing = channel % 16, 2 * number + channel // 16
                    for echo, counts, intensity in returns_of(pair, channel, mode):
                        if counts == 0:
                            continue
                        fires_us = model.fires_us(laser)
                        since_us = fires_us - model.fires_us(0)
                        since_us += (firing - number * model.firings_per_block) * model.period_us
                        rotor_deg = (azimuth + step * since_us / block_us) / 100
                        if is_hdl_64e:
                            found = calibration.point(laser, counts, intensity, rotor_deg)
                        else:
                            found = plain_point(model, laser, counts, intensity, rotor_deg)
                        time_us = packet.stamp_us + firing * model.period_us + fires_us
                        azimuth_deg, elevation_deg, range_m, seen, (x, y, z) = found
                        lines.append(
                            f"{index} {firing} {laser} {echo} {time_us:.4f} {azimuth_deg:.6f} "
                            f"{elevation_deg:.4f} {range_m:.6f} {seen:.3f} {x:.6f} {y:.6f} {z:.6f}"
                        )
        before = groups[0][0]
    print("\n".join(lines))


if __name__ == "__main__":
    main(sys.argv[1])
