"""Reads STEP files with Open CASCADE and writes them again: pairs of paths."""
import sys

from OCP.STEPCAFControl import STEPCAFControl_Reader, STEPCAFControl_Writer
from OCP.STEPControl import STEPControl_AsIs
from OCP.TCollection import TCollection_ExtendedString
from OCP.TDocStd import TDocStd_Document

for source, target in zip(sys.argv[1::2], sys.argv[2::2]):
    document = TDocStd_Document(TCollection_ExtendedString("parts"))
    reader, writer = STEPCAFControl_Reader(), STEPCAFControl_Writer()
    reader.ReadFile(source)
    reader.Transfer(document)
    writer.Transfer(document, STEPControl_AsIs)
    writer.Write(target)
