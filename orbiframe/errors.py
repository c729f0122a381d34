"""What orbiframe raises: one family of errors, each a sentence with a next step."""


class OrbiframeError(Exception):
    """Anything that the user can mend: bad data, impossible mathematics, a wrong name."""


class UsageError(OrbiframeError):
    """A wrong option, name or configuration key (exit status 2)."""


class ConfigError(UsageError):
    """A configuration that cannot be read or does not fit the components."""


class PluginError(OrbiframeError):
    """A plugin or component that is missing, broken or declared twice."""


class FormatError(OrbiframeError):
    """A file that cannot be read or written; the text names the file and the place."""


class TopologyError(OrbiframeError):
    """A polyhedron that is not one closed connected surface; the text names the elements."""


class GeometryError(OrbiframeError):
    """Points, isometries or polygons that break a law of their geometry."""


class MapError(OrbiframeError):
    """A map to X/H that does not exist or is not an embedding."""


class FitError(OrbiframeError):
    """A fit that cannot be computed."""


class Notice(UserWarning):
    """What was done to the content of a file without loss, such as a change of units: said, and never an error."""
