"""What panoplan bench refuses before anything is measured."""

import pytest

from panoplan.cli.main import main


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["runtime", "-o", "nowhere/runtime.json"], "nowhere/runtime.json: found no folder for it"),
        (["home", "-o", "home.json"], "expected bench home PATH"),
        (
            ["exports", "home", "--predict"],
            "--predict: found bench exports; expected bench home or",
        ),
        (["v1", "--predict"], "--predict: found bench v1; expected bench home or bench tour"),
        (["tour", "tours", "--live"], "--live: found bench tour; expected bench odometry"),
        (["odometry", "nowhere"], "nowhere: found no folder"),
        (["odometry", "."], "found no trajectory_gt.tum"),
    ],
)
def test_what_cannot_be_measured_is_told_at_once(words, told, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert main(["bench", *words, "--quiet"]) == 2
    assert told in capsys.readouterr().err
    assert not list(tmp_path.iterdir())
