"""Scenes, garments, recording, command line: everything between the user and the engine.

`toile.dress(scene)` is the program's main function and `toile.dress` is also this package: Python
puts the package under that name as soon as one of its modules is imported. So the package itself
can be called.
"""

import sys
from types import ModuleType
from typing import Any


class _CallablePackage(ModuleType):
    """A package that dresses a scene when called."""

    def __call__(self, *args: Any, **keywords: Any) -> Any:
        """Dress a scene; see toile.dress.dress.dress."""
        from toile.dress.dress import dress

        return dress(*args, **keywords)


sys.modules[__name__].__class__ = _CallablePackage
