#!/usr/bin/env python3
"""Writes roller_drum.obj: a smooth steel drum 1.22 m across and 1.68 m wide, by formula.

Frame: the axle along y, origin at the drum's centre, metres.
Usage: ./make_roller_drum.py > roller_drum.obj
"""
import math

RADIUS, WIDTH, SEGMENTS = 0.61, 1.68, 32

print("# Written by make_roller_drum.py; the axle along y, metres.")
for side in (-0.5, 0.5):
    for k in range(SEGMENTS):
        angle = 2 * math.pi * k / SEGMENTS
        print(f"v {RADIUS * math.cos(angle):.5f} {side * WIDTH:.5f} {RADIUS * math.sin(angle):.5f}")
for k in range(SEGMENTS):
    a, b = k + 1, (k + 1) % SEGMENTS + 1
    print(f"f {a} {a + SEGMENTS} {b + SEGMENTS} {b}")
print("f", *range(1, SEGMENTS + 1))
print("f", *range(2 * SEGMENTS, SEGMENTS, -1))
