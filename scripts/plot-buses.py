#!/usr/bin/env python3
"""Draws docs/pictures/can_overload.svg from the figures of `rigwire bench buses --json FILE`.

  build/rigwire bench buses --json buses.json && scripts/plot-buses.py buses.json [FOLDER]

FOLDER is docs/pictures beside this script's folder unless given. The picture: eight nodes that
together offer 1.3 times what a CAN bus carries, how much of each arrives and how long its frames
wait. Standard library only.
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
BLUE, RED = "#1f6fb2", "#b23a1f"


def overload(figures, path):
    nodes = figures["nodes"]
    left, middle, right, top, row = 130, 430, 760, 70, 30
    bottom = top + row * len(nodes)
    picture = BENCH.Svg(820, bottom + 50)
    picture.text(20, 24, f"A CAN bus asked for {100 * figures['offered_load']:.0f} % of what it "
                 f"carries, for {figures['seconds']} s", kind="t")
    picture.text(left, 52, "arrives")
    picture.text(middle + 30, 52, "longest wait of a frame that left, ms")
    decades = (0.1, 1000.0)

    def x_of(wait_ms):
        span = math.log10(decades[1] / decades[0])
        share = math.log10(max(wait_ms, decades[0]) / decades[0]) / span
        return middle + 30 + (right - middle - 30) * min(share, 1.0)

    for tick in (0.1, 1, 10, 100, 1000):
        picture.line(x_of(tick), top - 8, x_of(tick), bottom)
        picture.text(x_of(tick), bottom + 18, f"{tick:g}", "middle")
    for share in (0.0, 0.5, 1.0):
        x = left + share * (middle - left - 40)
        picture.line(x, top - 8, x, bottom)
        picture.text(x, bottom + 18, f"{100 * share:.0f} %", "middle")
    for i, node in enumerate(nodes):
        y = top + row * i + row / 2
        arrives = node["sent_per_s"] / node["offered_per_s"]
        picture.text(left - 10, y + 4, f"{node['id']:08X}", "end")
        picture.line(left, y, left + arrives * (middle - left - 40), y,
                     BLUE if arrives > 0.99 else RED, 14)
        if node["sent_per_s"] > 0.0:
            picture.dot(x_of(node["longest_wait_ms"]), y, BLUE if arrives > 0.99 else RED)
    picture.text(20, bottom + 42, "Most urgent identifier on top. By arbitration the least urgent "
                 "starve, and only they.")
    picture.write(path)


def main():
    if len(sys.argv) not in (2, 3):
        sys.exit(__doc__)
    folder = sys.argv[2] if len(sys.argv) == 3 else os.path.join(HERE, "..", "docs", "pictures")
    with open(sys.argv[1], encoding="utf-8") as file:
        figures = json.load(file)
    figures = figures.get("suites", figures).get("buses", figures)
    overload(figures["can_overload"], os.path.join(folder, "can_overload.svg"))


if __name__ == "__main__":
    main()
