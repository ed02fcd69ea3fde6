"""Reads a DXF by ezdxf, as CAD programs do, and prints as JSON what it holds.

Usage: read_dxf.py FILE
"""

import cmath
import json
import math
import sys

import ezdxf


def plane(point):
    return [point.x, point.y]


def flattened(vertices):
    """The vertices of a closed polyline, with points on its arcs."""
    for (x, y, bulge), (u, v, _) in zip(vertices, vertices[1:] + vertices[:1]):
        yield [x, y]
        if bulge:
            p, q = complex(x, y), complex(u, v)
            centre = (p + q) / 2 + 1j * (q - p) * (1 - bulge**2) / (4 * bulge)
            for k in range(1, 64):
                on_arc = centre + (p - centre) * cmath.exp(4j * math.atan(bulge) * k / 64)
                yield [on_arc.real, on_arc.imag]


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
        corners = list(flattened(list(entity.get_points("xyb"))))
        found["polylines"].append([layer, entity.closed, corners])
    elif kind == "TEXT":
        found["texts"].append(layer)
    else:
        sys.exit(f"unexpected entity {kind} on layer {layer}")
json.dump(found, sys.stdout)
