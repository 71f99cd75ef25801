import json
from dataclasses import replace

import numpy as np
import pytest
from tests.scenes import RECTANGLE, walk

from panoplan.cli.main import main
from panoplan.formats.mp3d_fpe import write_mp3d_fpe
from panoplan.types.pose import Trajectory
from panoplan.types.truth import GroundTruth, TruePlan, TrueRoom


@pytest.fixture
def root(tmp_path):
    cameras = np.array([[x, z] for x in (-1.4, -0.7, 0.0) for z in (-1.0, -0.6)])
    keyframes = walk(RECTANGLE, cameras)
    numbered = [replace(k, id=str(number + 1)) for number, k in enumerate(keyframes)]
    true = Trajectory(
        tuple(k.id for k in numbered),
        np.array([k.pose.rotation for k in numbered]),
        np.array([k.pose.translation for k in numbered]),
    )
    truth = GroundTruth(TruePlan((TrueRoom("room_01", "", RECTANGLE),)), true)
    write_mp3d_fpe(tmp_path / "root" / "scene" / "0", numbered, truth)
    return tmp_path / "root"


def test_the_dataset_is_scored_by_one_command(root, tmp_path, capsys):
    words = ["bench", "--dataset", "mp3d-fpe", "--root", str(root), "--methods", "paper"]
    assert main([*words, "--quiet", "-o", str(tmp_path / "out")]) == 0
    path = tmp_path / "out" / "v1-dataset-paper.json"
    assert capsys.readouterr().out.splitlines()[:-1] == [str(path)]
    data = json.loads(path.read_text())
    assert data["settings"]["preset"] == "paper"
    (scene,) = data["figures"]["shares"]["0.2"]["scenes"]
    assert (scene["scene"], scene["aligned"]["rooms_70"]) == ("scene_0", [1, 1, 1])
    plan = tmp_path / "out" / "predictions" / "scene_0" / "paper-20.json"
    assert main(["eval", str(plan), str(tmp_path / "out" / "scenes" / "scene_0")]) == 2
    assert main(["eval", str(plan), str(root / "scene" / "0"), "--align", "scale"]) == 0


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["-o", "x", "--family", "castle"], "found castle; expected"),
        (["-o", "x", "--dataset", "mp3d-fpe"], "expected --root FOLDER"),
        (["-o", "x", "--dataset", "mp3d-fpe", "--root", "nowhere"], "nowhere: found no folder"),
        (["-o", "x", "--ablate", "--dataset", "mp3d-fpe", "--root", "x"], "simulated buildings"),
        (["-o", "x", "--set", "seed=1"], "expected --methods"),
        ([], "expected -o FOLDER"),
    ],
)
def test_usage(tmp_path, monkeypatch, capsys, words, told):
    monkeypatch.chdir(tmp_path)
    assert main(["bench", "v1", "--quiet", *words]) == 2
    assert told in capsys.readouterr().err


def test_a_root_that_is_another_dataset_is_told(tmp_path, capsys):
    (tmp_path / "home" / "layouts_pred").mkdir(parents=True)
    words = ["bench", "--dataset", "mp3d-fpe", "--root", str(tmp_path), "-o", str(tmp_path / "x")]
    assert main([*words, "--quiet"]) == 2
    assert "<root>/<scene>/<version>/vo*/keyframe_list.txt" in capsys.readouterr().err
    assert main(["bench"]) == 2
    assert "nothing to measure" in capsys.readouterr().err


@pytest.mark.parametrize(
    "words",
    [
        ["--seeds", "9-3"],
        ["--seeds", "a"],
        ["--seeds", "1-x"],
        ["--seeds", "1-²"],
        ["--methods", "best"],
        ["--jobs", "0"],
        ["--jobs", "many"],
        ["--flats", "0"],
        ["--trials", "-1"],
    ],
)
def test_words_that_do_not_parse(words, capsys):
    with pytest.raises(SystemExit) as stop:
        main(["bench", "v1", "-o", "x", *words])
    assert stop.value.code == 2
    assert "expected" in capsys.readouterr().err
