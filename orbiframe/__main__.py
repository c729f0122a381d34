"""`python -m orbiframe` is `orbiframe`."""

import sys

from orbiframe.cli.main import main

sys.exit(main())
