"""A rig's page in Debian's Chromium, for the scripts that look at it."""
import contextlib
import json
import signal
import subprocess
import time

from selenium import webdriver
from selenium.webdriver.chrome.service import Service

PATIENCE_S = 300
IS_DRAWN = ("return window.rigwire?.view && rigwire.run.assets.size === 0 && "
            "(rigwire.view.clouds.size === 0 || rigwire.view.count.clouds > 2) && rigwire.view.entities.size > 5;")


@contextlib.contextmanager
def page_of(rig, folder, width, height, dark=False, run_options=()):
    """Runs the rig below `folder`; its browser, when everything is drawn, and its process."""
    run = subprocess.Popen(["build/rigwire", "run", rig, "--isolated", folder, "--dashboard", "--status", "none",
                            *run_options])
    browser = None
    try:
        told = folder / "run.json"
        while not (told.exists() and told.read_text().endswith("\n")):
            if run.poll() is not None:
                raise SystemExit(f"{rig}: the run ended with {run.returncode}")
            time.sleep(0.2)
        options = webdriver.ChromeOptions()
        options.page_load_strategy = "eager"
        for argument in ("--headless=new", "--no-sandbox", "--disable-dev-shm-usage", "--use-gl=angle",
                         "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--hide-scrollbars",
                         f"--window-size={width},{height}", f"--user-data-dir={folder}/profile"):
            options.add_argument(argument)
        browser = webdriver.Chrome(service=Service("/usr/bin/chromedriver"), options=options)
        if dark:
            browser.execute_cdp_cmd("Emulation.setEmulatedMedia", {
                "features": [{"name": "prefers-color-scheme", "value": "dark"}]})
        browser.set_script_timeout(PATIENCE_S)
        browser.get(json.loads(told.read_text())["dashboard"])
        end = time.monotonic() + PATIENCE_S
        while not browser.execute_script(IS_DRAWN):
            if time.monotonic() > end:
                raise SystemExit(f"{rig}: no picture within {PATIENCE_S} s")
            time.sleep(0.5)
        yield browser, run
    finally:
        if browser:
            browser.quit()
        if run.poll() is None:
            run.send_signal(signal.SIGINT)
            run.wait(60)
