"""pytest fixtures.

    def test_boom_rises(start_rig):
        rig = start_rig("excavator_pit", seed=3)
        rig.run_until(1.0)

Each rig has a folder of its own below the test's `tmp_path`, with its log and its report, which
pytest keeps after a failure; every rig is ended with its test.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from rigwire.rig import Rig


@pytest.fixture
def start_rig(tmp_path: Path) -> Iterator[Callable[..., Rig]]:
    """Starts rigs, with the arguments of `Rig`."""
    rigs: list[Rig] = []

    def start(rig: str | Path, **keys: Any) -> Rig:
        folder = tmp_path / f"rig{len(rigs)}"
        folder.mkdir()
        rigs.append(Rig(rig, folder=folder, **keys))
        return rigs[-1]

    yield start
    for rig in rigs:
        rig.close()
