"""stickslip: forced vibration of structures with rough, dry-friction joints.

The public names are listed once, in ``__init__.pyi``. Each is imported when it is first used, so that
``import stickslip`` costs nothing.
"""

import lazy_loader

# The only place of the version: pyproject.toml reads it here.
__version__ = "0.1.0"

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
