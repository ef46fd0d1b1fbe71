"""A controller and its excavator in lock-step: the test is the controller, over Modbus, and time moves
by one of its cycles when it has spoken. The same run on every machine, however slow.

    RIGWIRE=build/rigwire PYTHONPATH=python pytest examples/pytest
"""

import socket
import struct
import subprocess
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from rigwire import Rig
from rigwire.rig import find_program

pytest_plugins = ["rigwire.fixtures"]

CYCLE = 0.02  # s; the valves' watchdog wants a request every 0.2 s


class Valves:
    """Register 0 enables, 1 to 8 are openings in 0.1 %, 9 is the heartbeat (docs/devices/valve-driver.md)."""

    def __init__(self, rig: Rig) -> None:
        self._rig = rig
        self._cycle = 0
        address = rig.replaced["devices.valves.address"]
        self._socket = socket.create_connection((address, 1502), timeout=20)

    def hold(self, seconds: float, *openings: float) -> None:
        """Openings of swing, boom, stick and bucket, -1 to 1, for so long."""
        for _ in range(round(seconds / CYCLE)):
            self._cycle += 1
            spools = [round(1000 * opening) for opening in openings] + [0] * (8 - len(openings))
            request = struct.pack(">BHHBH8hH", 16, 0, 10, 20, 1, *spools, self._cycle)
            self._socket.sendall(struct.pack(">HHHB", self._cycle, 0, len(request) + 1, 1) + request)
            self._rig.step(CYCLE)
            answer = self._socket.recv(260)
            assert answer[7] == 16, f"exception {answer[8]}"

    def close(self) -> None:
        self._socket.close()


@pytest.fixture
def rig(start_rig: Callable[..., Rig], tmp_path: Path) -> Rig:
    return start_rig("excavator_pit", isolated=True, arguments=["--record", str(tmp_path / "recording")])


@pytest.fixture
def valves(rig: Rig) -> Iterator[Valves]:
    valves = Valves(rig)
    yield valves
    valves.close()


def test_one_cycle_lifts_soil_and_is_recorded_to_the_byte(
    rig: Rig, valves: Valves, tmp_path: Path
) -> None:
    rig.run_until(0.1)
    valves.hold(1.5, 0.0, 0.0, -1.0, -1.0)  # reach out
    valves.hold(2.2, 0.0, -0.8, 0.0, 0.0)  # into the heap
    valves.hold(2.5, 0.0, 0.0, 0.6, 0.3)
    valves.hold(1.5, 0.0, 0.0, 0.2, 1.0)  # fill
    valves.hold(0.5, 0.0, 0.0, 0.0, 1.0)  # curl
    valves.hold(1.2, 0.0, 0.8, 0.0, 0.5)  # lift, the bucket kept level
    machine = rig.read().machine
    assert machine["payload"] > 500.0
    assert machine["tip height"] > 2.0
    assert rig.read().devices["valves"].client_present
    rig.stop()
    # Once more, with what this test commanded at its instants: every byte of every wire.
    verified = subprocess.run(
        [find_program(), "replay", str(tmp_path / "recording"), "--verify"],
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
    )
    assert verified.returncode == 0, verified.stdout + verified.stderr


def test_valves_go_neutral_when_the_controller_stops_speaking(rig: Rig, valves: Valves) -> None:
    rig.run_until(0.1)
    valves.hold(0.6, 0.5, 0.5)
    assert rig.read().machine["boom"] > 45.0
    rig.step(1.0)  # silence, beyond the watchdog
    stood = rig.read().machine["boom"]
    rig.step(1.0)
    assert rig.read().machine["boom"] == pytest.approx(stood, abs=0.2)
