"""The report of a fit: as a file of JSON, and as a few lines to read."""

from __future__ import annotations

import json
import os
from collections.abc import Iterator, Mapping
from pathlib import Path
from tempfile import NamedTemporaryFile
from typing import Any


def write_report(path: Path, report: Mapping[str, Any]) -> None:
    """Write a report as JSON; the file appears complete or not at all."""
    with NamedTemporaryFile("w", dir=path.parent, prefix=f".{path.name}.", delete=False, encoding="utf-8") as file:
        try:
            file.write(json_text(report) + "\n")
            file.close()
            os.chmod(file.name, 0o666 & ~_umask())
            os.replace(file.name, path)
        except BaseException:
            os.unlink(file.name)
            raise


def json_text(report: Mapping[str, Any]) -> str:
    """A report as JSON; numbers of numpy become plain ones."""
    return json.dumps(report, indent=2, default=_plain, allow_nan=False)


def summary(report: Mapping[str, Any]) -> str:
    """A report in a few lines."""
    return "\n".join(f"{name:<10}{words}" for name, words in _lines(report))


def _lines(report: Mapping[str, Any]) -> Iterator[tuple[str, str]]:
    surface, group, mapped, fit, out = (report[key] for key in ("surface", "group", "map", "fit", "output"))
    yield "surface", f"{_surface_name(surface)} (Euler characteristic {surface['euler_characteristic']})"
    yield "geometry", str(report["geometry"])
    patches = _counted(group["patches"], "patch", "patches")
    yield "group", f"{group['source']}, {patches}, relation defect {group['relation_defect']:.1e}"
    angle = mapped["angle_distortion"]
    yield (
        "map",
        f"{mapped['triangles']} triangles, {mapped['not_positive']} not positive; angle distortion "
        f"median {angle['median']:.2f}, p95 {angle['p95']:.2f}, max {angle['max']:.2f}",
    )
    yield "fit", f"{fit['basis']}, {fit['size']} functions, {fit['samples']} samples"
    yield "error", f"rms {fit['rms']:.2e}, max {fit['max']:.2e} of the bounding-box diagonal"
    yield "output", f"{out['vertices']} vertices, {out['faces']} faces"
    stages = ", ".join(f"{stage} {seconds:.1f}" for stage, seconds in report["seconds"].items())
    yield "seconds", f"{sum(report['seconds'].values()):.1f} ({stages})"


def _surface_name(surface: Mapping[str, Any]) -> str:
    from orbiframe.topology import SurfaceType

    keys = ("euler_characteristic", "orientable", "components", "genus")
    return SurfaceType(closed=True, **{key: surface[key] for key in keys}).name


def _counted(count: int, one: str, many: str) -> str:
    return f"{count} {one if count == 1 else many}"


def _plain(value: Any) -> Any:
    if hasattr(value, "tolist"):
        return value.tolist()
    raise TypeError(f"a report cannot hold {type(value).__name__}")


def _umask() -> int:
    mask = os.umask(0)
    os.umask(mask)
    return mask
