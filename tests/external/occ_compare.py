"""What jobs changed in parts, as Open CASCADE reads the files before and after: one line of JSON for each pair.

Usage: occ_compare.py BEFORE AFTER [BEFORE AFTER]… Needs cadquery-ocp; with `--can` it only says whether it can be used.

Faces and edges are paired by their order, which a patched file keeps; edges by what the paired faces use. Points of
curves and surfaces are compared as bits. Of a face that was a B-spline and still is, the old surface is brought to the
degrees and knots of the new one by Open CASCADE, and control points are compared.
"""

import json
import math
import os
import sys

from OCP.BRep import BRep_Tool
from OCP.BRepCheck import BRepCheck_Analyzer
from OCP.Geom import Geom_BSplineSurface, Geom_RectangularTrimmedSurface, Geom_TrimmedCurve
from OCP.IFSelect import IFSelect_RetDone
from OCP.Message import Message
from OCP.STEPControl import STEPControl_Reader
from OCP.TopAbs import TopAbs_EDGE, TopAbs_FACE, TopAbs_SHELL, TopAbs_SOLID
from OCP.TopExp import TopExp_Explorer
from OCP.TopoDS import TopoDS

SAMPLES = 7
# Distance of control points, as a part of the greatest coordinate, that is rounding of two ways to insert knots.
ROUNDING = 1e-10


def cast(name):
    return getattr(TopoDS, name + "_s", None) or getattr(TopoDS, name)


def explored(shape, kind):
    explorer = TopExp_Explorer(shape, kind)
    while explorer.More():
        yield explorer.Current()
        explorer.Next()


def read(path):
    reader = STEPControl_Reader()
    if reader.ReadFile(path) != IFSelect_RetDone:
        raise SystemExit(f"{path}: not read")
    reader.TransferRoots()
    return reader.OneShape()


def steps(first, last):
    """Parameters between two; of an endless or a whole turn's range from 0 to 1, which is the same for both files."""
    if last - first > 1e50 or abs(last - first - 2 * math.pi) < 1e-9:
        first, last = 0.0, 1.0
    return [first + (last - first) * k / (SAMPLES - 1) for k in range(SAMPLES)]


def basis(geometry, kind, inner):
    """Without the trims that the reader puts round it."""
    while isinstance(geometry, kind):
        geometry = getattr(geometry, inner)()
    return geometry


def edge_points(edge):
    """Points of the curve that the edge lies on, whatever part of it."""
    if BRep_Tool.Degenerated_s(edge):
        return []
    curve = basis(BRep_Tool.Curve_s(edge, 0.0, 0.0), Geom_TrimmedCurve, "BasisCurve")
    points = [curve.Value(t) for t in steps(curve.FirstParameter(), curve.LastParameter())]
    return [(p.X(), p.Y(), p.Z()) for p in points]


def boundary(face):
    """Points of the face's edges; their order says nothing, since walking a wire depends on the surface."""
    return sorted(edge_points(cast("Edge")(edge)) for edge in explored(face, TopAbs_EDGE))


def surface_of(face):
    return basis(BRep_Tool.Surface_s(face), Geom_RectangularTrimmedSurface, "BasisSurface")


def surface_points(surface):
    u0, u1, v0, v1 = surface.Bounds()
    points = [surface.Value(u, v) for u in steps(u0, u1) for v in steps(v0, v1)]
    return [(p.X(), p.Y(), p.Z()) for p in points]


def knots(surface, along):
    count = surface.NbUKnots() if along == "U" else surface.NbVKnots()
    value = surface.UKnot if along == "U" else surface.VKnot
    times = surface.UMultiplicity if along == "U" else surface.VMultiplicity
    return [(value(k), times(k)) for k in range(1, count + 1)]


def control_points(old, new):
    """How many control points of the new surface are not those of the old one over the same knots."""
    same = Geom_BSplineSurface(old)
    same.IncreaseDegree(new.UDegree(), new.VDegree())
    for along, insert in (("U", same.InsertUKnot), ("V", same.InsertVKnot)):
        have = knots(same, along)
        for value, times in knots(new, along):
            # The new knots are the old ones and more, to the bit.
            found = [t for k, t in have if k == value]
            if times > sum(found):
                insert(value, times, 0.0)
    rows, columns = new.NbUPoles(), new.NbVPoles()
    if (same.NbUPoles(), same.NbVPoles()) != (rows, columns):
        return {"net": [rows, columns], "refined": [same.NbUPoles(), same.NbVPoles()]}
    size = max(abs(c) for i in (1, rows) for j in (1, columns) for c in new.Pole(i, j).Coord())
    apart = []
    for i in range(1, rows + 1):
        for j in range(1, columns + 1):
            apart.append(new.Pole(i, j).Distance(same.Pole(i, j)))
    moved = sum(1 for d in apart if d > ROUNDING * size)
    stayed = max((d for d in apart if d <= ROUNDING * size), default=0.0)
    border = max(
        new.Pole(i, j).Distance(same.Pole(i, j))
        for i in range(1, rows + 1)
        for j in range(1, columns + 1)
        if i in (1, rows) or j in (1, columns)
    )
    return {"net": [rows, columns], "moved": moved, "stayed_within": stayed, "border_moved": border, "highest": max(apart)}


def compare(before, after):
    old, new = read(before), read(after)
    faces = [[cast("Face")(f) for f in explored(s, TopAbs_FACE)] for s in (old, new)]
    def count(shape, kind):
        # A pole's edge is the reader's, not the file's.
        real = lambda s: kind != TopAbs_EDGE or not BRep_Tool.Degenerated_s(cast("Edge")(s))
        return sum(1 for s in explored(shape, kind) if real(s))

    counts = {
        name: [count(shape, kind) for shape in (old, new)]
        for name, kind in (("solids", TopAbs_SOLID), ("shells", TopAbs_SHELL), ("faces", TopAbs_FACE), ("edges", TopAbs_EDGE))
    }
    found = {
        "valid": [BRepCheck_Analyzer(shape).IsValid() for shape in (old, new)],
        "closed": [all(BRep_Tool.IsClosed_s(s) for s in explored(shape, TopAbs_SHELL)) for shape in (old, new)],
        "counts": counts,
        "changed": [],
        "other_bounds": 0,
    }
    for at, (was, now) in enumerate(zip(*faces)):
        found["other_bounds"] += boundary(was) != boundary(now)
        surfaces = [surface_of(face) for face in (was, now)]
        if type(surfaces[0]) is type(surfaces[1]) and surface_points(surfaces[0]) == surface_points(surfaces[1]):
            continue
        entry = {"face": at, "kinds": [type(s).__name__.removeprefix("Geom_") for s in surfaces]}
        if all(isinstance(s, Geom_BSplineSurface) for s in surfaces):
            entry.update(control_points(*surfaces))
        found["changed"].append(entry)
    return found


if __name__ == "__main__":
    if "--can" not in sys.argv:
        Message.DefaultMessenger_s().ChangePrinters().Clear()
        for before, after in zip(sys.argv[1::2], sys.argv[2::2]):
            print(json.dumps(compare(before, after)), flush=True)
        sys.stdout.flush()
        os._exit(0)
