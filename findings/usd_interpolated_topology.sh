#!/bin/sh
# usd-core 26.11: between two samples a mesh that changed its faces has the faces of one and points of both.
#
# A square whose points and faces are renumbered at time 1, as remeshing does: it covers the same place at both times.
# One would expect: the square of time 0 until time 1, since faces are held until then, or points that belong to the
# faces of the same time.
# What happens: points are interpolated wherever two samples have the same length, whatever the faces are. Halfway all
# four points lie in the middle, and the square has no area. With another number of points it stays.
#
# Output seen:
# time 0: area 1.0
# time 0.5: area 0.0
# time 1: area 1.0
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
"${PYTHON:-python3}" -m pip install --quiet --no-warn-script-location --target "$folder/site" usd-core==26.11 numpy==2.4.6
cd "$folder"
PYTHONPATH="$folder/site" "${PYTHON:-python3}" - <<'END'
import numpy as np
from pxr import Usd, UsdGeom, Vt

stage = Usd.Stage.CreateInMemory()
mesh = UsdGeom.Mesh.Define(stage, "/mesh")
corners = np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)], np.float32)
order = np.array([2, 3, 0, 1])
faces = np.array([0, 1, 2, 0, 2, 3], np.int32)
mesh.CreateFaceVertexCountsAttr([3, 3])
for time, points, own in ((0, corners, faces), (1, corners[order], np.argsort(order)[faces].astype(np.int32))):
    mesh.GetPointsAttr().Set(Vt.Vec3fArray.FromNumpy(np.ascontiguousarray(points)), time)
    mesh.GetFaceVertexIndicesAttr().Set(Vt.IntArray.FromNumpy(own), time)
areas = []
for time in (0, 0.5, 1):
    a, b, c = np.array(mesh.GetPointsAttr().Get(time))[np.array(mesh.GetFaceVertexIndicesAttr().Get(time))].reshape(
        -1, 3, 3
    ).transpose(1, 0, 2)
    areas.append(float(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2))
    print(f"time {time}: area {areas[-1]}")
raise SystemExit(areas != [1.0, 0.0, 1.0])
END
