import sys
from dataclasses import replace

import numpy as np
import pytest
from tests.metrics.plans import plan
from tests.scenes import RECTANGLE, exact_layout, walk, yaw

from panoplan.cli.main import main
from panoplan.errors import InputError, MissingExtraError
from panoplan.formats.sequence import write_sequence
from panoplan.types.plan import PlanPose
from panoplan.viewers.live import LiveView, _boundary_points


def test_boundary_points_lie_on_the_walls():
    camera, heading = np.array([0.4, -0.3]), 0.7
    layout = exact_layout(RECTANGLE, camera, yaw(heading), width=256)
    pose = PlanPose("k", 1.5 * camera, heading, None)
    points = _boundary_points(pose, layout.floor_boundary, 1.5)
    away = np.abs(np.abs(points / 1.5) - [2.0, 1.5]).min(axis=1)
    assert len(points) == 256
    assert away.max() < 0.03


def test_a_run_is_recorded(tmp_path, capsys):
    pytest.importorskip("rerun", reason="the extra 'live' is not installed")
    cameras = np.random.default_rng(0).uniform([-1.4, -0.9], [1.4, 0.9], (12, 2))
    write_sequence(tmp_path / "room", "room", walk(RECTANGLE, cameras))
    file = tmp_path / "run.rrd"
    words = ["run", str(tmp_path / "room"), "-o", str(tmp_path / "plan")]
    assert main([*words, "--live", str(file)]) == 0
    assert "room_01: 12." in capsys.readouterr().out
    data = file.read_bytes()
    assert data.startswith(b"RRF2")
    for entity in ("plan/rooms", "plan/walls", "plan/path", "image/boundary", "density"):
        assert entity.encode() in data


def test_a_file_that_cannot_be_written_is_told(tmp_path):
    pytest.importorskip("rerun", reason="the extra 'live' is not installed")
    with pytest.raises(InputError, match="folder that exists"):
        LiveView(tmp_path / "missing" / "run.rrd", {})


def test_what_is_missing_is_told(monkeypatch):
    monkeypatch.setitem(sys.modules, "rerun", None)
    with pytest.raises(MissingExtraError, match=r"rerun-sdk.*panoplan\[live\]"):
        LiveView(None, {})


def test_a_plan_without_rooms_is_shown(tmp_path):
    pytest.importorskip("rerun", reason="the extra 'live' is not installed")
    view = LiveView(tmp_path / "run.rrd", {})
    view.show_plan(plan((), ()))
    view.show_plan(plan())
    view.close()
    assert (tmp_path / "run.rrd").stat().st_size > 1000


def test_cameras_without_a_place_make_no_density(tmp_path):
    pytest.importorskip("rerun", reason="the extra 'live' is not installed")
    (keyframe,) = walk(RECTANGLE, np.array([[0.4, -0.3]]))
    for name, known in (("waiting", None), ("placed", 1.0)):
        view = LiveView(tmp_path / name, {})
        made = plan()
        pose = replace(made.trajectory[0], id=keyframe.id)
        made = replace(made, trajectory=(pose,), scale=replace(made.scale, ch_per_su=known))
        view.update(0, keyframe, (), lambda made=made: made)
        view.close()
    shown = [b"/density" in (tmp_path / name).read_bytes() for name in ("waiting", "placed")]
    assert shown == [False, True]
