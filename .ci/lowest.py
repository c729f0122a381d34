"""The lowest versions that pyproject.toml allows, as constraints for pip: `python .ci/lowest.py [EXTRA...]`.

Of the dependencies, and of the extras that are named; requirements for another system or Python are left out.
"""

from __future__ import annotations

import sys
import tomllib
from collections.abc import Iterator
from pathlib import Path

from packaging.requirements import Requirement

PROJECT = tomllib.loads((Path(__file__).parents[1] / "pyproject.toml").read_text(encoding="utf-8"))["project"]


def lowest(extras: list[str]) -> Iterator[str]:
    """One line for each requirement that states a lowest version."""
    texts = [*PROJECT["dependencies"], *(text for extra in extras for text in PROJECT["optional-dependencies"][extra])]
    for requirement in map(Requirement, texts):
        versions = [part.version for part in requirement.specifier if part.operator == ">="]
        if versions and (requirement.marker is None or requirement.marker.evaluate()):
            yield f"{requirement.name}=={versions[0]}"


if __name__ == "__main__":
    print("\n".join(lowest(sys.argv[1:])))
