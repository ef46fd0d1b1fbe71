"""A field program on its own wires in real time, and what it does when a sensor fails.

    RIGWIRE=build/rigwire PYTHONPATH=python pytest examples/pytest
"""

import subprocess
from collections.abc import Callable
from pathlib import Path

from rigwire import Rig
from rigwire.rig import find_program

pytest_plugins = ["rigwire.fixtures"]

ROOT = Path(__file__).resolve().parents[2]


def test_it_stops_when_its_receiver_is_jammed(start_rig: Callable[..., Rig]) -> None:
    rig = start_rig("unimog_forest", isolated=True, clock="real")
    program = subprocess.Popen(
        [
            Path(find_program()).parent / "path_follow",
            *("--path", ROOT / "configs/paths/forest_track.csv", "--antenna", "3.2,0"),
            *("--gnss", rig.replaced["devices.gnss.path"], "--gnss-sigma", "0.5"),
            *("--can", rig.replaced["buses.can.path"], "--quiet"),
        ],
        stderr=subprocess.PIPE,
        text=True,
    )
    try:
        rig.wait("speed", above=5.0, limit=60)  # km/h
        rig.add_fault("gnss", "jamming", loss="60 dB", for_=120.0)
        _, said = program.communicate(timeout=90)
    finally:
        program.kill()
    assert program.returncode == 1
    assert "no position for" in said
    rig.wait("speed", below=0.1, limit=20)
