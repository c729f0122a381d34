"""The public names of orbiframe.workers, each with the module it lives in."""

from .memory import limit_memory as limit_memory, peak_memory as peak_memory, reset_peak as reset_peak
from .pool import Outcome as Outcome, processors as processors, work as work
from .worker_process import COMPILING as COMPILING, Task as Task, Tell as Tell
