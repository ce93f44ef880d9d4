#!/bin/sh
# python-fcl 0.7.0.11: contacts of two meshes lie at corners far from where the triangles pierce each other.
#
# A narrow triangle stands upright and pierces a flat one around (0.25, 0.2, 0).
# One would expect: contacts whose positions lie on the segment in which the triangles meet.
# What happens: there are two, at the corners (1, 0, 0) and (0, 1, 0) of the flat triangle, outside the upright one.
#
# Output seen:
# the triangles meet between x = 0.20 and 0.25, y = 0.20 and 0.25
# contacts at [1. 0. 0.] and [0. 1. 0.]
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
"${PYTHON:-python3}" -m pip install --quiet --no-warn-script-location --target "$folder/site" python-fcl==0.7.0.11 numpy==2.4.6
cd "$folder"
PYTHONPATH="$folder/site" "${PYTHON:-python3}" - <<'END'
import fcl
import numpy as np


def triangle(*corners: tuple[float, float, float]) -> fcl.CollisionObject:
    model = fcl.BVHModel()
    model.beginModel(3, 1)
    model.addSubModel(np.array(corners), np.array([[0, 1, 2]]))
    model.endModel()
    return fcl.CollisionObject(model, fcl.Transform())


upright = np.array([(0.2, 0.2, -1.0), (0.3, 0.2, 1.0), (0.2, 0.3, 1.0)])
flat = triangle((0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0))
# The plane z = 0 halves the two edges that rise from the lowest corner.
ends = (upright[0] + upright[1:]) / 2
(x0, x1), (y0, y1) = np.sort(ends[:, :2].T)
print(f"the triangles meet between x = {x0:.2f} and {x1:.2f}, y = {y0:.2f} and {y1:.2f}")
result = fcl.CollisionResult()
fcl.collide(flat, triangle(*upright), fcl.CollisionRequest(num_max_contacts=10, enable_contact=True), result)
places = [np.round(contact.pos, 6) + 0.0 for contact in result.contacts]
print("contacts at", " and ".join(str(place) for place in places))
away = [min(np.linalg.norm(ends - place, axis=1)) for place in places]
raise SystemExit(len(places) != 2 or bool(min(away) < 0.5))
END
