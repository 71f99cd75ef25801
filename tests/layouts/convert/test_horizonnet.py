import subprocess
import sys

import numpy as np
import pytest

torch = pytest.importorskip("torch", reason="needs the extra train")

from panoplan.errors import InputError  # noqa: E402
from panoplan.layouts.convert.checkpoints import convert  # noqa: E402
from panoplan.layouts.convert.horizonnet import HorizonNet  # noqa: E402
from panoplan.layouts.onnx import OnnxLayouts  # noqa: E402


def norm(name, channels):
    """Names and shapes of a batch normalisation."""
    parts = {f"{name}.{p}": (channels,) for p in ("weight", "bias", "running_mean", "running_var")}
    return {**parts, f"{name}.num_batches_tracked": ()}


def published_shapes(depths=(3, 4, 6, 3)):
    """Names and shapes in the authors' resnet50 checkpoints with an LSTM, written down by rule.

    Convolutions wider than one pixel lie behind a padding, hence the ".1" in their names.
    """
    encoder = "feature_extractor.encoder"
    shapes = {f"{encoder}.conv1.1.weight": (64, 3, 7, 7), **norm(f"{encoder}.bn1", 64)}
    inputs = 64
    for k, depth in enumerate(depths):
        width = 64 * 2**k
        for number in range(depth):
            block = f"{encoder}.layer{k + 1}.{number}"
            shapes[f"{block}.conv1.weight"] = (width, inputs, 1, 1)
            shapes[f"{block}.conv2.1.weight"] = (width, width, 3, 3)
            shapes[f"{block}.conv3.weight"] = (4 * width, width, 1, 1)
            for n, channels in enumerate((width, width, 4 * width), start=1):
                shapes |= norm(f"{block}.bn{n}", channels)
            if number == 0:
                shapes[f"{block}.downsample.0.weight"] = (4 * width, inputs, 1, 1)
                shapes |= norm(f"{block}.downsample.1", 4 * width)
            inputs = 4 * width
    for k, c in enumerate((256, 512, 1024, 2048)):
        sizes = (c, c // 2, c // 2, c // 4, c // 8)
        for n in range(4):
            layers = f"reduce_height_module.ghc_lst.{k}.layer.{n}.layers"
            shapes[f"{layers}.0.1.weight"] = (sizes[n + 1], sizes[n], 3, 3)
            shapes[f"{layers}.0.1.bias"] = (sizes[n + 1],)
            shapes |= norm(f"{layers}.1", sizes[n + 1])
    for layer in range(2):
        for way in ("", "_reverse"):
            end = f"l{layer}{way}"
            shapes[f"bi_rnn.weight_ih_{end}"] = (2048, 1024)
            shapes[f"bi_rnn.weight_hh_{end}"] = (2048, 512)
            shapes[f"bi_rnn.bias_ih_{end}"] = shapes[f"bi_rnn.bias_hh_{end}"] = (2048,)
    return {**shapes, "linear.weight": (12, 1024), "linear.bias": (12,)}


def test_names_and_shapes_are_those_of_the_published_checkpoints():
    with torch.device("meta"):
        network = HorizonNet("resnet50", True)
    assert {n: tuple(w.shape) for n, w in network.state_dict().items()} == published_shapes()
    assert sum(p.numel() for p in network.parameters()) == pytest.approx(81.57e6, rel=1e-3)


@pytest.fixture(scope="module")
def small():
    torch.manual_seed(0)
    network = HorizonNet("resnet18", False).eval()
    for module in network.modules():
        if isinstance(module, torch.nn.BatchNorm2d):
            module.running_var.uniform_(0.5, 1.5)
            module.running_mean.uniform_(-0.1, 0.1)
    return network


def saved(network, path, **changes):
    kwargs = {"backbone": "resnet18", "use_rnn": network.use_rnn}
    data = {"args": {"id": "x"}, "kwargs": kwargs, "state_dict": network.state_dict()}
    torch.save({**data, **changes}, path)
    return path


def test_a_checkpoint_converted_answers_as_the_network(small, tmp_path):
    spec = convert(saved(small, tmp_path / "a.pth"), tmp_path / "a.onnx")
    assert spec.name == "HorizonNet"
    pixels = np.random.default_rng(0).integers(0, 255, (512, 1024, 3)).astype(np.uint8)
    told = OnnxLayouts(tmp_path / "a.onnx")(pixels)
    image = torch.from_numpy(pixels.transpose(2, 0, 1)[None].astype(np.float32) / 255)
    with torch.no_grad():
        boundary, corners = (t.numpy()[0].astype(float) for t in small(image))
    np.testing.assert_allclose(told.ceiling, -boundary[0], atol=1e-4)
    np.testing.assert_allclose(told.floor, -boundary[1], atol=1e-4)
    np.testing.assert_allclose(told.chances["corners"], 1 / (1 + np.exp(-corners[0])), atol=1e-4)


def test_turning_the_panorama_turns_the_answer(small):
    image = torch.rand(1, 3, 512, 1024)
    with torch.no_grad():
        answer = small(image)[0]
        turned = small(image.roll(256, dims=3))[0].roll(-256, dims=2)
    # The pooling does not go around; its one column of 256 reaches a little further.
    middle = slice(200, 824)
    np.testing.assert_allclose(turned[0, :, middle], answer[0, :, middle], atol=2e-3)


class Evil:
    def __reduce__(self):
        return (print, ("run",))


@pytest.mark.parametrize(
    ("changes", "told"),
    [
        ({"kwargs": {"backbone": "resnet50", "use_rnn": False}}, "state_dict"),
        ({"kwargs": {"backbone": "vgg", "use_rnn": True}}, "resnet18"),
        ({"kwargs": None}, "another network"),
        ({"state_dict": {"x": 1}}, "state_dict"),
        ({"extra": Evil()}, "no plain checkpoint"),
    ],
)
def test_other_checkpoints_are_refused_and_not_run(small, tmp_path, changes, told, capsys):
    path = saved(small, tmp_path / "a.pth", **changes)
    with pytest.raises(InputError, match=told):
        convert(path, tmp_path / "a.onnx")
    assert "run" not in capsys.readouterr().out
    assert not (tmp_path / "a.onnx").exists()


def test_without_torch_the_extra_is_named(small, tmp_path):
    path = saved(small, tmp_path / "a.pth")
    code = (
        "import sys; sys.modules['torch'] = None\n"
        "from panoplan.cli.main import main\n"
        f"sys.exit(main(['model', 'convert', {str(path)!r}, '-o', 'x.onnx']))"
    )
    ran = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert ran.returncode == 2
    assert "pip install 'panoplan[train]'" in ran.stderr
