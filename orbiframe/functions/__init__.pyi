"""The public names of orbiframe.functions, each with the module it lives in."""

from .basis import (
    Basis as Basis,
    DifferentiableBasis as DifferentiableBasis,
    PiecewiseBasis as PiecewiseBasis,
    lifted as lifted,
)
from .feet import (
    around as around,
    feet_of as feet_of,
    foot_points as foot_points,
    foot_step as foot_step,
    moved as moved,
)
from .fitter import (
    Fitter as Fitter,
    PreparedFitter as PreparedFitter,
    StartedFit as StartedFit,
    StartedFitter as StartedFitter,
    ValidatedFit as ValidatedFit,
    ValidatedFitter as ValidatedFitter,
)
from .jet_quotient import divide_jets as divide_jets
from .orbit_sum_basis import OrbitSumBasis as OrbitSumBasis
from .samples import Samples as Samples, coordinate_samples as coordinate_samples, joined as joined
from .samples_of_sides import Sides as Sides, crease_samples as crease_samples
from .smooth_samples import semi_smooth_samples as semi_smooth_samples, vertex_samples as vertex_samples
