#!/bin/sh
# python-fcl 0.7.0.11: by conservative advancement two boxes fly through each other without a collision.
#
# A unit box moves from x = 0 to x = 10, another stands at x = 5: they touch when the first is at 4, after 0.4 of the way.
# One would expect: a collision at 0.4 from both solvers that take this motion: conservative advancement is the one that
# should not miss any.
# What happens: sampling the way finds it; conservative advancement says that there is none, time of contact 1.
#
# Output seen:
# CCDC_NAIVE: collides True, time 0.400
# CCDC_CONSERVATIVE_ADVANCEMENT: collides False, time 1.000
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
"${PYTHON:-python3}" -m pip install --quiet --no-warn-script-location --target "$folder/site" python-fcl==0.7.0.11 numpy==2.4.6
cd "$folder"
PYTHONPATH="$folder/site" "${PYTHON:-python3}" - <<'END'
import fcl
import numpy as np

found = []
for name in ("CCDC_NAIVE", "CCDC_CONSERVATIVE_ADVANCEMENT"):
    start, end, there = (fcl.Transform(np.array([x, 0.0, 0.0])) for x in (0.0, 10.0, 5.0))
    flying, standing = fcl.CollisionObject(fcl.Box(1, 1, 1), start), fcl.CollisionObject(fcl.Box(1, 1, 1), there)
    request = fcl.ContinuousCollisionRequest(
        num_max_iterations=1000, toc_err=1e-3, ccd_motion_type=fcl.CCDMotionType.CCDM_TRANS,
        ccd_solver_type=getattr(fcl.CCDSolverType, name),
    )
    result = fcl.ContinuousCollisionResult()
    fcl.continuousCollide(flying, end, standing, there, request, result)
    found.append((result.is_collide, round(result.time_of_contact, 2)))
    print(f"{name}: collides {result.is_collide}, time {result.time_of_contact:.3f}")
raise SystemExit(found != [(True, 0.4), (False, 1.0)])
END
