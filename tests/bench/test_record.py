import json
import subprocess

import numpy as np
import pytest

from panoplan.bench.record import commit, record, to_json


def test_a_files_text_is_json_without_nan():
    told = {"a": [1.5, float("nan"), (np.float64("nan"), 2)], "b": {"c": float("nan"), "d": None}}
    text = to_json(told)
    assert json.loads(text, parse_constant=pytest.fail) == {
        "a": [1.5, None, [None, 2]],
        "b": {"c": None, "d": None},
    }
    assert text.endswith("}\n")


def test_what_is_infinite_is_refused():
    with pytest.raises(ValueError, match="JSON"):
        to_json({"a": float("inf")})


def test_the_commit_is_that_at_the_beginning(monkeypatch):
    def answer(text):
        done = subprocess.CompletedProcess([], 0, f"{text}\n")
        monkeypatch.setattr(subprocess, "run", lambda *args, **kwargs: done)

    commit.cache_clear()
    answer("before")
    assert commit() == "before"
    answer("after")
    assert record("b", {}, {})["commit"] == "before"
    commit.cache_clear()
