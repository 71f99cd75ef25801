"""What a run leaves in its folder."""

from dataclasses import replace

import numpy as np
from tests.scenes import RECTANGLE, walk

from panoplan.bench.estimate import estimate
from panoplan.config import Config
from panoplan.datasets.scene import Scene
from panoplan.estimator.state import Walk
from panoplan.formats.run_folder import RunFolder
from panoplan.pipeline import RunOptions, run, summary

SPOTS = np.array([[-1.2, 0.3], [0.4, -0.8], [1.3, 0.7], [-0.5, 0.9]])


def leave(path, *, explain, calls=None):
    scene = Scene("room", "by hand", tuple(walk(RECTANGLE, SPOTS)), np.eye(3), 1.5, "by hand")

    def progress(done, total, title="keyframes"):
        if calls is not None:
            calls.append((title, done, total))

    run(scene, Config(), RunOptions(explain=explain), RunFolder(path), progress)
    return {item.name for item in path.iterdir()}


def test_no_pictures_of_stages_unless_asked_for(tmp_path):
    usual = {"settings.toml", "log.jsonl", "plan.json", "plan.svg", "plan.png"}
    assert leave(tmp_path / "run", explain=False) == usual
    plan = (tmp_path / "run" / "plan.json").read_bytes()
    calls = []
    assert leave(tmp_path / "run", explain=True, calls=calls) == {*usual, "explain"}
    assert (tmp_path / "run" / "plan.json").read_bytes() == plan
    names = {item.name for item in (tmp_path / "run" / "explain").iterdir()}
    assert names == {"1_scale.png", "2_rooms.png", "3_views.png", "4_floors.png"}
    assert calls[-1] == ("pictures", 3, 4)
    assert [call[0].startswith("keyframes, ") for call in calls].count(True) == 4
    # What an earlier run explained is not left beside another plan.
    assert leave(tmp_path / "run", explain=False) == usual


def test_the_summary_says_how_sure_the_scale_is(tmp_path):
    plan = estimate(tuple(walk(RECTANGLE, SPOTS)), Config(), Walk())
    known = replace(plan, scale=replace(plan.scale, sigma=0.012))
    assert " camera heights a trajectory unit ± 1.2 % (entropy)" in summary(known)
    assert "uncertain" not in summary(known)
    assert "uncertain: 4 layouts" in summary(replace(plan, scale=replace(plan.scale, sigma=0.3)))
    assert "unit (entropy)" in summary(replace(plan, scale=replace(plan.scale, sigma=None)))
