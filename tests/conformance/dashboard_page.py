"""Looks at a run's page with Debian's Chromium, and at its wires with their real clients.

    dashboard_page.py BINARY_DIR SCRATCH_DIR [CASE ...]

Starts the excavator with wires of its own and goes through CASES in one browser. Asserts on numbers
and on pixels, never on a rate of frames: WebGL is drawn by the processor here.
"""
import base64
import json
import os
import pathlib
import re
import signal
import socket
import struct
import subprocess
import sys
import time
import urllib.error
import urllib.request

import cv2
import numpy
from selenium import webdriver
from selenium.webdriver.chrome.service import Service
from selenium.webdriver.common.by import By
from selenium.webdriver.support.ui import Select

binaries, scratch = (pathlib.Path(argument) for argument in sys.argv[1:3])
PATIENCE_S = 120
CHANNELS = 12 * 32  # returns of a data packet


def eventually(what, look, patience_s=PATIENCE_S):
    """What `look` returns, as soon as that is true."""
    end = time.monotonic() + patience_s
    while True:
        found = look()
        if found:
            return found
        assert time.monotonic() < end, f"not within {patience_s} s: {what}"
        time.sleep(0.1)


def answers(port):
    with socket.socket() as trial:
        return trial.connect_ex(("127.0.0.1", port)) == 0


class Rig:
    """An excavator that digs nowhere: it stands, and does what it is told by hand."""

    def __init__(self):
        self.folder = scratch / "run"
        self.process = subprocess.Popen(
            [binaries / "rigwire", "run", "excavator_pit", "--isolated", self.folder, "--dashboard",
             "--status", "none", "--duration", "20min"], stderr=open(scratch / "rig.log", "w"))
        eventually("the run is ready", (self.folder / "run.json").exists)
        eventually("all of it is told", lambda: (self.folder / "run.json").read_text().endswith("\n"))
        self.told = json.loads((self.folder / "run.json").read_text())
        self.page = self.told["dashboard"]
        self.base, self.token = self.page.split("/#")
        self.port = int(self.base.rsplit(":", 1)[1])

    def request(self, path, body=None, headers=None, method=None):
        """Status and text of an answer."""
        request = urllib.request.Request(self.base + path, body, headers or {}, method=method)
        try:
            with urllib.request.urlopen(request) as answer:
                return answer.status, answer.read().decode(), answer.headers
        except urllib.error.HTTPError as error:
            return error.code, error.read().decode(), error.headers

    def command(self, verb, **keys):
        status, text, _ = self.request("/command", json.dumps({"verb": verb, **keys}).encode(),
                                       {"Authorization": f"Bearer {self.token}"})
        assert status == 200, text
        return json.loads(text)

    def wire(self, device):
        return self.told["devices"][device]


class Viewer:
    """A WebSocket client of nothing but a socket, which reads when it is told to."""

    def __init__(self, rig, headers="", protocol="foxglove.websocket.v1", query=None):
        self.socket = socket.create_connection(("127.0.0.1", rig.port))
        query = f"?token={rig.token}" if query is None else query
        key = base64.b64encode(os.urandom(16)).decode()
        host = "" if "Host:" in headers else f"Host: 127.0.0.1:{rig.port}\r\n"
        self.socket.sendall(
            f"GET /stream{query} HTTP/1.1\r\n{host}Connection: Upgrade\r\nUpgrade: websocket\r\n"
            f"Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: {key}\r\n"
            f"Sec-WebSocket-Protocol: {protocol}\r\n{headers}\r\n".encode())
        head = b""
        while b"\r\n\r\n" not in head:
            head += self.socket.recv(1)
        self.status = int(head.split()[1])

    def exactly(self, size):
        data = b""
        while len(data) < size:
            piece = self.socket.recv(size - len(data))
            assert piece, "the connection was closed"
            data += piece
        return data

    def receive(self):
        """The next message: (is text, bytes)."""
        first, second = self.exactly(2)
        size = second & 0x7F
        if size == 126:
            size, = struct.unpack(">H", self.exactly(2))
        elif size == 127:
            size, = struct.unpack(">Q", self.exactly(8))
        return first & 0x0F == 1, self.exactly(size)

    def send(self, message):
        data = json.dumps(message).encode()
        mask = os.urandom(4)
        size = (bytes([0x80 | len(data)]) if len(data) < 126
                else bytes([0x80 | 126]) + struct.pack(">H", len(data)))
        self.socket.sendall(b"\x81" + size + mask
                            + bytes(byte ^ mask[i % 4] for i, byte in enumerate(data)))


def open_browser(url, width=1280, height=1000, dark=False):
    options = webdriver.ChromeOptions()
    for argument in ("--headless=new", "--no-sandbox", "--disable-dev-shm-usage", "--use-gl=angle",
                     "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
                     f"--window-size={width},{height}", f"--user-data-dir={scratch}/profile{time.time_ns()}"):
        options.add_argument(argument)
    if dark:
        options.add_argument("--force-dark-mode")
        options.add_argument("--blink-settings=preferredColorScheme=0")
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    browser = webdriver.Chrome(service=Service("/usr/bin/chromedriver"), options=options)
    browser.set_script_timeout(PATIENCE_S)
    browser.get(url)
    return browser


def value(browser, expression):
    return browser.execute_script(f"return {expression};")


def is_drawn(browser):
    """Everything that was asked for stands there, and clouds come."""
    return value(browser, "window.rigwire?.view && rigwire.run.assets.size === 0 && "
                          "rigwire.view.entities.size > 10 && rigwire.view.count.transforms > 0 && "
                          "rigwire.view.count.clouds > 0")


def picture(browser):
    png = browser.find_element(By.ID, "scene").screenshot_as_png
    return cv2.imdecode(numpy.frombuffer(png, numpy.uint8), cv2.IMREAD_COLOR).astype(int)


def frames_drawn(browser, count):
    """So many frames more."""
    before = value(browser, "rigwire.view.count.frames")
    eventually("the view draws", lambda: value(browser, "rigwire.view.count.frames") >= before + count)


def cell(browser, device, name):
    text = value(browser, f"document.querySelector('tr[data-device={device}] .{name}')?.textContent")
    return None if text in (None, "–") else float(text.replace(",", ""))


# Cases ------------------------------------------------------------------------------------------------


def nothing_is_complained_of(rig, browser):
    eventually("the scene is there", lambda: is_drawn(browser))
    complaints = [entry for entry in browser.get_log("browser") if entry["level"] == "SEVERE"]
    assert not complaints, complaints


def the_picture_is_of_the_machine(rig, browser):
    Select(browser.find_element(By.ID, "colour")).select_by_value("none")
    frames_drawn(browser, 3)
    still = picture(browser)
    assert len(numpy.unique(still.reshape(-1, 3), axis=0)) > 100, "the picture is blank"
    before = rig.command("read")["machine"]["quantities"]["boom"]["value"]
    rig.command("set", set={"boom": 0.6})
    rig.command("wait", quantity="boom", value=before + 8, limit="60 s")
    rig.command("set", set={"boom": None})
    frames_drawn(browser, 3)
    changed = (numpy.abs(picture(browser) - still).sum(axis=2) > 60).mean()
    assert changed > 0.002, f"{changed:.5f} of the pixels changed while the boom rose"
    Select(browser.find_element(By.ID, "colour")).select_by_value("range")


def points_are_those_of_the_packets(rig, browser):
    """A turn on the page has as many points as a client of the UDP port counts returns in one."""
    address, port = re.search(r"([\d.]+):(\d+)", rig.wire("lidar")).groups()
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as client:
        client.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4 << 20)
        client.bind((address, int(port)))
        client.settimeout(PATIENCE_S)
        turns, azimuth_before, returns = [], None, 0
        while len(turns) < 4:
            packet = client.recv(2000)
            if len(packet) != 1206:
                continue
            azimuth, = struct.unpack_from("<H", packet, 2)
            if azimuth_before is not None and azimuth < azimuth_before:
                turns.append(returns)
                returns = 0
            azimuth_before = azimuth
            for block in range(12):
                distances = struct.unpack_from("<" + "HB" * 32, packet, 100 * block + 4)[::2]
                returns += sum(distance > 0 for distance in distances)
    counted = sorted(turns[1:])[1]
    shown = eventually("a cloud", lambda: value(browser, "rigwire.view.cloudPoints"))
    assert abs(shown - counted) < 0.05 * counted, (shown, turns)


def a_fault_by_its_button_reaches_a_real_client(rig, browser):
    port = 20000 + os.getpid() % 10000
    daemon = subprocess.Popen(["gpsd", "-N", "-n", "-S", str(port), rig.folder / "wires/gnss.1"])
    eventually("gpsd listens", lambda: answers(port))
    client = subprocess.Popen(["gpspipe", "-w", f"localhost:{port}"], stdout=subprocess.PIPE, text=True)

    def modes():
        for line in client.stdout:
            report = json.loads(line)
            if report.get("class") == "TPV":
                yield report.get("mode", 0)

    try:
        reports = modes()
        assert next(mode for mode in reports if mode >= 3) == 3
        Select(browser.find_element(By.ID, "fault-on")).select_by_value("gnss")
        Select(browser.find_element(By.ID, "fault-type")).select_by_value("outage")
        browser.find_element(By.ID, "fault-add").click()
        assert next(mode for mode in reports if mode <= 1) <= 1
        eventually("the time line tells of it", lambda: "fault_begun" in browser.find_element(
            By.ID, "event-rows").text)
        row = browser.find_element(By.XPATH, "//tbody[@id='event-rows']/tr[td='fault_begun']")
        row.find_element(By.TAG_NAME, "button").click()
        shown = value(browser, "rigwire.plots.heldAt_s - rigwire.plots.span_s / 2")
        assert abs(shown - float(row.find_element(By.TAG_NAME, "button").text)) < 0.001, shown
        assert "fault_begun gnss" in value(browser, "rigwire.plots.marks.map(({ text }) => text)")
        listed = eventually("it is listed", lambda: browser.find_elements(By.CSS_SELECTOR, "#faults button"))
        listed[0].click()
        assert next(mode for mode in reports if mode >= 3) == 3
        eventually("its end is told", lambda: "fault_ended" in browser.find_element(
            By.ID, "event-rows").text)
    finally:
        client.terminate()
        daemon.terminate()
        client.wait()
        daemon.wait()


def pause_stops_everything(rig, browser):
    browser.find_element(By.ID, "pause").click()
    eventually("time stands", lambda: rig.command("state")["paused"])
    eventually("the page says so", lambda: "stands" in browser.find_element(By.ID, "time").text)
    before = rig.command("read")
    transforms = value(browser, "rigwire.view.count.transforms")
    time.sleep(1)
    after = rig.command("read")
    assert after["time_ns"] == before["time_ns"]
    assert ({name: device["frames"] for name, device in after["devices"].items()}
            == {name: device["frames"] for name, device in before["devices"].items()})
    assert value(browser, "rigwire.view.count.transforms") == transforms
    browser.find_element(By.ID, "step").click()
    eventually("a step of 100 ms was made",
               lambda: rig.command("state")["time_ns"] == before["time_ns"] + 100_000_000)


def tables_have_the_figures_of_the_run(rig, browser):
    """Precondition: time stands."""
    told = rig.command("read")["devices"]
    for name, device in told.items():
        eventually(f"{name} is shown as it is",
                   lambda: cell(browser, name, "frames") == device["frames"]
                   and cell(browser, name, "bytes") == device["bytes"]
                   and cell(browser, name, "drops") == device["dropped"])
    browser.find_element(By.ID, "pause").click()
    eventually("time goes on", lambda: not rig.command("state")["paused"])
    nominal = told["lidar"]["nominal_rate_hz"]
    eventually("the lidar has its rate", lambda: abs((cell(browser, "lidar", "rate") or 0) - nominal)
               < 0.1 * nominal)


def two_browsers_and_a_reload_see_the_same(rig, browser):
    second = open_browser(rig.page, 800, 900)
    try:
        eventually("the second sees the machine", lambda: is_drawn(second))
        browser.refresh()
        eventually("the first sees it again", lambda: is_drawn(browser))
        for one in (browser, second):
            assert value(one, "document.documentElement.scrollWidth <= innerWidth")
        assert value(second, "rigwire.view.entities.size") == value(browser, "rigwire.view.entities.size")
        assert not [entry for entry in second.get_log("browser") if entry["level"] == "SEVERE"]
    finally:
        second.quit()


def a_viewer_that_reads_nothing_costs_the_wires_nothing(rig, browser):
    viewer = Viewer(rig)
    assert viewer.status == 101
    channels = []
    while not channels:
        text, data = viewer.receive()
        channels = json.loads(data).get("channels", []) if text else []
    viewer.send({"op": "subscribe", "subscriptions":
                 [{"id": i, "channelId": channel["id"]} for i, channel in enumerate(channels)]})
    before = rig.command("read")
    time.sleep(10)
    after = rig.command("read")
    assert after["time_ns"] > before["time_ns"]
    for name, device in after["devices"].items():
        assert device["dropped"] == before["devices"][name]["dropped"], name
    # When it reads at last it is told what it missed.
    viewer.socket.settimeout(PATIENCE_S)
    for _ in range(200000):
        text, data = viewer.receive()
        if text and json.loads(data).get("id") == "dropped":
            assert "were dropped" in json.loads(data)["message"]
            break
    else:
        raise AssertionError("nobody told what was dropped")
    viewer.socket.close()


def strangers_are_refused(rig, browser):
    bearer = {"Authorization": f"Bearer {rig.token}"}
    pause = json.dumps({"verb": "state"}).encode()
    assert rig.request("/command", pause)[0] == 401
    assert rig.request("/command", pause, {"Authorization": "Bearer 0"})[0] == 401
    assert rig.request("/read")[0] == 401
    assert rig.request("/command", pause, {**bearer, "Origin": "http://elsewhere.example"})[0] == 403
    assert rig.request("/command", pause, {**bearer, "Host": "elsewhere.example"})[0] == 403
    assert rig.request("/command", pause, {**bearer, "Origin": rig.base})[0] == 200
    assert rig.request("/", headers={"Host": "elsewhere.example"})[0] == 403
    for path in ("/page/../run.js", "/page/%2e%2e/run.js", "/lib/../../etc/passwd", "/page/", "/page/x.js"):
        assert rig.request(path, headers=bearer)[0] == 404, path
    assert rig.request("/", b"", method="POST")[0] == 405
    status, page, headers = rig.request("/")
    policy = headers["Content-Security-Policy"]
    assert status == 200 and "script-src 'self'" in policy and "unsafe" not in policy, policy
    assert "<script>" not in page and " on" + "click" not in page
    for bad in ({"query": ""}, {"query": "?token=0"}, {"headers": "Origin: http://elsewhere.example\r\n"},
                {"headers": "Host: elsewhere.example\r\n"}, {"protocol": "chat"}):
        viewer = Viewer(rig, **bad)
        assert viewer.status in (400, 401, 403), (bad, viewer.status)
        viewer.socket.close()
    # A recording through a port is made in the run's own folder alone.
    status, text, _ = rig.request("/command", json.dumps({"verb": "record", "folder": "/tmp/x"}).encode(), bearer)
    assert status == 409, text


def the_report_has_what_the_page_showed(rig, browser):
    rig.command("pause")
    told = rig.command("read")["devices"]
    eventually("the page has it", lambda: all(cell(browser, name, "frames") == device["frames"]
                                              for name, device in told.items()))
    rig.command("stop")
    assert rig.process.wait(PATIENCE_S) == 0
    report = json.loads((rig.folder / "report.json").read_text())
    for name, device in report["devices"].items():
        assert cell(browser, name, "frames") == device["frames"], name
        assert cell(browser, name, "bytes") == device["bytes"], name
    eventually("the page says that nobody is there",
               lambda: "no connection" in browser.find_element(By.ID, "connection").text)


CASES = [nothing_is_complained_of, the_picture_is_of_the_machine, points_are_those_of_the_packets,
         a_fault_by_its_button_reaches_a_real_client, pause_stops_everything,
         tables_have_the_figures_of_the_run, two_browsers_and_a_reload_see_the_same,
         a_viewer_that_reads_nothing_costs_the_wires_nothing, strangers_are_refused,
         the_report_has_what_the_page_showed]


def main():
    scratch.mkdir(parents=True, exist_ok=True)
    rig = Rig()
    browser = None
    try:
        browser = open_browser(rig.page)
        for case in [case for case in CASES if not sys.argv[3:] or case.__name__ in sys.argv[3:]]:
            print(case.__name__, flush=True)
            case(rig, browser)
    finally:
        if browser:
            browser.quit()
        if rig.process.poll() is None:
            rig.process.send_signal(signal.SIGINT)
            rig.process.wait(PATIENCE_S)
    print("all seen")


if __name__ == "__main__":
    main()
