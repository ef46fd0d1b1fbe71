#!/usr/bin/env python3
"""The wires of running rigs as interfaces of Wireshark and tshark, live.

A program of Wireshark's extcap interface: linked into the personal extcap folder it is asked for its
interfaces, and writes what passes on one of them into a pipe.

    mkdir -p ~/.config/wireshark/extcap
    ln -s "$PWD/python/rigwire/extcap.py" ~/.config/wireshark/extcap/rigwire
    tshark -D
    tshark -i rigwire-dig-can

Runs are looked for in /tmp/rigwire, or where the variable RIGWIRE_EXTCAP says (paths with colons
between): folders of recordings that are being written (`run --record FOLDER`), which have an interface
for all wires and one for each, and control sockets (`run --control unix:FILE`), which have one for all
wires and are recorded while it is open. Needs nothing but the standard library.
"""

from __future__ import annotations

import argparse
import contextlib
import http.client
import json
import os
import shutil
import signal
import socket
import stat
import struct
import sys
import tempfile
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import FrameType

DEFAULT_PLACE = "/tmp/rigwire"
POLL_S = 0.05

#: Link types by the kind of wire in recording.json: number, name.
LINK_TYPES = {
    "ethernet": (1, "EN10MB"),
    "can": (227, "CAN_SOCKETCAN"),
    "serial": (250, "RTAC_SERIAL"),
}

SECTION_HEADER, INTERFACE = 0x0A0D0D0A, 0x00000001
MOST_BLOCK = 16 * 1024 * 1024


class Failed(Exception):
    """What is wrong, for people."""


@dataclass(frozen=True)
class Interface:
    value: str
    display: str
    kind: str
    folder: Path | None  #: Of a recording; None: it is made.
    wire: str  #: Empty: all of them.
    control: Path | None = None

    def file(self, folder: Path) -> Path:
        return folder / "wires" / f"{self.wire}.pcapng" if self.wire else folder / "all.pcapng"


class _Control(http.client.HTTPConnection):
    """The control surface of a run, at a Unix socket."""

    def __init__(self, path: Path) -> None:
        super().__init__("localhost", timeout=10)
        self._path = path

    def connect(self) -> None:
        self.sock = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
        self.sock.settimeout(self.timeout)
        self.sock.connect(str(self._path))

    def ask(self, verb: str, **keys: object) -> dict[str, object]:
        try:
            self.request("POST", "/command", json.dumps({"verb": verb, **keys}))
            reply = json.loads(self.getresponse().read())
        except (OSError, http.client.HTTPException, ValueError) as error:
            raise Failed(f"{self._path}: the run does not answer: {error}") from error
        finally:
            self.close()
        if not reply.get("ok"):
            raise Failed(f"{self._path}: {reply.get('what', 'refused')}")
        return dict(reply)


def description(folder: Path) -> dict[str, object] | None:
    """Of a recording, as it stands; None: there is none."""
    try:
        told = json.loads((folder / "recording.json").read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return None
    return told if isinstance(told, dict) else None


def places() -> Iterator[Path]:
    """Recordings and sockets, those that are named and those that lie in a named folder."""
    for place in os.environ.get("RIGWIRE_EXTCAP", DEFAULT_PLACE).split(":"):
        path = Path(place)
        if not place or not path.exists():
            continue
        yield path
        if path.is_dir() and not (path / "recording.json").exists():
            with contextlib.suppress(OSError):
                yield from sorted(path.iterdir())


def interfaces() -> list[Interface]:
    found: list[Interface] = []
    taken: set[str] = set()

    def name(words: str) -> str:
        plain = "rigwire-" + "".join(c if c.isalnum() or c in "-_." else "_" for c in words)
        unique, number = plain, 2
        while unique in taken:
            unique, number = f"{plain}.{number}", number + 1
        taken.add(unique)
        return unique

    for path in places():
        try:
            is_socket = stat.S_ISSOCK(path.stat().st_mode)
        except OSError:
            continue
        if is_socket:
            with contextlib.suppress(Failed):
                rig = _Control(path).ask("state").get("rig", "")
                found.append(
                    Interface(name(path.name), f"Rigwire: {rig}, all wires", "ethernet", None, "", path)
                )
            continue
        told = description(path)
        if told is None or told.get("end_ns") is not None:
            continue
        wires = told.get("wires")
        if not isinstance(wires, list) or not wires:
            continue
        label = path.name
        found.append(
            Interface(name(label), f"Rigwire: {told.get('rig', label)}, all wires", "ethernet", path, "")
        )
        for wire in wires:
            kind, about = str(wire.get("kind")), str(wire.get("name"))
            if kind in LINK_TYPES and "/" not in about:
                display = f"Rigwire: {told.get('rig', label)}, {about}"
                found.append(Interface(name(f"{label}-{about}"), display, kind, path, about))
    return found


class Blocks:
    """The blocks of a pcapng file that grows."""

    def __init__(self, path: Path) -> None:
        self._file = open(path, "rb")
        self._rest = b""

    def close(self) -> None:
        self._file.close()

    def size(self) -> int:
        return os.fstat(self._file.fileno()).st_size

    def whole(self) -> Iterator[tuple[int, int, bytes]]:
        """What has been written in whole since the last call: type, end in the file, block."""
        while piece := self._file.read(1 << 20):
            self._rest += piece
            at = 0
            while len(self._rest) - at >= 12:
                kind, length = struct.unpack_from("<II", self._rest, at)
                if length < 12 or length % 4 or length > MOST_BLOCK:
                    raise Failed("the recording has a block that is none")
                if len(self._rest) - at < length:
                    break
                end = self._file.tell() - len(self._rest) + at + length
                yield kind, end, self._rest[at : at + length]
                at += length
            self._rest = self._rest[at:]


def follow(interface: Interface, folder: Path, fifo: Path, history: bool) -> None:
    """Writes the wire's packets into the pipe until the recording ends or nobody reads any more."""
    path = interface.file(folder)
    while not path.exists():
        if description(folder) is None and not folder.exists():
            raise Failed(f"{folder}: the recording is gone")
        time.sleep(POLL_S)
    blocks = Blocks(path)
    begin = 0 if history else blocks.size()
    try:
        with open(fifo, "wb", buffering=0) as pipe:
            over = False
            while True:
                told = description(folder)
                last = over
                over = told is None or told.get("end_ns") is not None
                for kind, end, block in blocks.whole():
                    if end > begin or kind in (SECTION_HEADER, INTERFACE):
                        _write_all(pipe.fileno(), block)
                if last:
                    return
                if not over:
                    time.sleep(POLL_S)
    except BrokenPipeError:
        pass  # the capture was stopped
    finally:
        blocks.close()


def _write_all(descriptor: int, block: bytes) -> None:
    view = memoryview(block)
    while view:
        view = view[os.write(descriptor, view) :]


def _await_end(folder: Path) -> None:
    """Returns when the recording has its end, or after ten seconds."""
    until = time.monotonic() + 10.0
    while time.monotonic() < until:
        told = description(folder)
        if told is None or told.get("end_ns") is not None:
            return
        time.sleep(POLL_S)


def capture(interface: Interface, fifo: Path, history: bool) -> None:
    if interface.control is None:
        assert interface.folder is not None
        follow(interface, interface.folder, fifo, history)
        return
    parent = Path(tempfile.mkdtemp(prefix="rigwire-extcap-"))
    try:
        folder = parent / "recording"
        _Control(interface.control).ask("record", folder=str(folder))
        try:
            follow(interface, folder, fifo, history=True)
        finally:
            # The folder goes when the run has written its last file into it, however often the
            # capture is asked to stop.
            for number in (signal.SIGTERM, signal.SIGINT):
                signal.signal(number, signal.SIG_IGN)
            with contextlib.suppress(Failed):  # the run is over
                _Control(interface.control).ask("record", stop=True)
                _await_end(folder)
    finally:
        shutil.rmtree(parent, ignore_errors=True)


def _stop(number: int, frame: FrameType | None) -> None:
    raise SystemExit(0)


def main(arguments: Sequence[str] | None = None) -> int:
    parser = argparse.ArgumentParser(
        prog="rigwire-extcap", description="Wires of running rigs for Wireshark and tshark."
    )
    parser.add_argument("--extcap-interfaces", action="store_true")
    parser.add_argument("--extcap-version")
    parser.add_argument("--extcap-interface")
    parser.add_argument("--extcap-dlts", action="store_true")
    parser.add_argument("--extcap-config", action="store_true")
    parser.add_argument("--extcap-capture-filter")
    parser.add_argument("--capture", action="store_true")
    parser.add_argument("--fifo", type=Path)
    parser.add_argument("--history", default="false")
    parsed, _ = parser.parse_known_args(arguments)
    try:
        found = interfaces()
        if parsed.extcap_interfaces:
            print("extcap {version=1.0}{display=Rigwire}")
            for interface in found:
                print(f"interface {{value={interface.value}}}{{display={interface.display}}}")
            return 0
        chosen = next((i for i in found if i.value == parsed.extcap_interface), None)
        if parsed.extcap_config:
            print(
                "arg {number=0}{call=--history}{display=From the start of the recording}"
                "{type=boolflag}{default=false}"
                "{tooltip=Begin with what has passed already, not with what passes from now on}"
            )
            return 0
        if chosen is None:
            raise Failed(f"no wire {parsed.extcap_interface!r}; there are {[i.value for i in found]}")
        if parsed.extcap_dlts:
            number, name = LINK_TYPES[chosen.kind]
            print(f"dlt {{number={number}}}{{name={name}}}{{display={name}}}")
            return 0
        if not parsed.capture or parsed.fifo is None:
            parser.print_help(sys.stderr)
            return 2
        signal.signal(signal.SIGTERM, _stop)
        signal.signal(signal.SIGINT, _stop)
        capture(chosen, parsed.fifo, parsed.history.lower() == "true")
        return 0
    except (Failed, OSError) as error:
        print(f"rigwire-extcap: {error}", file=sys.stderr)
        return 1


if __name__ == "__main__":
    sys.exit(main())
