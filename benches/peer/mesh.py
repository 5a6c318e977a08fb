#!/usr/bin/env python3
"""Tessellation of STEP files, side by side with Open CASCADE's BRepMesh, in one run.

    python3 benches/peer/mesh.py BINARY ROUNDS FILE.step...

Needs the package `cadquery-ocp` and the bench `tessellate` (`cargo bench --no-run --bench tessellate` names its BINARY). Each
round runs both programs on the same file, one after the other, each in a process of its own and on one core, with
the same chord (0.1 mm) and angle (20 degrees), Open CASCADE's `InParallel` off. Least processor times; reading
is in neither, but Open CASCADE projects edges onto surfaces when it reads, and resurf when it tessellates: the
last columns have reading alone (bytes to model; `ReadFile` and `TransferRoots`), and both together.
"""

import json
import os
import subprocess
import sys

CHORD = 0.1
ANGLE = 20.0

PEER = """
import json, math, sys, time
from OCP.BRep import BRep_Tool
from OCP.BRepMesh import BRepMesh_IncrementalMesh
from OCP.Message import Message
from OCP.STEPControl import STEPControl_Reader
from OCP.TopAbs import TopAbs_FACE
from OCP.TopExp import TopExp_Explorer
from OCP.TopLoc import TopLoc_Location
from OCP.TopoDS import TopoDS
Message.DefaultMessenger_s().ChangePrinters().Clear()
begin = time.process_time()
reader = STEPControl_Reader()
reader.ReadFile(sys.argv[1])
reader.TransferRoots()
shape = reader.OneShape()
start = time.process_time()
BRepMesh_IncrementalMesh(shape, float(sys.argv[2]), False, math.radians(float(sys.argv[3])), False)
end = time.process_time()
# A face that stands in several places is meshed once.
face_of = getattr(TopoDS, "Face_s", None) or TopoDS.Face
import OCP.collections
faces, triangles = 0, 0
seen = OCP.collections.IndexedMap_TopoDS_Shape_TopTools_ShapeMapHasher()
explorer = TopExp_Explorer(shape, TopAbs_FACE)
while explorer.More():
    place = TopLoc_Location()
    face = face_of(explorer.Current())
    mesh = BRep_Tool.Triangulation_s(face, place)
    explorer.Next()
    known = seen.Extent()
    seen.Add(face.Located(TopLoc_Location()))
    if mesh is not None and seen.Extent() > known:
        faces, triangles = faces + 1, triangles + mesh.NbTriangles()
print(json.dumps(dict(faces=faces, triangles=triangles, seconds=end - start, read=start - begin)))
"""


def one_core():
    os.sched_setaffinity(0, {max(os.sched_getaffinity(0))})


def run(command):
    environment = dict(os.environ, RAYON_NUM_THREADS="1")
    done = subprocess.run(command, capture_output=True, preexec_fn=one_core, env=environment)
    return json.loads(done.stdout.splitlines()[-1]) if done.returncode == 0 else None


def least(rounds):
    best = min(rounds, key=lambda made: made["seconds"])
    return dict(best, read=min(made["read"] for made in rounds))


def main():
    binary, rounds, parts = sys.argv[1], int(sys.argv[2]), sys.argv[3:]
    print(f"chord {CHORD} mm, angle {ANGLE} degrees, least processor time of {rounds} rounds, faces per second")
    sums = [0.0] * 4
    print(f"{'':40} {'resurf':>28} {'Open CASCADE':>28}  ratio  reading   both")
    for part in parts:
        ours, peer = [], []
        for _ in range(rounds):
            ours.append(run([binary, part, str(CHORD / 1e3), str(ANGLE)]))
            peer.append(run([sys.executable, "-c", PEER, part, str(CHORD), str(ANGLE)]))
        name = os.path.basename(part)[:40]
        if None in ours + peer or not all(made["faces"] for made in ours + peer):
            print(f"{name:40} left out: one of the two reads or meshes no face of it")
            continue
        ours, peer = least(ours), least(peer)
        rate = lambda made: made["faces"] / max(made["seconds"], 1e-6)
        show = lambda made: f"{made['faces']:5} {made['triangles']:7} tri {rate(made):9.0f}/s"
        whole = lambda made: made["seconds"] + made["read"]
        print(f"{name:40} {show(ours):>28} {show(peer):>28} {rate(ours) / rate(peer):6.2f} "
              f"{peer['read'] / max(ours['read'], 1e-6):8.2f} {whole(peer) / whole(ours):6.2f}")
        sums = [a + b for a, b in zip(sums, (ours["seconds"], peer["seconds"], ours["read"], peer["read"]))]
        for reason in ours["refused"]:
            print(f"    refused: {reason}")
        sys.stdout.flush()
    if all(sums):
        print(f"all files: meshing {sums[0]:.2f} s and {sums[1]:.2f} s, ratio {sums[1] / sums[0]:.2f}; "
              f"reading {sums[2]:.3f} s and {sums[3]:.3f} s, ratio {sums[3] / sums[2]:.2f}")


if __name__ == "__main__":
    main()
