"""What Open CASCADE counts and measures in STEP and IGES files: one JSON line for each file given.

Needs cadquery-ocp; with `--can` it only says whether it can be used. Each solid and each shell outside of solids
counts once, whatever its location. Lengths are in the unit of the file's first context, as `METRES` in the
environment says (metres per unit, one number for each file, by commas); without it in millimetres.
"""

import json
import os
import sys
import time

import OCP.collections
from OCP.BRep import BRep_Tool
from OCP.BRepAdaptor import BRepAdaptor_Surface
from OCP.BRepCheck import BRepCheck_Analyzer
from OCP.BRepGProp import BRepGProp
from OCP.GProp import GProp_GProps
from OCP.IFSelect import IFSelect_RetDone
from OCP.IGESControl import IGESControl_Reader
from OCP.Message import Message
from OCP.STEPControl import STEPControl_Reader
from OCP.TopAbs import TopAbs_EDGE, TopAbs_FACE, TopAbs_SHELL, TopAbs_SOLID
from OCP.TopExp import TopExp
from OCP.TopLoc import TopLoc_Location
from OCP.TopoDS import TopoDS

# Its default is no reference: off by up to 2e-3 on trimmed freeform faces.
ACCURACY = 1e-7

KINDS = {
    "GeomAbs_Plane": "plane",
    "GeomAbs_Cylinder": "cylinder",
    "GeomAbs_Cone": "cone",
    "GeomAbs_Sphere": "sphere",
    "GeomAbs_Torus": "torus",
    "GeomAbs_BezierSurface": "b_spline",
    "GeomAbs_BSplineSurface": "b_spline",
    "GeomAbs_SurfaceOfExtrusion": "linear_extrusion",
    "GeomAbs_SurfaceOfRevolution": "revolution",
    "GeomAbs_OffsetSurface": "offset",
}


def subshapes(shape, kind):
    """Subshapes of a kind, each once whatever its location and sense."""
    found = OCP.collections.IndexedMap_TopoDS_Shape_TopTools_ShapeMapHasher()
    TopExp.MapShapes_s(shape, kind, found)
    once = OCP.collections.IndexedMap_TopoDS_Shape_TopTools_ShapeMapHasher()
    for at in range(1, found.Extent() + 1):
        once.Add(found.FindKey(at).Located(TopLoc_Location()))
    return [once.FindKey(at) for at in range(1, once.Extent() + 1)]


def edges_of_faces(faces):
    """Count of the edges that bound faces, each once; not those that are a point, which healing adds at poles."""
    edge_of = getattr(TopoDS, "Edge_s", None) or TopoDS.Edge
    once = OCP.collections.IndexedMap_TopoDS_Shape_TopTools_ShapeMapHasher()
    for face in faces:
        for edge in subshapes(face, TopAbs_EDGE):
            if not BRep_Tool.Degenerated_s(edge_of(edge)):
                once.Add(edge)
    return once.Extent()


def mass(shape, volume):
    """Volume and area with the centroid of the volume, or of the area."""
    area, solid = GProp_GProps(), GProp_GProps()
    BRepGProp.SurfaceProperties_s(shape, area, ACCURACY, False)
    if volume:
        BRepGProp.VolumeProperties_s(shape, solid, ACCURACY, False, False)
    centre = (solid if volume else area).CentreOfMass()
    facts = {"area": area.Mass(), "centroid": [centre.X(), centre.Y(), centre.Z()]}
    return {**facts, "volume": solid.Mass()} if volume else facts


def measure(path):
    is_iges = path.lower().endswith((".igs", ".iges"))
    reader = IGESControl_Reader() if is_iges else STEPControl_Reader()
    if reader.ReadFile(path) != IFSelect_RetDone:
        return {"error": "not read"}
    reader.TransferRoots()
    shape = reader.OneShape()
    if shape is None or shape.IsNull():
        return {"error": "nothing in it"}
    face_of = getattr(TopoDS, "Face_s", None) or TopoDS.Face
    faces = subshapes(shape, TopAbs_FACE)
    kinds = {}
    for face in faces:
        name = KINDS.get(BRepAdaptor_Surface(face_of(face)).GetType().name, "other")
        kinds[name] = kinds.get(name, 0) + 1
    solids = subshapes(shape, TopAbs_SOLID)
    shells = subshapes(shape, TopAbs_SHELL)
    inside = [shell for solid in solids for shell in subshapes(solid, TopAbs_SHELL)]
    loose = [shell for shell in shells if not any(shell.IsSame(other) for other in inside)]
    return {
        "valid": BRepCheck_Analyzer(shape).IsValid(),
        "counts": {
            "solids": len(solids),
            "shells": len(shells),
            "faces": len(faces),
            "edges": edges_of_faces(faces),
        },
        "surfaces": kinds,
        "solids": [{**mass(solid, True), "faces": len(subshapes(solid, TopAbs_FACE))} for solid in solids],
        "shells": [{**mass(shell, False), "faces": len(subshapes(shell, TopAbs_FACE))} for shell in loose],
    }


def main():
    if "--can" in sys.argv:
        return
    Message.DefaultMessenger_s().ChangePrinters().Clear()
    for path in sys.argv[1:]:
        start = time.time()
        found = measure(path)
        print(json.dumps({"file": path, **found, "seconds": time.time() - start}), flush=True)


if __name__ == "__main__":
    main()
    sys.stdout.flush()
    # The shapes must not be torn down in any order that the interpreter likes.
    os._exit(0)
