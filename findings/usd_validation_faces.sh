#!/bin/sh
# usd-core 26.11: UsdValidation finds no fault in a mesh whose faces name points that it does not have.
#
# A mesh of three points with a face (0, 1, 7), two normals, nine velocities and an extent far from all points.
# One would expect: an error from one of the 30 validators, since UsdGeom.Mesh.ValidateTopology, of the same package,
# names the fault, and the schema says that an extent bounds the points.
# What happens: no validator looks at faces, at the lengths of normals and velocities or at extents.
#
# Output seen:
# 30 validators, 0 errors
# ValidateTopology: Out of range face vertex index 7: Vertex must be in the range [0,3).
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
"${PYTHON:-python3}" -m pip install --quiet --no-warn-script-location --target "$folder/site" usd-core==26.11
cd "$folder"
PYTHONPATH="$folder/site" "${PYTHON:-python3}" - <<'END'
from pxr import Usd, UsdGeom, UsdValidation

stage = Usd.Stage.CreateInMemory()
UsdGeom.SetStageUpAxis(stage, UsdGeom.Tokens.y)
UsdGeom.SetStageMetersPerUnit(stage, 1.0)
root = UsdGeom.Xform.Define(stage, "/root")
stage.SetDefaultPrim(root.GetPrim())
mesh = UsdGeom.Mesh.Define(stage, "/root/mesh")
mesh.CreatePointsAttr([(0, 0, 0), (1, 0, 0), (0, 1, 0)])
mesh.CreateFaceVertexCountsAttr([3])
mesh.CreateFaceVertexIndicesAttr([0, 1, 7])
mesh.CreateNormalsAttr([(0, 0, 1)] * 2)
mesh.CreateVelocitiesAttr([(0, 0, 1)] * 9)
mesh.CreateExtentAttr([(5, 5, 5), (6, 6, 6)])
validators = UsdValidation.ValidationRegistry().GetOrLoadAllValidators()
errors = UsdValidation.ValidationContext(validators).Validate(stage)
print(f"{len(validators)} validators, {len(errors)} errors")
valid, reason = UsdGeom.Mesh.ValidateTopology([0, 1, 7], [3], 3)
print(f"ValidateTopology: {reason}")
raise SystemExit((len(errors), valid) != (0, False))
END
