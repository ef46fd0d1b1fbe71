#!/usr/bin/env python3
"""Draws docs/accuracy/*.svg from the figures of `rigwire bench --json FILE`.

  build/rigwire bench --json bench.json && scripts/plot-bench.py bench.json [FOLDER]

FOLDER is docs/accuracy beside this script's folder unless given. Draws what the file has:
work_precision.svg (excavator), dynamics_MACHINE.svg (dynamics), range_error.svg (lidar),
lateness.svg (pacing), gnss_lap.svg (gnss: after figure 2 of Wolf et al. 2020), drawbar.svg,
contact_trunk.svg, contact_rock.svg and contact_fallen_trunk.svg (contact). Standard library only.
"""
import json
import math
import os
import sys
from xml.sax.saxutils import escape

COLOURS = ["#1b6ca8", "#d1495b", "#3a7d44", "#8a5a9e", "#c98a1b", "#4a4a4a", "#2aa6a1", "#a0522d"]
STYLE = ('<style>text{font:12px sans-serif;fill:#333}.t{font-size:14px;font-weight:bold}'
         '.s{fill:#777;font-size:11px}</style>')


class Svg:
    def __init__(self, width, height):
        self.width, self.height = width, height
        self.parts = []

    def line(self, x1, y1, x2, y2, colour="#ddd", width=1, dash=""):
        self.parts.append(f'<line x1="{x1:.1f}" y1="{y1:.1f}" x2="{x2:.1f}" y2="{y2:.1f}" '
                          f'stroke="{colour}" stroke-width="{width}"'
                          + (f' stroke-dasharray="{dash}"' if dash else "") + "/>")

    def text(self, x, y, words, anchor="start", kind="", turn=0):
        turned = f' transform="rotate({turn} {x:.1f} {y:.1f})"' if turn else ""
        self.parts.append(f'<text x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}" class="{kind}"'
                          f'{turned}>{escape(words)}</text>')

    def path(self, points, colour, dash=""):
        at = " ".join(f"{x:.1f},{y:.1f}" for x, y in points)
        self.parts.append(f'<polyline points="{at}" fill="none" stroke="{colour}" '
                          'stroke-width="2"' + (f' stroke-dasharray="{dash}"' if dash else "")
                          + "/>")

    def dot(self, x, y, colour, radius=4.0):
        self.parts.append(f'<circle cx="{x:.1f}" cy="{y:.1f}" r="{radius}" fill="{colour}"/>')

    def cross(self, x, y, colour, radius=5.0):
        self.line(x - radius, y - radius, x + radius, y + radius, colour, 2)
        self.line(x - radius, y + radius, x + radius, y - radius, colour, 2)

    def write(self, path):
        with open(path, "w", encoding="utf-8") as file:
            file.write(f'<svg xmlns="http://www.w3.org/2000/svg" width="{self.width}" '
                       f'height="{self.height}" viewBox="0 0 {self.width} {self.height}">\n'
                       f'{STYLE}\n<rect width="100%" height="100%" fill="#fff"/>\n'
                       + "\n".join(self.parts) + "\n</svg>\n")
        print(path)


class LinearAxis:
    """From 0, or from the least value, to the greatest, mapped to pixels."""

    def __init__(self, low, high, start, end):
        self.low, self.high = low, max(high, low + 1e-9)
        self.start, self.end = start, end

    def at(self, value):
        share = (value - self.low) / (self.high - self.low)
        return self.start + share * (self.end - self.start)

    def ticks(self):
        rough = (self.high - self.low) / 5.0
        unit = 10.0 ** math.floor(math.log10(rough))
        step = next(f * unit for f in (1, 2, 5, 10) if f * unit >= rough)
        first = math.ceil(self.low / step - 1e-9)
        return [i * step for i in range(first, math.floor(self.high / step + 1e-9) + 1)]


class LogAxis:
    """Whole decades around the values, mapped to pixels."""

    def __init__(self, values, start, end):
        self.low = math.floor(math.log10(min(values)) + 1e-9)
        self.high = max(math.ceil(math.log10(max(values)) - 1e-9), self.low + 1)
        self.start, self.end = start, end

    def at(self, value):
        share = (math.log10(value) - self.low) / (self.high - self.low)
        return self.start + share * (self.end - self.start)

    def ticks(self):
        every = max(1, (self.high - self.low) // 6)
        return [10.0 ** e for e in range(self.low, self.high + 1, every)]


def with_unit(value, unit):
    """0.001, "m" -> "1 mm"."""
    for factor, prefix in ((1.0, ""), (1e-3, "m"), (1e-6, "µ"), (1e-9, "n"), (1e-12, "p"),
                           (1e-15, "f")):
        if value >= 0.999 * factor:
            return f"{value / factor:g} {prefix}{unit}"
    return f"{value:g} {unit}"


def frame(svg, x_axis, y_axis, x_text, y_text):
    for tick in x_axis.ticks():
        x = x_axis.at(tick)
        svg.line(x, y_axis.start, x, y_axis.end)
        svg.text(x, y_axis.start + 16, x_text(tick), "middle", "s")
    for tick in y_axis.ticks():
        y = y_axis.at(tick)
        svg.line(x_axis.start, y, x_axis.end, y)
        svg.text(x_axis.start - 6, y + 4, y_text(tick), "end", "s")


def host_line(bench):
    host = bench["host"]
    return (f'{host["processor"]}, {host["cores"]} cores, {host["kernel"]}, {host["compiler"]} '
            f'{host["flags"]}, load average {host["load_average"][0]:.2f}')


def work_precision(bench, path):
    rows = bench["excavator"]["work_precision"]
    methods = list(dict.fromkeys(row["method"] for row in rows))
    factors = sorted({row["stiffness_factor"] for row in rows})
    sound = [row for row in rows if not row["diverged"]]

    def cost(row):  # CPU seconds per simulated second
        return 1e-6 * row["us_per_step"] / row["step_s"]
    panel = 300
    svg = Svg(90 + panel * len(factors), 430)
    svg.text(20, 24, "Excavator: greatest error of the bucket's tip over 4 s against cost", kind="t")
    svg.text(20, 42, host_line(bench), kind="s")
    for i, factor in enumerate(factors):
        left = 80 + panel * i
        x_axis = LogAxis([cost(row) for row in rows], left, left + panel - 40)
        y_axis = LogAxis([row["greatest_error_m"] for row in sound], 350, 90)
        frame(svg, x_axis, y_axis, lambda v: with_unit(v, "s"),
              (lambda v: with_unit(v, "m")) if i == 0 else (lambda v: ""))
        svg.text((x_axis.start + x_axis.end) / 2, 80, f"stiffness of the oil × {factor:g}",
                 "middle")
        for method, colour in zip(methods, COLOURS):
            points = [(x_axis.at(cost(row)), y_axis.at(row["greatest_error_m"]))
                      for row in sound
                      if row["method"] == method and row["stiffness_factor"] == factor]
            svg.path(points, colour)
            for point in points:
                svg.dot(*point, colour)
    svg.text(20, 390, "CPU time per simulated second; points are steps of 0.1, 1, 2, 5, 10, 20 ms; "
             "diverged runs have no point", kind="s")
    for i, (method, colour) in enumerate(zip(methods, COLOURS)):
        svg.dot(28 + 230 * i, 410, colour)
        svg.text(38 + 230 * i, 414, method)
    svg.write(path)


def dynamics(bench, path, machine):
    """Rows of panels are scenes, columns stiffnesses; curves are levels and methods."""
    cases = [case for case in bench["dynamics"]["precision"]
             if case["machine"].split(" ")[0] == machine]
    scenes = list(dict.fromkeys(case["scene"] for case in cases))
    factors = sorted({case["stiffness_factor"] for case in cases})

    def curve_name(case, method):
        on = case["machine"][len(machine):]
        return f'{case["level"]}{on}, {method.replace("_", " ")}'

    def rows_of(case):
        return [row for row in case["rows"] if "refusal" not in row]

    def cost(row):  # CPU seconds per simulated second
        return 1e-6 * row["us_per_step"] / row["step_s"]
    curves = list(dict.fromkeys(curve_name(case, row["method"])
                                for case in cases for row in rows_of(case)))
    colour_of = {name: COLOURS[i % len(COLOURS)] for i, name in enumerate(curves)}
    costs = [cost(row) for case in cases for row in rows_of(case)]
    errors = [row["greatest_error_m"] for case in cases for row in rows_of(case)
              if not row["diverged"] and row["greatest_error_m"] > 0.0]
    panel, height = 310, 290
    bottom = 60 + height * len(scenes)
    svg = Svg(90 + panel * len(factors), bottom + 60 + 20 * ((len(curves) + 2) // 3))
    svg.text(20, 24, f"{machine[:1].upper()}{machine[1:]}: greatest error of any link over "
             f'{cases[0]["span_s"]:g} s against cost', kind="t")
    svg.text(20, 42, host_line(bench), kind="s")
    for j, scene in enumerate(scenes):
        for i, factor in enumerate(factors):
            left, top = 80 + panel * i, 84 + height * j
            x_axis = LogAxis(costs, left, left + panel - 40)
            y_axis = LogAxis(errors, top + height - 70, top)
            frame(svg, x_axis, y_axis, lambda v: with_unit(v, "s"),
                  (lambda v: with_unit(v, "m")) if i == 0 else (lambda v: ""))
            svg.text((x_axis.start + x_axis.end) / 2, top - 8, f"{scene}, stiffness × {factor:g}",
                     "middle")
            for case in cases:
                if case["scene"] != scene or case["stiffness_factor"] != factor:
                    continue
                for method in dict.fromkeys(row["method"] for row in rows_of(case)):
                    colour = colour_of[curve_name(case, method)]
                    of_method = [row for row in rows_of(case) if row["method"] == method]
                    points = [(x_axis.at(cost(row)), y_axis.at(row["greatest_error_m"]))
                              for row in of_method if not row["diverged"]]
                    svg.path(points, colour)
                    for point in points:
                        svg.dot(*point, colour, 3.0)
                    for row in of_method:
                        if row["diverged"]:
                            svg.cross(x_axis.at(cost(row)), y_axis.end, colour)
    svg.text(20, bottom + 26, "CPU time per simulated second; points are steps of 0.1 to 20 ms, right "
             "to left; a cross at the top edge diverged; refused steps have no point", kind="s")
    for i, name in enumerate(curves):
        x, y = 28 + 310 * (i % 3), bottom + 48 + 20 * (i // 3)
        svg.dot(x, y - 4, colour_of[name])
        svg.text(x + 10, y, name)
    svg.write(path)


def range_error(bench, path):
    rows = bench["lidar"]["range_error"]
    goal = bench["lidar"]["range_error_goal_m"]
    svg = Svg(620, 360)
    svg.text(20, 24, "Lidar: error of the cast range against a closed form in double", kind="t")
    svg.text(20, 42, host_line(bench), kind="s")
    y_axis = LogAxis([row["rms_m"] for row in rows] + [goal], 300, 70)
    for tick in y_axis.ticks():
        svg.line(80, y_axis.at(tick), 590, y_axis.at(tick))
        svg.text(74, y_axis.at(tick) + 4, with_unit(tick, "m"), "end", "s")
    places = [110 + 460 * i / max(len(rows) - 1, 1) for i in range(len(rows))]
    for x, row in zip(places, rows):
        svg.text(x, 318, f'{1e-3 * row["map_offset_m"]:g} km', "middle", "s")
    svg.text(335, 340, "distance of the scene from the map origin", "middle", "s")
    svg.line(80, y_axis.at(goal), 590, y_axis.at(goal), "#d1495b", 1, "6 4")
    svg.text(586, y_axis.at(goal) - 6, "half a distance unit (the goal for the worst)", "end", "s")
    for key, name, colour in (("worst_m", "worst ray", COLOURS[0]), ("rms_m", "rms", COLOURS[2])):
        points = [(x, y_axis.at(row[key])) for x, row in zip(places, rows)]
        svg.path(points, colour)
        for point in points:
            svg.dot(*point, colour)
        svg.text(points[-1][0], points[-1][1] - 10, name, "end")
    svg.write(path)


def lateness(bench, path):
    run = bench["pacing"]
    devices = {name: device["lateness_us"] for name, device in run["devices"].items()
               if device["units"] > 0}
    keys = [("p50", "p50"), ("p99", "p99"), ("p999", "p99.9"), ("max", "max")]
    values = [max(late[key], 0.1) for late in devices.values() for key, _ in keys]
    top = 92
    bottom = top - 8 + 34 * len(devices)
    svg = Svg(720, bottom + 60)
    svg.text(20, 24, f'Lateness over {run["sim_s"]:g} s of real time', kind="t")
    svg.text(20, 42, host_line(bench), kind="s")
    svg.text(20, 58, f'load average {run["load_average_before"][0]:.2f} before this run and '
             f'{run["load_average_after"][0]:.2f} after it', kind="s")
    x_axis = LogAxis(values, 120, 690)
    for tick in x_axis.ticks():
        svg.line(x_axis.at(tick), top - 18, x_axis.at(tick), bottom)
        svg.text(x_axis.at(tick), bottom + 16, with_unit(1e-6 * tick, "s"), "middle", "s")
    for i, (name, late) in enumerate(devices.items()):
        y = top + 34 * i
        svg.text(110, y + 4, name, "end")
        svg.line(x_axis.at(max(late["p50"], 0.1)), y, x_axis.at(late["max"]), y, "#bbb", 2)
        for (key, _), colour in zip(keys, COLOURS):
            svg.dot(x_axis.at(max(late[key], 0.1)), y, colour, 5)
    for i, ((_, name), colour) in enumerate(zip(keys, COLOURS)):
        svg.dot(128 + 90 * i, bottom + 38, colour, 5)
        svg.text(140 + 90 * i, bottom + 42, name)
    svg.write(path)


def gnss_lap(bench, path):
    """Count and dilutions over the way, receivers side by side: after the paper's figure 2."""
    lap = bench["gnss"]["lap"]
    panels = [("satellites", "satellites used"), ("horizontal_dilution", "HDOP"),
              ("vertical_dilution", "VDOP"), ("position_dilution", "PDOP"),
              ("horizontal_error_m", "horizontal error, m")]
    height, left, right = 150, 70, 860
    head = 98
    bottom = head + height * len(panels)
    svg = Svg(900, bottom + 70)
    svg.text(20, 24, "One lap of the campus: what each receiver reports along the way", kind="t")
    svg.text(20, 42, "rig gator_campus; grey: nearest point to a building, its name and height",
             kind="s")
    length = max(lap["receivers"][0]["epochs"]["along_m"])
    x_axis = LinearAxis(0.0, length, left, right)
    for i, (key, name) in enumerate(panels):
        top = head + height * i
        last_label = -1e9
        values = [v for r in lap["receivers"] for v in r["epochs"][key] if v is not None]
        y_axis = LinearAxis(0.0, 1.05 * max(values), top + height - 30, top)
        frame(svg, x_axis, y_axis,
              (lambda v: f"{v:g}") if i == len(panels) - 1 else (lambda v: ""),
              lambda v: f"{v:g}")
        svg.text(left + 6, y_axis.start - 6, name)
        for building in lap.get("buildings", []):
            x = x_axis.at(building["along_m"])
            svg.line(x, top, x, y_axis.start, "#999", 1, "3 3")
            if i == 0:  # in turns on two lines where they would run into each other
                row = 0 if x - last_label > 110 else 1
                last_label = x if row == 0 else -1e9
                svg.text(x, top - 8 - 14 * row, f'{building["name"]} {building["height_m"]:g} m', "middle", "s")
        for receiver, colour in zip(lap["receivers"], COLOURS):
            epochs = receiver["epochs"]
            run = []
            for along, value in zip(epochs["along_m"], epochs[key]):
                if value is None:  # nothing reported: a gap
                    svg.path(run, colour)
                    run = []
                else:
                    run.append((x_axis.at(along), y_axis.at(value)))
            svg.path(run, colour)
    svg.text((left + right) / 2, bottom + 6, "way along the track, m", "middle", "s")
    for i, (receiver, colour) in enumerate(zip(lap["receivers"], COLOURS)):
        svg.dot(78 + 260 * i, bottom + 36, colour)
        svg.text(88 + 260 * i, bottom + 40, f'{receiver["device"]} ({receiver["type"]})')
    svg.write(path)


def drawbar(bench, path):
    """Pull over slip: columns are soils, colours pressures, dashes who says so."""
    rows = bench["contact"]["drawbar"]
    soils = list(dict.fromkeys(row["soil"] for row in rows))
    pressures = list(dict.fromkeys(row["pressure_pa"] for row in rows))
    kinds = [("pull", "the tyre's own", ""), ("closed", "Bekker and Wong, closed form", "7 4"),
             ("published", "Brixius, fit to field tests", "2 3")]
    panel, left, top, bottom = 290, 60, 84, 350
    svg = Svg(left + panel * len(soils) + 10, 430)
    svg.text(20, 24, "Pull of one 395/85 R20 over its slip, 22 kN, untouched ground", kind="t")
    svg.text(20, 42, "share of the load; soils as Wong measured them", kind="s")
    values = [row[key] for row in rows for key, _, _ in kinds]
    for i, soil in enumerate(soils):
        x_axis = LinearAxis(0.0, max(row["slip"] for row in rows), left + panel * i,
                            left + panel * (i + 1) - 44)
        y_axis = LinearAxis(min(values) - 0.02, max(values) + 0.02, bottom, top)
        frame(svg, x_axis, y_axis, lambda v: f"{100 * v:g} %",
              (lambda v: f"{v:.1f}") if i == 0 else (lambda v: ""))
        svg.line(x_axis.start, y_axis.at(0.0), x_axis.end, y_axis.at(0.0), "#888")
        svg.text((x_axis.start + x_axis.end) / 2, top - 10, soil, "middle")
        for pressure, colour in zip(pressures, COLOURS):
            for key, _, dash in kinds:
                svg.path([(x_axis.at(row["slip"]), y_axis.at(row[key])) for row in rows
                          if row["soil"] == soil and row["pressure_pa"] == pressure], colour, dash)
    for i, (_, name, dash) in enumerate(kinds):
        svg.path([(28 + 260 * i, 390), (62 + 260 * i, 390)], "#333", dash)
        svg.text(70 + 260 * i, 394, name)
    for i, (pressure, colour) in enumerate(zip(pressures, COLOURS)):
        svg.dot(34 + 100 * i, 412, colour)
        svg.text(44 + 100 * i, 416, f"{1e-5 * pressure:.1f} bar")
    svg.write(path)


def meeting(bench, path, which):
    """Machine and obstacle from the side, and beside them force, overlap and dent: over the way in of
    what is bent, over time of what is not."""
    trace = bench["contact"]["traces"][which]
    instants = trace["instants"]
    outlines = trace["obstacle"] + trace["at_touch"] + trace["at_end"]
    xs = [x for outline in outlines for x, _ in outline]
    zs = [z for outline in outlines for _, z in outline] + [0.0]
    scale = min(440 / (max(xs) - min(xs)), 250 / (max(zs) - min(zs)))

    def at(x, z):
        return 30 + scale * (x - min(xs)), 330 - scale * (z - min(zs))
    svg = Svg(900, 400)
    svg.text(20, 24, trace["name"], kind="t")
    svg.text(20, 42, "from the side, drawn as new; what the contact does, in steps of 1 ms", kind="s")
    svg.line(*at(min(xs), 0.0), *at(max(xs), 0.0), "#999")
    for key, colour, dash in (("at_touch", "#999", "4 3"), ("at_end", COLOURS[0], ""),
                              ("obstacle", COLOURS[7], "")):
        for outline in trace[key]:
            svg.path([at(x, z) for x, z in outline], colour, dash)
    svg.path([at(one["x_m"], one["z_m"]) for one in instants], COLOURS[1], "2 2")
    legend = [("farthest in", COLOURS[0], ""), ("way of front or tip", COLOURS[1], "2 2")]
    if trace["at_touch"] != trace["at_end"]:
        legend.append(("at the first touch", "#999", "4 3"))
    for i, (name, colour, dash) in enumerate(legend):
        svg.path([(30 + 150 * i, 372), (56 + 150 * i, 372)], colour, dash)
        svg.text(62 + 150 * i, 376, name)
    touched = [one["time_s"] for one in instants if one["force_n"] > 0.0]
    span = max(touched[-1] - touched[0], 0.02)
    shown = [one for one in instants
             if touched[0] - 0.05 * span <= one["time_s"] <= touched[-1] + 0.05 * span]
    curves = [("force_n", 1e-3, "force, kN"), ("deepest_m", 1e3, "overlap, mm"),
              ("dent_m", 1e3, "dent, mm"), ("pressed_m", 1e3, "tyre pressed in, mm")]
    curves = [c for c in curves if max(one[c[0]] for one in shown) > 0.0]
    bent = max(one["dent_m"] for one in shown) > 0.0
    first = next(one["x_m"] for one in instants if one["force_n"] > 0.0)

    def along(one):
        return one["x_m"] - first if bent else one["time_s"]
    height = 276 / len(curves)
    for i, (key, factor, name) in enumerate(curves):
        top = 64 + height * i
        x_axis = LinearAxis(min(map(along, shown)), max(map(along, shown)), 560, 870)
        y_axis = LinearAxis(0.0, 1.1 * factor * max(one[key] for one in shown),
                            top + height - 24, top)
        frame(svg, x_axis, y_axis,
              (lambda v: f"{v:.3g} {'m' if bent else 's'}") if i == len(curves) - 1 else (lambda v: ""),
              lambda v: f"{v:g}")
        svg.path([(x_axis.at(along(one)), y_axis.at(factor * one[key])) for one in shown],
                 COLOURS[i])
        svg.text(566, top + 12, name)
    svg.write(path)


def main():
    if len(sys.argv) not in (2, 3) or sys.argv[1].startswith("-"):
        sys.exit(__doc__)
    here = os.path.dirname(os.path.abspath(__file__))
    folder = sys.argv[2] if len(sys.argv) == 3 else os.path.join(here, "..", "docs", "accuracy")
    try:
        with open(sys.argv[1], encoding="utf-8") as file:
            bench = json.load(file)
        for suite, draw, name in (("excavator", work_precision, "work_precision.svg"),
                                  ("lidar", range_error, "range_error.svg"),
                                  ("pacing", lateness, "lateness.svg"),
                                  ("gnss", gnss_lap, "gnss_lap.svg"),
                                  ("contact", drawbar, "drawbar.svg"),
                                  ("contact", lambda b, p: meeting(b, p, 0), "contact_trunk.svg"),
                                  ("contact", lambda b, p: meeting(b, p, 1), "contact_rock.svg"),
                                  ("contact", lambda b, p: meeting(b, p, 2),
                                   "contact_fallen_trunk.svg")):
            if suite in bench:
                draw(bench, os.path.normpath(os.path.join(folder, name)))
        for machine in dict.fromkeys(case["machine"].split(" ")[0] for case in
                                     bench.get("dynamics", {}).get("precision", [])):
            dynamics(bench, os.path.normpath(
                os.path.join(folder, f"dynamics_{machine.lower()}.svg")), machine)
    except (OSError, json.JSONDecodeError, KeyError) as error:
        sys.exit(f"plot-bench: {error!r}")


if __name__ == "__main__":
    main()
