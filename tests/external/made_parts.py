"""Parts that Open CASCADE makes and writes, with volumes, areas and centroids by formulas: one JSON line for each file.

    python3 made_parts.py FOLDER

Needs cadquery-ocp and scipy; with `--can` it only says whether both can be used. Every part is written as AP203 in
inches without parameter curves, as AP214 in millimetres with them, and as AP242 in metres without. What stands in the
lines comes from integrals that know nothing of either program, in millimetres.
"""

import json
import math
import os
import sys

from OCP.BRepAlgoAPI import BRepAlgoAPI_Common, BRepAlgoAPI_Cut, BRepAlgoAPI_Fuse
from OCP.BRepBuilderAPI import (
    BRepBuilderAPI_GTransform,
    BRepBuilderAPI_MakeEdge,
    BRepBuilderAPI_MakeFace,
    BRepBuilderAPI_MakeWire,
    BRepBuilderAPI_NurbsConvert,
    BRepBuilderAPI_Transform,
)
from OCP.BRepPrimAPI import (
    BRepPrimAPI_MakeBox,
    BRepPrimAPI_MakeCone,
    BRepPrimAPI_MakeCylinder,
    BRepPrimAPI_MakePrism,
    BRepPrimAPI_MakeRevol,
    BRepPrimAPI_MakeSphere,
    BRepPrimAPI_MakeTorus,
)
from OCP.gp import gp_Ax1, gp_Ax2, gp_Dir, gp_Elips, gp_GTrsf, gp_Pnt, gp_Trsf, gp_Vec
from OCP.Interface import Interface_Static
from OCP.Message import Message
from OCP.STEPControl import STEPControl_AsIs, STEPControl_Writer
from scipy.integrate import dblquad, quad

PI = math.pi
FORMS = [("AP203", "INCH", 0), ("AP214IS", "MM", 1), ("AP242DIS", "M", 0)]


def axis(point, direction=(0, 0, 1)):
    return gp_Ax2(gp_Pnt(*point), gp_Dir(*direction))


def sphere(radius):
    return BRepPrimAPI_MakeSphere(gp_Pnt(0, 0, 0), radius).Shape()


def cylinder(radius, height, point, direction=(0, 0, 1)):
    return BRepPrimAPI_MakeCylinder(axis(point, direction), radius, height).Shape()


def box(sizes, point=(0, 0, 0)):
    return BRepPrimAPI_MakeBox(gp_Pnt(*point), *sizes).Shape()


def cone():
    return BRepPrimAPI_MakeCone(10, 0, 25).Shape()


def cut(one, other):
    return BRepAlgoAPI_Cut(one, other).Shape()


def ellipse(point, direction):
    edge = BRepBuilderAPI_MakeEdge(gp_Elips(axis(point, direction), 8, 3)).Edge()
    return BRepBuilderAPI_MakeFace(BRepBuilderAPI_MakeWire(edge).Wire()).Face()


def over(function, low, high):
    return quad(function, low, high, epsabs=1e-12, epsrel=1e-12, limit=400)[0]


def over_disc(function, radius, x=0.0):
    """The integral of f(distance from the axis) over a disc."""
    at = lambda r, t: r * function(math.hypot(x + r * math.cos(t), r * math.sin(t)))
    return dblquad(at, 0, 2 * PI, 0, radius, epsabs=1e-10, epsrel=1e-11)[0]


def drilled_sphere(radius, hole, x):
    """Volume, area and the volume's moment along x of a sphere less a cylinder at x that goes all through."""
    height = lambda r: math.sqrt(radius**2 - r**2)
    wall = over(lambda t: 2 * hole * height(math.hypot(x + hole * math.cos(t), hole * math.sin(t))), 0, 2 * PI)
    caps = 2 * over_disc(lambda r: radius / height(r), hole, x)
    volume = 4 / 3 * PI * radius**3 - 2 * over_disc(height, hole, x)
    lost = lambda r, t: r * (x + r * math.cos(t)) * 2 * height(math.hypot(x + r * math.cos(t), r * math.sin(t)))
    moment = -dblquad(lost, 0, 2 * PI, 0, hole, epsabs=1e-10, epsrel=1e-11)[0]
    return volume, 4 * PI * radius**2 - caps + wall, [moment / volume, 0, 0]


def cone_by_a_plane():
    """What a plane at x = 3, parallel to the axis, leaves of a cone: radius 10, height 25; the plane's cut is a hyperbola."""
    slant = math.hypot(10, 25) / 25
    segment = lambda r: r * r * math.acos(3 / r) - 3 * math.sqrt(r * r - 9) if r > 3 else 0.0
    chord = lambda r: 2 * math.sqrt(r * r - 9)
    radius = lambda z: 10 * (1 - z / 25)
    top = 17.5
    volume = PI * 100 * 25 / 3 - over(lambda z: segment(radius(z)), 0, top)
    lateral = PI * 10 * math.hypot(10, 25) - over(lambda z: 2 * radius(z) * math.acos(3 / radius(z)) * slant, 0, top)
    area = lateral + PI * 100 - segment(10) + over(lambda z: chord(radius(z)), 0, top)
    return volume, area, None


def parts():
    """Name, shape, and its volume, area and centroid; `None` for a centroid that no formula gives at once."""
    mirror, stretch = gp_Trsf(), gp_GTrsf()
    mirror.SetMirror(axis((1, 2, 3), (1, 2, 3)))
    stretch.SetValue(1, 1, 2.0)
    stretch.SetValue(2, 2, 0.7)
    eighth = (PI * 12**3 / 6 * 4 / 4, PI * 144 / 2 + 3 * PI * 36, [4.5] * 3)
    yield "octant", BRepAlgoAPI_Common(sphere(12), box((20, 20, 20))).Shape(), eighth
    yield "side_hole", cut(sphere(12), cylinder(3, 40, (-20, 0, 0), (1, 0, 0))), drilled_sphere(12, 3, 0)
    yield "pole_hole", cut(sphere(12), cylinder(3, 40, (0, 0, -20))), drilled_sphere(12, 3, 0)
    beside = cut(sphere(12), cylinder(3, 40, (4, 0, -20)))
    yield "beside_pole", beside, drilled_sphere(12, 3, 4)
    yield "beside_pole_nurbs", BRepBuilderAPI_NurbsConvert(beside).Shape(), drilled_sphere(12, 3, 4)
    through = cut(sphere(12), cylinder(3, 40, (3, 0, -20)))
    yield "through_pole", through, drilled_sphere(12, 3, 3)
    yield "through_pole_nurbs", BRepBuilderAPI_NurbsConvert(through).Shape(), drilled_sphere(12, 3, 3)
    capsule = BRepAlgoAPI_Fuse(cylinder(5, 20, (0, 0, 0)), sphere(5)).Shape()
    round_ends = (PI * 25 * 20 + 2 / 3 * PI * 125, 2 * PI * 5 * 20 + 2 * PI * 25 + PI * 25, None)
    yield "round_end", capsule, round_ends
    halved = cut(cone(), box((40, 40, 40), (3, -20, -1)))
    yield "hyperbola", halved, cone_by_a_plane()
    yield "hyperbola_mirrored", BRepBuilderAPI_Transform(halved, mirror, True).Shape(), cone_by_a_plane()
    sideways = lambda t: math.sqrt((30 * math.cos(t)) ** 2 + (80 * math.sin(t)) ** 2 + (16 * math.sin(t) + 9 * math.cos(t)) ** 2)
    oblique = (PI * 240, 2 * PI * 24 + over(sideways, 0, 2 * PI), [1.5, 1, 5])
    yield "oblique", BRepPrimAPI_MakePrism(ellipse((0, 0, 0), (0, 0, 1)), gp_Vec(3, 2, 10)).Shape(), oblique
    around = over(lambda t: math.hypot(8 * math.sin(t), 3 * math.cos(t)), 0, 2 * PI)
    ring = BRepPrimAPI_MakeRevol(ellipse((20, 0, 0), (0, 1, 0)), gp_Ax1(gp_Pnt(0, 0, 0), gp_Dir(0, 0, 1))).Shape()
    yield "elliptic_ring", ring, (2 * PI * 20 * 24 * PI, 2 * PI * 20 * around, [0, 0, 0])
    part = lambda v, u: math.cos(v) * math.sqrt(
        (70 * math.cos(v) * math.cos(u)) ** 2 + (200 * math.cos(v) * math.sin(u)) ** 2 + (140 * math.sin(v)) ** 2
    )
    skin = 8 * dblquad(part, 0, PI / 2, 0, PI / 2, epsabs=1e-10, epsrel=1e-11)[0]
    egg = BRepBuilderAPI_GTransform(sphere(10), stretch, True).Shape()
    yield "ellipsoid", egg, (4 / 3 * PI * 1400, skin, [0, 0, 0])
    half = cut(BRepPrimAPI_MakeTorus(20, 6).Shape(), box((90, 90, 60), (-45, -45, 0)))
    yield "half_torus", half, (PI * PI * 20 * 36, 2 * PI * PI * 20 * 6 + PI * (26**2 - 14**2), None)


def write(shape, path, schema, unit, pcurves):
    Interface_Static.SetCVal_s("write.step.unit", unit)
    writer = STEPControl_Writer()
    Interface_Static.SetCVal_s("write.step.unit", unit)
    Interface_Static.SetCVal_s("write.step.schema", schema)
    Interface_Static.SetIVal_s("write.surfacecurve.mode", pcurves)
    writer.Transfer(shape, STEPControl_AsIs)
    writer.Write(path)


def main():
    if "--can" in sys.argv:
        return
    Message.DefaultMessenger_s().ChangePrinters().Clear()
    for name, shape, (volume, area, centroid) in parts():
        for schema, unit, pcurves in FORMS:
            path = os.path.join(sys.argv[1], f"{name}-{schema}.step")
            write(shape, path, schema, unit, pcurves)
            print(json.dumps({"file": path, "volume": volume, "area": area, "centroid": centroid}), flush=True)


if __name__ == "__main__":
    main()
    sys.stdout.flush()
    # The shapes must not be torn down in any order that the interpreter likes.
    os._exit(0)
