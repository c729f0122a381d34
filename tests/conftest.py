"""Its presence puts this folder on the path, so that tests in every subfolder can import what they share."""

import os

# The matrices of tests are small: a second thread costs more than it brings where other programs run too.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
os.environ.setdefault("OMP_NUM_THREADS", "1")

pytest_plugins = ["command_line"]
