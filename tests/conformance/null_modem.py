"""A serial line for programs that open one by its path, with the suite at its other end."""

import os
import termios
import threading
import tty


def null_modem(link):
    """Two pseudo-terminals, each with what is written to the other: `link` is one, the other's
    path is returned. What does not fit is lost, as on a line that nobody reads."""
    ends = [os.openpty() for _ in range(2)]
    for master, slave in ends:
        tty.setraw(slave, termios.TCSANOW)
        os.set_blocking(master, False)

    def carry(source, sink):
        os.set_blocking(source, True)
        while True:
            block = os.read(source, 4096)
            try:
                os.write(sink, block)
            except BlockingIOError:
                pass

    masters = [master for master, _ in ends]
    for source, sink in (masters, reversed(masters)):
        threading.Thread(target=carry, args=(source, os.dup(sink)), daemon=True).start()
    os.symlink(os.ttyname(ends[0][1]), link)
    return os.ttyname(ends[1][1])
