"""Live cloth and its obstacles as meshes of a GLB file."""

from toile.dressing.files.palette import linear
from toile.dressing.files.writers.glb import GlbMesh, glb_bytes
from toile.dressing.live.live_scene import Live
from toile.geometry.normals import drawn_normals


def live_glb(live: Live) -> bytes:
    """Return the cloth and its obstacles as they are, as a GLB file."""
    return glb_bytes(shown_meshes(live))


def shown_meshes(live: Live) -> list[GlbMesh]:
    """Return the cloth and its obstacles as they are."""
    cloth_colour, body_colour = live.colours
    x, faces = live.frame.positions, live.cloth.face_nodes
    node = live.cloth.node
    meshes = [
        GlbMesh(
            name=" and ".join(live.names), positions=x[node], normals=drawn_normals(x, faces)[node],
            faces=live.cloth.faces, colour=linear(cloth_colour), uv=live.cloth.uv, double_sided=True,
        )
    ]  # fmt: skip
    surfaces = live.obstacles.surfaces(None if live.surface is None else live.surface.vertices)
    meshes += [
        GlbMesh(
            name=name, positions=vertices, normals=drawn_normals(vertices, triangles), faces=triangles,
            colour=linear(body_colour),
        )
        for name, (vertices, triangles) in surfaces.items()
    ]  # fmt: skip
    return meshes
