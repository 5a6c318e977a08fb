#!/usr/bin/env python3
"""Reading STEP files to the model, and to the checked model, side by side with Open CASCADE, in one run.

    python3 benches/peer/read.py BINARY ROUNDS FILE.step...

Needs the package `cadquery-ocp`; BINARY is a release build of `resurf`. Each round runs both programs on the same
file, one after the other, each in a process of its own and on one core. Printed are the least processor times
and the greatest memory. Open CASCADE's figures are `ReadFile` and `TransferRoots` alone, without the start of
Python and without a check; resurf's are whole processes: `inspect --json` (index, model, counts, extents, output)
and `check` (all own checks besides).
"""

import json
import os
import subprocess
import sys

PEER = """
import resource, sys, time, json
from OCP.STEPControl import STEPControl_Reader
from OCP.Message import Message
Message.DefaultMessenger_s().ChangePrinters().Clear()
reader = STEPControl_Reader()
start = time.process_time()
reader.ReadFile(sys.argv[1])
reader.TransferRoots()
print(json.dumps([time.process_time() - start, resource.getrusage(resource.RUSAGE_SELF).ru_maxrss]))
"""


def one_core():
    os.sched_setaffinity(0, {max(os.sched_getaffinity(0))})


def run_peer(part):
    command = [sys.executable, "-c", PEER, part]
    out = subprocess.run(command, capture_output=True, preexec_fn=one_core).stdout
    return json.loads(out.splitlines()[-1]) if out else None


def run_resurf(command):
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, preexec_fn=one_core)
    _, status, usage = os.wait4(process.pid, 0)
    if os.WIFSIGNALED(status):
        sys.exit(f"{command} ended by signal {os.WTERMSIG(status)}")
    return usage.ru_utime + usage.ru_stime, usage.ru_maxrss


def least(rounds):
    return min(seconds for seconds, _ in rounds), max(memory for _, memory in rounds)


def main():
    binary, rounds, parts = sys.argv[1], int(sys.argv[2]), sys.argv[3:]
    print(f"least processor time of {rounds} rounds, greatest memory in sizes of the file")
    print(f"{'':40} {'MB':>6} {'inspect':>16} {'check':>16} {'Open CASCADE':>16}  ratio  checked")
    sums = [0.0] * 3
    for part in parts:
        size = os.path.getsize(part)
        runs = [[], [], []]
        for _ in range(rounds):
            runs[0].append(run_resurf([binary, "inspect", "--json", part]))
            runs[1].append(run_resurf([binary, "check", part]))
            runs[2].append(run_peer(part))
        if None in runs[2]:
            print(f"{os.path.basename(part)[:40]:40} left out: Open CASCADE does not come to an end")
            continue
        figures = [least(run) for run in runs]
        times = [seconds for seconds, _ in figures]
        shown = " ".join(f"{seconds:7.3f} s {memory * 1024 / size:5.1f} x" for seconds, memory in figures)
        print(f"{os.path.basename(part)[:40]:40} {size / 1e6:6.2f} {shown} "
              f"{times[2] / max(times[0], 1e-3):6.1f} {times[2] / max(times[1], 1e-3):8.1f}")
        sys.stdout.flush()
        sums = [total + seconds for total, seconds in zip(sums, times)]
    print(f"all files: {sums[0]:.2f} s, {sums[1]:.2f} s checked, Open CASCADE {sums[2]:.2f} s: "
          f"ratios {sums[2] / sums[0]:.1f} and {sums[2] / sums[1]:.1f}")


if __name__ == "__main__":
    main()
