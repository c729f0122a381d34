"""Processes that do the same task for many items, on one machine.

`pool.py` hands out the items, `worker_process.py` is what runs in a process, `memory.py` what a process may use.
The public names are listed in `__init__.pyi`; each is imported on first use.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
