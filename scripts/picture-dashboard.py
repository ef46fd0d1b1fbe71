#!/usr/bin/env -S /usr/bin/python3
"""Stills of the dashboard, one for each rig, as docs/pictures has them.

    scripts/picture-dashboard.py [--width 1280] [--dark] [-o docs/pictures] [RIG ...]
"""
import argparse
import pathlib
import tempfile
import time

from dashboard_browser import page_of

# A device's lateness and messages, the buses; the page stays where it is.
OPEN = """
    const devices = rigwire.wires.before?.devices ?? {};
    const chosen = ["lidar", "gnss"].find((name) => name in devices);
    if (chosen) rigwire.wires.choose(chosen, devices[chosen].wire);
    document.getElementById("buses").open = true;"""
RIGS = ["excavator_pit", "unimog_forest", "roller_road", "gator_campus", "lidar_park", "excavator_vision"]


def still(rig, arguments, folder):
    with page_of(rig, folder, arguments.width, arguments.height, arguments.dark) as (browser, _):
        for quantity in arguments.plot:
            browser.execute_script("rigwire.plots.add(arguments[0]);", quantity)
        browser.execute_script(OPEN)
        time.sleep(arguments.settle)
        suffix = "-dark" if arguments.dark else ""
        name = f"dashboard-{rig}{suffix}.png"
        browser.execute_script('return rigwire.run.command("pause");')  # nothing beside the picture costs time
        time.sleep(2)
        browser.save_screenshot(str(arguments.output / name))
        for entry in browser.get_log("browser"):
            print(rig, entry["level"], entry["message"])


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--width", type=int, default=1280)
    parser.add_argument("--height", type=int, default=900)
    parser.add_argument("--dark", action="store_true")
    parser.add_argument("--settle", type=float, default=6.0, help="seconds before the still")
    parser.add_argument("--plot", action="append", default=[], help="a quantity that is plotted")
    parser.add_argument("-o", "--output", type=pathlib.Path, default=pathlib.Path("docs/pictures"))
    parser.add_argument("rigs", nargs="*", default=RIGS)
    arguments = parser.parse_args()
    for rig in arguments.rigs:
        with tempfile.TemporaryDirectory() as scratch:
            still(rig, arguments, pathlib.Path(scratch) / "run")


if __name__ == "__main__":
    main()
