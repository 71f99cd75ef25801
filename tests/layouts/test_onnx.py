import subprocess
import sys

import numpy as np
import onnx
import pytest
from tests.networks import WIDTH, brightness_network, metadata, painted

from panoplan.errors import InputError
from panoplan.layouts.onnx import OnnxLayouts

FLOOR = np.linspace(0.4, 0.9, WIDTH)


@pytest.fixture(scope="module")
def network_file(tmp_path_factory):
    return brightness_network(tmp_path_factory.mktemp("network") / "brightness.onnx")


def test_the_known_answer(network_file):
    told = OnnxLayouts(network_file)(painted(FLOOR, corners=[10, 40]))
    np.testing.assert_allclose(told.floor, -FLOOR, atol=1 / 500)
    np.testing.assert_allclose(told.ceiling, FLOOR / 2, atol=1 / 500)
    assert np.flatnonzero(told.chances["corners"] > 0.5).tolist() == [10, 40]


def test_normalisation_is_that_of_the_file(tmp_path):
    told = metadata(
        input={"tensor": "image", "height": 32, "width": 64, "mean": [0, 51, 0], "std": [255] * 3}
    )
    dense = OnnxLayouts(brightness_network(tmp_path / "n.onnx", told))(painted(FLOOR))
    np.testing.assert_allclose(dense.floor, -(FLOOR - 51 / 255), atol=1 / 500)


@pytest.mark.parametrize("averaging", [("flip",), ("rotate",), ("flip", "rotate")])
def test_averaging_a_network_that_does_not_mind_changes_nothing(network_file, averaging):
    image = painted(FLOOR, corners=[10])
    plain, averaged = OnnxLayouts(network_file)(image), OnnxLayouts(network_file, averaging)(image)
    np.testing.assert_allclose(averaged.floor, plain.floor, atol=1e-6)
    np.testing.assert_allclose(averaged.chances["corners"], plain.chances["corners"], atol=1e-6)
    np.testing.assert_allclose(averaged.sigma, 0, atol=1e-6)


def test_what_averaging_is_part_of_the_fingerprint(network_file):
    one, other = OnnxLayouts(network_file), OnnxLayouts(network_file, ["flip"])
    assert one.fingerprint == OnnxLayouts(network_file).fingerprint
    assert one.fingerprint != other.fingerprint


@pytest.mark.parametrize(
    ("told", "message"),
    [
        (metadata(input={"tensor": "x", "height": 32, "width": 64}), "one input x"),
        (metadata(input={"tensor": "image", "height": 64, "width": 128}), "128"),
        (
            metadata(outputs={"floor_boundary": {"tensor": "y", "meaning": "depression"}}),
            r"\['y'\], too",
        ),
    ],
)
def test_metadata_that_the_model_contradicts_is_refused(tmp_path, told, message):
    with pytest.raises(InputError, match=message):
        OnnxLayouts(brightness_network(tmp_path / "n.onnx", told))


def test_a_model_without_metadata_is_refused(tmp_path, network_file):
    model = onnx.load(network_file)
    del model.metadata_props[:]
    onnx.save(model, tmp_path / "bare.onnx")
    with pytest.raises(InputError, match=r"panoplan model convert"):
        OnnxLayouts(tmp_path / "bare.onnx")


def test_what_is_no_model_is_refused(tmp_path):
    (tmp_path / "a.onnx").write_bytes(b"\x80\x04 not a model")
    with pytest.raises(InputError, match="no ONNX model"):
        OnnxLayouts(tmp_path / "a.onnx")


def test_without_onnxruntime_the_extra_is_named(network_file):
    code = (
        "import sys; sys.modules['onnxruntime'] = None\n"
        "from panoplan.layouts.onnx import OnnxLayouts\n"
        f"from pathlib import Path\nOnnxLayouts(Path({str(network_file)!r}))"
    )
    ran = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert "pip install 'panoplan[images]'" in ran.stderr
