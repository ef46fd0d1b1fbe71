#!/usr/bin/env -S /usr/bin/python3
"""Leaves a rig's page open and says what it and the run hold, minutes later.

    scripts/leave-dashboard-open.py [--minutes 1 10 30 60] [RIG]

Everything is looked at: the scene, two plots, the messages of a wire, the CAN buses. A line for each instant: what
JavaScript holds after a collection, nodes of the page, resident memory of the run, frames drawn,
messages that the server dropped since the page was too slow. Processors that draw without a graphics
card have one core's work with it: nothing else is measured beside it.
"""
import argparse
import pathlib
import tempfile
import time

from selenium.webdriver.common.by import By
from selenium.webdriver.support.ui import Select

from dashboard_browser import page_of


def resident_mb(process):
    for line in pathlib.Path(f"/proc/{process.pid}/status").read_text().splitlines():
        if line.startswith("VmRSS:"):
            return int(line.split()[1]) * 1024e-6
    raise SystemExit("the kernel tells nothing of the run")


def look_at_everything(browser):
    browser.execute_script("""
        rigwire.plots.add("truth.position_m.0");
        rigwire.plots.add(`wires.${Object.keys(rigwire.wires.before?.devices ?? {})[0]}.frames`);""")
    wires = Select(browser.find_element(By.ID, "wire"))
    names = [option.get_attribute("value") for option in wires.options]
    wires.select_by_value("/wire/can" if "/wire/can" in names else names[-1])
    browser.find_element(By.CSS_SELECTOR, "#buses summary").click()
    browser.execute_script("window.scrollTo(0, 0);")  # what is out of sight is not drawn


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--minutes", type=float, nargs="+", default=[1, 10, 30, 60])
    parser.add_argument("--width", type=int, default=1024)
    parser.add_argument("--height", type=int, default=700)
    parser.add_argument("rig", nargs="?", default="excavator_pit")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as scratch:
        folder = pathlib.Path(scratch) / "run"
        with page_of(arguments.rig, folder, arguments.width, arguments.height) as (browser, run):
            begin = time.monotonic()
            look_at_everything(browser)
            browser.execute_cdp_cmd("Performance.enable", {})
            for minutes in sorted(arguments.minutes):
                time.sleep(max(0.0, begin + 60 * minutes - time.monotonic()))
                browser.execute_cdp_cmd("HeapProfiler.collectGarbage", {})
                held = {one["name"]: one["value"]
                        for one in browser.execute_cdp_cmd("Performance.getMetrics", {})["metrics"]}
                simulated, frames, dropped = browser.execute_script(
                    "return [document.getElementById('time').textContent, rigwire.view.count.frames,"
                    " rigwire.wires.before?.viewers.dropped ?? 0];")
                print(f"{minutes:g} min, {simulated}: page {held['JSHeapUsedSize'] / 1e6:.1f} MB in "
                      f"{held['Nodes']:.0f} nodes, run {resident_mb(run):.1f} MB, {frames} frames drawn, "
                      f"{dropped} messages dropped", flush=True)
            complaints = [entry["message"] for entry in browser.get_log("browser") if entry["level"] == "SEVERE"]
            if complaints:
                raise SystemExit("\n".join(complaints))


if __name__ == "__main__":
    main()
