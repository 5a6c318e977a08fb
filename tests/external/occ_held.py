"""What Open CASCADE finds in parts before and after a scaling that held cylinders: one JSON line for each pair.

Arguments: three factors, then pairs of files. Under factors that differ only what was held stays a cylinder or cone. With
`plugs` the volume that such cylinders enclose, positive for holes: radius times area by 2, with its first moment. What the
part must have after the scaling follows from the part before, the plugs before, and the plugs after. `stray` sums up the
difference between the areas of faces and those of Open CASCADE's own affine image, over faces that neither are held nor
bear what is.
"""

import json
import os
import sys

import OCP.collections
from OCP.BRep import BRep_Tool
from OCP.BRepAdaptor import BRepAdaptor_Surface
from OCP.BRepBuilderAPI import BRepBuilderAPI_GTransform
from OCP.BRepCheck import BRepCheck_Analyzer
from OCP.BRepGProp import BRepGProp
from OCP.GeomAbs import GeomAbs_Cylinder, GeomAbs_Plane
from OCP.gp import gp_GTrsf, gp_Pnt, gp_Vec
from OCP.GProp import GProp_GProps
from OCP.IFSelect import IFSelect_RetDone
from OCP.Message import Message
from OCP.STEPControl import STEPControl_Reader
from OCP.TopAbs import TopAbs_EDGE, TopAbs_FACE, TopAbs_REVERSED, TopAbs_SHELL, TopAbs_SOLID
from OCP.TopExp import TopExp
from OCP.TopLoc import TopLoc_Location
from OCP.TopoDS import TopoDS

ACCURACY = 1e-7
FACE = getattr(TopoDS, "Face_s", None) or TopoDS.Face
MAP = OCP.collections.IndexedMap_TopoDS_Shape_TopTools_ShapeMapHasher


def subshapes(shape, kind):
    found, once = MAP(), MAP()
    TopExp.MapShapes_s(shape, kind, found)
    for at in range(1, found.Extent() + 1):
        once.Add(found.FindKey(at).Located(TopLoc_Location()))
    return [once.FindKey(at) for at in range(1, once.Extent() + 1)]


def solids(path):
    reader = STEPControl_Reader()
    if reader.ReadFile(path) != IFSelect_RetDone:
        sys.exit(f"{path}: not read")
    reader.TransferRoots()
    return subshapes(reader.OneShape(), TopAbs_SOLID)


def volume(shape):
    found = GProp_GProps()
    BRepGProp.VolumeProperties_s(shape, found, ACCURACY, False, False)
    at = found.CentreOfMass()
    return found.Mass(), [at.X(), at.Y(), at.Z()]


def area(shape):
    found = GProp_GProps()
    BRepGProp.SurfaceProperties_s(shape, found, ACCURACY, False)
    at = found.CentreOfMass()
    return found.Mass(), [at.X(), at.Y(), at.Z()]


def plug(face, surface):
    """Volume that a cylindrical face encloses with its axis, and its moment; negative where material is inside."""
    cylinder = surface.Cylinder()
    u = 0.5 * (surface.FirstUParameter() + surface.LastUParameter())
    v = 0.5 * (surface.FirstVParameter() + surface.LastVParameter())
    point, du, dv = gp_Pnt(), gp_Vec(), gp_Vec()
    surface.D1(u, v, point, du, dv)
    normal = du.Crossed(dv)
    if face.Orientation() == TopAbs_REVERSED:
        normal.Reverse()
    axis = cylinder.Axis()
    way = gp_Vec(axis.Location(), point)
    outward = way.Subtracted(gp_Vec(axis.Direction()).Multiplied(way.Dot(gp_Vec(axis.Direction()))))
    size, center = area(face)
    signed = (-1.0 if normal.Dot(outward) > 0 else 1.0) * 0.5 * cylinder.Radius() * size
    return signed, [signed * x for x in center]


def image_faces(solid, map_):
    """Faces of the affine image; none where Open CASCADE cannot make it."""
    try:
        return subshapes(BRepBuilderAPI_GTransform(solid, map_, True).Shape(), TopAbs_FACE)
    except Exception:
        return []


def compare(before, after, factors):
    det = factors[0] * factors[1] * factors[2]
    faces = [[FACE(face) for face in subshapes(solid, TopAbs_FACE)] for solid in (before, after)]
    surfaces = [[BRepAdaptor_Surface(face) for face in own] for own in faces]
    (v0, c0), (v1, c1) = volume(before), volume(after)
    kept = [
        k
        for k, (a, b) in enumerate(zip(*surfaces))
        if a.GetType() == b.GetType() and a.GetType() not in (GeomAbs_Plane,) and a.GetType().value < 5
    ]
    plugs = [(0.0, [0.0] * 3), (0.0, [0.0] * 3)]
    for k in kept:
        if surfaces[0][k].GetType() == GeomAbs_Cylinder:
            for side in (0, 1):
                size, moment = plug(faces[side][k], surfaces[side][k])
                plugs[side] = plugs[side][0] + size, [x + y for x, y in zip(plugs[side][1], moment)]
    expected = det * (v0 + plugs[0][0]) - plugs[1][0]
    moments = [det * s * (v0 * c + m) - n for s, c, m, n in zip(factors, c0, plugs[0][1], plugs[1][1])]
    grown = gp_GTrsf()
    for k in range(3):
        grown.SetValue(k + 1, k + 1, factors[k])
    images = image_faces(before, grown)
    rims = MAP()
    for k in kept:
        for edge in subshapes(faces[1][k], TopAbs_EDGE):
            rims.Add(edge)
    bears = lambda face: any(rims.Contains(edge) for edge in subshapes(face, TopAbs_EDGE))
    strays = [
        abs(area(face)[0] - area(image)[0])
        for k, (face, image) in enumerate(zip(faces[1], images))
        if k not in kept and not bears(face)
    ]
    return {
        "valid": BRepCheck_Analyzer(after).IsValid(),
        "closed": all(BRep_Tool.IsClosed_s(shell) for shell in subshapes(after, TopAbs_SHELL)),
        "faces": [len(own) for own in faces],
        "kept": len(kept),
        "volume": v1,
        "expected_volume": expected,
        "centroid": c1,
        "expected_centroid": [m / expected for m in moments],
        "area": area(after)[0],
        "stray": sum(strays),
        "plain": len(strays),
    }


def main():
    Message.DefaultMessenger_s().ChangePrinters().Clear()
    factors = [float(x) for x in sys.argv[1:4]]
    for before, after in zip(sys.argv[4::2], sys.argv[5::2]):
        pairs = zip(solids(before), solids(after))
        print(json.dumps([compare(a, b, factors) for a, b in pairs]), flush=True)


if __name__ == "__main__":
    main()
    sys.stdout.flush()
    # The shapes must not be torn down in any order that the interpreter likes.
    os._exit(0)
