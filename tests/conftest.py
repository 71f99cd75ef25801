"""Fixtures for all tests: the real data where it is at hand."""

import json
import os
import shutil
from pathlib import Path

import numpy as np
import pytest

from panoplan.formats.tum import read_tum, write_tum
from panoplan.types.pose import Trajectory

# Trajectory units are these metres, so that the scale is to be found and not to be had for free.
METRES_PER_UNIT = 2.7


@pytest.fixture(scope="session")
def shared_data():
    """Folder with zind_000 and mp3d_levels; the test is skipped where it is absent."""
    root = os.environ.get("PANOPLAN_SHARED")
    shared = Path(root) if root else Path(__file__).resolve().parents[1].parent / "shared"
    for data in (shared / "data", shared):
        if (data / "zind_000" / "sequence.json").is_file():
            return data
    pytest.skip("no real data: set PANOPLAN_SHARED to the folder that holds data/zind_000")


@pytest.fixture(scope="session")
def zind_scene_folder(shared_data, tmp_path_factory):
    """A sequence folder of the real home with inputs only: no truth, translations rescaled.

    Do not write into it.
    """
    source = shared_data / "zind_000"
    folder = tmp_path_factory.mktemp("zind") / "zind_000"
    folder.mkdir()
    data = json.loads((source / "sequence.json").read_text(encoding="utf-8"))
    (folder / "sequence.json").write_text(json.dumps(known_to_a_run(data)), encoding="utf-8")
    shutil.copytree(source / "layouts_pred", folder / "layouts_pred")
    write_tum(folder / "trajectory.tum", rescaled(read_tum(source / "trajectory_gt.tum")))
    return folder


def known_to_a_run(description):
    """The fields of a sequence.json that are no truth."""
    known = {k: description[k] for k in ("name", "layout_size", "camera_height")}
    known["keyframes"] = [
        {k: item[k] for k in ("id", "image", "order")} for item in description["keyframes"]
    ]
    return known


def rescaled(trajectory):
    """The trajectory in units of METRES_PER_UNIT."""
    return Trajectory(
        trajectory.labels,
        np.array(trajectory.rotations),
        trajectory.translations / METRES_PER_UNIT,
    )
