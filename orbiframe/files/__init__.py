"""Files: the gate through which all meshes and surfaces go.

`gate.py` reads and writes; `soundness.py` says what passes; `sandbox.py` confines foreign readers.
The public names are listed in `__init__.pyi`; each is imported on first use.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
