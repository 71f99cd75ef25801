"""The scenes of bench v1, frozen: hashes of what families and seeds give.

Figures of two versions of the code can be compared only where these are the same. A change of the
generator that changes them is a new benchmark with another name.
"""

from __future__ import annotations

import hashlib
from collections.abc import Iterable

import numpy as np

from panoplan.simulate.buildings import Building
from panoplan.simulate.scene import SimulatedScene
from panoplan.types.arrays import FloatArray

_DECIMALS = 4
"""Of metres and radians: what other processors and libraries compute differs by far less."""

BUILDINGS: dict[str, str] = {
    "mp3d-fpe": "2725a1b4b54f501294c189214341603df5287e902c7395f59d800d7e01b88079",
    "flat": "1528507e57c590c1b27582b768a87956fca7082cb85412bc35d56e1c9d686f2f",
}
"""Of the buildings of seeds 0 to 49, by family."""

SCENES: dict[tuple[str, int], str] = {
    ("mp3d-fpe", 22): "0661c27ec93751154b51b2dd66242468b123570e512d456c2b4b92dcf3a511c5",
    ("flat", 9): "e41a59085e37c526d9d0c0418794a1774b9470be7e466837f53d530e0ce3cd06",
    ("flat", 30): "07a3a854731b0dfdb6d08426399eeacb9d99e9ade107dc175224cb9a262c0aaa",
}
"""Of whole scenes of the grade `measured`: walks, odometry and layouts; by family and seed."""


def buildings_digest(buildings: Iterable[Building]) -> str:
    """SHA-256 of rooms, passages, windows, outer doors and stairs, in hexadecimal."""
    digest = hashlib.sha256()
    for building in buildings:
        for room in building.rooms:
            digest.update(room.label.encode())
            _add(digest, *room.rings, np.array([room.ceiling_height_m]))
        for passage in building.passages:
            digest.update(f"{passage.kind}{passage.rooms}".encode())
            _add(digest, passage.faces)
        for window in building.windows:
            _add(digest, window.segment)
        for door in building.blind_doors:
            digest.update(door.kind.encode())
            _add(digest, door.segment)
        for stairs in building.stairs:
            digest.update(f"{stairs.rooms}".encode())
            _add(digest, stairs.line, np.array([stairs.width, *building.floors_m]))
    return digest.hexdigest()


def scene_digest(scene: SimulatedScene) -> str:
    """SHA-256 of a scene's building, poses, layouts and unit, in hexadecimal."""
    digest = hashlib.sha256(buildings_digest([scene.building]).encode())
    _add(digest, np.array([scene.camera_height_m, scene.metres_per_su]))
    if scene.truth.trajectory is not None:
        _add(digest, scene.truth.trajectory.translations, scene.truth.trajectory.rotations)
    for keyframe in scene.keyframes:
        digest.update(keyframe.id.encode())
        metres = scene.metres_per_su * keyframe.pose.translation
        _add(digest, metres, keyframe.pose.rotation)
        layout = keyframe.layout
        if layout is None:
            continue
        spans = layout.spans
        told = [layout.floor_boundary, layout.ceiling_boundary, layout.corners, layout.floor_sigma]
        told += [] if spans is None else [spans.doors, spans.openings, spans.windows]
        _add(digest, *(values for values in told if values is not None))
    return digest.hexdigest()


def _add(digest: hashlib._Hash, *arrays: FloatArray) -> None:
    """Adds arrays, rounded, with their shapes."""
    for values in arrays:
        digest.update(str(values.shape).encode())
        digest.update((np.round(values, _DECIMALS) + 0.0).astype("<f8").tobytes())
