#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Measures the time per step of a run shared by several processes against what info --processes predicts.

    scripts/network-trial.py PROGRAM -o OUT.csv [--quick]     as root, with iproute2 and Open MPI 4.1

By shared memory with 1, 2, 4 and 8 processes; and with 2 and 4 between network namespaces, each taken for a
machine. The namespaces are joined by a switch of their own (network-switch.cpp), since not every kernel has
netem: each has a tap device, and the switch takes every Ethernet frame from one and puts it into another
after the latency. The bandwidth is limited by tc tbf on the devices. Nothing of it is seen outside; all is
removed at the end.

What a run takes is the median over some runs of run.json's wall_s over its steps; the prediction is that of
info in the same minutes, as many at once as processes compute at once, with what bench --network tells of
the same network. Both go before other work on the machine (nice -20). All processes share the processors of
this machine, with the switch.
"""

import argparse
import csv
import fcntl
import json
import os
import re
import shutil
import signal
import statistics
import struct
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any, NamedTuple, Self

ROOT = Path(__file__).resolve().parent.parent
MPI = {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}
TIMEOUT_S = 120
PROCESSORS = os.cpu_count() or 1

# A rupture under uniform tractions, so that statics take no part: rigid_flat_a.toml on wider plates.
CASE = ROOT / "cases" / "reference" / "rigid_flat_a.toml"
CASES = {
    # 2401 x 241 nodes, the plain scheme: a process has much to compute between two exchanges.
    "plain": [
        "plate.width_m=1.2",
        "plate.height_m=0.12",
        "time.interface_substeps=1",
        "time.interface_rows=1",
    ],
    # 2401 x 121 nodes with 18 sub-steps: the halo is wide, exchanges are frequent.
    "sub-cycled": ["plate.width_m=1.2", "plate.height_m=0.06", "time.interface_substeps=18"],
}
COMMON = [
    "plate.element_size_m=0.5e-3",
    "nucleation.x_m=0.6",
    "time.quiet_s=inf",
    "output.history_interval_s=0.5e-6",
    "output.energy_interval_s=20e-6",
]


def sets(case: str, end_s: float) -> list[str]:
    keys = [*COMMON, *CASES[case], f"time.end_s={end_s}"]
    return [word for key in keys for word in ("--set", key)]


# --- the switch


def make_tap(name: str) -> int:
    tap = os.open("/dev/net/tun", os.O_RDWR | os.O_NONBLOCK)
    TUNSETIFF, IFF_TAP, IFF_NO_PI = 0x400454CA, 0x0002, 0x1000
    fcntl.ioctl(tap, TUNSETIFF, struct.pack("16sH22x", name.encode(), IFF_TAP | IFF_NO_PI))
    return tap


def ip(*words: str) -> None:
    subprocess.run(["ip", *words], check=True)


class Machines:
    """Network namespaces of this process's, with a switch between them while it is used as a context."""

    def __init__(self, count: int, latency_s: float, bits_per_s: int, work: Path):
        self.names = [f"slipfront{os.getpid()}-{k}" for k in range(count)]
        self.addresses = [f"10.77.0.{k + 1}" for k in range(count)]
        self.latency_s, self.bits_per_s, self.work = latency_s, bits_per_s, work
        self.switch: subprocess.Popen[bytes] | None = None
        self.taps: list[int] = []

    def __enter__(self) -> Self:
        try:
            for k, name in enumerate(self.names):
                self.add(k, name)
        except BaseException:
            self.__exit__()
            raise
        program = self.work / "network-switch"
        if not program.exists():
            source = ROOT / "scripts" / "network-switch.cpp"
            subprocess.run(["g++", "-std=c++20", "-O2", "-o", program, source], check=True)
        command = [str(word) for word in (program, self.latency_s, *self.taps)]
        self.switch = subprocess.Popen(command, pass_fds=self.taps)
        return self

    def add(self, k: int, name: str) -> None:
        tap = f"sf{os.getpid() % 100000}t{k}"
        ip("netns", "add", name)
        self.taps.append(make_tap(tap))
        ip("link", "set", tap, "netns", name)
        ip("-n", name, "link", "set", "lo", "up")
        ip("-n", name, "link", "set", tap, "address", f"02:00:00:00:00:{k:02x}", "mtu", "9000")
        ip("-n", name, "link", "set", tap, "txqueuelen", "10000", "up")
        ip("-n", name, "addr", "add", f"{self.addresses[k]}/24", "dev", tap)
        if self.bits_per_s:
            shape = ["rate", str(self.bits_per_s), "burst", "20000", "latency", "400ms"]
            subprocess.run(["tc", "-n", name, "qdisc", "add", "dev", tap, "root", "tbf", *shape], check=True)

    def __exit__(self, *_: object) -> None:
        if self.switch:
            self.switch.kill()
            self.switch.wait()
        for name in self.names:
            subprocess.run(["ip", "netns", "delete", name], stderr=subprocess.DEVNULL)
        for tap in self.taps:
            os.close(tap)

    def agent(self) -> Path:
        """What mpirun starts its daemons with instead of ssh: ADDRESS COMMAND..."""
        script = self.work / "agent"
        lines = ["#!/bin/sh", 'address=$1; shift; case "$address" in']
        for name, address in zip(self.names, self.addresses, strict=True):
            lines.append(f'  {address}) exec ip netns exec {name} unshare -u sh -c "hostname {name}; $*" ;;')
        script.write_text("\n".join([*lines, "esac", "exit 1", ""]))
        script.chmod(0o755)
        return script

    def mpirun(self, processes: int) -> list[str]:
        hosts = ",".join(f"{address}:1" for address in self.addresses[:processes])
        options = {
            "plm_rsh_agent": self.agent(),
            "btl": "tcp,self",
            "btl_tcp_if_include": "10.77.0.0/24",
            "oob_tcp_if_include": "10.77.0.0/24",
        }
        words = [word for name, value in options.items() for word in ("--mca", name, str(value))]
        inside = ["ip", "netns", "exec", self.names[0], "unshare", "-u", "sh", "-c"]
        return [
            *inside,
            f'hostname {self.names[0]}; exec "$@"',
            "sh",
            "mpirun",
            "-n",
            str(processes),
            *words,
            "--host",
            hosts,
        ]


class SharedMemory:
    """This machine as it is."""

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        pass

    def mpirun(self, processes: int) -> list[str]:
        return ["mpirun", "-n", str(processes)]


# --- measurement


def begin(command: list[Any]) -> subprocess.Popen[str]:
    """Before other work on the machine, in a group of its own, so that what it has started ends with it."""
    words = ["nice", "-n", "-20", *map(str, command)]
    pipe, environment = subprocess.PIPE, os.environ | MPI
    return subprocess.Popen(
        words, stdout=pipe, stderr=pipe, text=True, env=environment, start_new_session=True
    )


def end(process: subprocess.Popen[str]) -> str:
    """What it has printed."""
    try:
        out, errors = process.communicate(timeout=TIMEOUT_S)
    except subprocess.TimeoutExpired:
        os.killpg(process.pid, signal.SIGKILL)
        process.wait()
        raise
    if process.returncode != 0:
        raise RuntimeError(f"{process.args!r}\n{errors}")
    return out


def call(command: list[Any]) -> str:
    return end(begin(command))


Network = SharedMemory | Machines


class Link(NamedTuple):
    """As bench --network tells it."""

    latency_s: float
    bandwidth_bytes_per_s: float
    processor_s_per_byte: float


class Trial:
    def __init__(self, program: Path, work: Path, repeats: int):
        self.program, self.work, self.repeats = program, work, repeats

    def together(self, network: Network, processes: int, *words: Any) -> str:
        if processes == 1:
            return call([self.program, *words])
        mpirun = [*network.mpirun(processes), "--oversubscribe", "--bind-to", "none"]
        return call([*mpirun, self.program, *words])

    def link(self, network: Network) -> Link:
        """Between two processes."""
        told = [json.loads(self.together(network, 2, "bench", "--network", "--json")) for _ in range(3)]
        return Link(*(statistics.median(t[key] for t in told) for key in Link._fields))

    def predict(self, case: str, end_s: float, processes: int, link: Link) -> dict[str, float]:
        """Parts of the time and of the division, by name; times in all steps."""
        options: list[Any] = ["--processes", processes, "--processors", min(processes, PROCESSORS)]
        for name, value in link._asdict().items():
            options += ["--" + name.replace("_", "-"), value]
        command = [self.program, "info", CASE, *sets(case, end_s), *options]
        # As many at once as processes compute at once: a processor is slower while the others are busy.
        at_once = [begin(command) for _ in range(min(processes, PROCESSORS))]
        parts: dict[str, list[float]] = {}
        for text in [end(process) for process in at_once]:
            for name, s in re.findall(r"^  time: (.+?) {2,}(\S+) s$", text, re.MULTILINE):
                parts.setdefault(name, []).append(float(s))
        for name in ("statics, leader alone", "start"):
            del parts[name]
        return {name: statistics.mean(values) for name, values in parts.items()}

    def run(self, case: str, end_s: float, network: Network, processes: int) -> dict[str, Any]:
        out = self.work / "run"
        words = [*sets(case, end_s), "--threads", "1", "-o", out, "-q", "--overwrite"]
        self.together(network, processes, "run", CASE, *words)
        return json.loads((out / "run.json").read_text())

    def measure(
        self, case: str, end_s: float, network: Network, name: str, link: Link, processes: int
    ) -> dict[str, Any]:
        predictions, runs = [], []
        for _ in range(self.repeats):
            predictions.append(self.predict(case, end_s, processes, link))
            runs.append(self.run(case, end_s, network, processes))
        steps = runs[0]["steps"]
        us = [1e6 * run["wall_s"] / steps for run in runs]
        measured_us = statistics.median(us)
        part_us = {
            key: 1e6 * statistics.median(p[key] for p in predictions) / steps for key in predictions[0]
        }
        predicted_us = sum(part_us.values())
        # Of the run in the middle.
        cost = runs[us.index(sorted(us)[len(us) // 2])].get("processes")
        waits = ("computing_s", "waiting_in_exchanges_s", "waiting_in_commands_s")
        of_run = {key: [1e6 * s / steps for s in cost[key]] for key in waits} if cost else {}
        return {
            "network": name,
            "case": case,
            "processes": processes,
            "processors": min(processes, PROCESSORS),
            "latency_us": link.latency_s * 1e6,
            "bandwidth_MB_per_s": link.bandwidth_bytes_per_s * 1e-6,
            "processor_ns_per_byte": link.processor_s_per_byte * 1e9,
            "own_columns": max(cost["own_columns"]) if cost else 2401,
            "halo_columns": max(cost["halo_columns"]) if cost else 0,
            "steps_per_exchange": cost["steps_per_exchange"] if cost else 0,
            "steps": steps,
            "runs": len(runs),
            "measured_us_per_step": measured_us,
            "least_us_per_step": min(us),
            "largest_us_per_step": max(us),
            "predicted_us_per_step": predicted_us,
            "deviation_percent": 100 * (predicted_us / measured_us - 1),
            **{f"predicted_{key.split(' ')[0].strip(',')}_us_per_step": us for key, us in part_us.items()},
            "measured_computing_us_per_step": max(of_run["computing_s"]) if cost else measured_us,
            "measured_exchange_us_per_step": statistics.mean(of_run["waiting_in_exchanges_s"]) if cost else 0,
            "measured_commands_us_per_step": max(of_run["waiting_in_commands_s"]) if cost else 0,
            "messages_per_step": cost["messages_per_step"] if cost else 0,
            "bytes_per_step": cost["bytes_per_step"] if cost else 0,
        }


def print_row(row: dict[str, Any]) -> None:
    print(
        f"{row['network']:<22}{row['case']:<12}{row['processes']:>3} on {row['processors']}"
        f"{row['own_columns']:>7} + {row['halo_columns']:<5}{row['steps_per_exchange']:>3}"
        f"{row['measured_us_per_step']:>10.0f}"
        f" ({row['least_us_per_step']:.0f} to {row['largest_us_per_step']:.0f})"
        f"{row['predicted_us_per_step']:>10.0f}{row['deviation_percent']:>+8.0f} %",
        flush=True,
    )


COLUMNS = {
    "network": "network",
    "case": "case",
    "processes": "processes",
    "latency_us": "latency, us",
    "bandwidth_MB_per_s": "MB/s each way",
    "processor_ns_per_byte": "processor, ns/byte",
    "steps_per_exchange": "steps per exchange",
    "measured_us_per_step": "measured, us",
    "least_us_per_step": "from",
    "largest_us_per_step": "to",
    "predicted_us_per_step": "predicted, us",
    "deviation_percent": "deviation, %",
    "measured_computing_us_per_step": "of it computing",
    "measured_exchange_us_per_step": "waiting in exchanges",
    "measured_commands_us_per_step": "in commands",
}


def print_table(rows: list[dict[str, Any]]) -> None:
    """As docs/measured/network.md has it, with more columns."""
    print("| " + " | ".join(COLUMNS.values()) + " |\n|" + "---|" * len(COLUMNS))
    for row in rows:
        cells = [f"{v:.3g}" if isinstance(v := row[key], float) and v < 100 else v for key in COLUMNS]
        print("| " + " | ".join(f"{v:.0f}" if isinstance(v, float) else str(v) for v in cells) + " |")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("program", type=Path)
    parser.add_argument("-o", "--output", type=Path, required=True)
    parser.add_argument("--quick", action="store_true", help="one short run of each")
    options = parser.parse_args()
    if os.geteuid() != 0:
        sys.exit("network-trial: network namespaces are made as root")
    for tool in ("ip", "tc", "mpirun", "unshare"):
        if shutil.which(tool) is None:
            sys.exit(f"network-trial: {tool} is missing")
    end_s, repeats = (2e-5, 1) if options.quick else (4e-4, 3)
    gbit = int(1e9)
    networks: list[tuple[str, float | None, tuple[int, ...]]] = [("shared memory", None, (1, 2, 4, 8))]
    networks += [(f"1 Gbit/s, {ms} ms added", ms * 1e-3, (2, 4)) for ms in (0, 0.1, 1)]
    rows = []
    with tempfile.TemporaryDirectory(prefix="slipfront-network.") as folder:
        trial = Trial(options.program.resolve(), Path(folder), repeats)
        for name, latency_s, numbers in networks:
            for processes in numbers:
                machines: Network = SharedMemory()
                if latency_s is not None:
                    machines = Machines(processes, latency_s, gbit, trial.work)
                with machines as network:
                    link = trial.link(network)
                    for case in CASES:
                        try:
                            rows.append(trial.measure(case, end_s, network, name, link, processes))
                        except subprocess.TimeoutExpired:
                            print(
                                f"{name}, {case}, {processes} processes: no end within {TIMEOUT_S} s",
                                flush=True,
                            )
                            continue
                        print_row(rows[-1])
                        with options.output.open("w", newline="") as file:
                            table = csv.DictWriter(file, rows[0].keys())
                            table.writeheader()
                            for row in rows:
                                table.writerow(
                                    {k: f"{v:.4g}" if isinstance(v, float) else v for k, v in row.items()}
                                )
    print_table(rows)


if __name__ == "__main__":
    main()
