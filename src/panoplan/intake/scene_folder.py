"""The sequence folder that is made from images, and what is told beside it."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

from scipy.spatial.transform import Rotation

from panoplan.formats.atomic import write_text
from panoplan.formats.sequence import DESCRIPTION, TRAJECTORY
from panoplan.formats.tum import write_tum
from panoplan.types.pose import Trajectory

IMAGES = "images"


@dataclass(frozen=True)
class Report:
    """What is told of images beside their scene.

    Attributes:
        lines: for the terminal.
        trajectory_unit: "m" where the poses found are metric.
    """

    lines: tuple[str, ...] = ()
    trajectory_unit: Literal["unknown", "m"] = "unknown"


def write_scene(work: Path, source: Path, poses: Trajectory) -> None:
    """Writes the poses, and sequence.json, which comes last.

    Args:
        work: the folder; images/NAME.jpg are in it.
        source: what the images came from.
        poses: labelled with the images' names, in the order of the walk.
    """
    write_tum(work / TRAJECTORY, poses)
    entries = [
        {"id": name, "image": f"{IMAGES}/{name}.jpg", "order": k}
        for k, name in enumerate(poses.labels)
    ]
    description = {"name": source.stem or "walk", "keyframes": entries}
    write_text(work / DESCRIPTION, json.dumps(description, ensure_ascii=False, indent=1) + "\n")


def plain(trajectory: Trajectory) -> dict[str, Any]:
    """A trajectory as plain values."""
    return {
        "labels": list(trajectory.labels),
        "translations": trajectory.translations.tolist(),
        "quaternions": Rotation.from_matrix(trajectory.rotations).as_quat().tolist(),
    }


def trajectory_of(data: Mapping[str, Any]) -> Trajectory:
    """The trajectory of plain values."""
    return Trajectory.from_quaternions(
        tuple(data["labels"]), data["translations"], data["quaternions"]
    )
