#!/usr/bin/env python3
"""Writes haul_truck_side.png: what is painted on the sides of the dump body, by formula.

1024 x 256 pixels over 5.70 m x 1.65 m, sRGB: orange paint with a number, a reflecting band, hazard
strips at both ends, ribs, dirt that runs down from them. Needs Python alone.
Usage: ./make_haul_truck_side.py > haul_truck_side.png
"""
import struct
import sys
import zlib

WIDTH, HEIGHT = 1024, 256
PAINT, YELLOW, BLACK = (200, 123, 48), (226, 172, 34), (28, 27, 26)
WHITE, RED = (226, 226, 220), (176, 36, 28)
DIRT = (128, 108, 82)
# Digits of 5 x 7 fields.
DIGITS = {"2": ["01110", "10001", "00001", "00110", "01000", "10000", "11111"],
          "7": ["11111", "00001", "00010", "00100", "01000", "01000", "01000"]}


def noise(x, y):
    """-1 .. 1, of whole numbers."""
    mixed = (x * 0x9E3779B1 ^ y * 0x85EBCA77) & 0xFFFFFFFF
    mixed = ((mixed ^ mixed >> 15) * 0x2C1B3C6D) & 0xFFFFFFFF
    return (mixed ^ mixed >> 13) % 2048 / 1023.5 - 1


def smooth(x, y, cell):
    """Noise blended between the corners of cells."""
    column, row = int(x // cell), int(y // cell)
    a, b = x / cell - column, y / cell - row
    upper = noise(column, row) * (1 - a) + noise(column + 1, row) * a
    lower = noise(column, row + 1) * (1 - a) + noise(column + 1, row + 1) * a
    return upper * (1 - b) + lower * b


def in_number(x, y):
    size, left, top = 22, 380, 36
    column, row = (x - left) // size, (y - top) // size
    if not 0 <= row < 7 or column < 0:
        return False
    digit, field = divmod(column, 7)
    return digit < 2 and field < 5 and DIGITS["27"[digit]][row][field] == "1"


def colour(x, y):
    if not 52 <= x < WIDTH - 52:  # hazard strips, their stripes at 45 degrees
        base = BLACK if (x + y) // 34 % 2 else YELLOW
    elif in_number(x, y):
        base = BLACK
    elif 66 <= y < 78 and not x // 64 % 2 and not 350 < x < 670:  # reflecting band
        base = RED if x // 128 % 2 else WHITE
    else:
        base = PAINT
    light = 1.0
    rib = (x + 64) % 128
    if rib < 6 or 10 <= rib < 13:  # a welded rib: its light side, its shadow
        light = 1.08 if rib < 6 else 0.72
    # Dirt: streaks from above, splashes from below, blotches.
    streak = max(0.0, smooth(x, 0.12 * y + 900, 7)) * (1 - y / HEIGHT) * 0.5
    splash = max(0.0, (y - 150) / 106) ** 2 * (0.55 + 0.35 * smooth(x, y, 15))
    blotch = max(0.0, smooth(x + 5000, y, 40)) * 0.25
    dirt = min(0.85, streak + splash + blotch)
    # In steps of three, which a file keeps in a third of the bytes.
    return [min(255, 3 * round((light * b + (d - light * b) * dirt) / 3)) for b, d in zip(base, DIRT)]


def chunk(name, content):
    body = name + content
    return struct.pack(">I", len(content)) + body + struct.pack(">I", zlib.crc32(body))


rows = b"".join(b"\0" + bytes(part for x in range(WIDTH) for part in colour(x, y))
                for y in range(HEIGHT))
sys.stdout.buffer.write(b"\x89PNG\r\n\x1a\n"
                        + chunk(b"IHDR", struct.pack(">IIBBBBB", WIDTH, HEIGHT, 8, 2, 0, 0, 0))
                        + chunk(b"IDAT", zlib.compress(rows, 9)) + chunk(b"IEND", b""))
