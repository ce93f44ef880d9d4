#!/bin/sh
# python-fcl 0.7.0.11: nearest points of a mesh and a sphere come in the frames of the shapes, those of two meshes in the world's.
#
# A triangle stands at x = 10; above it, 3 higher, stands another triangle, and then a sphere of radius 0.5.
# One would expect: `DistanceResult.nearest_points` in one frame, whatever the shapes: x is about 10 in both.
# What happens: between meshes the points are in the world; between a mesh and a sphere each is in the frame of its own
# shape, so their distance is not the distance that the same call returns.
#
# Output seen:
# mesh and mesh: distance 3.0, points [10. 0. 0.] [10. 0. 3.]
# mesh and sphere: distance 2.5, points [0.2 0.2 0. ] [ 0. 0. -0.5]
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
"${PYTHON:-python3}" -m pip install --quiet --no-warn-script-location --target "$folder/site" python-fcl==0.7.0.11 numpy==2.4.6
cd "$folder"
PYTHONPATH="$folder/site" "${PYTHON:-python3}" - <<'END'
import fcl
import numpy as np


def triangle() -> fcl.BVHModel:
    model = fcl.BVHModel()
    model.beginModel(3, 1)
    model.addSubModel(np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]]), np.array([[0, 1, 2]]))
    model.endModel()
    return model


lower = fcl.CollisionObject(triangle(), fcl.Transform(np.array([10.0, 0, 0])))
gaps = []
for name, shape, place in (("mesh", triangle(), (10.0, 0, 3)), ("sphere", fcl.Sphere(0.5), (10.2, 0.2, 3))):
    upper = fcl.CollisionObject(shape, fcl.Transform(np.array(place)))
    result = fcl.DistanceResult()
    distance = fcl.distance(lower, upper, fcl.DistanceRequest(enable_nearest_points=True), result)
    one, other = (np.round(point, 6) + 0.0 for point in result.nearest_points)
    print(f"mesh and {name}: distance {distance:.1f}, points {one} {other}")
    gaps.append((round(distance, 6), abs(np.linalg.norm(other - one) - distance) < 1e-6, one[0] > 9))
raise SystemExit(gaps != [(3.0, True, True), (2.5, False, False)])
END
