# Run by freecadcmd: reads the part named in RESURF_PART and writes what it found as JSON to RESURF_SENTINEL.
#
# Part.Shape.read, because the Import module crashes without a window; BoundBox, because optimalBoundingBox
# crashes when it is given arguments (0.20); check(False), because check(True) calls touching parts of an
# assembly an error. The sentinel is renamed into place when it is complete, and the process ends at once:
# an exception before that leaves no sentinel, whatever the exit code says.
import json
import math
import os

import FreeCAD
import Part


def finite(found, name, values):
    if all(math.isfinite(value) for value in values):
        return True
    found["messages"].append("%s is not finite" % name)
    return False


def measure(path):
    found = {"read": False, "messages": []}
    found["version"] = ".".join(FreeCAD.Version()[:3]).split(" ")[0]
    shape = Part.Shape()
    try:
        shape.read(path)
    except Exception as error:
        found["messages"].append("not read: %s" % error)
        return found
    found["read"] = not shape.isNull()
    if shape.isNull():
        found["messages"].append("no shape in the file")
        return found
    for name in ("Solids", "Shells", "Faces", "Edges"):
        found[name.lower()] = len(getattr(shape, name))
    figures = {"volume": shape.Volume, "area": shape.Area, "tolerance": shape.getTolerance(1)}
    for name, value in figures.items():
        if finite(found, name, [value]):
            found[name] = value
    box = shape.BoundBox
    low, high = [box.XMin, box.YMin, box.ZMin], [box.XMax, box.YMax, box.ZMax]
    if finite(found, "extents", low + high):
        found["extents"] = {"min": low, "max": high}
    found["valid"] = bool(shape.isValid())
    if not found["valid"]:
        found["messages"].append("the shape is not valid")
    try:
        shape.check(False)
    except Exception as error:
        found["valid"] = False
        lines = [line for line in str(error).splitlines() if line.strip()]
        found["messages"].extend(lines[:100])
    return found


def write(found, path):
    with open(path + ".part", "w", encoding="utf-8") as sentinel:
        json.dump(found, sentinel)
    os.replace(path + ".part", path)


write(measure(os.environ["RESURF_PART"]), os.environ["RESURF_SENTINEL"])
os._exit(0)
