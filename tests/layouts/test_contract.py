import json

import pytest
from tests.networks import metadata

from panoplan.errors import InputError
from panoplan.layouts.contract import METADATA_KEY, parse_spec, spec_json


def test_a_spec_is_read_as_written():
    told = metadata(
        pixel_centre=0, input={"tensor": "x", "height": 256, "width": 512, "mean": [127, 1, 2.5]}
    )
    spec = parse_spec(json.dumps(told), "model")
    assert (spec.tensor, spec.height, spec.width, spec.pixel_centre) == ("x", 256, 512, 0)
    assert spec.mean == (127, 1, 2.5)
    assert spec.std == (255, 255, 255)
    assert spec.outputs["floor_boundary"].channel == 1
    assert parse_spec(spec_json(spec), "model") == spec


def test_other_fields_are_kept():
    spec = parse_spec(json.dumps(metadata(trained_on="renders")), "model")
    assert spec.extra == {"trained_on": "renders"}
    assert json.loads(spec_json(spec))["trained_on"] == "renders"


FLOOR = {"tensor": "rows", "meaning": "depression"}


@pytest.mark.parametrize(
    ("changes", "told"),
    [
        ({"format": 2}, "format 1"),
        ({"input": {"tensor": "x", "height": 256}}, "input.width"),
        ({"input": {"tensor": "x", "height": 256, "width": 10**9}}, "16 to 8192"),
        ({"input": {"height": 256, "width": 512}}, "tensor"),
        ({"input": {"tensor": "x", "height": 256, "width": 512, "std": [1, 0, 1]}}, "above 0"),
        ({"input": {"tensor": "x", "height": 256, "width": 512, "mean": [1]}}, "three numbers"),
        ({"outputs": {"corners": {"tensor": "rows", "meaning": "logit"}}}, "floor_boundary"),
        ({"outputs": {"floor_boundary": {"tensor": "rows", "meaning": "rows"}}}, "depression"),
        ({"outputs": {"floor_boundary": FLOOR, "flor": FLOOR}}, "an output not known"),
        ({"outputs": {"floor_boundary": {**FLOOR, "channel": -1}}}, "channel"),
        ({"outputs": []}, "dict"),
        ({"pixel_centre": "middle"}, "a number"),
    ],
)
def test_a_wrong_spec_is_refused_with_the_place(changes, told):
    with pytest.raises(InputError, match=told) as caught:
        parse_spec(json.dumps(metadata(**changes)), "model.onnx")
    assert f"model.onnx, {METADATA_KEY}" in str(caught.value)


@pytest.mark.parametrize("text", ["", "[]", "{", "[" * 5000, "x" * 100_000])
def test_what_is_no_object_is_refused(text):
    with pytest.raises(InputError, match="no JSON object"):
        parse_spec(text, "model.onnx")
