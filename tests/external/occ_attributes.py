"""What Open CASCADE reads of a STEP file beside its geometry: names, colours and layers, as JSON on standard output.

Usage: occ_attributes.py FILE. Needs cadquery-ocp. The lists are sorted by their text, so two files that differ in
geometry alone give the same output. With `--can` it only says whether it can be used.
"""

import json
import os
import sys

from OCP.Quantity import Quantity_Color
from OCP.STEPCAFControl import STEPCAFControl_Reader
from OCP.Interface import Interface_Static
from OCP.IFSelect import IFSelect_RetDone
from OCP.TCollection import TCollection_ExtendedString
from OCP.TDF import TDF_AttributeIterator, TDF_Label
from OCP.TDataStd import TDataStd_Name
from OCP.TDocStd import TDocStd_Document
from OCP.TopAbs import TopAbs_FACE, TopAbs_SOLID
from OCP.TopExp import TopExp_Explorer
from OCP.XCAFApp import XCAFApp_Application
from OCP.XCAFDoc import XCAFDoc_ColorCurv, XCAFDoc_ColorGen, XCAFDoc_ColorSurf, XCAFDoc_DocumentTool

COLOUR_TYPES = {"general": XCAFDoc_ColorGen, "surface": XCAFDoc_ColorSurf, "curve": XCAFDoc_ColorCurv}


def label_sequence():
    """An empty sequence of labels: the class moved between versions."""
    try:
        from OCP.TDF import TDF_LabelSequence

        return TDF_LabelSequence()
    except ImportError:
        from OCP.collections import Sequence_TDF_Label

        return Sequence_TDF_Label()


def labels_of(fill):
    """The labels that a method puts into a sequence."""
    labels = label_sequence()
    fill(labels)
    return [labels.Value(k) for k in range(1, labels.Length() + 1)]


def name_of(label):
    """The name of a label. Looked for among all attributes: asked for by its kind, it comes back unusable."""
    attributes = TDF_AttributeIterator(label, True)
    while attributes.More():
        if isinstance(attributes.Value(), TDataStd_Name):
            return attributes.Value().Get().ToExtString()
        attributes.Next()
    return None


def static(owner, name):
    """A static method, which most versions spell apart from the others."""
    return getattr(owner, name + "_s", None) or getattr(owner, name)


def colours_of(tool, owner):
    """The colours of a label or shape by type, to six digits: what a file says, not what a screen shows."""
    colours = {}
    ask = static(tool, "GetColor") if isinstance(owner, TDF_Label) else tool.GetColor
    for word, kind in COLOUR_TYPES.items():
        colour = Quantity_Color()
        if ask(owner, kind, colour):
            colours[word] = ["%.6f" % part for part in (colour.Red(), colour.Green(), colour.Blue())]
    return colours


def layers_in(tool):
    """Names of the layers, each with the labels on it."""
    found = []
    for layer in labels_of(tool.GetLayerLabels):
        members = label_sequence()
        static(tool, "GetShapesOfLayer")(layer, members)
        found.append((name_of(layer), [members.Value(k) for k in range(1, members.Length() + 1)]))
    return found


def read(path, document):
    # Names of faces and edges are passed over unless this says otherwise.
    reader = STEPCAFControl_Reader()
    Interface_Static.SetIVal_s("read.stepcaf.subshapes.name", 1)
    reader.SetNameMode(True)
    reader.SetColorMode(True)
    reader.SetLayerMode(True)
    if reader.ReadFile(path) != IFSelect_RetDone or not reader.Transfer(document):
        raise RuntimeError("Open CASCADE does not read " + path)


def dump(document):
    main = document.Main()
    shapes = XCAFDoc_DocumentTool.ShapeTool_s(main)
    colours = XCAFDoc_DocumentTool.ColorTool_s(main)
    layers = layers_in(XCAFDoc_DocumentTool.LayerTool_s(main))
    get_shape = static(shapes, "GetShape")
    is_assembly = static(shapes, "IsAssembly")
    sub_shapes = static(shapes, "GetSubShapes")

    def on_layers(holds):
        return sorted(name for name, members in layers if any(holds(member) for member in members))

    def entry(label, kind):
        facts = {"kind": kind, "name": name_of(label), "colours": colours_of(colours, label)}
        return {**facts, "layers": on_layers(lambda member: member.IsEqual(label))}

    def shape_entry(shape):
        same = on_layers(lambda member: get_shape(member).IsSame(shape))
        return {"colours": colours_of(colours, shape), "layers": same}

    labels, faces, solids = [], [], []
    for label in labels_of(shapes.GetShapes):
        labels.append(entry(label, "assembly" if is_assembly(label) else "part"))
        for sub in labels_of(lambda found: sub_shapes(label, found)):
            kind = str(get_shape(sub).ShapeType()).rsplit("_", 1)[-1].lower()
            labels.append(entry(sub, kind))
        if is_assembly(label):
            continue
        for kind, found in ((TopAbs_FACE, faces), (TopAbs_SOLID, solids)):
            explorer = TopExp_Explorer(get_shape(label), kind)
            while explorer.More():
                found.append(shape_entry(explorer.Current()))
                explorer.Next()
    text = lambda value: json.dumps(value, sort_keys=True)
    return {
        "labels": sorted(labels, key=text),
        "faces": sorted(faces, key=text),
        "solids": sorted(solids, key=text),
        "face_count": len(faces),
        "layers": sorted([name, len(members)] for name, members in layers),
    }


if __name__ == "__main__":
    if sys.argv[1] == "--can":
        print("yes")
        sys.stdout.flush()
        os._exit(0)
    # Both must outlive every label: what they own is freed with them.
    application = XCAFApp_Application.GetApplication_s()
    document = TDocStd_Document(TCollection_ExtendedString("XmlXCAF"))
    application.NewDocument(TCollection_ExtendedString("XmlXCAF"), document)
    try:
        # The reader itself writes progress to standard output: the answer is the last line.
        read(sys.argv[1], document)
        print("\n" + json.dumps(dump(document), sort_keys=True))
        code = 0
    except Exception as error:  # any failure is an answer of its own
        print("%s: %s" % (type(error).__name__, error), file=sys.stderr)
        code = 1
    sys.stdout.flush()
    sys.stderr.flush()
    # Without the interpreter's own end: it frees the document after its application, and crashes.
    os._exit(code)
