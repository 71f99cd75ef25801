"""What the README says is true: its program runs, its tables are those measured."""

import re
import shlex
from pathlib import Path

import numpy as np
import pytest
from tests.scenes import RECTANGLE, walk

from panoplan.bench.table import updated
from panoplan.cli import main as command_line

ROOT = Path(__file__).parents[1]
README = ROOT / "README.md"


def _blocks(language):
    return re.findall(rf"```{language}\n(.*?)```", README.read_text(encoding="utf-8"), re.DOTALL)


def test_the_live_example_runs(capsys):
    (program,) = _blocks("python")
    assert program.count("\n") <= 30
    cameras = np.random.default_rng(2).uniform([-1.4, -0.9], [1.4, 0.9], (30, 2))

    def your_camera():
        for keyframe in walk(RECTANGLE, cameras, factor=3.0):
            pose = keyframe.pose
            yield keyframe.id, pose.rotation, pose.translation, keyframe.layout.floor_boundary

    names = {"your_camera": your_camera}
    exec(compile(program, str(README), "exec"), names)
    # So short a walk gets its scale at its end.
    assert capsys.readouterr().out.count("KeyframeWaiting") == len(cameras)
    assert names["plan"].scale.ch_per_su == pytest.approx(3.0, rel=0.02)
    (room,) = names["plan"].rooms
    assert np.sort(np.ptp(room.polygon, axis=0)) == pytest.approx([3.0, 4.0], rel=0.02)
    assert len(room.polygon) == 4


def test_its_commands_are_understood():
    text = README.read_text(encoding="utf-8")
    commands = re.findall(r"`(panoplan [^`]+)`", text) + re.findall(r"bin/(panoplan [^\n]+)", text)
    assert commands
    for command in commands:
        words = shlex.split(command)[1:]
        if "--version" not in words and "--help" not in words:
            command_line.parser().parse_args(words)


@pytest.mark.parametrize("page", [README, ROOT / "docs" / "benchmarks.md"])
def test_tables_are_those_measured(page):
    text = page.read_text(encoding="utf-8")
    # Raises where there is no place for tables.
    assert updated(text, ROOT / "benchmarks", page) == text
