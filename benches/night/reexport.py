# FreeCAD's side: opens every part that is named in $PARTS and exports it again into $OUT.
import os

import Part

for path in open(os.environ["PARTS"]).read().splitlines():
    shape = Part.Shape()
    try:
        shape.read(path)
        shape.exportStep(os.path.join(os.environ["OUT"], os.path.basename(path)))
    except Exception as error:
        print("failed:", path, error)
