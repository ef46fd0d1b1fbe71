#!/usr/bin/env python3
"""Draws docs/pictures/weather_*.svg from the figures of `rigwire bench weather --json FILE`.

  build/rigwire bench weather --json weather.json && scripts/plot-weather.py weather.json [FOLDER]

FOLDER is docs/pictures beside this script's folder unless given. weather_transmission.svg: what is
left of the light over range, there and back. weather_dust.svg: the dust of a bucket that empties,
from above, and what a lidar returns. Standard library only.
"""
import importlib.util
import json
import math
import os
import sys

HERE = os.path.dirname(os.path.abspath(__file__))


def load_plot_bench():
    spec = importlib.util.spec_from_file_location("plot_bench",
                                                  os.path.join(HERE, "plot-bench.py"))
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


BENCH = load_plot_bench()


def transmission(curves, path):
    left, right, top, bottom = 60, 560, 40, 340
    picture = BENCH.Svg(760, 390)
    picture.text(left, 24, "Two-way transmission over range", kind="t")

    def x_of(range_m):
        return left + (right - left) * range_m / 100.0

    def y_of(share):
        return bottom - (bottom - top) * share

    for tenth in range(0, 11, 2):
        picture.line(left, y_of(tenth / 10), right, y_of(tenth / 10))
        picture.text(left - 8, y_of(tenth / 10) + 4, f"{10 * tenth} %", "end")
    for range_m in range(0, 101, 20):
        picture.line(x_of(range_m), top, x_of(range_m), bottom)
        picture.text(x_of(range_m), bottom + 18, f"{range_m} m", "middle")
    for index, curve in enumerate(curves):
        colour = BENCH.COLOURS[index % len(BENCH.COLOURS)]
        picture.path([(x_of(r), y_of(t)) for r, t in zip(curve["range_m"], curve["two_way"])],
                     colour)
        y = top + 20 + 24 * index
        picture.line(right + 20, y - 4, right + 44, y - 4, colour, 3)
        picture.text(right + 52, y, curve["medium"])
    picture.write(path)


def dust(view, path):
    scale = 32.0  # pixels per metre
    sensor_x, sensor_y = view["sensor_m"]
    west, east, south, north = sensor_x - 6.0, sensor_x + 18.0, sensor_y - 7.0, sensor_y + 8.0
    picture = BENCH.Svg((east - west) * scale, (north - south) * scale + 46)

    def place(x_m, y_m):
        return (x_m - west) * scale, 40 + (north - y_m) * scale

    picture.text(12, 24, "A bucket empties 7 m ahead: returns from dust red, from the ground grey", kind="t")
    for x_m, y_m, sigma_m, mass_kg in view["puffs"]:
        # Blackness by the optical depth seen from above, extinction 57 m2 per kg.
        depth = 57.0 * mass_kg / (2.0 * math.pi * sigma_m ** 2)
        x, y = place(x_m, y_m)
        for rings in (2.0, 1.5, 1.0, 0.5):
            shade = (1.0 - math.exp(-depth * math.exp(-0.5 * rings ** 2))) / 2.0
            picture.parts.append(f'<circle cx="{x:.1f}" cy="{y:.1f}" r="{scale * rings * sigma_m:.1f}"'
                                 f' fill="#b08d57" fill-opacity="{shade:.3f}"/>')
    for x_m, y_m, from_dust in view["returns"]:
        if west < x_m < east and south < y_m < north:
            picture.dot(*place(x_m, y_m), "#c1121f" if from_dust else "#777", 1.8)
    x, y = place(sensor_x, sensor_y)
    picture.cross(x, y, "#1b6ca8", 7)
    x, y = place(west + 2.0, south + 1.0)
    picture.line(x, y, x + 5.0 * scale, y, "#333", 2)
    picture.text(x + 2.5 * scale, y - 6, "5 m", "middle")
    picture.write(path)


def main():
    if len(sys.argv) not in (2, 3):
        sys.exit(__doc__)
    with open(sys.argv[1], encoding="utf-8") as file:
        figures = json.load(file)
    figures = figures.get("suites", figures).get("weather", figures)
    folder = sys.argv[2] if len(sys.argv) == 3 else os.path.join(HERE, "..", "docs", "pictures")
    transmission(figures["transmission"], os.path.join(folder, "weather_transmission.svg"))
    dust(figures["dust_view"], os.path.join(folder, "weather_dust.svg"))


if __name__ == "__main__":
    main()
