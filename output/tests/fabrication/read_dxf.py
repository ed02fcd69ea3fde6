"""Reads a DXF by ezdxf, as CAD programs do, and prints as JSON what it holds.

Usage: read_dxf.py FILE
"""

import json
import sys

import ezdxf


def plane(point):
    return [point.x, point.y]


drawing = ezdxf.readfile(sys.argv[1])
auditor = drawing.audit()
found = {
    "version": drawing.acad_release,
    "millimetres": drawing.header["$INSUNITS"] == 4,
    "defects": [defect.message for defect in auditor.errors + auditor.fixes],
    "lines": [],
    "circles": [],
    "polylines": [],
    "texts": [],
}
for entity in drawing.modelspace():
    layer, kind = entity.dxf.layer, entity.dxftype()
    if kind == "LINE":
        found["lines"].append([layer, [plane(entity.dxf.start), plane(entity.dxf.end)]])
    elif kind == "CIRCLE":
        found["circles"].append([layer, plane(entity.dxf.center), entity.dxf.radius])
    elif kind == "LWPOLYLINE":
        corners = list(entity.get_points("xy"))
        found["polylines"].append([layer, entity.closed, corners])
    elif kind == "TEXT":
        found["texts"].append(layer)
    else:
        sys.exit(f"unexpected entity {kind} on layer {layer}")
json.dump(found, sys.stdout)
