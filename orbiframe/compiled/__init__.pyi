"""The public names of orbiframe.compiled, each with the module it lives in."""

from .decorator import compiled as compiled
from .matrices import (
    copy as copy,
    exchange as exchange,
    is_identity as is_identity,
    multiply as multiply,
    set_identity as set_identity,
)
