#!/usr/bin/env -S /usr/bin/python3
"""Stills of the dashboard, one for each rig, as docs/pictures has them.

    scripts/picture-dashboard.py [--width 1280] [--dark] [-o docs/pictures] [RIG ...]
"""
import argparse
import json
import pathlib
import signal
import subprocess
import tempfile
import time

from selenium import webdriver
from selenium.webdriver.chrome.service import Service

RIGS = ["excavator_pit", "unimog_forest", "roller_road", "gator_campus"]
PATIENCE_S = 300


def still(rig, arguments, folder):
    run = subprocess.Popen(["build/rigwire", "run", rig, "--isolated", folder, "--dashboard", "--status", "none"])
    told = folder / "run.json"
    while not (told.exists() and told.read_text().endswith("\n")):
        time.sleep(0.2)
    options = webdriver.ChromeOptions()
    options.page_load_strategy = "eager"
    for argument in ("--headless=new", "--no-sandbox", "--disable-dev-shm-usage", "--use-gl=angle",
                     "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--hide-scrollbars",
                     f"--window-size={arguments.width},{arguments.height}", f"--user-data-dir={folder}/profile"):
        options.add_argument(argument)
    browser = webdriver.Chrome(service=Service("/usr/bin/chromedriver"), options=options)
    try:
        if arguments.dark:
            browser.execute_cdp_cmd("Emulation.setEmulatedMedia", {
                "features": [{"name": "prefers-color-scheme", "value": "dark"}]})
        browser.set_script_timeout(PATIENCE_S)
        browser.get(json.loads(told.read_text())["dashboard"])
        end = time.monotonic() + PATIENCE_S
        while not browser.execute_script(
                "return window.rigwire?.view && rigwire.run.assets.size === 0 && "
                "(rigwire.view.clouds.size === 0 || rigwire.view.count.clouds > 2) && rigwire.view.entities.size > 5;"):
            if time.monotonic() > end:
                raise SystemExit(f"{rig}: no picture within {PATIENCE_S} s")
            time.sleep(0.5)
        for quantity in arguments.plot:
            browser.execute_script("rigwire.plots.add(arguments[0]);", quantity)
        time.sleep(arguments.settle)
        suffix = "-dark" if arguments.dark else ""
        name = f"dashboard-{rig}{suffix}.png"
        browser.execute_script('return rigwire.run.command("pause");')  # nothing beside the picture costs time
        time.sleep(2)
        browser.save_screenshot(str(arguments.output / name))
        for entry in browser.get_log("browser"):
            print(rig, entry["level"], entry["message"])
    finally:
        browser.quit()
        run.send_signal(signal.SIGINT)
        run.wait(60)


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
