"""Writing of a body in the format that the file's extension names."""

from toile.dressing.body.avatar import Avatar
from toile.dressing.files.palette import BODY, linear
from toile.dressing.files.writers.glb import GlbMesh, glb_bytes
from toile.dressing.files.writers.obj import obj_bytes
from toile.dressing.files.writers.ply import ply_bytes
from toile.dressing.files.writers.stl import stl_bytes
from toile.geometry.normals import drawn_normals

FORMATS = (".obj", ".ply", ".stl", ".glb")
"""File extensions that can be written."""


def body_bytes(body: Avatar, extension: str) -> bytes:
    """Return the body [m, Y up] as a file of one of FORMATS."""
    if extension == ".obj":
        return obj_bytes(body.vertices, body.faces, comment=f"{body.name}: metres, Y up")
    if extension == ".ply":
        return ply_bytes(body.vertices, body.faces)
    if extension == ".stl":
        return stl_bytes(body.vertices, body.faces)
    normals = drawn_normals(body.vertices, body.faces)
    return glb_bytes(
        [
            GlbMesh(
                name="body",
                positions=body.vertices,
                normals=normals,
                faces=body.faces,
                colour=linear(BODY),
            )
        ]
    )
