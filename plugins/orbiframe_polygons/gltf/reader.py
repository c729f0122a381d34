"""glTF reader: the triangles of a .gltf or .glb at their places, with normals and colours."""

from __future__ import annotations

import warnings
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from orbiframe import FormatError, Polyhedron
from orbiframe_polygons.gltf.accessors import Accessors
from orbiframe_polygons.gltf.container import Container
from orbiframe_polygons.gltf.placement import Placed, placed_meshes
from orbiframe_polygons.gltf.primitives import Shape, shape_of, with_colours_of_all
from orbiframe_polygons.gltf.tree import Node
from orbiframe_polygons.parts import Part, polyhedron_of
from orbiframe_polygons.room import Budget

QUANTIZATION, INSTANCING = "KHR_mesh_quantization", "EXT_mesh_gpu_instancing"
# Extensions without which the triangles are the same: materials, textures, lights and notes.
HARMLESS = ("KHR_materials_", "KHR_texture_", "EXT_texture_", "MSFT_texture_", "KHR_lights_", "EXT_lights_", "KHR_xmp")
# Extensions that are met where they are used: they may be required and yet not touch a mesh.
LATER = (QUANTIZATION, INSTANCING, "FB_ngon_encoding")


def read(path: Path) -> Polyhedron:
    """The triangles of the scene of a glTF 2.0 file, each mesh moved to the places of its nodes, in metres.

    Read are lists, strips and fans of triangles, normals, colours of vertices, sparse and quantized accessors and
    morph targets. A mesh that has open edges is closed where points are equal. Points and lines are skipped with a
    warning; materials and pictures are skipped, and pictures are never opened. Under a node that mirrors, faces are
    turned. Buffers stand in the file, or in a file beside it that is no link. Raises FormatError for compressed meshes
    (Draco, meshopt), skins, instancing and required extensions that are not known, each by name.

    Source: Khronos Group, glTF 2.0 Specification, and KHR_mesh_quantization.
    """
    container = Container(path)
    root = container.root
    _require_known(root)
    parts = list(_parts(container))
    if not parts:
        raise FormatError(f"{path}: the scene holds no triangles")
    return polyhedron_of(with_colours_of_all(tuple(parts)), "metre")


def _require_known(root: Node) -> None:
    """Raise FormatError for another version, and for extensions without which the triangles would be others."""
    asset = root.child("asset")
    if asset.has("version") and not asset.word("version").startswith("2."):
        asset.refuse(f"the version is {asset.word('version')[:20]!r}, but glTF 2.0 is read")
    for name in root.words("extensionsRequired"):
        if name not in LATER and not name.startswith(HARMLESS):
            root.refuse(f"the file requires the extension {name[:60]!r}, which is not read; save it without")


def _parts(container: Container) -> Iterator[Part]:
    root, accessors = container.root, Accessors(container)
    meshes = root.children("meshes")
    quantized = QUANTIZATION in root.words("extensionsUsed") + root.words("extensionsRequired")
    shapes: dict[tuple[int, bytes], Shape] = {}
    budget = Budget(container.path, "its nodes repeat their meshes")
    skipped: Counter[str] = Counter()
    for placed in placed_meshes(root):
        _require_plain(placed.node)
        mesh = meshes[placed.mesh]
        weights = (placed.node if placed.node.has("weights") else mesh).numbers("weights", [], count=None)
        key = (placed.mesh, weights.tobytes())
        if key not in shapes:
            shapes[key] = shape_of(mesh, accessors, weights, quantized=quantized)
        skipped.update(shapes[key].skipped)
        budget.spend(1 + sum(len(part.points) + len(part.tail) for part in shapes[key].parts))
        if shapes[key].parts:
            yield _at_place(placed, shapes[key])
    for kind, count in sorted(skipped.items()):
        warnings.warn(f"{container.path.name}: {count} primitives of {kind} are no triangles; left out", stacklevel=3)


def _require_plain(node: Node) -> None:
    """Raise FormatError for what would bend or repeat a mesh."""
    if node.has("skin"):
        node.refuse("the mesh is bent by a skin, which is not read; apply it to the mesh first")
    if node.child("extensions").has(INSTANCING):
        node.refuse(f"the mesh is repeated by {INSTANCING}, which is not read; make its copies real")


def _at_place(placed: Placed, shape: Shape) -> Part:
    """All triangles of a mesh as one part, at its place."""
    parts = with_colours_of_all(shape.parts)
    whole = polyhedron_of(parts)
    part = Part(whole.vertices, whole.face_sizes, whole.tail, whole.normals, whole.colors, whole.corner_uv)
    with np.errstate(over="ignore", invalid="ignore"):
        moved = part.moved(placed.matrix[:3, :3], placed.matrix[3, :3])
    if not np.isfinite(moved.points).all():
        placed.node.refuse("its place makes coordinates too large")
    return moved.closed()
