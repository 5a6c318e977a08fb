"""What Open CASCADE's document model says of assemblies: components, and each placed solid with the box of its
vertices (millimetres) and the colours of its faces. One JSON line per file."""
import json
import os
import sys

from OCP.BRep import BRep_Tool
from OCP.IFSelect import IFSelect_RetDone
from OCP.Message import Message
from OCP.Quantity import Quantity_ColorRGBA
from OCP.STEPCAFControl import STEPCAFControl_Reader
from OCP.TCollection import TCollection_ExtendedString
from OCP.TDocStd import TDocStd_Document
from OCP.TDF import TDF_Label
from OCP.TopAbs import TopAbs_FACE, TopAbs_SOLID, TopAbs_VERTEX
from OCP.TopExp import TopExp_Explorer
from OCP.TopLoc import TopLoc_Location
from OCP.TopoDS import TopoDS
from OCP.XCAFApp import XCAFApp_Application
from OCP.XCAFDoc import (
    XCAFDoc_ColorCurv,
    XCAFDoc_ColorGen,
    XCAFDoc_ColorSurf,
    XCAFDoc_ColorTool,
    XCAFDoc_DocumentTool,
    XCAFDoc_ShapeTool,
)

try:
    from OCP.collections import Sequence_TDF_Label as LabelSequence
except ImportError:
    from OCP.TDF import TDF_LabelSequence as LabelSequence

vertex_of = getattr(TopoDS, "Vertex_s", None) or TopoDS.Vertex


def colour_name(rgba):
    # As the file writes it: Open CASCADE keeps linear values.
    from OCP.Quantity import Quantity_Color, Quantity_TOC_sRGB

    parts = rgba.GetRGB().Values(Quantity_TOC_sRGB)
    return "#" + "".join(f"{round(255 * min(max(part, 0), 1)):02x}" for part in parts)


class Walk:
    def __init__(self, document):
        self.shapes = XCAFDoc_DocumentTool.ShapeTool_s(document.Main())
        self.colours = XCAFDoc_DocumentTool.ColorTool_s(document.Main())
        self.components = 0
        self.solids = []

    def label_colour(self, label):
        rgba = Quantity_ColorRGBA()
        for kind in (XCAFDoc_ColorSurf, XCAFDoc_ColorGen):
            if XCAFDoc_ColorTool.GetColor_s(label, kind, rgba):
                return colour_name(rgba)
        return None

    def shape_colour(self, shape):
        rgba = Quantity_ColorRGBA()
        for kind in (XCAFDoc_ColorSurf, XCAFDoc_ColorGen):
            if self.colours.GetColor(shape, kind, rgba):
                return colour_name(rgba)
        return None

    def visit(self, label, location, inherited):
        """Depth first; a component's colour reaches what has none of its own."""
        if XCAFDoc_ShapeTool.IsAssembly_s(label):
            components = LabelSequence()
            XCAFDoc_ShapeTool.GetComponents_s(label, components, False)
            inherited = inherited or self.label_colour(label)
            for at in range(1, components.Length() + 1):
                component = components.Value(at)
                referred = TDF_Label()
                if not XCAFDoc_ShapeTool.GetReferredShape_s(component, referred):
                    continue
                self.components += 1
                placed = location.Multiplied(XCAFDoc_ShapeTool.GetLocation_s(component))
                self.visit(referred, placed, self.label_colour(component) or inherited)
            return
        shape = XCAFDoc_ShapeTool.GetShape_s(label)
        whole = self.label_colour(label) or inherited
        solids = TopExp_Explorer(shape, TopAbs_SOLID)
        while solids.More():
            self.solid(solids.Current(), location, whole)
            solids.Next()

    def solid(self, solid, location, whole):
        own = self.shape_colour(solid) or whole
        faces, counts = TopExp_Explorer(solid, TopAbs_FACE), {}
        while faces.More():
            name = self.shape_colour(faces.Current()) or own or "none"
            counts[name] = counts.get(name, 0) + 1
            faces.Next()
        points, vertices = [], TopExp_Explorer(solid.Moved(location), TopAbs_VERTEX)
        while vertices.More():
            point = BRep_Tool.Pnt_s(vertex_of(vertices.Current()))
            points.append((point.X(), point.Y(), point.Z()))
            vertices.Next()
        low = [min(p[k] for p in points) for k in range(3)]
        high = [max(p[k] for p in points) for k in range(3)]
        self.solids.append({"box": low + high, "colours": counts})


def read(path):
    application = XCAFApp_Application.GetApplication_s()
    document = TDocStd_Document(TCollection_ExtendedString("XmlXCAF"))
    application.InitDocument(document)
    reader = STEPCAFControl_Reader()
    reader.SetColorMode(True)
    reader.SetNameMode(True)
    reader.SetLayerMode(True)
    if reader.ReadFile(path) != IFSelect_RetDone or not reader.Transfer(document):
        return {"error": "not read"}
    walk = Walk(document)
    free = LabelSequence()
    walk.shapes.GetFreeShapes(free)
    for at in range(1, free.Length() + 1):
        label = free.Value(at)
        walk.visit(label, XCAFDoc_ShapeTool.GetLocation_s(label), None)
    return {"components": walk.components, "solids": walk.solids, "keep": (document, reader, application)}


Message.DefaultMessenger_s().ChangePrinters().Clear()
kept = []
for path in sys.argv[1:]:
    found = read(path)
    kept.append(found.pop("keep", None))
    print(json.dumps({"file": os.path.basename(path), **found}), flush=True)
# The documents must not be torn down in any order that the interpreter likes.
os._exit(0)
