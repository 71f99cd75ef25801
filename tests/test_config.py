import dataclasses
import tomllib

import pytest
import tomli_w

from panoplan.config import NOT_PRINTED, PRESETS, Config, as_dict, override, preset
from panoplan.errors import ConfigError


def _fields(node, path=""):
    for item in dataclasses.fields(node):
        value = getattr(node, item.name)
        if dataclasses.is_dataclass(value):
            yield from _fields(value, f"{path}{item.name}.")
        else:
            yield f"{path}{item.name}", item, value


def test_every_setting_says_what_it_is():
    for name, item, _ in _fields(Config()):
        assert item.metadata["doc"].endswith("."), name


@pytest.mark.parametrize("name", PRESETS)
def test_presets_survive_toml(name):
    config = preset(name)
    data = tomllib.loads(tomli_w.dumps(as_dict(config)))
    assert override(Config(), data) == config


def test_the_paper_preset_has_what_the_paper_prints():
    for name, item, value in _fields(preset("paper")):
        printed = item.metadata["paper"]
        if printed not in (NOT_PRINTED, "unlimited", "all"):
            assert value == printed, name


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"room": {}}, "expected rooms"),
        ({"rooms": {"treshold": 0.4}}, "expected rooms.threshold"),
        ({"rooms": {"threshold": 1.5}}, "0.0 to 1.0"),
        ({"rooms": {"threshold": "high"}}, "float"),
        ({"rooms": {"normalise": "none"}}, "coverage"),
        ({"rooms": 3}, "a table"),
        ({"scale": {"steps": []}}, "tuple"),
        ({"seed": True}, "int"),
        ({"planes": {"max_residual_ch": float("nan")}}, "float"),
        ({"adjust": {"odometry_multiples": [0.5, 0.5]}}, "increasing"),
        ({"misplaced": {"conflict_share": 0.2}}, "more than innocent_share = 0.2"),
    ],
)
def test_unknown_and_unfitting_settings_are_refused(changes, message):
    with pytest.raises(ConfigError, match=message):
        override(Config(), changes)


def test_an_unknown_preset_is_refused_with_the_known_ones():
    with pytest.raises(ConfigError, match="default or paper or released or sound"):
        preset("best")
