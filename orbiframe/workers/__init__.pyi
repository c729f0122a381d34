"""The public names of orbiframe.workers, each with the module it lives in."""

from .memory import peak_memory as peak_memory, reset_peak as reset_peak, resident_memory as resident_memory
from .pool import Outcome as Outcome, work as work
from .solving import chosen_solver as chosen_solver, solving_by as solving_by
from .threads import in_threads as in_threads, processors as processors, thread_count as thread_count
from .worker_process import COMPILING as COMPILING
