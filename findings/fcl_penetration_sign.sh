#!/bin/sh
# python-fcl 0.7.0.11: the sign of a contact's penetration depth depends on the kinds of the two shapes.
#
# A sphere of radius 0.5 reaches 0.4 through a wall, once a box and once a mesh of the box's faces.
# One would expect: the same depth, 0.4, with the same sign: both are contacts of the same two solids.
# What happens: the depth is positive for the box and negative for the mesh, so that "depth > 0" finds no contact with a mesh.
#
# Output seen:
# box: 1 contacts, penetration depth 0.400
# mesh: 2 contacts, penetration depth -0.400
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
"${PYTHON:-python3}" -m pip install --quiet --no-warn-script-location --target "$folder/site" python-fcl==0.7.0.11 numpy==2.4.6
cd "$folder"
PYTHONPATH="$folder/site" "${PYTHON:-python3}" - <<'END'
import fcl
import numpy as np

corners = np.array([[x, y, z] for x in (-2.0, 2) for y in (-2.0, 2) for z in (-0.5, 0.5)])
faces = np.array(
    [[0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1], [2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4],
     [1, 5, 7], [1, 7, 3]]
)  # fmt: skip
mesh = fcl.BVHModel()
mesh.beginModel(len(corners), len(faces))
mesh.addSubModel(corners, faces)
mesh.endModel()
depths = []
for name, wall in (("box", fcl.Box(4, 4, 1)), ("mesh", mesh)):
    sphere = fcl.CollisionObject(fcl.Sphere(0.5), fcl.Transform(np.array([0.3, 0.1, 0.6])))
    result = fcl.CollisionResult()
    request = fcl.CollisionRequest(num_max_contacts=10, enable_contact=True)
    fcl.collide(fcl.CollisionObject(wall, fcl.Transform()), sphere, request, result)
    depth = max((contact.penetration_depth for contact in result.contacts), key=abs)
    print(f"{name}: {len(result.contacts)} contacts, penetration depth {depth:.3f}")
    depths.append(round(depth, 3))
raise SystemExit(depths != [0.4, -0.4])
END
