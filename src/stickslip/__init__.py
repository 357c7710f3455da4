"""stickslip: forced vibration of structures with rough, dry-friction joints.

The public names are listed once, in ``__init__.pyi``. Each is imported when it is first used, so that
``import stickslip`` costs nothing.
"""

from typing import Any

import lazy_loader

_public, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)


def __getattr__(name: str) -> Any:
    if name == "__version__":
        from importlib.metadata import version

        return version("stickslip")
    return _public(name)
