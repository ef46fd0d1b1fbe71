"""Runs Rigwire rigs from Python: one process per rig, governed over its control socket.

    from rigwire import Rig

    with Rig("excavator_pit") as rig:              # time stands at 0, every wire is open
        rig.run_until(2.0)
        rig.wait("boom", above=40.0, limit=20.0)   # degrees, as rig.read() has them
        print(rig.read().devices["gnss"].last_request)

Needs nothing but the standard library and the program `rigwire`, which it looks for in the variable
RIGWIRE, then in the path. Simulated times are seconds; `time_ns` is exact.
"""

from rigwire.rig import (
    BusNode,
    BusStatus,
    DeviceStatus,
    Event,
    Events,
    Fault,
    FaultWindow,
    Machine,
    Quantity,
    Reading,
    Refused,
    Request,
    Rig,
    RigwireError,
    RunEnded,
    State,
    UnknownQuantity,
)

__all__ = [
    "BusNode",
    "BusStatus",
    "DeviceStatus",
    "Event",
    "Events",
    "Fault",
    "FaultWindow",
    "Machine",
    "Quantity",
    "Reading",
    "Refused",
    "Request",
    "Rig",
    "RigwireError",
    "RunEnded",
    "State",
    "UnknownQuantity",
]
