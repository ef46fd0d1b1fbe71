"""Runs every command of README.md, CONTRIBUTING.md and docs/ as it is written there.

    document_commands.py SOURCE_DIR BINARY_DIR SCRATCH_DIR run GROUP
    document_commands.py SOURCE_DIR BINARY_DIR SCRATCH_DIR table GROUP...

A group is what runs beside the commands: a rig, "gpsd", or "alone". The second form looks whether
COMMANDS and these groups are complete, and runs nothing. Commands are the lines of ```sh blocks, the lines of indented blocks that begin with a program, and
the code in the last column of README's tables that does. COMMANDS says how each is judged. A command
without a row, and a row without a command, are failures: what is not run is written down here.

To be run in a network and a mount namespace of its own: wires and ports are those of the documents.
"""
import json
import os
import pathlib
import re
import select
import shutil
import signal
import socket
import subprocess
import sys
import time

source, binaries, scratch = (pathlib.Path(argument) for argument in sys.argv[1:4])
PATIENCE_S = 250  # for what hangs
AT_LEAST_S = 2  # that a program which goes on is looked at
SETTLED_S = 5  # of the rig's own time: receivers boot for two seconds, and their first fixes wander

PROGRAMS = (r"(build/|scripts/|\./(demo|check)\b|(sudo|rigwire|dig_cycle|path_follow|roll_lane|gpsd|cgps|"
            r"gpspipe|ubxtool|candump|cansend|canbusload|ip|slcand|socketcand|mbpoll|tshark|curl|nc|"
            r"j1939acd|testj1939|j1939cat|usbip|evtest|modprobe|cp|while|python3|ros2|arv-[a-z-]+0\.8|"
            r"gst-launch-1\.0|str2str)\s)")

KERNEL_CAN = "needs a kernel with CAN; tests/kernel runs its tools"
ROOT = "needs root on the whole machine"
BUILDS = "installs packages or builds; this test is a part of it"
LONG = "takes minutes; tests/bench runs each suite"
FIGURES = "draws the figures of a benchmark that is not run here"

# (command as a regular expression, how it is judged, what runs beside it, what it must print)
#   "ends"   by itself, with exit code 0
#   "goes on" until it is interrupted
#   else     why it is not run
# Beside: a rig by name, and a field program that has its lines open.
# It goes on where a busy host kept the lidar silent for half a second.
PIT = ("excavator_pit", "dig_cycle --wait")
UNIMOG = ("unimog_forest", "path_follow --path configs/paths/forest_track.csv --antenna 3.2,0")
GATOR = ("gator_campus", "path_follow --gnss /tmp/rigwire/starfire --gnss-baud 19200 "
         "--path configs/paths/campus.csv --antenna 0.4,0 --gear 2")
COMMANDS = [
    (r"\./(demo|check)\b.*", BUILDS, None, None),
    (r"scripts/build\.sh .*", BUILDS, None, None),
    (r"cmake --install build .*", "tests/install does so, to a folder of its own", None, None),
    # Verbs.
    (r"cp configs/rigs/excavator_pit\.yaml my_rig\.yaml", "ends", None, None),
    (r"cp ~/\.local/share/rigwire/\S+ my_rig\.yaml", "needs an installed program; tests/install makes one in a folder of its own", None, None),
    (r"build/rigwire check my_rig\.yaml --print", "ends", None, "devices:"),
    (r"rigwire check my_rig\.yaml", "ends", None, None),
    (r"build/rigwire run my_rig\.yaml --(duration 1min --report report\.json|clock free --duration 10min)",
     "goes on", None, None),
    (r"build/rigwire describe gnss", "ends", None, "UBX"),
    (r"build/rigwire doctor", "ends", None, None),
    (r"(build/)?rigwire schema( machine)? > \S+", "ends", None, None),
    (r"rigwire describe --dbc unimog_forest > unimog\.dbc", "ends", None, None),
    (r"rigwire describe --dbc-node configs/can/slope_sensor\.yaml", "ends", None, "inertial.pitch"),
    (r"rigwire describe --valve-map configs/valves/my_valve\.yaml", "ends", None, "Holding registers"),
    (r"(build/)?rigwire picture unimog_vision .*", "ends", None, None),
    (r"rigwire conform modbus-tcp --list", "ends", None, "modbus/6.3/1"),
    (r"rigwire conform (?!modbus-tcp --list$).*",
     "needs a device or a quiet host; conform_*_test.cpp have wires of their own", None, None),
    # Recordings; the run's is the first of them.
    (r"rigwire run excavator_pit --clock free --duration 20s --record \S+", "ends", None, None),
    (r"rigwire record (info|cut) .*", "ends", None, "/truth"),
    (r"rigwire record export .*", "ends", None, "rows of truth"),
    (r"tshark -r /tmp/rigwire/dig/all\.pcapng .*", "ends", None, "J1939"),
    (r"tshark -i rigwire-dig-can", "extcap_test.cpp runs it beside a rig", None, None),
    (r"gpsdecode < /tmp/rigwire/dig/\S+", "ends", None, "TPV"),
    (r"rigwire replay /tmp/rigwire/dig --verify", "ends", None, "equal"),
    (r"rigwire run excavator_pit --set machine\.motion\.file=\S+ --clock free --duration 4s", "ends", None,
     None),
    (r"rigwire replay /tmp/rigwire/dig --dashboard", "goes on", None, None),
    (r"rigwire replay /tmp/rigwire/dig --dashboard --control .*", "goes on", None, None),
    (r"rigwire replay /tmp/rigwire/dig --from 1s --to 4s", "ends", None, None),
    (r"rigwire run excavator_pit --isolated \S+", "goes on", None, None),
    (r"rigwire run excavator_pit --dashboard", "goes on", None, None),
    (r"rigwire run excavator_pit --clock drained .*", "an hour; control_process_test.cpp waits for clients",
     None, None),
    # Campaigns, in this order.
    (r"rigwire campaign expand forest_drive -o \S+", "ends", None, "200 runs"),
    (r"rigwire campaign run forest_drive --index 1 -o \S+", "ends", None, "run 1: (passed|failed)"),
    (r"rigwire campaign collect \S+", "ends", None, "199 missing"),
    (r"rigwire campaign report .*", "ends", None, "199 missing"),
    (r"configs/campaigns/engines/slurm\.sh .*", "campaign_engines_test.cpp does so with a cluster of its own",
     None, None),
    (r"(cpack|scripts/try-(package|image)\.sh) .*", "tests/install does so", None, None),
    # Rigs and field programs.
    (r"build/find_rocks --camera 127\.0\.0\.3 .*", "goes on", ("unimog_vision",), None),
    (r"build/find_rocks --mount .*", "goes on", ("excavator_vision",), None),
    (r"build/rigwire run configs/rigs/unimog_forest\.yaml", "goes on", None, None),
    (r"build/dig_cycle( .*)?", "goes on", ("excavator_pit",), None),
    (r"build/path_follow --path .*", "goes on", ("unimog_forest",), None),
    (r"build/path_follow --gnss .*", "goes on", ("gator_campus",), None),
    (r"build/roll_lane .*", "goes on", ("roller_road",), None),
    # What others read of them, while the field program has its own lines open.
    (r"gpsd -N -n -S 2950 /tmp/rigwire/gnss\.1", "goes on", PIT, None),
    (r"cgps localhost:2950", "goes on", ("gpsd",), None),
    (r"gpsd -N -n -s 19200 -S 2950 /tmp/rigwire/starfire\.1", "goes on", GATOR, None),
    (r"ubxtool -f /tmp/rigwire/gnss_left .*", "ends", ("gator_heading",), "HPG"),
    (r"str2str -in ntrip://rover:secret@\S+ -out serial://../tmp/rigwire/gnss:115200", "goes on",
     ("gator_rtk",), r"\[CC"),
    (r"tshark -i lo -f 'udp port 2368'", "goes on", PIT, "UDP"),
    (r"mbpoll -m tcp -p 1502 -0 -t 3 -r 0 -c 22 127\.0\.0\.1", "goes on", PIT, r"\[0\]:"),
    (r"mbpoll -m tcp .* -1 .*", "ends", ("excavator_pit",), None),
    (r"mbpoll -m rtu .*", "ends", ("modbus_rtu",), r"\[0\]:"),
    (r"dig_cycle --modbus rtu:.*", "goes on", ("modbus_rtu",), None),
    (r"curl http://127\.0\.0\.1:8081/.*", "ends", ("lidar_park",), None),
    (r"rigwire run excavator_vision( --camera-truth .*)?", "goes on", None, None),
    (r"arv-tool-0\.8", "ends", ("excavator_vision",), r"EX-02"),
    (r"arv-tool-0\.8 -a .*", "ends", ("excavator_vision",), "ExposureTime = 2000"),
    (r"arv-camera-test-0\.8 .*", "ends", ("excavator_vision",), "n_completed_buffers +="),
    (r"gst-launch-1\.0 .*", "gige_camera_programs_test.cpp runs it as an ordinary user", None, None),
    (r"python3 -m can\.logger -i slcan .*", "goes on", PIT, "ID: "),
    (r"python3 -m can\.logger -i socketcand .*", "goes on", ("socketcand",), "ID: "),
    # What cannot be run here.
    (r"(candump|cansend|canbusload|j1939acd|testj1939|j1939cat|ip .*can0|while sleep .*cansend"
     r"|tshark -i can0)\b.*", KERNEL_CAN, None, None),
    (r"sudo (slcand|modprobe|usbip|ip) .*", ROOT, None, None),
    (r"sudo scripts/lidar-namespace\.sh .*", ROOT, None, None),
    (r"(usbip|modprobe|evtest)( .*)?", ROOT, None, None),
    (r"scripts/lidar-namespace\.sh run bash|build/rigwire run my_rig\.yaml &|ros2 .*"
     r"|curl http://192\.168\.1\.201/.*", "lidar_namespace_test.cpp runs this recipe", None, None),
    (r"(build/)?rigwire (ctl unix:/tmp/control .*|run (excavator_pit|my_rig\.yaml) --clock step --control .*)",
     "control_process_test.cpp governs a run", None, None),
    (r"build/rigwire bench.*", LONG, None, None),
    (r"build/(bench/rigwire_benchmarks|oracle_bench)", LONG, None, None),
    (r"scripts/(plot-|lidar-peer|picture-dashboard).*", FIGURES, None, None),
    (r"build/rigwire run excavator_pit --duration 3s & scripts/picture-lidar\.py .*", FIGURES, None,
     None),
    (r"(apt-get|cmake(?! --install)|ninja|-DLASTools_DIR).*", "builds a program that others wrote", None, None),
]


def commands_of(document):
    """(line number, command) of one document."""
    fence = None
    for number, line in enumerate(document.read_text().splitlines(), 1):
        text = line.strip()
        if text.startswith("```"):
            fence = None if fence is not None else text[3:]
            continue
        if fence is not None:
            candidates = [text] if fence in ("sh", "console") else []
        elif document.name == "README.md" and line.startswith("|"):
            candidates = [code for code in re.findall(r"`([^`]*)`", line.rstrip("|").split("|")[-1])
                          if re.match(PROGRAMS, code + " ")]
        else:
            candidates = [text] if re.match("    " + PROGRAMS, line + " ") else []
        for candidate in candidates:
            command = re.sub(r"\s+#.*", "", candidate)
            if command and not command.startswith("#"):
                yield number, command


class Running:
    """A program of its own process group; what it prints is in a file."""

    def __init__(self, command, name, pass_fds=()):
        self.command = command
        self.log = scratch / (re.sub(r"\W+", "_", name)[:60] + ".log")
        with open(self.log, "wb") as log:
            self.process = subprocess.Popen(["bash", "-c", "exec " + command], cwd=scratch,
                                            stdin=subprocess.DEVNULL, stdout=log,
                                            stderr=subprocess.STDOUT, start_new_session=True,
                                            pass_fds=pass_fds)

    def output(self):
        return self.log.read_text(errors="replace")

    def ended(self, patience):
        try:
            self.process.wait(patience)
        except subprocess.TimeoutExpired:
            return False
        return True

    def end(self):
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGKILL):
            if self.process.poll() is None:
                os.killpg(self.process.pid, number)
                self.ended(10)


# Those that no file of configs/ is. The line takes clients of any speed: the documents' differ.
RIGS = {"socketcand": "excavator_pit --set buses.can.socketcand.port=29536",
        "modbus_rtu": "modbus_rtu.yaml"}
MODBUS_RTU = """
machine: {include: configs/machines/excavator_ref18t.yaml}
scene: {include: configs/scenes/open_pit.yaml}
modbus: {cab: {wire: rtu, path: /tmp/rigwire/modbus, baud: 115200, parity: even, check_baud: none}}
devices: {valves: {type: valve-driver, line: cab, unit: 3}}
"""


def neighbours(beside):
    """Starts a rig and its field program, or a gpsd and all that it needs; back when they are open."""
    if beside == ("gpsd",):
        running = neighbours(PIT) + [Running("gpsd -N -n -S 2950 /tmp/rigwire/gnss.1", "gpsd")]
        wait_until_open("localhost", 2950)
        return running
    is_ready, ready = os.pipe()
    rig = RIGS.get(beside[0], beside[0])
    control = f"unix:{scratch}/control"
    running = [Running(f"rigwire run {rig} --status none --control {control} --ready-fd {ready}",
                       beside[0], (ready,))]
    os.close(ready)
    select.select([is_ready], [], [], PATIENCE_S)
    os.close(is_ready)
    wait_until_settled(control)
    running += [Running(program, program.split()[0]) for program in beside[1:]]
    return running


def wait_until_settled(control):
    end = time.monotonic() + PATIENCE_S
    while time.monotonic() < end:
        state = subprocess.run([binaries / "rigwire", "ctl", control, "state"], capture_output=True,
                               check=False)
        if state.returncode == 0 and json.loads(state.stdout)["time_ns"] >= SETTLED_S * 1e9:
            return
        time.sleep(0.1)


def wait_until_open(host, port):
    end = time.monotonic() + PATIENCE_S
    while time.monotonic() < end:
        try:
            socket.create_connection((host, port), 1).close()
            return
        except OSError:
            time.sleep(0.1)


def judge(command, how, expected):
    """What is wrong with it, or nothing."""
    run = f"script -qec '{command}' /dev/null" if command.startswith("cgps") else command
    program = Running(run if how == "goes on" else f"timeout {PATIENCE_S} bash -c {quoted(run)}", command)
    if how == "ends":
        if not program.ended(PATIENCE_S) or program.process.returncode != 0:
            return f"exit code {program.process.returncode}\n{program.output()}"
    else:
        began = time.monotonic()
        while (time.monotonic() < began + PATIENCE_S and not program.ended(0.2) and
               not (time.monotonic() > began + AT_LEAST_S and
                    (expected is None or re.search(expected, program.output())))):
            pass
        if program.process.poll() is not None:
            return f"ended with exit code {program.process.returncode}\n{program.output()}"
        program.end()
    if expected is not None and not re.search(expected, program.output()):
        return f"printed nothing like {expected}\n{program.output()}"
    return None


def quoted(text):
    return "'" + text.replace("'", "'\\''") + "'"


def main():
    scratch.mkdir(exist_ok=True)
    (scratch / "build").symlink_to(binaries)
    (scratch / "scripts").symlink_to(source / "scripts")
    shutil.copytree(source / "configs", scratch / "configs")
    shutil.copy(source / "configs/valves/ehc_amplifier.yaml",
                scratch / "configs/valves/my_valve.yaml")
    (scratch / "modbus_rtu.yaml").write_text(MODBUS_RTU)
    os.environ["RIGWIRE_CONFIGS"] = str(scratch / "configs")
    os.environ["PATH"] = f"{binaries}:/usr/bin:/usr/sbin:{os.environ['PATH']}"
    os.environ["TERM"] = "xterm"

    task, *groups = sys.argv[4:]
    problems, to_run = read_documents()
    if task == "table":
        if set(groups) != set(to_run):
            problems.append(f"groups {sorted(to_run)}, not {sorted(groups)}")
        print("\n".join(problems))
        return 1 if problems else 0
    return run(to_run[groups[0]])


def read_documents():
    """What is wrong with the table, and the commands by group: each is run once, wherever it is
    written."""
    problems, used, to_run = [], set(), {}
    for document in [source / "README.md", source / "CONTRIBUTING.md",
                     *sorted((source / "docs").rglob("*.md"))]:
        for number, command in commands_of(document):
            where = f"{document.relative_to(source)}:{number}: {command}"
            rows = [i for i, row in enumerate(COMMANDS) if re.fullmatch(row[0], command)]
            used.update(rows)
            if len(rows) != 1:
                problems.append(f"{where}\n  {len(rows)} rows of COMMANDS say how to judge it")
                continue
            _, how, beside, expected = COMMANDS[rows[0]]
            if how in ("ends", "goes on"):
                group = to_run.setdefault(beside[0] if beside else "alone", {})
                group.setdefault(command, (where, how, beside, expected))
    problems += [f"COMMANDS: no document has {row[0]}" for i, row in enumerate(COMMANDS)
                 if i not in used]
    return problems, to_run


def run(commands):
    problems, running, present = [], [], None
    for command, (where, how, beside, expected) in sorted(
            commands.items(), key=lambda item: str(item[1][2])):
        if beside != present:
            end_all(running, problems)
            running, present = neighbours(beside) if beside else [], beside
        began = time.monotonic()
        problem = judge(command, how, expected)
        print(f"{'ok  ' if problem is None else 'FAIL'} {time.monotonic() - began:5.1f} s  {where}",
              flush=True)
        if problem is not None:
            problems.append(f"{where}\n  {problem}")
    end_all(running, problems)
    print("\n".join(problems))
    return 1 if problems else 0


def end_all(running, problems):
    for program in reversed(running):
        if program.process.poll() is not None:
            problems.append(f"beside: {program.command} ended\n{program.output()}")
        program.end()


sys.exit(main())
