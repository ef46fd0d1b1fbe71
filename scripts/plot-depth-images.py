#!/usr/bin/env python3
"""Draws docs/accuracy/depth_images_*.svg from the figures of `rigwire bench lidar --json FILE`.

  build/rigwire bench lidar --json lidar.json && scripts/plot-depth-images.py lidar.json [FOLDER]

FOLDER is docs/accuracy beside this script's folder unless given. Draws, after Wolf et al. 2020,
  depth_images_rows.svg   which rows of one camera's image the lasers have by each rule (figure 4)
  depth_images_rings.svg  the points on level ground by each rule (figure 5)
  depth_images_error.svg  range error over range by sampling and image size, cost beside it
Standard library only.
"""
import importlib.machinery
import importlib.util
import json
import math
import os
import sys

HERE = os.path.dirname(os.path.abspath(__file__))


def load_plot_bench():
    loader = importlib.machinery.SourceFileLoader("plot_bench",
                                                  os.path.join(HERE, "plot-bench.py"))
    module = importlib.util.module_from_spec(importlib.util.spec_from_loader("plot_bench", loader))
    loader.exec_module(module)
    return module


PLOT = load_plot_bench()
HEIGHT_M = 2.5  # of the lidar over the level ground
FIELD_OF_VIEW_DEG = 120.0
RULES = (("straight rows", "straight rows"), ("b = W/2", "Eq. 4 as printed: b = W / 2"),
         ("exact", "exact: b = f"))


def thin_path(svg, points, colour):
    at = " ".join(f"{x:.1f},{y:.1f}" for x, y in points)
    svg.parts.append(f'<polyline points="{at}" fill="none" stroke="{colour}"/>')


def dots(svg, points, colour):
    """Many small ones in one path."""
    at = "".join(f"M{x:.1f} {y:.1f}h0" for x, y in points)
    svg.parts.append(f'<path d="{at}" stroke="{colour}" stroke-width="1.8" '
                     'stroke-linecap="round"/>')


def row(rule, tangent, u):
    """v of a laser at u, both in focal lengths, in an image of 120 degrees."""
    half_width = math.tan(math.radians(FIELD_OF_VIEW_DEG / 2.0))
    b = {"straight rows": math.inf, "b = W/2": half_width, "exact": 1.0}[rule]
    return tangent * math.hypot(1.0, u / b)


def rows_picture(path):
    half_width = math.tan(math.radians(FIELD_OF_VIEW_DEG / 2.0))
    panel, scale = 300, 75.0
    svg = PLOT.Svg(40 + panel * len(RULES), 240)
    svg.text(20, 24, "Where the lasers of an HDL-32E are in the image of a camera with 120° of view, "
             "by the rule that finds their rows", kind="t")
    for i, (rule, words) in enumerate(RULES):
        middle_x, middle_y = 20 + panel * (i + 0.5), 110
        svg.text(middle_x, 56, words, "middle")
        for laser in range(32):
            tangent = math.tan(math.radians(-92.0 / 3.0 + 4.0 / 3.0 * laser))
            points = []
            for step in range(-40, 41):
                u = half_width * step / 40.0
                points.append((middle_x + scale * u, middle_y - scale * row(rule, tangent, u)))
            thin_path(svg, points, PLOT.COLOURS[i])
        svg.line(middle_x - scale * half_width, middle_y, middle_x + scale * half_width, middle_y,
                 "#999", 1, "4 3")
    svg.text(20, 226, "Dashed: the horizon. A cone of rays is a hyperbola in the image: the right one "
             "is what the lasers really see.", kind="s")
    svg.write(path)


def rings_picture(lidar, path):
    groups = [group for group in lidar["depth_image_rings"]
              if group["variant"] in ("straight rows", "b = W/2", "b = W/2, 4 cameras",
                                      "as printed", "exact")]
    panel, reach_m = 300, 15.0
    columns = 3
    lines = (len(groups) + columns - 1) // columns
    svg = PLOT.Svg(30 + panel * columns, 60 + (panel + 24) * lines)
    svg.text(20, 24, f"Points of the lasers on level ground, seen from {HEIGHT_M:g} m, by the rule "
             f"that reads the depth images (rings within {reach_m:g} m)", kind="t")
    for i, group in enumerate(groups):
        middle_x = 15 + panel * (i % columns + 0.5)
        middle_y = 70 + (panel + 24) * (i // columns) + panel / 2
        scale = (panel / 2 - 8) / reach_m
        cameras = group["cameras"]
        name = group["variant"] if "cameras" in group["variant"] else \
            f'{group["variant"]}, {cameras} cameras'
        svg.text(middle_x, middle_y - panel / 2, name, "middle")
        for camera in range(cameras):  # edges of the sectors
            edge = math.radians(360.0 / cameras * (camera + 0.5))
            svg.line(middle_x, middle_y, middle_x + scale * reach_m * math.sin(edge),
                     middle_y - scale * reach_m * math.cos(edge), "#ccc", 1, "3 3")
        for ring in group["rings"]:
            true_m = HEIGHT_M / math.tan(math.radians(-ring["elevation_deg"]))
            if true_m > reach_m:
                continue
            points = []
            for azimuth_deg, radius_m in zip(ring["azimuth_deg"], ring["radius_m"]):
                if radius_m <= reach_m:
                    azimuth = math.radians(azimuth_deg)
                    points.append((middle_x + scale * radius_m * math.sin(azimuth),
                                   middle_y - scale * radius_m * math.cos(azimuth)))
            dots(svg, points, PLOT.COLOURS[0])
    svg.write(path)


def error_picture(lidar, bench, path):
    rows = [entry for entry in lidar["depth_images"]
            if entry["variant"] == "exact" and entry["scene"] == "level ground"]
    samplings = ("nearest", "bilinear z", "edge-aware")
    svg = PLOT.Svg(760, 420)
    svg.text(20, 24, "Depth images, exact mapping, level ground: range error against rays", kind="t")
    svg.text(20, 42, PLOT.host_line(bench), kind="s")
    x_axis = PLOT.LinearAxis(0.0, 80.0, 80, 520)
    values = [c["rms_m"] for entry in rows for c in entry["classes"] if c["rms_m"] > 0.0]
    y_axis = PLOT.LogAxis(values, 370, 70)
    PLOT.frame(svg, x_axis, y_axis, lambda v: f"{v:g} m", lambda v: PLOT.with_unit(v, "m"))
    widths = sorted({entry["width_px"] for entry in rows})
    line = 0
    for sampling, colour in zip(samplings, PLOT.COLOURS):
        for width in widths:
            for entry in rows:
                if entry["sampling"] != sampling or entry["width_px"] != width:
                    continue
                from_m, points = 0.0, []
                for c in entry["classes"]:
                    points.append((x_axis.at((from_m + c["to_m"]) / 2.0), y_axis.at(c["rms_m"])))
                    from_m = c["to_m"]
                svg.path(points, colour)
                for point in points:
                    svg.dot(*point, colour, 2.0 + widths.index(width))
                y = 90 + 26 * line
                svg.dot(548, y - 4, colour, 2.0 + widths.index(width))
                svg.text(558, y, f"{sampling}, {width} px")
                svg.text(558, y + 12, f'cost {entry["cost_of_rays"]:.0f} × rays', kind="s")
                line += 1
    svg.text(20, 408, "Root of the mean square; the range classes of the table, drawn at their "
             "middles. Rays: 1 × by definition.", kind="s")
    svg.write(path)


def main():
    if len(sys.argv) not in (2, 3) or sys.argv[1].startswith("-"):
        sys.exit(__doc__)
    folder = sys.argv[2] if len(sys.argv) == 3 else os.path.join(HERE, "..", "docs", "accuracy")

    def in_folder(name):
        return os.path.normpath(os.path.join(folder, name))
    try:
        with open(sys.argv[1], encoding="utf-8") as file:
            bench = json.load(file)
        lidar = bench["lidar"]
        rows_picture(in_folder("depth_images_rows.svg"))
        rings_picture(lidar, in_folder("depth_images_rings.svg"))
        error_picture(lidar, bench, in_folder("depth_images_error.svg"))
    except (OSError, json.JSONDecodeError, KeyError) as error:
        sys.exit(f"plot-depth-images: {error!r}")


if __name__ == "__main__":
    main()
