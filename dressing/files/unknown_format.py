"""What to do with files of bodies and motions that are not read."""

from pathlib import Path

from toile.dressing.files.read_surface import FORMATS

THROUGH_BLENDER = "open it in Blender and export .glb (with its animation), or use toile's extension there"
WHAT_TO_DO = {
    ".fbx": f"FBX is a closed format; {THROUGH_BLENDER}",
    ".bvh": "BVH is a skeleton in motion without a body; put it on a character in Blender and export .glb",
    ".dae": f"Collada is no longer read by most programs; {THROUGH_BLENDER}",
    ".abc": f"Alembic is not read; {THROUGH_BLENDER}",
    ".blend": f"a .blend file is Blender's own; {THROUGH_BLENDER}",
    ".mhx2": f"MakeHuman's exchange format is not read; {THROUGH_BLENDER}",
    ".mhclo": "it is clothing of MakeHuman and no body; export the body as .obj",
    ".pkl": "a pickle can run any code; save vertices and faces with numpy.savez as .npz",
    ".pickle": "a pickle can run any code; save vertices and faces with numpy.savez as .npz",
    ".npy": "it holds one array without faces; save vertices and faces with numpy.savez as .npz",
    ".pc2": "a point cache has no faces; export the animated body as .glb",
    ".mdd": "a point cache has no faces; export the animated body as .glb",
}
"""Extension to what a file is and what to do."""


def unknown_format(path: Path) -> str:
    """Return what a file of a body is that is not read, and what to do with it."""
    extension = path.suffix.lower()
    if extension in WHAT_TO_DO:
        return WHAT_TO_DO[extension]
    extension = extension or "(no extension)"
    return f"unknown avatar format {extension!r}; export the body as one of {', '.join(FORMATS)}"


def foreign_npz(names: frozenset[str]) -> str | None:
    """Return what an .npz file without vertices and faces is, by its arrays' names, if that is known."""
    if {"poses", "trans"} <= names or {"poses", "betas"} <= names:
        return (
            "it holds joint angles and shape numbers of SMPL (AMASS), not vertices: pose the body model with "
            "them and save its `vertices` (frames, vertices, 3) and `faces`"
        )
    if {"v_template", "shapedirs"} <= names or {"v_template", "weights"} <= names:
        return "it is a body model (SMPL), not a body: pose it and save its `vertices` and `faces`"
    if "v_posed" in names or {"pose", "transl"} <= names:
        return (
            "it holds a posed frame of CAPE, whose faces are those of SMPL: save `vertices` and `faces` of "
            "all frames in one file"
        )
    return None
