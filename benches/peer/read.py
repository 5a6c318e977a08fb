#!/usr/bin/env python3
"""Reading a STEP file to the model, side by side with Open CASCADE, in one run.

    python3 benches/peer/read.py FILE.step [ROUNDS]

Needs the package `cadquery-ocp` and a release build of resurf. Each round runs both programs on the same
file, one after the other, each in a process of its own and on one core. Printed are the least CPU times
and the greatest memory. Open CASCADE's figures are `ReadFile` and `TransferRoots` alone, without the start of
Python; resurf's are the whole process (`inspect --json`: index, model, counts, extents, output).
"""

import json
import os
import subprocess
import sys
from pathlib import Path

PEER = """
import resource, sys, time, json
from OCP.STEPControl import STEPControl_Reader
from OCP.Message import Message
Message.DefaultMessenger_s().ChangePrinters().Clear()
reader = STEPControl_Reader()
start = time.process_time()
reader.ReadFile(sys.argv[1])
read = time.process_time()
reader.TransferRoots()
print(json.dumps([read - start, time.process_time() - start, resource.getrusage(resource.RUSAGE_SELF).ru_maxrss]))
"""


def one_core():
    os.sched_setaffinity(0, {min(os.sched_getaffinity(0))})


def run_peer(part):
    command = [sys.executable, "-c", PEER, part]
    out = subprocess.run(command, check=True, capture_output=True, preexec_fn=one_core).stdout
    return json.loads(out.splitlines()[-1])


def run_resurf(binary, part):
    process = subprocess.Popen([binary, "inspect", "--json", part], stdout=subprocess.DEVNULL, preexec_fn=one_core)
    _, status, usage = os.wait4(process.pid, 0)
    if status != 0:
        sys.exit(f"resurf failed on {part}: status {status}")
    return usage.ru_utime + usage.ru_stime, usage.ru_maxrss


def main():
    part = sys.argv[1]
    rounds = int(sys.argv[2]) if len(sys.argv) > 2 else 3
    binary = Path(__file__).resolve().parents[2] / "target" / "release" / "resurf"
    size = os.path.getsize(part)
    peer, ours = [], []
    for _ in range(rounds):
        ours.append(run_resurf(str(binary), part))
        peer.append(run_peer(part))
    read, total = min(p[0] for p in peer), min(p[1] for p in peer)
    mine = min(o[0] for o in ours)
    rate = lambda seconds: f"{seconds:8.3f} s  {size / seconds / 1e6:8.1f} MB/s"
    memory = lambda kilobytes: f"{kilobytes * 1024 / size:5.2f} x file"
    print(f"{part}: {size / 1e6:.1f} MB, {rounds} rounds, least CPU time, greatest memory")
    print(f"resurf inspect          {rate(mine)}  {memory(max(o[1] for o in ours))}")
    print(f"Open CASCADE ReadFile   {rate(read)}")
    print(f"  + TransferRoots       {rate(total)}  {memory(max(p[2] for p in peer))}")
    print(f"ratio {total / mine:.1f}")


if __name__ == "__main__":
    main()
