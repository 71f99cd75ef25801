"""Surfaces as a binary glTF file."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from panoplan.errors import MissingExtraError
from panoplan.exporters.drawing import room_colours
from panoplan.exporters.model.atlas import Atlas, packed
from panoplan.exporters.model.surfaces import Kind, Surface
from panoplan.exporters.model.texture import EDGE, Picture
from panoplan.types.arrays import FloatArray
from panoplan.types.plan import FloorPlan

_COLOURS: dict[Kind, str] = {
    "ceiling": "#F4F4F2",
    "wall": "#ECEAE4",
    "reveal": "#D8D3C8",
    "top": "#4A515B",
}
_UNLIT = "KHR_materials_unlit"


def plan_glb(
    plan: FloorPlan, surfaces: Sequence[Surface], pictures: Mapping[str, Picture]
) -> bytes:
    """A plan's surfaces as glTF: a mesh a floor, ceiling and wall, one-sided.

    Faces look into the rooms, so from outside and above one sees into them. Surfaces with a
    picture show it unlit, one JPEG a room; the others are in plain colours.

    Args:
        plan: that the surfaces are of.
        surfaces: what `plan_surfaces` gives.
        pictures: by the surface's id, as many as there are.

    Raises:
        MissingExtraError: trimesh is not installed.
    """
    try:
        import trimesh
    except ImportError:
        raise MissingExtraError("GLB", "trimesh", "export") from None
    colours = room_colours(plan.rooms)
    plain: dict[str, Any] = {}
    scene = trimesh.Scene()

    def add(surface: Surface, material: Any, uv: Any) -> None:
        visual = trimesh.visual.TextureVisuals(uv=uv, material=material)
        points, faces = surface.triangles()
        mesh = trimesh.Trimesh(
            surface.in_space(points),
            faces,
            vertex_normals=np.broadcast_to(surface.normal, (len(points), 3)),
            visual=visual,
            process=False,
        )
        scene.add_geometry(mesh, node_name=surface.id, geom_name=surface.id)

    for room in dict.fromkeys(surface.room for surface in surfaces):
        own = [surface for surface in surfaces if surface.room == room]
        shown = [surface for surface in own if surface.id in pictures]
        if shown:
            atlas = packed({surface.id: pictures[surface.id].pixels for surface in shown})
            material = _photo(room or "reveals", atlas)
            for surface in shown:
                uv = _on_atlas(surface.triangles()[0], pictures[surface.id], surface.id, atlas)
                add(surface, material, uv)
        for surface in own:
            if surface.id not in pictures:
                is_floor = surface.kind == "floor"
                colour = colours[room] if is_floor else _COLOURS[surface.kind]
                add(surface, plain.setdefault(colour, _plain(colour)), None)
    return bytes(scene.export(file_type="glb", include_normals=True, tree_postprocessor=_unlit))


def _on_atlas(points: FloatArray, picture: Picture, name: str, atlas: Atlas) -> FloatArray:
    """(V, 2) texture coordinates, from the lower left corner, of points of a surface."""
    left, top = atlas.places[name]
    rows, columns = np.array(picture.pixels.shape[:2]) - 2 * EDGE
    share = (points - picture.low) / picture.size
    x = left + EDGE + share[:, 0] * columns
    y = top + EDGE + (1 - share[:, 1]) * rows
    height, width = atlas.pixels.shape[:2]
    return np.stack([x / width, 1 - y / height], axis=1)


def _photo(name: str, atlas: Atlas) -> Any:
    from PIL import Image
    from trimesh.visual.material import PBRMaterial

    image = Image.fromarray(atlas.pixels)
    # By this the exporter writes it as JPEG.
    image.format = "JPEG"
    return PBRMaterial(name=name, baseColorTexture=image, metallicFactor=0.0, roughnessFactor=1.0)


def _plain(colour: str) -> Any:
    from trimesh.visual.material import PBRMaterial

    rgb = [int(colour[k : k + 2], 16) for k in (1, 3, 5)]
    return PBRMaterial(
        name=colour, baseColorFactor=[*rgb, 255], metallicFactor=0.0, roughnessFactor=1.0
    )


def _unlit(tree: dict[str, Any]) -> None:
    """Photos hold the light of the rooms already."""
    for material in tree.get("materials", ()):
        if "baseColorTexture" in material.get("pbrMetallicRoughness", {}):
            material.setdefault("extensions", {})[_UNLIT] = {}
            tree.setdefault("extensionsUsed", [])
            if _UNLIT not in tree["extensionsUsed"]:
                tree["extensionsUsed"].append(_UNLIT)
