"""Bodies in the text form of USD: one that is carried and scaled, and one on a skeleton that moves."""

from collections.abc import Iterable

import trimesh

STAGE = """#usda 1.0
(
    endTimeCode = 3
    metersPerUnit = 1
    startTimeCode = 1
    timeCodesPerSecond = 24
    upAxis = "Y"
)

def {kind} "group"
{{
    def Mesh "skin" (
        prepend apiSchemas = ["SkelBindingAPI"]
    )
    {{
        int[] faceVertexCounts = [{counts}]
        int[] faceVertexIndices = [{corners}]
        uniform token orientation = "rightHanded"
        point3f[] points = [{points}]
        token purpose = "render"
        token visibility = "inherited"
{more}
}}
"""
CARRIED = """        float3 xformOp:scale = (1, 1, 1)
        double3 xformOp:translate.timeSamples = {
            1: (0, 0, 0),
            3: (0, 0, 0.1),
        }
        uniform token[] xformOpOrder = ["xformOp:translate", "xformOp:scale"]
    }
"""
UNMOVED = "( (1, 0, 0, 0), (0, 1, 0, 0), (0, 0, 1, 0), (0, 0, 0, 1) )"
BOUND = f"""        int[] primvars:skel:jointIndices = [0] (
            elementSize = 1
            interpolation = "constant"
        )
        float[] primvars:skel:jointWeights = [1] (
            elementSize = 1
            interpolation = "constant"
        )
        rel skel:skeleton = </group/bones>
    }}

    def Skeleton "bones" (
        prepend apiSchemas = ["SkelBindingAPI"]
    )
    {{
        uniform matrix4d[] bindTransforms = [{UNMOVED}]
        uniform token[] joints = ["root"]
        uniform matrix4d[] restTransforms = [{UNMOVED}]
        rel skel:animationSource = </group/wave>
    }}

    def SkelAnimation "wave"
    {{
        uniform token[] joints = ["root"]
        quatf[] rotations = [(1, 0, 0, 0)]
        half3[] scales = [(1, 1, 1)]
        float3[] translations.timeSamples = {{
            1: [(0, 0, 0)],
            3: [(0, 0.1, 0)],
        }}
    }}
"""


def usds(body: trimesh.Trimesh) -> Iterable[tuple[str, bytes]]:
    """Return stages of three frames that hold a body."""
    for kind, more in (("Xform", CARRIED), ("SkelRoot", BOUND)):
        text = STAGE.format(
            kind=kind, more=more, counts=", ".join("3" for _ in body.faces),
            corners=", ".join(map(str, body.faces.ravel().tolist())),
            points=", ".join("({:.6g}, {:.6g}, {:.6g})".format(*point) for point in body.vertices.tolist()),
        )  # fmt: skip
        yield ".usda", text.encode()
