"""The layout network: folding, turning, likelihood, training, export."""

import copy
import json

import numpy as np
import pytest

torch = pytest.importorskip("torch", reason="the extra train is not installed")

from panoplan.errors import InputError  # noqa: E402
from panoplan.layouts.network import calibration, confidence  # noqa: E402
from panoplan.layouts.network import train as training  # noqa: E402
from panoplan.layouts.network.calibration import KNOTS_CH, Widening  # noqa: E402
from panoplan.layouts.network.confidence import spoilt  # noqa: E402
from panoplan.layouts.network.data import batches  # noqa: E402
from panoplan.layouts.network.export import export  # noqa: E402
from panoplan.layouts.network.finish import together  # noqa: E402
from panoplan.layouts.network.head import OUTPUTS, Head, Heads, LayoutNetwork  # noqa: E402
from panoplan.layouts.network.samples import TARGETS  # noqa: E402
from panoplan.layouts.network.shards import HELD_OUT_SEED  # noqa: E402
from panoplan.layouts.network.trunk import CHANNELS, Trunk, _Conv, _fold  # noqa: E402
from panoplan.layouts.onnx import OnnxLayouts  # noqa: E402

_COUNT = 8


@pytest.fixture(scope="module")
def network():
    torch.manual_seed(0)
    torch.set_num_threads(1)
    made = LayoutNetwork(Trunk(), Head())
    for parameter in made.parameters():
        if parameter.ndim > 1:
            torch.nn.init.kaiming_normal_(parameter, nonlinearity="linear")
    return made.eval()


def _folder(path, *, noise):
    """Two shards of made-up features; where they are informative, they tell the floor."""
    rng = np.random.default_rng(0)
    for number in (0, HELD_OUT_SEED):
        rows = np.zeros((_COUNT, len(TARGETS), 512), dtype=np.float32)
        level = rng.uniform(-1, -0.3, (_COUNT, 1))
        rows[:, 0], rows[:, 1], rows[:, 2] = level, level, -level
        np.save(path / f"targets-{number:07d}.npy", rows)
        for part, channels, size in zip(
            ("shallow", "middle", "deep"), CHANNELS, (32, 16, 8), strict=True
        ):
            values = np.repeat(level[:, :, None, None], channels, axis=1)
            values = values + noise * rng.normal(size=(_COUNT, channels, size, 2 * size))
            np.save(path / f"{part}-{number:07d}.npy", values.astype(np.float16))
    return path


def test_a_folded_normalisation_is_the_normalisation():
    torch.manual_seed(1)
    conv = torch.nn.Conv2d(8, 16, 1, bias=False)
    norm = torch.nn.BatchNorm2d(16, eps=1e-3).eval()
    for value in (norm.weight, norm.running_var):
        torch.nn.init.uniform_(value, 0.5, 2)
    torch.nn.init.normal_(norm.running_mean)
    torch.nn.init.normal_(norm.bias)
    weights = {"c.weight": conv.weight, **{f"n.{k}": v for k, v in norm.state_dict().items()}}
    folded = _Conv(8, 16, 1, 1, depthwise=False, active=False)
    _fold(folded, weights, "c", "n")
    x = torch.randn(2, 8, 5, 7)
    torch.testing.assert_close(folded(x), norm(conv(x)), rtol=1e-4, atol=1e-5)


@torch.no_grad()
def test_turning_the_panorama_turns_the_answer(network):
    image = torch.randn(1, 3, 256, 512)
    (answer, sure), (turned, still) = network(image), network(torch.roll(image, 96, dims=-1))
    torch.testing.assert_close(sure, still, rtol=1e-3, atol=1e-3)
    assert answer.shape == (1, len(OUTPUTS), 512)
    assert answer.std(dim=-1).min() > 0
    torch.testing.assert_close(torch.roll(answer, 96, dims=-1), turned, rtol=1e-3, atol=1e-3)


def test_likelihood_by_hand():
    answer = torch.zeros(1, len(OUTPUTS), 4)
    answer[:, 3:6] = float(np.log(0.1))
    targets = torch.zeros(1, len(TARGETS), 4)
    targets[:, 0] = 0.05
    # Laplace: |Δ|/b + ln b with weights 1, ½, ½; four even coins at a weight of 8.
    expected = 0.05 / 0.1 + 2 * np.log(0.1) + 8 * 4 * np.log(2)
    assert training.loss_of(answer, targets).item() == pytest.approx(expected, rel=1e-5)
    # Half of the columns at a scale four times as large count twice as much as the others.
    answer[:, 3:6, :2] = float(np.log(0.4))
    wide, narrow = 0.05 / 0.4 + np.log(0.4), 0.05 / 0.1 + np.log(0.1)
    floor = (2 * wide + narrow) / 3
    others = (2 * np.log(0.4) + np.log(0.1)) / 3
    assert training.loss_of(answer, targets).item() == pytest.approx(
        floor + others + 8 * 4 * np.log(2), rel=1e-5
    )


def test_batches_turn_features_and_targets_alike(tmp_path):
    folder = _folder(tmp_path, noise=0.0)
    rows = np.zeros((_COUNT, len(TARGETS), 512), dtype=np.float32)
    rows[:, :, 64:96] = 1
    np.save(folder / "targets-0000000.npy", rows)
    shallow = np.zeros((_COUNT, 40, 32, 64), dtype=np.float16)
    shallow[..., 8:12] = 1
    np.save(folder / "shallow-0000000.npy", shallow)
    turns = set()
    for seed in range(6):
        for features, _, _, targets in batches(folder, [0], 8, np.random.default_rng(seed)):
            wide = features[0, 0, 0].repeat_interleave(8)
            torch.testing.assert_close(wide, targets[0, 0])
            turns.add(int(targets[0, 0].argmax()))
    assert len(turns) > 3


@pytest.mark.parametrize("trunk_rate", [0.0, 1e-3])
def test_training_learns_and_goes_on(tmp_path, monkeypatch, network, trunk_rate):
    folder = _folder(tmp_path, noise=0.05)
    monkeypatch.setattr(training, "pretrained", lambda: copy.deepcopy(network.trunk))
    out, told = tmp_path / "run", []
    for steps in (1, 5):
        plan = training.Plan(
            60, steps=steps, batch=8, trunk_rate=trunk_rate, average=0.2, warm_up=1, shards=(0,)
        )
        training.train(folder, out, plan, told.append)
    first, second = (json.loads(line)["loss"] for line in told)
    assert second < first - 0.05
    kept = training.load(out / training.CHECKPOINT)
    assert {"door_f1", "opening_f1", "window_f1"} <= json.loads(told[-1]).keys()
    moved = not training.same(kept.trunk, network.trunk)
    assert moved == (trunk_rate > 0)


def test_mixing_moves_looks_and_leaves_what_is_seen():
    features = [torch.randn(6, 5, 4, 8) * 3 + torch.arange(6.0)[:, None, None, None]]
    (told,) = training.mixed(features, np.random.default_rng(1))

    def looks(x):
        return x.mean((2, 3), keepdim=True), x.std((2, 3), keepdim=True)

    (mean, spread), (new_mean, new_spread) = looks(features[0]), looks(told)
    seen, same = (features[0] - mean) / spread, (told - new_mean) / new_spread
    torch.testing.assert_close(seen, same, atol=1e-2, rtol=1e-2)
    assert (new_mean - mean).abs().max() > 0.5
    assert new_mean.min() >= mean.min() - 1e-3
    assert new_mean.max() <= mean.max() + 1e-3


def test_the_exported_file_says_the_same_and_what_it_is(tmp_path, network):
    path = tmp_path / "layout.onnx"
    export(network, path, np.full(len(KNOTS_CH), np.log(2.0)))
    assert path.stat().st_size < 20e6
    shipped = OnnxLayouts(path, threads=1)
    assert (shipped.spec.height, shipped.spec.width) == (256, 512)
    pixels = np.random.default_rng(0).integers(0, 256, (256, 512, 3), dtype=np.uint8)
    told = shipped(pixels)
    image = torch.from_numpy((pixels.astype(np.float32) - 127) / 128).permute(2, 0, 1)[None]
    with torch.no_grad():
        answer, sure = (part[0].numpy() for part in network(image))
    assert told.confidence == pytest.approx(1 / (1 + np.exp(-sure[0])), rel=1e-3)
    # An untrained network also says what no elevation can be; that is told as unknown.
    known = np.abs(answer[0]) < 1.5
    assert known.mean() > 0.2
    spread = answer[0].std()
    np.testing.assert_allclose(told.floor[known], answer[0][known], atol=0.05 * spread)
    sigma = 2 * np.sqrt(2) * np.exp(answer[3])
    np.testing.assert_allclose(told.sigma[known], sigma[known], rtol=0.3, atol=1e-3)


class _Says(torch.nn.Module):
    def __init__(self, place, scale, chance):
        super().__init__()
        self.rows = [place] * 3 + [float(np.log(scale))] * 3 + [chance] * 4

    def forward(self, shallow, middle, deep):
        return torch.tensor(self.rows)[None, :, None].expand(1, len(OUTPUTS), 8)


def test_heads_are_averaged_by_how_sure_they_are():
    """One says -0.4 ± 0.01, the other -0.7 ± 0.02: two thirds of the first, one of the other."""
    answer = Heads([_Says(-0.4, 0.01, -9.0), _Says(-0.7, 0.02, 3.0)])(None, None, None)[0, :, 0]
    assert answer[0].item() == pytest.approx(-0.5, rel=1e-5)
    square = (0.01**2 + 0.02**2) / 2 + (0.1**2 + 0.2**2) / 2 / 2
    assert answer[3].item() == pytest.approx(np.log(square) / 2, rel=1e-5)
    assert answer[6:].tolist() == [3.0] * 4
    alone = _Says(-0.4, 0.01, 2.0)
    np.testing.assert_allclose(
        Heads([alone, alone])(None, None, None), alone(None, None, None), rtol=1e-5
    )


def test_only_runs_with_the_same_trunk_answer_together(network):
    other = copy.deepcopy(network)
    both = together(network, [("run.pt", other)])
    assert both.trunk is network.trunk
    assert both.sure is network.sure
    assert len(both.head.heads) == 2
    assert together(network, []) is network
    with torch.no_grad():
        other.trunk.stem.conv.bias.add_(1.0)
    with pytest.raises(InputError, match=r"run\.pt.*another trunk"):
        together(network, [("run.pt", other)])


def test_widening_is_linear_in_the_elevation_between_the_knots():
    factors = np.log(np.arange(1.0, len(KNOTS_CH) + 1))
    knots = -np.arctan(1 / np.array(KNOTS_CH))
    places = np.array([-1.5, *knots, (knots[2] + knots[3]) / 2, -0.01])
    wide = Widening(factors)(torch.full((1, len(places)), -3.0), torch.tensor(places[None]).float())
    expected = -3 + np.array([factors[0], *factors, (factors[2] + factors[3]) / 2, factors[-1]])
    np.testing.assert_allclose(wide[0].numpy(), expected, atol=1e-5)


def test_scales_are_widened_where_the_errors_are_wider(tmp_path, monkeypatch, network):
    """All columns are told at 1.2 camera heights or at 3.3, where they err thrice as much."""
    folder, rng = _folder(tmp_path, noise=0.0), np.random.default_rng(0)
    level = -np.arctan(1 / np.where(np.arange(512) < 256, 1.2, 3.3))
    answer = torch.zeros(_COUNT, len(OUTPUTS), 512)
    answer[:, 0], answer[:, 3] = torch.from_numpy(level).float(), float(np.log(0.01))
    rows = np.zeros((_COUNT, len(TARGETS), 512), dtype=np.float32)
    errors = np.where(np.arange(512) < 256, 0.02, 0.06) * rng.laplace(size=(_COUNT, 512))
    rows[:, 0] = level + errors
    np.save(folder / "targets-0000000.npy", rows)
    monkeypatch.setattr(calibration, "answer_of", lambda *a, **k: answer)
    factors = np.exp(calibration.widening(network, folder, [0], tuned=False))
    np.testing.assert_allclose(factors[KNOTS_CH.index(1.2)], 2.0, rtol=0.15)
    np.testing.assert_allclose(factors[KNOTS_CH.index(3.3)], 6.0, rtol=0.15)
    # Nothing is known of what is nearer than all; what is farther is as what is a little nearer.
    assert factors[0] == 1.0
    assert factors[-1] == factors[KNOTS_CH.index(3.3)]
    answer[:, 3] = 0.0
    np.testing.assert_array_equal(calibration.widening(network, folder, [0], tuned=False), 0.0)


@pytest.mark.parametrize("seed", range(12))
def test_what_is_spoilt_is_no_upright_panorama(seed):
    """Rows of an image that is dark below and bright above."""
    image = np.zeros((256, 512, 3), dtype=np.uint8)
    image[:128], image[128:] = 200, 50
    wrong = spoilt(image, np.random.default_rng(seed))
    assert wrong.shape == image.shape
    assert wrong.dtype == np.uint8
    off = np.abs(wrong.astype(float) - image).mean()
    # A part of it may be alike, stretched; all others are far off.
    assert off > 20 or wrong[:40].std() < 1


def test_confidence_is_learnt_from_what_is_spoilt(tmp_path, monkeypatch, network):
    """A featuriser that tells only how bright the upper half is."""
    image = np.zeros((256, 512, 3), dtype=np.uint8)
    image[:128], image[128:] = 200, 50
    for number in (0, HELD_OUT_SEED):
        np.save(tmp_path / f"images-{number:07d}.npy", np.repeat(image[None], 12, axis=0))

    class Brightness:
        def __init__(self, trunk):
            pass

        def __call__(self, image):
            rows = image.reshape(8, 32, 512, 3).mean(axis=(1, 2, 3)) / 255
            return [np.tile(rows[None, :, None], (320, 1, 16)).astype(np.float32)]

    monkeypatch.setattr(confidence, "Featuriser", Brightness)
    monkeypatch.setattr(confidence, "spoilt", lambda image, rng: image[::-1])
    made = copy.deepcopy(network)
    assert confidence.fit(made, tmp_path, [0], HELD_OUT_SEED) == (1.0, 1.0)
