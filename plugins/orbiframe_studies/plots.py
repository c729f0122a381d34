"""Plots: errors against unknowns on logarithmic axes, times of stages, and pictures of surfaces."""

from __future__ import annotations

import io
from collections.abc import Sequence
from typing import Any

import numpy as np

from orbiframe import PluginError
from orbiframe_studies.arrays import SurfaceArrays
from orbiframe_studies.orders import Series

_LIGHT, _CLAY, _VIEW = np.array([0.3, -0.5, 0.8]), np.array([0.79, 0.84, 0.89]), np.array([5.0, -9.0, 8.0])
_MARKS = "osD^v<>phX*"


def _pyplot() -> Any:
    """The figures of matplotlib, without a display. Raises PluginError where it is not installed."""
    try:
        from matplotlib import rc_context, rcParams
        from matplotlib.figure import Figure
    except ImportError as error:
        raise PluginError('a report has plots, which need matplotlib: pip install "orbiframe[studies]"') from error
    rcParams["svg.hashsalt"] = "orbiframe"  # names in the picture are the same every time
    return Figure, rc_context


def error_plot(series: Sequence[Series], measure: str) -> str:
    """Errors against unknowns, with the line of the fitted order, as SVG."""
    return _svg(error_figure(series, measure))


def error_figure(series: Sequence[Series], measure: str) -> Any:
    """The same as a figure of matplotlib."""
    figure, axes = _axes(9, 5.5)
    for number, each in enumerate(series):
        order = "" if each.order is None else f", order {each.order:.1f}"
        colour, mark = f"C{number % 10}", _MARKS[number % len(_MARKS)]
        axes.loglog(each.unknowns, each.errors, mark, color=colour, markersize=5, label=f"{each.name}{order}")
        if each.order is not None:
            axes.loglog(each.unknowns, _line_of(each), "-", color=colour, linewidth=1, alpha=0.7)
    axes.set(xlabel="unknowns", ylabel=f"{measure}, relative to the diagonal")
    axes.grid(True, which="both", alpha=0.25)
    if series:
        axes.legend(fontsize=7, loc="center left", bbox_to_anchor=(1.01, 0.5), frameon=False)
    return figure


def time_plot(names: Sequence[str], seconds: Sequence[dict[str, float]]) -> str:
    """The times of the stages of each fit, as stacked bars, in SVG."""
    figure, axes = _axes(9, 1.2 + 0.22 * len(names))
    left = np.zeros(len(names))
    for stage in dict.fromkeys(stage for each in seconds for stage in each):
        widths = np.array([each.get(stage, 0.0) for each in seconds])
        axes.barh(range(len(names)), widths, left=left, height=0.7, label=stage)
        left += widths
    axes.set(xlabel="seconds", yticks=range(len(names)), ylim=(len(names) - 0.5, -0.5))
    axes.set_yticklabels(names, fontsize=7)
    axes.legend(fontsize=7, loc="center left", bbox_to_anchor=(1.01, 0.5), frameon=False)
    return _svg(figure)


def surface_picture(parts: Sequence[SurfaceArrays]) -> bytes:
    """A shaded picture of the surfaces of one fit, as PNG; what is nearer is drawn over what is farther."""
    from matplotlib.collections import PolyCollection

    corners = np.concatenate([part.vertices[part.triangles] for part in parts])
    away = _VIEW / np.linalg.norm(_VIEW)
    right = np.cross([0.0, 0.0, 1.0], away)
    right /= np.linalg.norm(right)
    up = np.cross(away, right)
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), np.finfo(float).tiny)
    normals *= np.where(normals @ away < 0, -1.0, 1.0)[:, None]
    shade = 0.35 + 0.65 * np.clip(normals @ (_LIGHT / np.linalg.norm(_LIGHT)), 0, 1)
    order = np.argsort(corners.mean(axis=1) @ away, kind="stable")
    flat = np.stack([corners @ right, corners @ up], axis=-1)[order]
    colours = np.clip(shade[order, None] * _CLAY * 1.1, 0, 1)
    figure, axes = _axes(3.2, 2.4)
    axes.add_collection(PolyCollection(list(flat), facecolors=colours, edgecolors=colours, linewidths=0.3))
    axes.autoscale_view()
    axes.set_aspect("equal")
    axes.set_axis_off()
    made = io.BytesIO()
    figure.savefig(made, format="png", dpi=110, bbox_inches="tight", metadata={"Software": None})
    return made.getvalue()


def _line_of(series: Series) -> Any:
    """The straight line of the fitted order at the unknowns of a series."""
    x, y = np.log(series.unknowns), np.log(np.maximum(series.errors, np.finfo(float).tiny))
    return np.exp(y.mean() - (series.order or 0.0) / 2 * (x - x.mean()))


def _axes(width: float, height: float) -> tuple[Any, Any]:
    figure_of, _ = _pyplot()
    figure = figure_of(figsize=(width, height))
    return figure, figure.add_subplot()


def _svg(figure: Any) -> str:
    made = io.StringIO()
    figure.savefig(made, format="svg", bbox_inches="tight", metadata={"Date": None, "Creator": None})
    return made.getvalue()[made.getvalue().index("<svg") :]
