"""An excavator and its software on trial, in simulated time that moves when the test says so.

    RIGWIRE=build/rigwire PYTHONPATH=python pytest examples/pytest
"""

import os
import select
import subprocess
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest

from rigwire import Refused, Rig, RigwireError
from rigwire.rig import find_program

pytest_plugins = ["rigwire.fixtures"]

RIG = """\
name: excavator on a plane
scene:
  terrain: {{type: level, size: 40 m, cell: 1 m}}
machine: {{type: excavator}}
devices:
  gnss:
    type: ublox-neo-7p
    path: {folder}/gnss
    faults: [{{type: jamming, at: 6 s, for: 2 s, loss: 40 dB}}]
"""


@pytest.fixture
def rig(tmp_path: Path, start_rig: Callable[..., Rig]) -> Rig:
    return start_rig(write_rig(tmp_path))


def write_rig(folder: Path) -> Path:
    path = folder / "rig.yaml"
    path.write_text(RIG.format(folder=folder), encoding="utf-8")
    return path


def test_a_quantity_that_the_machine_does_not_have_is_refused_with_the_nearest(rig: Rig) -> None:
    with pytest.raises(Refused, match=r"did you mean boom\?"):
        rig.wait("bom", above=1.0)
    rig.step(0.1)
    machine = rig.read().machine
    assert machine.quantity("boom").unit == "deg"
    with pytest.raises(Refused, match=r"did you mean boom\?"):
        machine["bom"]


def test_every_wire_is_open_before_time_begins(rig: Rig) -> None:
    assert rig.state().time_ns == 0
    assert rig.state().paused
    assert Path(rig.devices["gnss"].split()[-1]).exists()


def test_time_stands_exactly_where_it_was_sent(rig: Rig) -> None:
    assert rig.run_until(1.5) == 1.5
    assert rig.step(0.000_000_001) == pytest.approx(1.500_000_001, abs=1e-12)
    assert rig.state().time_ns == 1_500_000_001
    frames = rig.read().devices["gnss"].frames
    assert frames > 0
    assert rig.read().devices["gnss"].frames == frames  # nothing moves by itself


def test_a_fault_that_is_added_acts_and_ends(rig: Rig) -> None:
    rig.run_until(2.0)
    fault = rig.add_fault("gnss", "outage", for_=60.0)
    rig.run_until(4.0)
    assert [acting.type for acting in rig.read().faults] == ["outage"]
    rig.clear_fault(fault)
    rig.step(0.1)
    assert not rig.read().faults
    with pytest.raises(Refused, match="jamming"):
        rig.add_fault("gnss", "motor_stall")


def test_a_fault_of_the_file_acts_in_its_window(rig: Rig) -> None:
    rig.run_until(5.0)
    assert not rig.read().faults
    rig.run_until(6.5)
    assert [fault.type for fault in rig.read().faults] == ["jamming"]
    rig.run_until(8.5)
    assert not rig.read().faults


def test_a_fault_of_the_rig_waits_for_the_machine(
    tmp_path: Path, start_rig: Callable[..., Rig]
) -> None:
    (tmp_path / "still").mkdir()
    still = start_rig(write_rig(tmp_path / "still"))
    still.run_until(0.1)
    lifted = still.read().machine["boom"] + 1.0
    path = write_rig(tmp_path)
    when = f"{{quantity: boom, above: true, value: {lifted}}}"
    text = f"faults: [{{on: gnss, type: outage, for: 1 s, when: {when}}}]\n"
    path.write_text(path.read_text(encoding="utf-8") + text, encoding="utf-8")
    rig = start_rig(path)
    rig.run_until(1.0)
    waiting = next(fault for fault in rig.faults() if fault.type == "outage")
    assert waiting.begin_ns is None
    assert not rig.read().faults
    rig.set(boom=0.8)
    there = rig.wait("boom", above=lifted)
    rig.step(0.1)
    (begun,) = [fault for fault in rig.faults() if fault.type == "outage"]
    assert begun.begin_ns is not None
    assert begun.begin_ns * 1e-9 == pytest.approx(there, abs=0.005)
    assert [acting.type for acting in rig.read().faults] == ["outage"]
    rig.step(1.0)
    assert not rig.read().faults


def test_what_is_not_possible_says_what_is(rig: Rig) -> None:
    rig.run_until(1.0)
    with pytest.raises(Refused, match="later than 1 s"):
        rig.run_until(0.5)
    with pytest.raises(Refused, match="allowed"):
        rig.wait("bucket temperature", above=1.0)
    with pytest.raises(RigwireError, match="did not start"):
        Rig("no_such_rig")


def test_the_same_steps_give_the_same_bytes(tmp_path: Path, start_rig: Callable[..., Rig]) -> None:
    path = write_rig(tmp_path)
    hashes = []
    for lengths in ([0.1] * 20, [2.0], [0.333, 1.667]):
        run = start_rig(path, seed=5)
        for length in lengths:
            run.step(length)
        hashes.append(run.stop()["devices"]["gnss"]["stream_hash"])
    assert len(set(hashes)) == 1


def test_many_runs_stand_side_by_side(start_rig: Callable[..., Rig]) -> None:
    runs = [start_rig("excavator_can", isolated=True) for _ in range(20)]
    assert len({run.replaced["buses.can.path"] for run in runs}) == len(runs)
    with ThreadPoolExecutor(4) as pool:
        assert list(pool.map(lambda run: run.run_until(0.1), runs)) == [0.1] * len(runs)


def test_a_hand_digs_and_the_recording_verifies(rig: Rig, tmp_path: Path) -> None:
    rig.run_until(0.5)
    before = rig.read().machine["boom"]
    with rig.record(tmp_path / "take"):
        rig.set(boom=0.8, swing=-0.2)
        rig.step(1.0)
        rig.release("boom")
        rig.step(0.5)
        with pytest.raises(Refused, match="on its way"):
            rig.start_recording(tmp_path / "another")
    assert rig.read().machine["boom"] > before + 1.0
    with pytest.raises(Refused, match="-1 .. 1"):
        rig.set(boom=2.0)
    verify = [find_program(), "replay", str(tmp_path / "take"), "--verify"]
    assert subprocess.run(verify, timeout=120).returncode == 0


def test_a_device_is_told_another_rate(rig: Rig, tmp_path: Path) -> None:
    rig.run_until(1.0)
    assert "rate" in rig.read().devices["gnss"].settable
    with rig.record(tmp_path / "take"):
        assert rig.set("gnss", rate="5 Hz", nmea_sentences=["RMC"]) == pytest.approx(1.0)
        before = rig.read().devices["gnss"].frames
        rig.step(2.0)
        fast = rig.read().devices["gnss"].frames - before
        rig.set("gnss", rate="1 Hz")
        before = rig.read().devices["gnss"].frames
        rig.step(2.0)
    assert fast > 3 * (rig.read().devices["gnss"].frames - before)
    with pytest.raises(Refused, match="cannot be changed while it runs"):
        rig.set("gnss", mount={"link": "boom"})
    with pytest.raises(Refused, match="Hz"):
        rig.set("gnss", rate="1 kHz")
    verify = [find_program(), "replay", str(tmp_path / "take"), "--verify"]
    assert subprocess.run(verify, timeout=120).returncode == 0


def test_events_tell_what_happened_and_when(rig: Rig) -> None:
    rig.run_until(9.0)
    events = rig.events()
    assert [(event.kind, event.time) for event in events] == [
        ("fault_begun", pytest.approx(6.0)),
        ("fault_ended", pytest.approx(8.0)),
    ]
    assert rig.events(since=events.last) == []
    rig.set(boom=0.1)
    assert [event.where for event in rig.events(since=events.last)] == ["boom"]


def test_a_slow_reader_loses_nothing_when_time_waits_for_it(
    tmp_path: Path, start_rig: Callable[..., Rig]
) -> None:
    run = start_rig(write_rig(tmp_path), clock="drained")
    line = os.open(tmp_path / "gnss", os.O_RDONLY | os.O_NOCTTY)
    taken = 0
    with ThreadPoolExecutor(1) as pool:
        arrived = pool.submit(run.run_until, 60.0)
        while not arrived.done() or select.select([line], [], [], 0.2)[0]:
            if select.select([line], [], [], 0.2)[0]:
                taken += len(os.read(line, 100))
                time.sleep(0.0002)
        assert arrived.result() == pytest.approx(60.0)
    os.close(line)
    report = run.stop()
    assert report["devices"]["gnss"]["dropped"] == 0
    assert report["patience_expiries"] == 0
    assert taken == report["devices"]["gnss"]["bytes"]
