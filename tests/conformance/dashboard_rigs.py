"""Opens a rig's page with Debian's Chromium: it draws, and complains of nothing.

    dashboard_rigs.py BINARY_DIR SCRATCH_DIR RIG

Of excavator_vision the pictures too: previews at first, then those that Aravis takes.
"""
import contextlib
import re
import subprocess
import sys

import numpy

import dashboard_page
from dashboard_page import eventually, frames_drawn, picture, value


@contextlib.contextmanager
def client_of_the_cameras(rig):
    """Takes pictures of every camera, as long as it lasts."""
    clients = [subprocess.Popen(["arv-camera-test-0.8", "--no-packet-socket", "-n", address],
                                stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
               for address in re.findall(r"udp ([\d.]+):3956\b", " ".join(rig.told["devices"].values()))]
    try:
        yield clients
    finally:
        for client in clients:
            client.terminate()
            client.wait()


def see_the_pictures(rig, browser):
    cameras = value(browser, "[...rigwire.sensors.cameras.keys()]")
    assert "/camera/surround" in cameras, cameras
    for topic in cameras:
        eventually(f"a preview of {topic}", lambda: value(
            browser, f"rigwire.sensors.cameras.get('{topic}').previews") > 0)
    said = value(browser, "document.getElementById('pictures').textContent")
    assert said.count("preview, rendered for this page; no client takes the camera's pictures") == len(cameras), said
    assert value(browser, "[...rigwire.sensors.cameras.values()].every(({ count }) => count === 0)"), "no client yet"
    rig.command("speed", factor=0.1)  # pictures are to be rendered in time on a busy machine, too
    with client_of_the_cameras(rig) as clients:
        assert len(clients) == len(cameras), rig.told["devices"]
        for topic in cameras:
            eventually(f"pictures of {topic}", lambda: value(
                browser, f"rigwire.sensors.cameras.get('{topic}').count") > 1)
            width, height, colours, sent = browser.execute_script("""
                const { canvas, caption } = rigwire.sensors.cameras.get(arguments[0]);
                const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
                return [canvas.width, canvas.height, new Set(new Uint32Array(data.buffer)).size, caption.textContent];
                """, topic)
            size = re.search(r"(\d+) × (\d+)", sent)
            assert abs(width / height - int(size[1]) / int(size[2])) < 0.05, (topic, width, height, sent)
            assert colours > 50, f"{topic}: the picture has {colours} colours"


def main():
    dashboard_page.scratch.mkdir(parents=True, exist_ok=True)
    name = sys.argv[3]
    rig = dashboard_page.Rig(name)
    browser = None
    try:
        browser = dashboard_page.open_browser(rig.page)
        eventually("the scene is there", lambda: value(
            browser, "window.rigwire?.view && rigwire.run.assets.size === 0 && rigwire.view.entities.size > 5 "
                     "&& rigwire.view.count.transforms > 0 "
                     "&& [...rigwire.view.clouds.values()].every("
                     "({ points }) => points.geometry.drawRange.count > 0)"))
        frames_drawn(browser, 3)
        rig.command("pause")  # else a busy machine has no time for the browser's picture
        assert len(numpy.unique(picture(browser).reshape(-1, 3), axis=0)) > 100, "the picture is blank"
        rig.command("resume")
        if name.endswith("vision"):
            see_the_pictures(rig, browser)
        complaints = [entry for entry in browser.get_log("browser") if entry["level"] == "SEVERE"]
        assert not complaints, complaints
        rig.command("stop")
        assert rig.process.wait(dashboard_page.PATIENCE_S) == 0
    finally:
        if browser:
            browser.quit()
        rig.end()
    print("all seen")


if __name__ == "__main__":
    main()
