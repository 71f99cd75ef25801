"""Where the benchmark's scenes come from: simulated buildings, or folders of a dataset."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from typing import Literal, Protocol

import panoplan
from panoplan.datasets.detect import open_scene, read_truth
from panoplan.datasets.mp3d_fpe import version_folder
from panoplan.errors import InputError
from panoplan.estimator.state import Walk
from panoplan.formats.ply import read_ply_points
from panoplan.simulate.families import simulate_scene
from panoplan.simulate.noise import NoiseModel
from panoplan.simulate.scan import scanned
from panoplan.simulate.scene import Grade, SimulatedScene
from panoplan.types.arrays import FloatArray
from panoplan.types.keyframe import Keyframe
from panoplan.types.truth import GroundTruth


@dataclass(frozen=True, eq=False)
class Recording:
    """One walk, and its truth for the scores.

    Attributes:
        keyframes: in the order of the walk.
        truth: true plan and poses.
        camera_height_m: of the median camera, None where unknown.
        true_ch_per_su: true scale in heights of the first camera, None where unknown.
        trajectory_unit: "m" where the method is told that it is metric.
        rooms: a number for each keyframe where the method is told which are of one room.
    """

    keyframes: tuple[Keyframe, ...]
    truth: GroundTruth
    camera_height_m: float | None
    true_ch_per_su: float | None
    trajectory_unit: Literal["unknown", "m"] = "unknown"
    rooms: tuple[int, ...] | None = None

    @property
    def walk(self) -> Walk:
        """What the method is told in advance."""
        count = len(self.keyframes)
        return Walk(self.trajectory_unit, self.camera_height_m, count, self.rooms)

    @property
    def bare(self) -> Recording:
        """Without the layouts."""
        return replace(self, keyframes=tuple(replace(k, layout=None) for k in self.keyframes))


_CLOUD = "pcl.ply"


class Source(Protocol):
    """A scene that can be had, here or on another machine."""

    @property
    def name(self) -> str:
        """Unique in a run; a file's name."""

    def key(self) -> str:
        """A hash of all that the recording depends on."""

    def open(self) -> Recording:
        """The recording."""

    def scan(self) -> FloatArray:
        """(N, 3) a scan of the scene in the true world; raises InputError where there is none."""

    def scan_key(self) -> str:
        """A hash of all that the scan depends on."""


@dataclass(frozen=True)
class Simulated:
    """A made-up building.

    Attributes:
        family: of `panoplan.simulate.families`.
        seed: which one.
        grade: of the errors.
    """

    family: str
    seed: int
    grade: Grade | NoiseModel = "measured"

    @property
    def name(self) -> str:
        """Family and seed."""
        return f"{self.family}-{self.seed:03d}"

    def key(self) -> str:
        """Of what it is and of the code that makes it."""
        return digest(repr(self), code_version("simulate", "geometry", "types"))

    def open(self) -> Recording:
        """Makes the building and walks through it."""
        return recorded(self.simulated())

    def simulated(self) -> SimulatedScene:
        """The scene with all that is known of how it was made."""
        return simulate_scene(self.family, self.seed, self.grade)

    def scan(self) -> FloatArray:
        """A scan without drift, of all that can be seen."""
        scene = self.simulated()
        return scanned(scene.building, scene.camera_height_m, self.seed)

    def scan_key(self) -> str:
        """The scene's."""
        return self.key()


def recorded(scene: SimulatedScene) -> Recording:
    """What the benchmark takes of a simulated scene.

    Args:
        scene: the scene.

    Returns:
        Its keyframes and truth.
    """
    return Recording(scene.keyframes, scene.truth, scene.camera_height_m, scene.ch_per_su)


@dataclass(frozen=True)
class Folder:
    """A scene of a dataset.

    Attributes:
        path: one version of an MP3D-FPE scene.
    """

    path: Path

    @property
    def name(self) -> str:
        """Scene and version."""
        return f"{self.path.parent.name}_{self.path.name}"

    def key(self) -> str:
        """Of the bytes of its poses, layouts and truth."""
        files = [*self.path.glob("*.json"), *self.path.glob("*.txt"), *self.path.glob("vo*/**/*.*")]
        return _digest_of(self.path, (path for path in files if path.is_file()))

    def open(self) -> Recording:
        """Reads it; raises as the readers do."""
        scene = open_scene(self.path)
        return Recording(scene.keyframes, read_truth(self.path), scene.camera_height_m, None)

    def scan(self) -> FloatArray:
        """The points of pcl.ply."""
        return read_ply_points(self.path / _CLOUD)

    def scan_key(self) -> str:
        """Of the bytes of pcl.ply."""
        return _digest_of(self.path, self.path.glob(_CLOUD))


def mp3d_fpe_scenes(root: Path) -> list[Folder]:
    """All versions of all scenes of the dataset.

    Args:
        root: folder of the dataset, `<root>/<scene>/<version>`.

    Raises:
        InputError: no such folder, or no scene in it.
    """
    if not root.is_dir():
        raise InputError(root, "no folder", "the root of MP3D-FPE: <root>/<scene>/<version>")
    versions = (path for path in sorted(root.glob("*/*")) if path.is_dir())
    found = [Folder(path.resolve()) for path in versions if version_folder(path) == path]
    if not found:
        raise InputError(root, "no scene", "<root>/<scene>/<version>/vo*/keyframe_list.txt")
    return found


@cache
def code_version(*parts: str) -> str:
    """A hash of the source of some of panoplan's packages or modules.

    Args:
        parts: their paths within the package, without ending.
    """
    root = Path(panoplan.__file__).parent
    modules = (root / f"{part}.py" for part in parts)
    inside = (file for part in parts for file in (root / part).rglob("*.py"))
    return _digest_of(root, [*(file for file in modules if file.is_file()), *inside])


def digest(*parts: str) -> str:
    """A hash of some texts."""
    return hashlib.sha256("\0".join(parts).encode()).hexdigest()


def _digest_of(root: Path, files: Iterable[Path]) -> str:
    """A hash of files' names and bytes."""
    made = hashlib.sha256()
    for file in sorted(files):
        made.update(str(file.relative_to(root)).encode() + b"\0")
        with file.open("rb") as stream:
            made.update(hashlib.file_digest(stream, "sha256").digest())
    return made.hexdigest()
