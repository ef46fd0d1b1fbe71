"""A rig as a context manager. What may be asked of a run is described by GET /openapi.json."""

from __future__ import annotations

import difflib
import http.client
import json
import os
import shutil
import socket
import subprocess
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from types import TracebackType
from typing import Any


class RigwireError(Exception):
    """The rig could not be started, or the run did not answer."""


class Refused(RigwireError):
    """The run refused a request; `reply` says what was wrong, found and allowed."""

    def __init__(self, reply: Mapping[str, Any]) -> None:
        self.reply = dict(reply)
        words = [str(reply.get("what", "refused"))]
        words += [f"{key} {reply[key]}" for key in ("found", "allowed") if reply.get(key)]
        super().__init__(", ".join(words))


class RunEnded(Refused):
    """The run ended before the request was done."""


class UnknownQuantity(Refused, KeyError):
    """The machine has no quantity of that name; the reply has those that it has, and the nearest."""

    def __init__(self, name: str, quantities: Mapping[str, Quantity]) -> None:
        allowed = ", ".join(
            f"{known} ({quantity.unit})" if quantity.unit else known
            for known, quantity in quantities.items()
        )
        near = difflib.get_close_matches(name, quantities, n=1)
        if near:
            allowed += f", did you mean {near[0]}?"
        super().__init__(
            {
                "ok": False,
                "what": "the machine has no such quantity",
                "path": "quantity",
                "found": name,
                "allowed": allowed,
            }
        )

    def __str__(self) -> str:
        # A KeyError would show its argument as Python writes it, with quotes.
        return str(self.args[0])


@dataclass(frozen=True)
class State:
    """Where a run stands."""

    time_ns: int
    paused: bool
    rig: str
    seed: int
    config_hash: str
    clock: str

    @property
    def time(self) -> float:
        return self.time_ns * 1e-9


@dataclass(frozen=True)
class Quantity:
    value: float
    unit: str


@dataclass(frozen=True)
class Machine:
    """The machine's true state at the end of the newest slice."""

    time_ns: int
    quantities: Mapping[str, Quantity]

    def __getitem__(self, name: str) -> float:
        """The value of a quantity, in its own unit. Raises UnknownQuantity."""
        return self.quantity(name).value

    def __contains__(self, name: object) -> bool:
        return name in self.quantities

    def quantity(self, name: str) -> Quantity:
        """Value and unit of a quantity, by the word that `wait` takes. Raises UnknownQuantity."""
        try:
            return self.quantities[name]
        except KeyError:
            raise UnknownQuantity(name, self.quantities) from None


@dataclass(frozen=True)
class Request:
    """What a device's client asked last, in the words of its wire."""

    time_ns: int
    text: str


@dataclass(frozen=True)
class DeviceStatus:
    wire: str
    frames: int
    bytes: int
    dropped: int
    nominal_rate_hz: float  #: 0: it has none.
    lateness_p50_us: float
    lateness_p99_us: float
    lateness_max_us: float
    lateness_us: Sequence[Sequence[float | None]]  #: [upper edge, messages] by class; None: above all.
    client_present: bool
    readers: int  #: Programs on one plug.
    last_request: Request | None
    settable: Sequence[str] = ()  #: Keys of its configuration that `set` can change.


@dataclass(frozen=True)
class BusNode:
    """A node of a CAN bus, as its emulated controller has it."""

    name: str  #: Empty: the client's.
    state: str  #: "active", "warning", "passive", "bus-off".
    transmit_errors: int
    receive_errors: int
    sent: int
    received: int
    overflowed: int  #: Lost since its queue was full.
    retransmissions: int
    bus_offs: int


@dataclass(frozen=True)
class BusStatus:
    load: float  #: Share of the last second that it was busy.
    frames: int
    error_frames: int
    nodes: Sequence[BusNode]


@dataclass(frozen=True)
class FaultWindow:
    where: str
    type: str
    begin_ns: int | None  #: None: it waits, see `waits_for`.
    end_ns: int | None


@dataclass(frozen=True)
class Fault(FaultWindow):
    id: int  #: Number within the run.
    waits_for: str | None = None  #: What must become true: "boom above 0.5".


@dataclass(frozen=True)
class Event:
    """Something that happened in the run."""

    number: int
    time_ns: int
    kind: str  #: "fault_begun", "contact_begun", "client_came", ...
    level: str
    where: str  #: A device, wire or part of the machine; empty: the run.
    text: str

    @property
    def time(self) -> float:
        return self.time_ns * 1e-9


class Events(list[Event]):
    """Events in the order of their numbers."""

    last: int = 0  #: Number of the newest there is, to be the next `since`.
    lost: int = 0  #: How many after `since` are kept no longer.


@dataclass(frozen=True)
class Reading:
    time_ns: int
    machine: Machine
    devices: Mapping[str, DeviceStatus]
    buses: Mapping[str, BusStatus]
    faults: Sequence[FaultWindow]
    wall_s: float  #: Wall time since the run began.
    slipped_s: float  #: By which the clock gave way to a host that is too slow.
    recording: str | None  #: Folder of the one that goes on.


class _UnixConnection(http.client.HTTPConnection):
    """HTTP over a Unix socket."""

    def __init__(self, path: str, timeout: float | None) -> None:
        super().__init__("localhost", timeout=timeout)
        self._path = path

    def connect(self) -> None:
        self.sock = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
        self.sock.settimeout(self.timeout)
        self.sock.connect(self._path)


def find_program() -> str:
    """Path of `rigwire`: the variable RIGWIRE, else the path."""
    program = os.environ.get("RIGWIRE") or shutil.which("rigwire")
    if not program:
        raise RigwireError("no program rigwire: set the variable RIGWIRE to its path")
    return program


class Rig:
    """One run of a rig.

    `rig` is a name of `rigwire list rigs` or a file; `sets` are changes of its values, as --set takes
    them. With `isolated` the run has wires of its own, found by `devices` and `replaced`, so that any
    number of runs of one rig stand side by side. With the clock "step", the default, simulated time moves only when told; "real", "free" and
    "scaled:X" are as for `rigwire run`. `patience` is how long an answer may take, in seconds of
    wall time, None: as long as it takes.
    """

    def __init__(
        self,
        rig: str | Path,
        *,
        sets: Mapping[str, object] | None = None,
        clock: str = "step",
        seed: int | None = None,
        duration: float | None = None,
        isolated: bool = False,
        arguments: Sequence[str] = (),
        folder: str | Path | None = None,
        patience: float | None = 120.0,
    ) -> None:
        self._patience = patience
        self._own_folder = folder is None
        self.folder = Path(folder) if folder else Path(tempfile.mkdtemp(prefix="rigwire-"))
        self.report_path = self.folder / "report.json"
        self.log_path = self.folder / "rigwire.log"
        self._socket = str(self.folder / "control")
        self.devices: dict[str, str] = {}  #: Wire of each device.
        #: What an isolated run has in place of the rig's values: "devices.lidar.port", as text.
        self.replaced: dict[str, str] = {}
        ready, told = os.pipe()
        command = [find_program(), "run", str(rig), "--clock", clock, "--status", "none"]
        command += ["--control", f"unix:{self._socket}", "--ready-fd", str(told)]
        command += ["--report", str(self.report_path)]
        if isolated:
            command += ["--isolated", str(self.folder / "run")]
        for key, value in (sets or {}).items():
            command += ["--set", f"{key}={value}"]
        if seed is not None:
            command += ["--seed", str(seed)]
        if duration is not None:
            command += ["--duration", f"{duration!r}s"]
        command += list(arguments)
        with open(self.log_path, "wb") as log:
            self._process = subprocess.Popen(
                command, stdin=subprocess.DEVNULL, stdout=log, stderr=log, pass_fds=(told,)
            )
        os.close(told)
        with os.fdopen(ready, encoding="utf-8") as line:
            text = line.readline()  # ends with the process, too
        if not text:
            self._process.wait()
            log_text = self.log()
            self._remove_folder()
            raise RigwireError(f"the run did not start: {log_text}")
        told_ready = json.loads(text)
        self.devices = dict(told_ready.get("devices", {}))
        self.replaced = dict(told_ready.get("replaced", {}))

    def __enter__(self) -> Rig:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()

    @property
    def pid(self) -> int:
        return self._process.pid

    def log(self) -> str:
        """What the run has said so far."""
        return self.log_path.read_text(encoding="utf-8", errors="replace").strip()

    def ask(self, verb: str, **keys: object) -> dict[str, Any]:
        """Any request by its name; returns the reply. Raises Refused, RunEnded, RigwireError."""
        connection = _UnixConnection(self._socket, self._patience)
        body = json.dumps({"verb": verb, **{k: v for k, v in keys.items() if v is not None}})
        try:
            connection.request("POST", "/command", body)
            response = connection.getresponse()
            reply = json.loads(response.read())
        except (OSError, http.client.HTTPException, ValueError) as error:
            raise RigwireError(f"the run does not answer: {error}; it said: {self.log()}") from error
        finally:
            connection.close()
        if response.status == 410:
            raise RunEnded(reply)
        if not reply.get("ok"):
            raise Refused(reply)
        return dict(reply)

    def state(self) -> State:
        reply = self.ask("state")
        return State(
            reply["time_ns"],
            reply["paused"],
            reply["rig"],
            reply["seed"],
            reply["config_hash"],
            reply["clock"],
        )

    def pause(self) -> float:
        """Time stands; returns it."""
        return _time(self.ask("pause"))

    def resume(self) -> float:
        return _time(self.ask("resume"))

    def run_until(self, time: float) -> float:
        """Runs to that instant and stands there."""
        return _time(self.ask("run_until", time=_span(time)))

    def step(self, length: float) -> float:
        """Runs that much further and stands there."""
        return _time(self.ask("step", length=_span(length)))

    def speed(self, factor: float) -> None:
        """Another pace, with the clocks "real" and "scaled:X"."""
        self.ask("speed", factor=factor)

    def wait(
        self,
        quantity: str,
        *,
        above: float | None = None,
        below: float | None = None,
        limit: float = 10.0,
    ) -> float:
        """Until a quantity of the machine is above or below a value, in its own unit; returns the
        time. Its name is a word of `read`; an unknown one raises Refused with those that there are.
        Raises Refused after `limit` simulated seconds."""
        if (above is None) == (below is None):
            raise ValueError("wait: one of above and below")
        value = below if above is None else above
        return _time(
            self.ask("wait", quantity=quantity, value=value, above=above is not None, limit=_span(limit))
        )

    def read(self) -> Reading:
        reply = self.ask("read")
        machine = reply["machine"]
        return Reading(
            reply["time_ns"],
            Machine(
                machine["time_ns"],
                {name: Quantity(q["value"], q["unit"]) for name, q in machine["quantities"].items()},
            ),
            {
                name: DeviceStatus(
                    **{
                        **device,
                        "last_request": Request(**device["last_request"])
                        if device["last_request"]
                        else None,
                    }
                )
                for name, device in reply["devices"].items()
            },
            {
                name: BusStatus(**{**bus, "nodes": [BusNode(**node) for node in bus["nodes"]]})
                for name, bus in reply["buses"].items()
            },
            [FaultWindow(**fault) for fault in reply["faults"]],
            reply["wall_s"],
            reply["slipped_s"],
            reply["recording"],
        )

    def add_fault(self, on: str, type: str, **keys: object) -> Fault:
        """One fault more, of a device, of "bus NAME" or "modbus NAME"; its other keys as in a rig's
        file, times in seconds (`for_` stands for the key `for`, a word of Python's). Without `at` it
        begins as soon as it can. Raises Refused for what the target cannot have."""
        fault = {"type": type, **{key.rstrip("_"): value for key, value in keys.items()}}
        return _fault(self.ask("fault_add", on=on, fault=fault)["fault"])

    def clear_fault(self, fault: Fault | int) -> Fault:
        """It ends, or will not begin; returns it with its end."""
        number = fault.id if isinstance(fault, Fault) else fault
        return _fault(self.ask("fault_clear", id=number)["fault"])

    def faults(self) -> list[Fault]:
        """Every fault of this run: of its file, and added; also what is over."""
        return [_fault(fault) for fault in self.ask("fault_list")["faults"]]

    def fault_kinds(self) -> dict[str, dict[str, str]]:
        """What can go wrong where: by target the kinds, each with a sentence."""
        return {on: dict(kinds) for on, kinds in self.ask("fault_list")["targets"].items()}

    def events(self, since: int = 0, *, wait: bool = False) -> Events:
        """What happened after the event of number `since`; with `wait` when there is a newer one."""
        reply = self.ask("events", since=since, wait=wait)
        events = Events(Event(**event) for event in reply["events"])
        events.last = reply["last"]
        events.lost = reply["lost"]
        return events

    @contextmanager
    def record(self, folder: str | Path, only: Sequence[str] | None = None) -> Iterator[Path]:
        """Records the run into a folder that is new or empty, while the block lasts."""
        path = Path(folder).absolute()
        self.start_recording(path, only)
        try:
            yield path
        finally:
            try:
                self.stop_recording()
            except RunEnded:
                pass  # the recording ended with the run

    def start_recording(self, folder: str | Path, only: Sequence[str] | None = None) -> None:
        """Raises Refused while there is a recording, or where the folder cannot be had."""
        self.ask("record", folder=str(Path(folder).absolute()), only=list(only) if only else None)

    def stop_recording(self) -> float:
        """Ends the recording; returns its last instant."""
        return float(self.ask("record", stop=True)["end_ns"]) * 1e-9

    def set(self, on: str = "machine", /, **values: Any) -> float:
        """Set points of the machine by hand, beside the client's, as numbers in the key's unit or
        text with one ("20 km/h"); None lets one go. With the name of a device keys of its
        configuration, as in the rig's file, of those that it can be told while it runs
        (`read().devices[on].settable`). Returns when they act."""
        return float(self.ask("set", on=on, set=values)["acts_from_ns"]) * 1e-9

    def release(self, *names: str) -> float:
        """Lets set points go to the client again."""
        return self.set(**dict.fromkeys(names))

    def stop(self) -> dict[str, Any]:
        """Ends the run; returns its report."""
        if self._process.poll() is None:
            try:
                self.ask("stop")
            except RunEnded:
                pass
        status = self._process.wait(timeout=self._patience)
        if status != 0:
            raise RigwireError(f"the run ended with {status}: {self.log()}")
        return dict(json.loads(self.report_path.read_text(encoding="utf-8")))

    def close(self) -> None:
        """Ends the run whatever it does, and removes the folder if it was made for it."""
        if self._process.poll() is None:
            self._process.terminate()
            try:
                self._process.wait(timeout=10)
            except subprocess.TimeoutExpired:
                self._process.kill()
                self._process.wait()
        self._remove_folder()

    def _remove_folder(self) -> None:
        if self._own_folder:
            shutil.rmtree(self.folder, ignore_errors=True)


def _fault(told: Mapping[str, Any]) -> Fault:
    return Fault(
        told["where"],
        told["type"],
        told["begin_ns"],
        told["end_ns"],
        told["id"],
        told.get("waits_for"),
    )


def _span(seconds: float) -> str:
    """Exact to the nanosecond."""
    return f"{round(seconds * 1e9)} ns"


def _time(reply: Mapping[str, Any]) -> float:
    return float(reply["time_ns"]) * 1e-9
