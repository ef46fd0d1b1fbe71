#!/usr/bin/env python3
"""Writes the centre line of a scene's track as a path file for examples/path_follow.

    scripts/path-from-track.py configs/scenes/forest_track.yaml > configs/paths/forest_track.csv

Options: --track NAME (the first), --spacing METRES (2), --latitude, --longitude, --height of the
scene's origin (the defaults of a rig's `origin`).

Catmull-Rom, centripetal, as sim/scene/track.h; tangent plane to WGS 84 by way of earth-centred
coordinates. A test compares the committed file with the scene.
"""
import argparse
import math
import re

A = 6378137.0
F = 1 / 298.257223563
E2 = F * (2 - F)


def read_tracks(path):
    """Name, points and whether it is closed of each track; knows the layout of configs/scenes."""
    tracks, inside = [], False
    for line in open(path, encoding="utf-8"):
        line = line.split("#")[0].rstrip()
        if re.match(r"\S", line):
            inside = line.startswith("tracks:")
        elif inside and (name := re.match(r"\s*- name:\s*(\S+)", line)):
            tracks.append({"name": name[1], "points": [], "closed": False})
        elif inside and (at := re.search(r"at:\s*\[\s*([-\d.]+)\s*m?\s*,\s*([-\d.]+)", line)):
            tracks[-1]["points"].append((float(at[1]), float(at[2])))
        elif inside and re.match(r"\s*closed:\s*true", line):
            tracks[-1]["closed"] = True
    return tracks


def spline(points, closed, pieces=64):
    count = len(points)

    def at(i):
        if closed:
            return points[i % count]
        if i < 0:
            return tuple(2 * a - b for a, b in zip(points[0], points[1]))
        if i >= count:
            return tuple(2 * a - b for a, b in zip(points[-1], points[-2]))
        return points[i]

    def mix(p, q, u):
        return (p[0] + (q[0] - p[0]) * u, p[1] + (q[1] - p[1]) * u)

    line = [at(0)]
    for span in range(count if closed else count - 1):
        a, b, c, d = (at(span + k) for k in (-1, 0, 1, 2))
        tb = math.dist(a, b) ** 0.5
        tc = tb + math.dist(b, c) ** 0.5
        td = tc + math.dist(c, d) ** 0.5
        for k in range(1, pieces + 1):
            t = tb + (tc - tb) * k / pieces
            ab, bc, cd = mix(a, b, t / tb), mix(b, c, (t - tb) / (tc - tb)), mix(c, d, (t - tc) / (td - tc))
            line.append(mix(mix(ab, bc, t / tc), mix(bc, cd, (t - tb) / (td - tb)), (t - tb) / (tc - tb)))
    return line


def evenly(line, spacing):
    length = sum(math.dist(p, q) for p, q in zip(line, line[1:]))
    spacing = length / round(length / spacing)
    result, done, wanted = [line[0]], 0.0, spacing
    for p, q in zip(line, line[1:]):
        piece = math.dist(p, q)
        while wanted <= done + piece + 1e-9:
            u = (wanted - done) / piece
            result.append((p[0] + (q[0] - p[0]) * u, p[1] + (q[1] - p[1]) * u))
            wanted += spacing
        done += piece
    return result


def geodetic(east, north, lat0, lon0, height0):
    """Of a point in the tangent plane, itself at height 0 of the plane."""
    f, l = math.radians(lat0), math.radians(lon0)
    n = A / math.sqrt(1 - E2 * math.sin(f) ** 2)
    x = (n + height0) * math.cos(f) * math.cos(l) - math.sin(l) * east - math.sin(f) * math.cos(l) * north
    y = (n + height0) * math.cos(f) * math.sin(l) + math.cos(l) * east - math.sin(f) * math.sin(l) * north
    z = (n * (1 - E2) + height0) * math.sin(f) + math.cos(f) * north
    p = math.hypot(x, y)
    latitude = math.atan2(z, p * (1 - E2))
    for _ in range(8):
        n = A / math.sqrt(1 - E2 * math.sin(latitude) ** 2)
        latitude = math.atan2(z + E2 * n * math.sin(latitude), p)
    return math.degrees(latitude), math.degrees(math.atan2(y, x))


def main():
    parser = argparse.ArgumentParser(description="Writes a scene's track as a path file.")
    parser.add_argument("scene")
    parser.add_argument("--track")
    parser.add_argument("--spacing", type=float, default=2.0)
    parser.add_argument("--latitude", type=float, default=49.4247)
    parser.add_argument("--longitude", type=float, default=7.7517)
    parser.add_argument("--height", type=float, default=240.0)
    given = parser.parse_args()
    tracks = [t for t in read_tracks(given.scene) if given.track in (None, t["name"])]
    if not tracks:
        parser.error(f"{given.scene}: no such track")
    track = tracks[0]
    line = evenly(spline(track["points"], track["closed"]), given.spacing)
    if track["closed"] and math.dist(line[0], line[-1]) < 0.01:
        line.pop()
    print(f"# Centre line of the track '{track['name']}' of {given.scene}, for a rig whose origin is")
    print(f"# {given.latitude}, {given.longitude}. Made by scripts/path-from-track.py.")
    if track["closed"]:
        print("closed")
    for east, north in line:
        print("%.9f,%.9f" % geodetic(east, north, given.latitude, given.longitude, given.height))


main()
