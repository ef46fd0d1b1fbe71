#!/usr/bin/python3
"""The lidar's rays, cast by ours and by others, side by side in one run.

  scripts/lidar-peer.py [--program build/rigwire] [--helios PROGRAM] [--folder FOLDER]

Runs `rigwire bench lidar_peer`, which writes its scene and rays, then every peer that is installed
on the same scene and rays, one thread each, three times in turns; prints rays per second (the best
of the turns), the ratio to our whole lidar stage, and how far the ranges differ.

open3d   RaycastingScene of Debian's python3-open3d (with python3-numpy, and libembree-dev and cc for
         lidar_peer_open3d.c, without which its rays meet nothing)
helios   HELIOS++, through scripts/lidar_peer_helios.cpp built against it (docs/accuracy/
         depth-images.md); given with --helios

Debian's own Python, because its packages belong to that one.
"""
import argparse
import array
import json
import os
import subprocess
import sys
import tempfile
import time

TURNS = 3
REACH_M = 100.0
OPEN3D_ROUNDS = 5


def ours(program, folder):
    """Figures of our run; leaves scene.ply, rays.f64 and ranges.f32 in the folder."""
    out = os.path.join(folder, "ours.json")
    subprocess.run([program, "bench", "lidar_peer", "--json", out], check=True,
                   stdout=subprocess.DEVNULL, env={**os.environ, "RIGWIRE_PEER_FOLDER": folder})
    with open(out, encoding="utf-8") as file:
        return json.load(file)["lidar_peer"]


def load_numbers(path, kind):
    numbers = array.array(kind)
    with open(path, "rb") as file:
        numbers.frombytes(file.read())
    return numbers


def cast_with_open3d(folder):
    """In a process of its own: writes ranges_open3d.f64, prints name and CPU seconds."""
    import numpy
    import open3d
    mesh = open3d.io.read_triangle_mesh(os.path.join(folder, "scene.ply"))
    scene = open3d.t.geometry.RaycastingScene()
    scene.add_triangles(open3d.t.geometry.TriangleMesh.from_legacy(mesh))
    rays = numpy.fromfile(os.path.join(folder, "rays.f64")).reshape(-1, 6)
    rays = open3d.core.Tensor(rays.astype(numpy.float32))
    least = float("inf")
    for _ in range(OPEN3D_ROUNDS):
        before = time.process_time()
        found = scene.cast_rays(rays, nthreads=1)
        least = min(least, time.process_time() - before)
    ranges = found["t_hit"].numpy().astype(float)
    ranges[ranges > REACH_M] = 0.0
    ranges.tofile(os.path.join(folder, "ranges_open3d.f64"))
    print(f"Open3D {open3d.__version__} RaycastingScene\n{least:.6f}")


class Open3d:
    """Raises subprocess.CalledProcessError when it cannot be had."""

    def __init__(self, folder):
        self.folder = folder
        self.preload = os.path.join(folder, "lidar_peer_open3d.so")
        source = os.path.join(os.path.dirname(os.path.abspath(__file__)), "lidar_peer_open3d.c")
        subprocess.run(["cc", "-O2", "-shared", "-fPIC", "-o", self.preload, source, "-ldl"],
                       check=True)
        self.name = self.run()[0]

    def run(self):
        done = subprocess.run([sys.executable, os.path.abspath(__file__), "--open3d-in", self.folder],
                              check=True, stdout=subprocess.PIPE, text=True,
                              env={**os.environ, "LD_PRELOAD": self.preload})
        return done.stdout.strip().splitlines()[-2:]

    def cast(self):
        """Ranges, and CPU seconds of the least of some rounds."""
        seconds = float(self.run()[1])
        return load_numbers(os.path.join(self.folder, "ranges_open3d.f64"), "d"), seconds


class Helios:
    def __init__(self, folder, program):
        self.name = "HELIOS++ Scene::getIntersection"
        self.folder, self.program = folder, program

    def cast(self):
        done = subprocess.run([self.program, self.folder], check=True, capture_output=True,
                              text=True)
        seconds = float(done.stdout.strip().splitlines()[-1])
        return load_numbers(os.path.join(self.folder, "ranges_helios.f64"), "d"), seconds


def differences(ours_m, theirs_m):
    """Sorted absolute differences where both hit; rays that only one sees."""
    both = sorted(abs(a - b) for a, b in zip(ours_m, theirs_m) if a > 0 and b > 0)
    one_sided = sum((a > 0) != (b > 0) for a, b in zip(ours_m, theirs_m))
    return both, one_sided


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--program", default="build/rigwire")
    parser.add_argument("--helios", help="lidar_peer_helios, built against HELIOS++")
    parser.add_argument("--folder", help="keep scene, rays and ranges there")
    parser.add_argument("--open3d-in", help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if arguments.open3d_in:
        cast_with_open3d(arguments.open3d_in)
        return
    with tempfile.TemporaryDirectory() as scratch:
        folder = arguments.folder or scratch
        os.makedirs(folder, exist_ok=True)
        best = ours(arguments.program, folder)
        ranges = load_numbers(os.path.join(folder, "ranges.f32"), "f")
        peers = []
        try:
            peers.append(Open3d(folder))
        except subprocess.CalledProcessError as failure:
            print(f"without Open3D: {failure}", file=sys.stderr)
        if arguments.helios:
            peers.append(Helios(folder, arguments.helios))
        speed = {peer.name: 0.0 for peer in peers}
        found = {}
        for turn in range(TURNS):
            if turn > 0:
                again = ours(arguments.program, folder)
                for key in ("stage_rays_per_s", "bare_rays_per_s"):
                    best[key] = max(best[key], again[key])
            for peer in peers:
                found[peer.name], seconds = peer.cast()
                speed[peer.name] = max(speed[peer.name], best["rays"] / seconds)
        print(f"{best['triangles']} triangles, {best['rays']} rays, {best['hits']} hits, "
              "one thread, best of turns")
        stage = best["stage_rays_per_s"]
        head = f"{'':40} {'rays/s':>12} {'ours / it':>9} {'median mm':>10} {'99.9 % mm':>10} " \
               f"{'worst mm':>9} {'1-sided':>8}"
        print(head)
        print(f"{'Rigwire, lidar stage':40} {stage:12.0f} {1.0:9.2f}")
        print(f"{'Embree alone, same packets':40} {best['bare_rays_per_s']:12.0f} "
              f"{stage / best['bare_rays_per_s']:9.2f}")
        for peer in peers:
            both, one_sided = differences(ranges, found[peer.name])
            print(f"{peer.name:40} {speed[peer.name]:12.0f} {stage / speed[peer.name]:9.2f} "
                  f"{1e3 * both[len(both) // 2]:10.4f} {1e3 * both[len(both) * 999 // 1000]:10.4f} "
                  f"{1e3 * both[-1]:9.2f} {one_sided:8}")


if __name__ == "__main__":
    main()
