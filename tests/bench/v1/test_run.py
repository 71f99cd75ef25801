"""The runner: what is kept is not made again, what fails counts."""

import json
import shutil
from dataclasses import dataclass, replace

import numpy as np
import pytest
from tests.bench.points.test_baseline import cloud
from tests.scenes import L_SHAPE, RECTANGLE, walk

from panoplan.bench.parallel import processes
from panoplan.bench.v1.predict import Row, rows_of
from panoplan.bench.v1.run import run, write_methods
from panoplan.bench.v1.scenes import Folder, Recording, mp3d_fpe_scenes
from panoplan.bench.v1.store import Store
from panoplan.errors import InputError
from panoplan.formats.mp3d_fpe import write_mp3d_fpe
from panoplan.types.layout import Layout
from panoplan.types.pose import Trajectory
from panoplan.types.truth import GroundTruth, TruePlan, TrueRoom

HERE = processes(1)
ROWS = (Row("paper", 0.2), Row("paper", 1.0))
FACTOR = 2.0
"""Trajectory units a metre: 0.5 m each, one camera height."""


def recording(polygon):
    cameras = np.array([[x, z] for x in (-1.4, -0.7, 0.0) for z in (-1.0, -0.6)])
    keyframes = walk(polygon, cameras, factor=FACTOR)
    rotations = np.array([k.pose.rotation for k in keyframes])
    translations = FACTOR * np.array([k.pose.translation for k in keyframes])
    true = Trajectory(tuple(k.id for k in keyframes), rotations, translations)
    rooms = (TrueRoom("room_01", "", polygon),)
    return Recording(tuple(keyframes), GroundTruth(TruePlan(rooms), true), 1.0, FACTOR)


@dataclass(frozen=True)
class Made:
    name: str
    polygon: tuple
    blind: bool = False
    version: int = 1

    def key(self):
        return repr(self)

    def open(self):
        made = recording(np.array(self.polygon))
        if not self.blind:
            return made
        up = Layout(np.full(64, 0.3))
        return replace(made, keyframes=tuple(replace(k, layout=up) for k in made.keyframes))


def sources():
    shapes = (("one", RECTANGLE), ("two", L_SHAPE), ("three", RECTANGLE + 0.1))
    return [Made(name, tuple(map(tuple, shape))) for name, shape in shapes]


def counting(calls, limit=None):
    def workers(function, work):
        for number, item in enumerate(work):
            calls.append(item)
            if limit is not None and len(calls) > limit:
                raise KeyboardInterrupt
            yield number, function(item)

    return workers


def ran(chosen, folder, workers=HERE, rows=ROWS):
    return run(chosen, rows, Store(folder), workers, HERE, lambda *_: None)


def without_cost(figures):
    text = json.dumps(figures, sort_keys=True)
    data = json.loads(text)
    for row in data.values():
        row["summary"].pop("cpu_seconds")
        for scene in row["scenes"]:
            scene.pop("cpu_seconds")
    return data


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    """A complete run: its folder, not to be written to, and its figures."""
    folder = tmp_path_factory.mktemp("whole")
    return folder, ran(sources(), folder)


@pytest.fixture
def kept(whole, tmp_path):
    """A copy of the folder of a complete run."""
    return shutil.copytree(whole[0], tmp_path / "kept")


def test_rooms_that_are_there_are_found(whole):
    _, figures = whole
    assert set(figures) == {"paper-20", "paper-100"}
    row = figures["paper-100"]
    assert [scene["scene"] for scene in row["scenes"]] == ["one", "two", "three"]
    assert row["summary"]["aligned"]["rooms_50 recall"] == 1.0
    assert row["summary"]["aligned"]["rooms_50 precision"] == 1.0
    assert row["scenes"][0]["aligned"]["rooms_50"] == [1, 1, 1]
    assert row["scenes"][0]["area_m2"] == pytest.approx(12.0)
    assert row["scenes"][0]["cpu_seconds"] > 0


def test_a_run_that_was_stopped_goes_on(tmp_path, whole):
    calls = []
    with pytest.raises(KeyboardInterrupt):
        ran(sources(), tmp_path, counting(calls, 4))
    rest = []
    figures = ran(sources(), tmp_path, counting(rest))
    # Three scenes and both rows of one were made before, those of the next were not.
    assert (len(calls), len(rest)) == (5, 2)
    assert without_cost(figures) == without_cost(whole[1])


def test_scoring_again_makes_nothing(whole):
    folder, figures = whole
    calls = []
    assert ran(sources(), folder, counting(calls)) == figures
    assert calls == []


def test_another_scene_or_row_is_made_anew_and_only_that(kept):
    changed, calls = sources(), []
    changed[1] = replace(changed[1], version=2)
    ran(changed[:2], kept, counting(calls), (*ROWS, Row("paper", 0.5)))
    assert calls[0].name == "two"
    made = [(task.source.name, task.row.name) for tasks in calls[1:] for task in tasks]
    assert len(calls) == 3
    assert sorted(made) == [
        ("one", "paper-50"), ("two", "paper-100"), ("two", "paper-20"), ("two", "paper-50")
    ]  # fmt: skip


def test_half_a_prediction_is_made_again(kept):
    (kept / "predictions" / "two" / "paper-20.kept.json").write_text('{"key": "')
    calls = []
    ran(sources(), kept, counting(calls))
    assert [(task.source.name, task.row.name) for (task,) in calls] == [("two", "paper-20")]


def test_a_scene_without_a_plan_counts_as_nothing_found(tmp_path):
    chosen = [*sources()[:1], replace(sources()[1], blind=True)]
    row = ran(chosen, tmp_path, rows=ROWS[1:])["paper-100"]
    good, lost = row["scenes"]
    assert good["failure"] is None
    assert lost["aligned"]["rooms_50"] == [0, 1, 0]
    assert lost["aligned"]["corners"] == [0, 6, 0]
    assert lost["unaligned"]["rooms_30"] == [0, 1, 0]
    assert row["summary"]["aligned"]["rooms_50 recall"] == 0.5
    assert row["summary"]["aligned"]["rooms_50 precision"] == 0.5


@dataclass(frozen=True)
class Breaking(Made):
    """The truth is kept from a good walk; later the walk names a keyframe twice."""

    def key(self):
        return Made(self.name, self.polygon).key()

    def open(self):
        made = super().open()
        return replace(made, keyframes=(made.keyframes[0], *made.keyframes))


def test_a_method_that_fails_is_told_and_counts(kept):
    scene = Breaking("one", sources()[0].polygon)
    row = ran([scene], kept, rows=(Row("paper", 0.5),))["paper-50"]
    assert "an id given before" in row["scenes"][0]["failure"]
    assert row["summary"]["failures"] == 1
    assert row["summary"]["aligned"]["rooms_30 recall"] == 0.0


def test_a_dataset_of_folders(tmp_path):
    made = recording(L_SHAPE)
    numbered = [replace(k, id=str(7 * n + 3)) for n, k in enumerate(made.keyframes)]
    for scene in ("a", "b"):
        write_mp3d_fpe(tmp_path / "root" / scene / "0", numbered, made.truth)
    chosen = mp3d_fpe_scenes(tmp_path / "root")
    assert [source.name for source in chosen] == ["a_0", "b_0"]
    figures = ran(chosen, tmp_path / "out")
    row = figures["paper-100"]
    assert row["summary"]["aligned"]["rooms_50 recall"] == 1.0
    # Nobody knows the camera's height, so metres cannot be told.
    assert row["scenes"][0]["unaligned"] is None
    assert row["summary"]["unaligned"]["rooms_50 recall"] is None
    (path,) = write_methods(figures, "dataset", ROWS, tmp_path)
    data = json.loads(path.read_text())
    assert (path.name, data["benchmark"]) == ("v1-dataset-paper.json", "v1")
    assert data["figures"]["shares"]["1"] == json.loads(json.dumps(row))


def test_the_baseline_needs_a_scan_and_has_one_row(tmp_path):
    plyfile = pytest.importorskip("plyfile", reason="the extra points is not installed")
    made = recording(L_SHAPE)
    numbered = [replace(k, id=str(n + 1)) for n, k in enumerate(made.keyframes)]
    for scene in ("a", "b"):
        write_mp3d_fpe(tmp_path / "root" / scene / "0", numbered, made.truth)
    points = cloud(L_SHAPE)
    rows = np.zeros(len(points), dtype=[(axis, "f4") for axis in "xyz"])
    for k, axis in enumerate("xyz"):
        rows[axis] = points[:, k]
    element = plyfile.PlyElement.describe(rows, "vertex")
    plyfile.PlyData([element]).write(tmp_path / "root" / "a" / "0" / "pcl.ply")
    chosen, rows = mp3d_fpe_scenes(tmp_path / "root"), rows_of(["points"])
    assert [row.name for row in rows] == ["points-100"]
    row = ran(chosen, tmp_path / "out", rows=rows)["points-100"]
    scanned, unscanned = row["scenes"]
    assert scanned["aligned"]["rooms_70"] == [1, 1, 1]
    assert "pcl.ply: found nothing" in unscanned["failure"]
    assert unscanned["aligned"]["rooms_70"] == [0, 1, 0]
    (path,) = write_methods({"points-100": row}, "dataset", rows, tmp_path)
    assert json.loads(path.read_text())["settings"]["preset"] == "points"


def test_a_folder_has_another_key_when_a_byte_of_it_changes(tmp_path):
    made = recording(RECTANGLE)
    numbered = [replace(k, id=str(n + 1)) for n, k in enumerate(made.keyframes)]
    write_mp3d_fpe(tmp_path / "0", numbered, made.truth)
    source = Folder(tmp_path / "0")
    before = source.key()
    assert source.key() == before
    layout = next((tmp_path / "0").glob("vo*/hn_mp3d/*.npy"))
    layout.write_bytes(layout.read_bytes()[:-1] + b"\1")
    assert source.key() != before


@pytest.mark.parametrize("inside", [None, "a/0"])
def test_a_root_without_scenes(tmp_path, inside):
    root = tmp_path / "root"
    if inside:
        (root / inside).mkdir(parents=True)
    with pytest.raises(InputError, match="<root>/<scene>/<version>"):
        mp3d_fpe_scenes(root)
