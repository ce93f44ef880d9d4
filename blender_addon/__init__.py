"""The Blender extension: panels and operators around an engine that runs in a process of its own.

This folder is under GPL-3.0-or-later, as what uses Blender's Python interface is; see LICENSE in it.
"""


def register(kernels: str | None = None) -> None:
    """Add panels, operators and properties to Blender; compiled kernels go into the folder given."""
    from toile.blender_addon.dressing import Place
    from toile.blender_addon.registration import register_all

    Place.kernels = kernels
    register_all()


def unregister() -> None:
    """Take them out again; a run in progress is cancelled."""
    from toile.blender_addon.registration import unregister_all

    unregister_all()
