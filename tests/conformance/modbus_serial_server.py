"""pymodbus' serial server, unit 1, at one end of a null modem.

    modbus_serial_server.py LINK [DEFECT]

With one of the defects that are named below its event log is wrong in that, or is right in what
pymodbus does not count.
"""

import sys

from null_modem import null_modem
from pymodbus.datastore import ModbusSequentialDataBlock as Block
from pymodbus.datastore import ModbusServerContext, ModbusSlaveContext
from pymodbus.framer.rtu_framer import ModbusRtuFramer
from pymodbus.other_message import GetCommEventLogRequest, GetCommEventLogResponse
from pymodbus.server import StartSerialServer

LINK = sys.argv[1]
DEFECT = sys.argv[2] if len(sys.argv) > 2 else ""
LOGS = {
    "too_many_events": {"events": [0x40] * 65},
    "an_event_of_no_type": {"events": [0x40, 0x20]},
    "counts_other_events": {"event_count": 7},
    "counts_its_message": {"message_count": 1},
}


class Log(GetCommEventLogRequest):
    def execute(self, context=None):
        return GetCommEventLogResponse(**LOGS[DEFECT])


tables = ModbusSlaveContext(
    di=Block(0, [1] * 101),
    co=Block(0, [0] * 101),
    hr=Block(0, list(range(101))),
    ir=Block(0, list(range(101))),
    zero_mode=True,
)
StartSerialServer(
    context=ModbusServerContext(slaves={1: tables}, single=False),
    framer=ModbusRtuFramer,
    port=null_modem(LINK),
    baudrate=19200,
    custom_functions=[Log] if DEFECT else [],
)
