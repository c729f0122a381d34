"""Its presence puts this folder on the path, so that tests in every subfolder can import what they share."""

import os

# The matrices of tests are small: a second thread costs more than it brings where other programs run too.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
os.environ.setdefault("OMP_NUM_THREADS", "1")

from hypothesis import settings

# The same examples in every run, on every machine, however slow: a failure is found again, and no time decides.
settings.register_profile("repeatable", derandomize=True, deadline=None, database=None)
settings.load_profile("repeatable")

pytest_plugins = ["command_line", "browsers", "installed_gmsh"]
