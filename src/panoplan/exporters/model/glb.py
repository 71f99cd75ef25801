"""Surfaces as a binary glTF file."""

from __future__ import annotations

from typing import Any

import numpy as np

from panoplan.errors import MissingExtraError
from panoplan.exporters.drawing import room_colours
from panoplan.exporters.model.surfaces import Kind, Surface, plan_surfaces
from panoplan.types.plan import FloorPlan

_COLOURS: dict[Kind, str] = {
    "ceiling": "#F4F4F2",
    "wall": "#ECEAE4",
    "reveal": "#D8D3C8",
    "top": "#4A515B",
}


def plan_glb(plan: FloorPlan) -> bytes:
    """A metric plan as glTF: a mesh a floor, ceiling and wall, one-sided, in plain colours.

    Faces look into the rooms, so from outside and above one sees into them.

    Raises:
        InputError: not metric or without rooms; MissingExtraError: trimesh is not installed.
    """
    colours = room_colours(plan.rooms)
    try:
        import trimesh
    except ImportError:
        raise MissingExtraError("GLB", "trimesh", "export") from None
    scene = trimesh.Scene()
    materials: dict[str, Any] = {}
    for surface in plan_surfaces(plan):
        colour = colours[surface.room] if surface.kind == "floor" else _COLOURS[surface.kind]
        if colour not in materials:
            materials[colour] = _plain(colour)
        visual = trimesh.visual.TextureVisuals(material=materials[colour])
        scene.add_geometry(_mesh(surface, visual), node_name=surface.id, geom_name=surface.id)
    return bytes(scene.export(file_type="glb", include_normals=True))


def _mesh(surface: Surface, visual: Any) -> Any:
    import trimesh

    points, faces = surface.triangles()
    normals = np.broadcast_to(surface.normal, (len(points), 3))
    return trimesh.Trimesh(
        surface.in_space(points), faces, vertex_normals=normals, visual=visual, process=False
    )


def _plain(colour: str) -> Any:
    from trimesh.visual.material import PBRMaterial

    rgb = [int(colour[k : k + 2], 16) for k in (1, 3, 5)]
    return PBRMaterial(
        name=colour, baseColorFactor=[*rgb, 255], metallicFactor=0.0, roughnessFactor=1.0
    )
