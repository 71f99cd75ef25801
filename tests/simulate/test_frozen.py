"""The scenes of bench v1 are what they were when its figures were measured."""

from dataclasses import replace

import numpy as np
import pytest

from panoplan.simulate.families import FAMILIES, make_building, simulate_scene
from panoplan.simulate.frozen import BUILDINGS, SCENES, buildings_digest, scene_digest


@pytest.mark.parametrize("family", FAMILIES)
def test_buildings_are_as_frozen(family):
    made = (make_building(family, seed) for seed in range(50))
    assert buildings_digest(made) == BUILDINGS[family], "another generator: give it another name"


@pytest.mark.parametrize(("family", "seed"), SCENES)
def test_walks_odometry_and_layouts_are_as_frozen(family, seed):
    found = scene_digest(simulate_scene(family, seed))
    assert found == SCENES[family, seed], "another generator: give it another name"


def test_every_part_of_a_scene_is_in_its_digest():
    scene = simulate_scene("flat", 19, as_stills=True)
    known = scene_digest(scene)
    building, first = scene.building, scene.keyframes[0]
    layout = first.layout
    moved = replace(first.pose, translation=first.pose.translation + [0.0, 0.0, 1.0])
    others = [
        replace(scene, metres_per_su=2 * scene.metres_per_su),
        replace(scene, building=replace(building, windows=building.windows[1:])),
        replace(scene, building=replace(building, passages=building.passages[1:])),
        replace(scene, keyframes=scene.keyframes[1:]),
        *(
            replace(scene, keyframes=(changed, *scene.keyframes[1:]))
            for changed in (
                replace(first, pose=moved),
                replace(first, layout=replace(layout, floor_sigma=2 * layout.floor_sigma)),
                replace(first, layout=replace(layout, floor_boundary=layout.floor_boundary - 1e-3)),
                replace(first, layout=replace(layout, corners=layout.corners[1:])),
            )
        ),
    ]
    assert len({known, *map(scene_digest, others)}) == 1 + len(others)
    nearly = replace(layout, floor_boundary=layout.floor_boundary * (1 + 1e-14))
    nudged = replace(scene, keyframes=(replace(first, layout=nearly), *scene.keyframes[1:]))
    assert scene_digest(nudged) == known


def test_rounding_has_no_negative_zero():
    scene = simulate_scene("flat", 19, as_stills=True)
    layout = scene.keyframes[0].layout
    spans = [
        replace(
            scene,
            keyframes=(
                replace(scene.keyframes[0], layout=replace(layout, corners=np.array([zero]))),
            ),
        )
        for zero in (0.0, 1e-9)
    ]
    assert scene_digest(spans[0]) == scene_digest(spans[1])
