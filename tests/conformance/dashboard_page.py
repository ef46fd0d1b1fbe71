"""Looks at a run's page with Debian's Chromium, and at its wires with their real clients.

    dashboard_page.py BINARY_DIR SCRATCH_DIR [GROUP or CASE ...]

Starts the excavator with wires of its own and goes through the cases of a group, else of all, in one
browser. Asserts on numbers
and on pixels, never on a rate of frames: WebGL is drawn by the processor here.
"""
import base64
import contextlib
import json
import math
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
from selenium.webdriver.common.action_chains import ActionChains
from selenium.webdriver.common.by import By
from selenium.webdriver.common.keys import Keys
from selenium.webdriver.support.ui import Select

binaries, scratch = (pathlib.Path(argument) for argument in sys.argv[1:3])
PATIENCE_S = 120
NODE_PACKAGES = ["@foxglove/ws-protocol@0.8.0", "@foxglove/rosmsg@5", "@foxglove/rosmsg2-serialization@3", "ws@8"]  # installed into the build folder
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


claims = []


def free_port():
    """A port that no other test takes while this process runs (tests/support/private_wires.h)."""
    for attempt in range(2000):
        port = 10000 + 2 * ((os.getpid() * 37 + attempt * 101) % 10000)
        claim = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
        with contextlib.suppress(OSError):
            claim.bind(f"\0rigwire-test port {port}")
            if not answers(port):
                claims.append(claim)
                return port
    raise RuntimeError("no free port")


def answers(port):
    with socket.socket() as trial:
        return trial.connect_ex(("127.0.0.1", port)) == 0


class Rig:
    """The excavator digs nowhere: it stands, and does what it is told by hand."""

    def __init__(self, name="excavator_pit", folder="run", options=(), duration="20min"):
        self.folder = scratch / folder
        self.process = subprocess.Popen(
            [binaries / "rigwire", "run", name, "--isolated", self.folder, "--dashboard",
             "--status", "none", "--duration", duration, *options], stderr=open(scratch / f"{folder}.log", "w"))
        eventually("the run is ready", (self.folder / "run.json").exists)
        eventually("all of it is told", lambda: (self.folder / "run.json").read_text().endswith("\n"))
        self.take(json.loads((self.folder / "run.json").read_text()))

    def take(self, told):
        """What it tells when every wire is open."""
        self.told = told
        self.page = told["dashboard"]
        self.base, self.token = self.page.split("/#")
        self.port = int(self.base.rsplit(":", 1)[1])

    def end(self):
        if self.process.poll() is None:
            self.process.send_signal(signal.SIGINT)
            self.process.wait(PATIENCE_S)

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


class ShownRecording(Rig):
    def __init__(self, recording, options=()):
        ready, told = os.pipe()
        self.process = subprocess.Popen(
            [binaries / "rigwire", "replay", recording, "--dashboard", "--ready-fd", str(told), *options],
            stderr=open(scratch / "shown.log", "w"), pass_fds=[told])
        os.close(told)
        with os.fdopen(ready) as line:
            self.take(json.loads(line.read()))

    def state(self):
        """Empty while it begins anew."""
        with contextlib.suppress(OSError):  # nobody is there
            status, text, _ = self.request("/state", headers={"Authorization": f"Bearer {self.token}"})
            if status != 410:  # it has ended
                return json.loads(text)
        return {}


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
        self.send_frame(0x81, json.dumps(message).encode())

    def send_frame(self, kind, data):
        mask = os.urandom(4)
        size = (bytes([0x80 | len(data)]) if len(data) < 126
                else bytes([0x80 | 126]) + struct.pack(">H", len(data)))
        self.socket.sendall(bytes([kind]) + size + mask
                            + bytes(byte ^ mask[i % 4] for i, byte in enumerate(data)))

    def until(self, wanted):
        """The first message from now on of which `wanted(is text, bytes)` makes something."""
        while True:
            found = wanted(*self.receive())
            if found:
                return found


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
    # As root it would give its threads precedence over everything that is measured here.
    ordinary = scratch / "chromedriver"
    ordinary.write_text("#!/bin/sh\n"
                        "without='setpriv --bounding-set=-sys_nice --inh-caps=-sys_nice'\n"
                        "$without true 2>/dev/null || without=\n"
                        "exec $without /usr/bin/chromedriver \"$@\"\n")
    ordinary.chmod(0o700)
    browser = webdriver.Chrome(service=Service(str(ordinary)), options=options)
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
    """So many frames more; out of sight none is drawn."""
    browser.execute_script("document.getElementById('scene').scrollIntoView({ block: 'center' });")
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

    def colours(by):
        """Of some points of a turn that came after it was chosen, in the order in which they were fired."""
        Select(browser.find_element(By.ID, "colour")).select_by_value(by)
        before = value(browser, "rigwire.view.count.clouds")
        eventually("another cloud", lambda: value(browser, "rigwire.view.count.clouds") > before)
        return value(browser, """(() => {
            const { points } = rigwire.view.clouds.get("/points/lidar");
            const all = points.geometry.attributes.color.array;
            return [0, 0.25, 0.5, 0.75].map((share) => {
                const at = 3 * Math.floor(share * rigwire.view.cloudPoints);
                return [...all.slice(at, at + 3)];
            });
        })()""")
    by_time = colours("time")
    assert len({tuple(round(part, 1) for part in one) for one in by_time}) == 4, by_time
    assert numpy.abs(numpy.subtract(colours("time"), by_time)).max() < 0.1, "a turn is as the one before it"
    for other in ("reflectivity", "laser", "range"):
        assert numpy.abs(numpy.subtract(colours(other), by_time)).max() > 0.1, other


@contextlib.contextmanager
def gpsd_reports(rig):
    """What gpsd makes of the receiver's second port."""
    port = free_port()
    daemon = subprocess.Popen(["gpsd", "-N", "-n", "-S", str(port), rig.folder / "wires/gnss.1"])
    client = None
    try:
        eventually("gpsd listens", lambda: answers(port))
        client = subprocess.Popen(["gpspipe", "-w", f"localhost:{port}"], stdout=subprocess.PIPE, text=True)
        yield (json.loads(line) for line in client.stdout)
    finally:
        for process in (client, daemon):
            if process:
                process.terminate()
                process.wait()


def a_fault_by_its_button_reaches_a_real_client(rig, browser):
    with gpsd_reports(rig) as reports:
        modes = (report.get("mode", 0) for report in reports if report.get("class") == "TPV")
        assert next(mode for mode in modes if mode >= 3) == 3
        Select(browser.find_element(By.ID, "fault-on")).select_by_value("gnss")
        Select(browser.find_element(By.ID, "fault-type")).select_by_value("outage")
        browser.find_element(By.ID, "fault-add").click()
        assert next(mode for mode in modes if mode <= 1) <= 1
        eventually("the time line tells of it", lambda: "fault_begun" in browser.find_element(
            By.ID, "event-rows").text)
        row = browser.find_element(By.XPATH, "//tbody[@id='event-rows']/tr[td='fault_begun']")
        row.find_element(By.TAG_NAME, "button").click()
        shown = value(browser, "rigwire.plots.heldAt_s - rigwire.plots.span_s / 2")
        assert abs(shown - float(row.find_element(By.TAG_NAME, "button").text)) < 0.001, shown
        assert "fault_begun gnss" in value(browser, "rigwire.plots.marks.map(({ text }) => text)")
        eventually("it is a band in the plots", lambda: value(browser, "rigwire.plots.bandsDrawn") == 1)
        band = eventually("and on the time line", lambda: browser.find_elements(
            By.CSS_SELECTOR, "#time-line rect.fault"))
        assert len(band) == 1
        eventually("it is listed", lambda: browser.find_elements(By.CSS_SELECTOR, "#faults button"))
        # The mark behind its band ends it.
        eventually("it can be undone", lambda: click_if_there(browser, "#time-line .undo"))
        assert next(mode for mode in modes if mode >= 3) == 3
        eventually("its end is told", lambda: "fault_ended" in browser.find_element(
            By.ID, "event-rows").text)
        eventually("nothing acts any more", lambda: not browser.find_elements(
            By.CSS_SELECTOR, "#time-line .undo, #faults button"))
        browser.find_element(By.ID, "plot-pause").click()


def click_if_there(browser, selector):
    """By an event of its own: what is drawn anew twice a second may be gone before a real click."""
    return value(browser, f"""(() => {{
        const found = document.querySelector({json.dumps(selector)});
        found?.dispatchEvent(new MouseEvent("click", {{ bubbles: true }}));
        return Boolean(found);
    }})()""")


def satellites_are_those_that_gpsd_hears_of(rig, browser):
    with gpsd_reports(rig) as reports:
        # gpsd begins to tell of a sky before it has all pages.
        skies = (report for report in reports if report.get("class") == "SKY" and report.get("satellites"))
        told = [next(skies) for _ in range(3)][-1]
    used = sum(satellite["used"] for satellite in told["satellites"])
    assert used >= 4, told

    def shown():
        return value(browser, "rigwire.sensors.skies.get('/satellites/gnss')?.told?.satellites") or []
    eventually("the page has as many", lambda: abs(sum(one["used"] for one in shown()) - used) <= 1)
    by_number = {one["name"].split()[-1]: one for one in shown()}
    compared = 0
    for satellite in told["satellites"]:
        one = by_number.get(str(satellite["PRN"]))
        if one and "az" in satellite:
            compared += 1
            turn = (one["azimuth_deg"] - satellite["az"] + 180) % 360 - 180
            assert abs(turn) <= 2 and abs(one["elevation_deg"] - satellite["el"]) <= 2, (one, satellite)
    assert compared >= 4, (by_number, told)
    # The lines are there, in the colour of those that are used.
    rig.command("pause")
    lines = "rigwire.sensors.skies.get('/satellites/gnss').lines"
    assert value(browser, f"{lines}.visible && {lines}.geometry.drawRange.count") == 2 * len(shown())
    with_lines = picture(browser)
    browser.find_element(By.ID, "show-satellites").click()
    frames_drawn(browser, 3)
    assert value(browser, "[...rigwire.run.subscriptions.values()].filter((t) => t.startsWith('/sat')).length") == 0
    assert (numpy.abs(with_lines - picture(browser)).sum(axis=2) > 60).sum() > 100, "no line was drawn"
    browser.find_element(By.ID, "show-satellites").click()
    rig.command("resume")


def sensors_sit_where_the_rig_says(rig, browser):
    place = "rigwire.sensors.shown.get('imu_boom').group"
    assert value(browser, f"{place}.position.toArray()") == [2.5, 0.2, 0.5]
    assert value(browser, f"{place}.parent === rigwire.view.frames.get('boom')")
    kinds = value(browser, "[...rigwire.sensors.shown].map(([name, { kind }]) => `${name} ${kind}`)")
    assert {"imu_chassis imu", "imu_boom imu", "imu_stick imu", "imu_bucket imu", "lidar lidar",
            "gnss receiver"} == set(kinds), kinds
    browser.find_element(By.ID, "show-axes").click()
    assert not value(browser, f"{place}.visible")
    browser.find_element(By.ID, "show-axes").click()
    assert value(browser, f"{place}.visible")


def mbpoll(rig, table, register, *values):
    """An independent Modbus client reads one register of the valve driver, or writes it; what it says."""
    address, port = re.search(r"([\d.]+):(\d+)", rig.wire("valves")).groups()
    count = [] if values else ["-c", "1"]
    return subprocess.run(["mbpoll", "-m", "tcp", "-p", port, "-0", "-1", "-o", "10", "-a", "1", "-t", table,
                           "-r", str(register), *count, address, *map(str, values)],
                          capture_output=True, text=True, check=True).stdout


def registers_have_their_names_and_who_wrote_them(rig, browser):
    browser.find_element(By.CSS_SELECTOR, "#registers summary").click()

    def cells(name):
        return value(browser, f"[...(document.querySelector('tr[data-register=\"{name}\"]')?.cells ?? [])]"
                              ".map((cell) => cell.textContent)")
    eventually("all are listed", lambda: cells("heartbeat"))
    assert cells("heartbeat")[3] == "–" and cells("heartbeat")[5] == "–", cells("heartbeat")
    browser.execute_script("rigwire.wires.choose('valves', 'valves');")
    eventually("it is subscribed", lambda: "/wire/valves" in value(
        browser, "[...rigwire.run.subscriptions.values()]"))
    mbpoll(rig, "4", 9, 77)
    eventually("the write is there", lambda: cells("heartbeat")[3].strip() == "77")
    assert cells("heartbeat")[5].startswith("client "), cells("heartbeat")
    answer = mbpoll(rig, "3", 18)
    raw = int(re.search(r"\[18\]:\s+(-?\d+)", answer).group(1))
    shown = eventually("the voltage is there", lambda: cells("supply_voltage")[3] != "–"
                       and cells("supply_voltage")[3])
    number, unit = shown.split()
    assert unit == "V" and abs(float(number) - 0.01 * raw) < 0.5, (shown, raw)
    assert cells("supply_voltage")[5] == "–", "nobody wrote it"
    browser.find_element(By.CSS_SELECTOR, "#registers summary").click()
    # The message itself: a field marks its bytes.
    told, marked = mark_field(browser, "unit 1: write register", "heartbeat")
    assert told == "77" and marked == ["00", "4d"], (told, marked)


def buses_have_their_load_their_nodes_and_their_identifiers(rig, browser):
    summary = browser.find_element(By.CSS_SELECTOR, "#buses summary")
    eventually("the status has told of buses", summary.is_displayed)
    summary.click()

    def rows(of):
        return value(browser, f"[...document.getElementById('{of}').rows].map("
                              "(row) => [...row.cells].map((cell) => cell.textContent))")
    eventually("nodes are listed", lambda: any(name == "imu_boom" for _, name, *_ in rows("bus-nodes")))
    assert all(state == "active" for _, _, state, *_ in rows("bus-nodes")), rows("bus-nodes")

    def frames():
        read = rig.command("read")
        return read["time_ns"] * 1e-9, read["buses"]["can"]["frames"]
    begin_s, before = frames()
    eventually("6 s go by", lambda: frames()[0] > begin_s + 6)
    end_s, after = frames()
    eventually("rates are those of the bus", lambda: abs(
        sum(float(rate) for _, _, rate, *_ in rows("bus-identifiers")) / ((after - before) / (end_s - begin_s)) - 1) < 0.1)
    shown = float(re.search(r"can: load ([\d.]+) %", browser.find_element(By.ID, "bus-loads").text).group(1))
    load = 100 * rig.command("read")["buses"]["can"]["load"]
    assert 1 < load < 100 and abs(shown - load) < 5, (shown, load)
    summary.click()
    eventually("nobody listens any more", lambda: "/identifiers/can" not in value(
        browser, "[...rigwire.run.subscriptions.values()]"))


def lateness_of_a_device_is_shown_by_class(rig, browser):
    browser.find_element(By.CSS_SELECTOR, "tr[data-device=lidar] button").click()
    told = eventually("it is told", lambda: browser.find_element(By.ID, "lateness-words").text)
    assert told.startswith("lidar: "), told
    counts = value(browser, "rigwire.wires.status.devices.lidar.lateness_us")
    assert [us for us, _ in counts][:3] == [10, 20, 50] and counts[-1][0] is None, counts
    assert sum(count for _, count in counts) > 1000, counts
    assert value(browser, "document.querySelectorAll('#lateness rect').length") >= 6
    browser.execute_script("""
        const choice = document.getElementById("wire");
        choice.value = "";
        choice.dispatchEvent(new Event("change"));""")


def a_fix_has_its_ellipse(rig, browser):
    sigma_m = eventually("an ellipse", lambda: value(browser, """(() => {
        const { ellipse, latest } = rigwire.view.fixes.get("gnss");
        return ellipse.visible && [ellipse.scale.x, Math.sqrt(latest.position_covariance[0]), latest.position_covariance_type];
    })()"""))
    assert abs(sigma_m[0] - sigma_m[1]) < 1e-6 and 0.3 < sigma_m[0] < 40 and sigma_m[2] in (1, 2), sigma_m
    frames_drawn(browser, 15)
    blue, green, red = numpy.moveaxis(picture(browser), 2, 0)
    assert numpy.sum((red > 200) & (green < 60) & (blue > 180)) > 100, "fix and ellipse are hidden"
    eventually("it is said", lambda: "1σ" in browser.find_element(By.ID, "view-figures").text)


def mark_field(browser, message, field):
    """Chooses a message of the wire that is watched, points at a field: its words, and the bytes marked."""
    chosen = f"[...document.querySelectorAll('#messages li')].find((li) => li.textContent.includes({json.dumps(message)}))"
    eventually(f"a message with {message}", lambda: value(browser, f"Boolean({chosen})"))
    found, all_of_them = browser.execute_script(f"""
        rigwire.wires.pick({chosen});
        const fields = [...document.querySelectorAll("#message-fields li")];
        const found = fields.find((item) => item.textContent.startsWith(arguments[0]));
        found?.scrollIntoView({{ block: "center" }});
        return [found, fields.map((item) => item.textContent)];""", field)
    assert found, all_of_them
    ActionChains(browser).move_to_element(found).perform()
    # The browser delivers the pointer's event when it has drawn the page.
    marked = eventually("bytes are marked", lambda: value(
        browser, """[...document.querySelectorAll("#message-bytes .marked")].map((byte) => byte.textContent)"""))
    return browser.execute_script("return arguments[0].textContent;", found).split(": ", 1)[1], marked


def fields_mark_their_bytes(rig, browser):
    for wire, message, field in (("gnss", "GGA", "latitude"), ("lidar", "data packet", "block 1, azimuth"),
                                 ("can", "engine_speed=", "engine_speed")):
        Select(browser.find_element(By.ID, "wire")).select_by_value(f"/wire/{wire}")
        told, marked = mark_field(browser, message, field)
        marked = bytes.fromhex("".join(marked))
        if wire == "gnss":
            assert marked.decode() == told, (marked, told)
        elif wire == "lidar":
            assert abs(struct.unpack("<H", marked)[0] * 0.01 - float(told.split()[0])) < 0.006, (marked, told)
        else:  # J1939-71, PGN 61444: bytes 4 and 5, 0.125 rpm
            turns = struct.unpack("<H", marked)[0] * 0.125 * math.pi / 30
            assert told.endswith("rad/s") and abs(turns - float(told.split()[0])) < 0.01, (turns, told)
    browser.find_element(By.ID, "message-follow").click()
    assert not browser.find_elements(By.CSS_SELECTOR, "#messages [aria-current]")
    browser.find_element(By.ID, "messages").send_keys(Keys.ARROW_DOWN, Keys.ARROW_DOWN)
    assert len(browser.find_elements(By.CSS_SELECTOR, "#messages [aria-current]")) == 1
    Select(browser.find_element(By.ID, "wire")).select_by_value("")


def a_hand_is_marked_beside_what_the_client_asks(rig, browser):
    held = "document.querySelector('[data-stick=boom]').className.includes('held')"
    output = "document.querySelector('[data-stick=boom] output').textContent"
    rig.command("set", set={"boom": 0.2})  # by another hand than the page's
    eventually("the slider is marked", lambda: value(browser, held))
    assert value(browser, output).startswith("hand 0.2"), value(browser, output)
    mbpoll(rig, "4", 0, 1)
    mbpoll(rig, "4", 2, 150)
    eventually("the client's command is beside it", lambda: "client 15 %" in value(browser, output))
    browser.find_element(By.CSS_SELECTOR, "[data-stick=boom] button").click()
    eventually("it is the client's again", lambda: not value(browser, held))


def a_mark_on_the_time_line_moves_the_plots(rig, browser):
    status, text, _ = rig.request("/command", json.dumps({"verb": "set", "set": {"nothing": 1}}).encode(),
                                  {"Authorization": f"Bearer {rig.token}"})
    assert status == 400, text
    eventually("it is on the time line", lambda: click_if_there(browser, "#time-line circle"))
    line = browser.find_element(By.ID, "time-line")
    line.send_keys(Keys.ARROW_RIGHT)
    time_s = value(browser, "rigwire.timeLine.chosen.time_s")
    assert abs(value(browser, "rigwire.plots.heldAt_s - rigwire.plots.span_s / 2") - time_s) < 1e-6
    assert f"{time_s:.3f} s" in browser.find_element(By.ID, "time-line-words").text
    browser.find_element(By.ID, "plot-pause").click()


def quantities_have_the_words_of_read_and_unknown_ones_are_answered(rig, browser):
    """`boom` and Add did nothing and said nothing: the plots knew keys of the truth only."""
    field = browser.find_element(By.ID, "quantity")
    answer = browser.find_element(By.ID, "plot-answer")

    def add(name):
        field.clear()
        field.send_keys(name)
        browser.find_element(By.ID, "plot-add").click()
        return answer.text
    eventually("the list has the words", lambda: value(
        browser, "[...document.getElementById('quantities').options].some(({ value }) => value === 'boom')"))
    assert add("boom") == ""
    told = eventually("it is plotted", lambda: value(browser, "rigwire.plots.lines.get('boom')?.at(-1)?.y"))
    rig.command("pause")
    read = rig.command("read")["machine"]["quantities"]["boom"]
    rig.command("resume")
    assert read["unit"] == "deg" and abs(told - read["value"]) < 5, (told, read)
    eventually("with its unit", lambda: "boom (deg)" in value(
        browser, "rigwire.plots.chart.data.datasets.map(({ label }) => label)"))
    assert add("joint_rad.1") == "" and value(browser, "rigwire.plots.lines.has('truth.joint_rad.1')")
    assert add("boom") == "boom is plotted already."
    assert "Did you mean boom" in add("bom"), answer.text
    assert add("") == "Name a quantity of the list."
    span = browser.find_element(By.ID, "plot-span")
    before = span.get_attribute("value")
    span.clear()
    span.send_keys("long", Keys.TAB)
    assert answer.text == "The span is a number of seconds above 0." and span.get_attribute("value") == before
    browser.find_element(By.ID, "plot-clear").click()


def fog_by_its_slider_shortens_what_the_lidar_sees(rig, browser):
    farthest = """(() => {
        const { geometry } = rigwire.view.clouds.get('/points/lidar').points;
        const { array } = geometry.attributes.position;
        let most = 0;
        for (let i = 0; i < geometry.drawRange.count; ++i) most = Math.max(most, Math.hypot(...array.subarray(3 * i, 3 * i + 3)));
        return most;
    })()"""
    clear_m = eventually("a cloud", lambda: value(browser, farthest))
    assert clear_m > 45, clear_m
    frames_drawn(browser, 2)
    clear = picture(browser).std()
    browser.execute_script("""
        const slider = document.getElementById("air-fog");
        slider.value = 1;
        slider.dispatchEvent(new Event("change"));""")
    eventually("it is said on the page", lambda: "10 m" in value(
        browser, "document.querySelector('[data-air=fog].held output')?.textContent ?? ''"))
    assert rig.command("read")["air"] == {"rain": None, "snow": None, "fog": "10 m"}
    # An echo of 45 m would have e^-27 of its strength.
    eventually("nothing far is seen", lambda: value(browser, farthest) < 45)
    eventually("the view is told", lambda: "visibility 10 m" in browser.find_element(By.ID, "view-figures").text)
    eventually("the view is dim", lambda: picture(browser).std() < 0.7 * clear)
    browser.find_element(By.CSS_SELECTOR, "[data-air=fog] button").click()
    eventually("it is clear again", lambda: value(browser, farthest) > 0.9 * clear_m)
    eventually("the page says so", lambda: not browser.find_elements(By.CSS_SELECTOR, "[data-air].held"))


def pause_stops_everything(rig, browser):
    browser.find_element(By.ID, "pause").click()
    eventually("time stands", lambda: rig.command("state")["paused"])
    eventually("the page says so", lambda: "paused" in browser.find_element(By.ID, "time").text)
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


# What is not within its parent, or the window. What scrolls may hold more than it shows.
CLIPPED = """
const clipped = [];
for (const one of document.querySelectorAll("header *, main *")) {
  if (one.closest(".scroll, svg, #messages, #message-fields, option, datalist") || !one.getClientRects().length) continue;
  const { left, right } = one.getBoundingClientRect();
  const parent = one.parentElement.getBoundingClientRect();
  if (right > innerWidth + 1 || left < -1 || right > parent.right + 1) clipped.push(`${one.tagName}#${one.id} ${left} ${right}`);
}
if (document.documentElement.scrollWidth > innerWidth) clipped.push("the page scrolls sideways");
return clipped;
"""


def nothing_is_clipped(rig, browser):
    try:
        # A wide window, a narrow one, and 1280 pixels at 200 %.
        for width, scale in ((1280, 1), (800, 1), (640, 2)):
            browser.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", {
                "width": width, "height": 900, "deviceScaleFactor": scale, "mobile": False})
            eventually(f"it is {width} wide", lambda: value(browser, "innerWidth") == width)
            # Plots follow the window with its next event.
            eventually(f"nothing is clipped at {width}: {browser.execute_script(CLIPPED)}",
                       lambda: not browser.execute_script(CLIPPED))
    finally:
        browser.execute_cdp_cmd("Emulation.clearDeviceMetricsOverride", {})


def contrast(browser, one, other):
    """WCAG 2.1, of two custom properties."""
    def luminance(colour):
        parts = [int(colour[i:i + 2], 16) / 255 for i in (1, 3, 5)]
        parts = [part / 12.92 if part <= 0.04045 else ((part + 0.055) / 1.055) ** 2.4 for part in parts]
        return 0.2126 * parts[0] + 0.7152 * parts[1] + 0.0722 * parts[2]
    lights = sorted(luminance(value(browser, "getComputedStyle(document.documentElement)"
                                             f".getPropertyValue('{name}').trim()")) for name in (one, other))
    return (lights[1] + 0.05) / (lights[0] + 0.05)


def light_and_dark_can_both_be_read(rig, browser):
    grounds = set()
    for scheme in ("light", "dark"):
        browser.execute_cdp_cmd("Emulation.setEmulatedMedia", {
            "features": [{"name": "prefers-color-scheme", "value": scheme}]})
        grounds.add(value(browser, "getComputedStyle(document.body).backgroundColor"))
        for ink in ("--ink", "--faint", "--accent", "--bad"):
            for ground in ("--panel", "--row"):
                assert contrast(browser, ink, ground) >= 4.5, (scheme, ink, ground)
    assert len(grounds) == 2, grounds
    browser.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": []})


def keys_reach_everything(rig, browser):
    """Every control that is shown has its turn with Tab, and one sees where one is."""
    wanted = browser.execute_script("""
        document.body.focus();
        return [...document.querySelectorAll("button, input, select, summary, [tabindex='0']")]
          .filter((one) => one.getClientRects().length && !one.disabled && !one.closest("table, ul"))
          .map((one) => one.id || one.closest("[id], [data-stick]").id || one.closest("[data-stick]").dataset.stick);""")
    body = browser.find_element(By.TAG_NAME, "body")
    browser.execute_script("document.activeElement.blur(); scrollTo(0, 0);")
    reached, hidden = set(), []
    for _ in range(200):
        ActionChains(browser).send_keys(Keys.TAB).perform()
        name, outline = browser.execute_script("""
            const one = document.activeElement;
            const name = one.id || one.closest("[id], [data-stick]")?.id || one.closest("[data-stick]")?.dataset.stick;
            return [name, getComputedStyle(one).outlineStyle];""")
        if name in (None, "") and reached:
            break
        if name:
            reached.add(name)
            if outline == "none":
                hidden.append(name)
        if set(wanted) <= reached:
            break
    assert set(wanted) <= reached, set(wanted) - reached
    assert not hidden, hidden
    assert body


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
    eventually("10 s go by", lambda: rig.command("state")["time_ns"] > before["time_ns"] + 10_000_000_000)
    after = rig.command("read")
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


def foxgloves_own_client_hears_it(rig, browser):
    modules = binaries.absolute() / "node"
    modules.mkdir(exist_ok=True)
    names = [package.rsplit("@", 1)[0] for package in NODE_PACKAGES]
    if not all((modules / "node_modules" / name).exists() for name in names):
        fetched = subprocess.run(["npm", "install", "--no-audit", "--no-fund", "--prefix", modules, *NODE_PACKAGES],
                                 capture_output=True, text=True)
        if fetched.returncode != 0:
            print("skipped: no registry of npm answers:", fetched.stderr.splitlines()[-1:], flush=True)
            return
    heard = subprocess.run(["node", pathlib.Path(__file__).with_name("dashboard_foxglove.mjs"), rig.page, modules],
                           capture_output=True, text=True)
    assert heard.returncode == 0 and "all heard" in heard.stdout, heard.stdout + heard.stderr


def start_ns(viewer):
    info = viewer.until(lambda is_text, data: is_text and json.loads(data))
    return info["dataStartTime"]["sec"] * 10**9 + info["dataStartTime"]["nsec"]


def seek(viewer, time_ns, name):
    """By a viewer's transport bar; what the server says to it: whether it sought and where time is."""
    viewer.send_frame(0x82, struct.pack("<BBfBQI", 3, 1, 1.0, 1, time_ns, len(name)) + name)

    def state(is_text, data):
        told = not is_text and data[0] == 5 and data.endswith(name) and struct.unpack_from("<BBQfBI", data)
        return told and (told[4], told[2])
    return viewer.until(state)


def a_transport_bar_seeks_forward_where_time_steps(rig, browser):
    def complaint(is_text, data):
        message = is_text and json.loads(data)
        return message and message["op"] == "status" and message["level"] == 2 and message["message"]

    stepped = Rig(folder="stepped", options=("--clock", "step"))
    try:
        viewer = Viewer(stepped)
        start = start_ns(viewer)
        assert seek(viewer, start + 500_000_000, b"on") == (1, start + 500_000_000)
        state = stepped.command("state")
        assert state["time_ns"] == 500_000_000 and state["paused"], state
        assert seek(viewer, start + 100_000_000, b"back") == (0, start + 500_000_000)
        assert "cannot go back" in viewer.until(complaint)
        assert stepped.command("state")["time_ns"] == 500_000_000
    finally:
        stepped.end()
    viewer = Viewer(rig)
    did_seek, _ = seek(viewer, start_ns(viewer) + 10**12, b"paced")
    assert not did_seek
    assert "follows the wall clock" in viewer.until(complaint)


def a_viewer_at_the_end_has_the_last_of_it(rig, browser):
    ended = Rig(folder="ended", duration="3s")
    try:
        viewer = Viewer(ended)
        channels = viewer.until(lambda is_text, data: is_text and json.loads(data).get("channels"))
        truth = next(channel["id"] for channel in channels if channel["topic"] == "/truth")
        viewer.send({"op": "subscribe", "subscriptions": [{"id": 1, "channelId": truth}]})
        last_s = 0.0
        while viewer.socket.recv(1, socket.MSG_PEEK):
            is_text, data = viewer.receive()
            if not is_text and data[0] == 1:  # a message: subscription, time stamp, what it says
                last_s = json.loads(data[13:])["sim_s"]
        assert last_s == 3.0, f"the last that was heard is of {last_s} s"
    finally:
        ended.end()


def a_recording_goes_to_any_instant(rig, browser):
    """Time stands between its clients' acts, so that the recorded run and the shown one are the same."""
    taken = Rig(folder="taken", options=("--clock", "step", "--record", scratch / "recording"))
    try:
        taken.command("run_until", time=1)
        taken.command("set", set={"boom": 0.5})
        taken.command("run_until", time=2)
        early = taken.command("read")
        taken.command("run_until", time=3.5)
        taken.command("fault_add", on="gnss", fault={"type": "outage", "for": "1 s"})
        taken.command("run_until", time=5)
        late = taken.command("read")
        taken.command("run_until", time=6)
    finally:
        taken.end()

    shown = ShownRecording(scratch / "recording", ("--clock", "scaled:0.1"))
    second = open_browser(shown.page)

    def stands_at(read):
        state = shown.state()
        return state.get("paused") and state["time_ns"] == read["time_ns"]

    def seeks(time_s):
        second.execute_script("""
            const slider = document.getElementById("scrub-time");
            slider.value = arguments[0];
            slider.dispatchEvent(new Event("input"));
            slider.dispatchEvent(new Event("change"));""", time_s)

    def says():
        return value(second, "document.getElementById('scrub-words').textContent")

    try:
        eventually("it is seen", lambda: is_drawn(second))
        assert not second.find_element(By.ID, "fault").is_displayed()
        assert not second.find_element(By.ID, "sticks").is_displayed()
        second.execute_script("rigwire.plots.add('truth.position_m.0')")
        second.find_element(By.ID, "pause").click()
        eventually("it stands", lambda: shown.command("state")["paused"])

        seeks(5)
        eventually("time goes forward", lambda: stands_at(late))
        assert shown.command("read")["machine"]["quantities"] == late["machine"]["quantities"]
        assert shown.command("read")["devices"]["gnss"]["frames"] == late["devices"]["gnss"]["frames"]
        eventually("the page says so", lambda: says() == "5.00 of 6.00 s")
        eventually("the outage has its band", lambda: value(second, "document.querySelectorAll('#time-line .fault').length") == 1)
        session = value(second, "rigwire.run.session")

        seeks(2)
        eventually("time goes back", lambda: stands_at(early))
        assert shown.command("read")["machine"]["quantities"] == early["machine"]["quantities"]
        eventually("the page has begun anew", lambda: value(second, "window.rigwire?.run.session") not in (None, session))
        eventually("it is seen again", lambda: is_drawn(second))
        eventually("the page says so", lambda: says() == "2.00 of 6.00 s")
        assert value(second, "rigwire.plots.lines.has('truth.position_m.0')"), "the plots are those of before"

        # What is to come is on the time line, and a click goes there.
        eventually("the outage is to come", lambda: click_if_there(second, "#time-line .to-come"))
        eventually("time goes there", lambda: shown.state().get("time_ns", 0) >= 3_500_000_000)
        begun_s = shown.command("state")["time_ns"] * 1e-9
        assert 3.5 <= begun_s < 3.6, begun_s
        assert abs(value(second, "rigwire.plots.heldAt_s - rigwire.plots.span_s / 2") - begun_s) < 1e-3

        # Nobody changes what has been, and it ends where it ended.
        status, text, _ = shown.request("/command", json.dumps({"verb": "set", "set": {"boom": 1}}).encode(),
                                        {"Authorization": f"Bearer {shown.token}"})
        assert status == 409 and "read-only" in text, text
        shown.command("speed", factor=2)
        eventually("the page knows that it stands", lambda: second.find_element(By.ID, "pause").text == "Resume")
        second.find_element(By.ID, "pause").click()
        eventually("it is played to its end", lambda: shown.state().get("time_ns") == 6_000_000_000 and shown.state().get("paused"))
        # So does a viewer's transport bar, back and forth.
        viewer = Viewer(shown)
        did_seek, _ = seek(viewer, start_ns(viewer) + early["time_ns"], b"back")
        assert did_seek
        eventually("time goes back", lambda: stands_at(early))
        viewer = Viewer(shown)
        start = start_ns(viewer)
        assert seek(viewer, start + late["time_ns"], b"on") == (1, start + late["time_ns"])
        assert stands_at(late)
        assert seek(viewer, start - 1, b"before the start") == (0, start + late["time_ns"])
    finally:
        second.quit()
        shown.end()


def a_run_that_is_started_again_is_found_again(rig, browser):
    port = free_port()
    os.environ["RIGWIRE_CONTROL_TOKEN"] = "0123456789abcdef"
    second = None
    run = None
    try:
        options = ("--control", f"127.0.0.1:{port}")
        run = Rig(folder="started", options=options)
        second = open_browser(run.page)
        eventually("it is seen", lambda: is_drawn(second))
        second.execute_script("rigwire.plots.add('truth.position_m.0')")
        Select(second.find_element(By.ID, "camera")).select_by_value("top")
        session = value(second, "rigwire.run.session")
        run.process.kill()
        run.process.wait(PATIENCE_S)
        eventually("the page says that it is gone", lambda: "no connection" in second.find_element(By.ID, "connection").text)
        run = Rig(folder="started_again", options=options)
        eventually("another run is there", lambda: value(second, "window.rigwire?.run.session") not in (None, session))
        eventually("it is seen", lambda: is_drawn(second))
        assert "no connection" not in second.find_element(By.ID, "connection").text
        assert second.find_element(By.ID, "camera").get_property("value") == "top"
        assert value(second, "rigwire.plots.lines.has('truth.position_m.0')")
    finally:
        del os.environ["RIGWIRE_CONTROL_TOKEN"]
        if second:
            second.quit()
        if run:
            run.end()


def a_thousand_connections_take_nothing_from_the_wires(rig, browser):
    def open_files():
        return len(os.listdir(f"/proc/{rig.process.pid}/fd"))

    before = rig.command("read")
    files = open_files()
    crowd = []
    try:
        for number in range(1000):
            one = socket.create_connection(("127.0.0.1", rig.port), PATIENCE_S)
            crowd.append(one)
            if number % 2:
                with contextlib.suppress(OSError):  # it may have been refused already
                    one.sendall(b"GET /stream HTTP/1.1\r\nHost: 127.0.0.1\r\n")
        time.sleep(1)
        most = open_files()
        assert most < files + 100, f"{files} open files before, {most} with a thousand connections"
        transforms = value(browser, "rigwire.view.count.transforms")
        eventually("the page that was there sees on", lambda: value(browser, "rigwire.view.count.transforms") > transforms + 20)
    finally:
        for one in crowd:
            one.close()

    def serves():
        with contextlib.suppress(OSError, AssertionError):
            return rig.command("read")
        return None
    after = eventually("it serves again", serves)
    for name, device in after["devices"].items():
        assert device["dropped"] == before["devices"][name]["dropped"], name
    eventually("nothing of them is left", lambda: open_files() <= files + 2)


def what_others_have_named_is_text(rig, browser):
    script = "<script>window.broken = 1</script>"
    image = "<img src=x onerror='window.broken=1'>"
    named = scratch / "named.yaml"
    pit = pathlib.Path(__file__).parents[2] / "configs/rigs/excavator_pit.yaml"
    named.write_text(f'include: {pit}\nname: "{script}"\n')
    run = Rig(named, folder="named")
    second = open_browser(run.page)
    try:
        eventually("it is seen", lambda: is_drawn(second))
        assert second.find_element(By.ID, "rig").text == script
        Select(second.find_element(By.ID, "wire")).select_by_value("/wire/gnss")
        with open(run.wire("gnss").split()[0], "wb", buffering=0) as line:
            eventually("a client's bytes are told", lambda: line.write(image.encode() + b"\r\n")
                       and "client" in value(second, "[...document.querySelectorAll('#messages li')].map(li => li.className).join()"))
        status, _, _ = run.request("/command", json.dumps({"verb": "set", "on": image, "set": {script: 1}}).encode(),
                                   {"Authorization": f"Bearer {run.token}"})
        assert status == 400
        eventually("the refusal is told", lambda: "refused" in second.find_element(By.ID, "event-rows").text)
        assert value(second, "window.broken") is None
        assert value(second, "document.querySelectorAll('main img, main script').length") == 0
        nothing_is_complained_of(run, second)
    finally:
        second.quit()
        run.end()
    # A device cannot be called so.
    named.write_text(f'include: {pit}\ndevices:\n  "{script}":\n    type: ublox-neo-m8\n')
    refused = subprocess.run([binaries / "rigwire", "check", named], capture_output=True, text=True)
    assert refused.returncode == 2 and "not a name" in refused.stderr, refused


def metrics_are_as_prometheus_wants_them(rig, browser):
    status, text, _ = rig.request("/metrics", headers={"Authorization": f"Bearer {rig.token}"})
    assert status == 200 and "rigwire" in text
    judged = subprocess.run(["promtool", "check", "metrics"], input=text, capture_output=True, text=True)
    assert judged.returncode == 0, judged.stdout + judged.stderr


def a_page_that_is_left_open_keeps_its_size(rig, browser):
    """Everything is looked at; what JavaScript holds after a collection does not grow with time."""
    browser.execute_script("rigwire.plots.add('truth.position_m.0'); rigwire.plots.add('wires.lidar.frames');")
    Select(browser.find_element(By.ID, "wire")).select_by_value("/wire/can")
    browser.find_element(By.CSS_SELECTOR, "#registers summary").click()
    browser.execute_cdp_cmd("Performance.enable", {})

    def held_mb():
        browser.execute_cdp_cmd("HeapProfiler.collectGarbage", {})
        metrics = browser.execute_cdp_cmd("Performance.getMetrics", {})["metrics"]
        return next(one["value"] for one in metrics if one["name"] == "JSHeapUsedSize") / 1e6

    def after(simulated_s):
        begin_s = rig.command("state")["time_ns"] * 1e-9
        eventually(f"{simulated_s} s go by", lambda: rig.command("state")["time_ns"] * 1e-9 > begin_s + simulated_s)
        return held_mb()

    rig.command("speed", factor=4)
    first = after(20)  # until lists and plots are as long as they get
    held = [after(20) for _ in range(3)]
    rig.command("speed", factor=1)
    print(f"held after 20 s of simulated time {first:.1f} MB, then each 20 s", *(f"{one:.1f}" for one in held))
    assert max(held) < first + 8, (first, held)


GROUPS = {
    "page": [nothing_is_complained_of, the_picture_is_of_the_machine, points_are_those_of_the_packets,
             a_fault_by_its_button_reaches_a_real_client, pause_stops_everything,
             tables_have_the_figures_of_the_run, two_browsers_and_a_reload_see_the_same,
             a_viewer_that_reads_nothing_costs_the_wires_nothing, strangers_are_refused,
             the_report_has_what_the_page_showed],
    "wires": [nothing_is_complained_of, satellites_are_those_that_gpsd_hears_of, sensors_sit_where_the_rig_says,
              registers_have_their_names_and_who_wrote_them, fields_mark_their_bytes,
              buses_have_their_load_their_nodes_and_their_identifiers, lateness_of_a_device_is_shown_by_class,
              a_fix_has_its_ellipse,
              a_hand_is_marked_beside_what_the_client_asks, fog_by_its_slider_shortens_what_the_lidar_sees,
              a_mark_on_the_time_line_moves_the_plots,
              quantities_have_the_words_of_read_and_unknown_ones_are_answered],
    "looks": [nothing_is_complained_of, nothing_is_clipped, light_and_dark_can_both_be_read,
              keys_reach_everything],
    "recorded": [a_recording_goes_to_any_instant, a_run_that_is_started_again_is_found_again,
                 a_thousand_connections_take_nothing_from_the_wires, what_others_have_named_is_text],
    "lasting": [nothing_is_complained_of, a_transport_bar_seeks_forward_where_time_steps,
                a_viewer_at_the_end_has_the_last_of_it,
                metrics_are_as_prometheus_wants_them, foxgloves_own_client_hears_it,
                a_page_that_is_left_open_keeps_its_size],
}


def main():
    scratch.mkdir(parents=True, exist_ok=True)
    rig = Rig()
    browser = None
    try:
        browser = open_browser(rig.page)
        asked = sys.argv[3:] or list(GROUPS)
        cases = {case: None for group, cases in GROUPS.items() for case in cases
                 if group in asked or case.__name__ in asked}
        # What ends the run comes last, whatever is asked for.
        for case in sorted(cases, key=lambda case: case is the_report_has_what_the_page_showed):
            print(case.__name__, flush=True)
            case(rig, browser)
    finally:
        if browser:
            browser.quit()
        rig.end()
    print("all seen")


if __name__ == "__main__":
    main()
