"""A network adapted to a walk by its plan, and read back from its file."""

import copy

import numpy as np
import pytest
from PIL import Image
from tests.metrics.plans import plan

torch = pytest.importorskip("torch", reason="the extra train is not installed")

from panoplan.cli.main import main  # noqa: E402
from panoplan.errors import InputError  # noqa: E402
from panoplan.layouts.network import adapt as adapting  # noqa: E402
from panoplan.layouts.network.adapt import put_back  # noqa: E402
from panoplan.layouts.network.calibration import KNOTS_CH  # noqa: E402
from panoplan.layouts.network.data import MEAN, STD  # noqa: E402
from panoplan.layouts.network.export import export  # noqa: E402
from panoplan.layouts.network.head import Head, Heads, LayoutNetwork  # noqa: E402
from panoplan.layouts.network.reload import reload  # noqa: E402
from panoplan.layouts.network.trunk import Trunk  # noqa: E402

SQUARE = np.array([[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0]])


@pytest.fixture(scope="module")
def network():
    """A floor 0.6 rad below the horizon in all columns, give or take 0.1."""
    torch.manual_seed(0)
    made = LayoutNetwork(Trunk(), Heads([Head(), Head()])).eval()
    for head in made.head.heads:
        torch.nn.init.normal_(head.answer.weight, std=1e-3)
        for values in head.parameters():
            # As after training no two are alike; the exporter would keep them once.
            values.data.add_(1e-3 * torch.randn_like(values))
    return made


@pytest.mark.parametrize(
    ("unit", "elevation"), [("ch", np.arctan(1 / 2)), ("m", np.arctan(1.5 / 2))]
)
def test_a_plan_is_put_back_into_its_panoramas_by_hand(unit, elevation):
    """From the middle of a square the nearest place of each wall is two away."""
    floors = put_back(plan([SQUARE], [(2.0, 2.0), (2.0, 1.0), (2.0, 2.0)], unit=unit))
    # The third is in no room.
    assert list(floors) == ["kf0", "kf1"]
    middle = floors["kf0"]
    assert middle.min() == pytest.approx(-elevation, abs=1e-4)
    np.testing.assert_allclose(middle, np.roll(middle, 128), atol=1e-9)
    # One wall is one away; the camera is turned by 0.25 rad towards +x, the wall is behind it.
    turned = floors["kf1"]
    column = (np.pi - 0.25) / (2 * np.pi) * 512 + 255.5
    assert abs(int(turned.argmin()) - column) < 1


def _walk(folder, count):
    rng = np.random.default_rng(0)
    for k in range(count):
        pixels = rng.integers(0, 256, (256, 512, 3), dtype=np.uint8)
        Image.fromarray(pixels).save(folder / f"kf{k}.png")
    return {f"kf{k}": folder / f"kf{k}.png" for k in range(count)}


def test_the_floor_follows_the_plan_and_what_differs_is_left_out(tmp_path, monkeypatch, network):
    for name, value in (("STEPS", 3), ("_BATCH", 1), ("_FEWEST", 1), ("_RATE", 3e-4)):
        monkeypatch.setattr(adapting, name, value)
    images, made = _walk(tmp_path, 2), copy.deepcopy(network)
    # Of the second camera, hard by a wall, the plan says something else than the network.
    walked = plan([SQUARE], [(2.0, 2.0), (0.02, 0.02)], unit="ch")
    told = []
    assert adapting.adapt(made, images, walked, lambda done, total: told.append(done)) == 1
    assert told == [1, 2, 3, 4, 5]
    pixels = torch.from_numpy(np.asarray(Image.open(images["kf0"])).astype(np.float32))
    image = ((pixels - MEAN) / STD).permute(2, 0, 1)[None]
    with torch.no_grad():
        before, after = network(image)[0][0], made(image)[0][0]
    aim = put_back(walked)["kf0"].mean()
    assert abs(after[0].mean() - aim) < abs(before[0].mean() - aim) - 0.005
    assert (after[1:] - before[1:]).abs().mean() < 0.05
    assert all(torch.equal(a, b) for a, b in zip(
        network.trunk.parameters(), made.trunk.parameters(), strict=True
    ))  # fmt: skip
    with pytest.raises(InputError, match="0 of 1 panoramas"):
        adapting.adapt(made, {"another": images["kf0"]}, walked, lambda done, total: None)


def test_a_network_is_read_back_from_its_file(tmp_path, network):
    factors = np.log(np.linspace(1.0, 2.0, len(KNOTS_CH)))
    export(network, tmp_path / "a.onnx", factors)
    again, told = reload(tmp_path / "a.onnx")
    np.testing.assert_allclose(told, factors, atol=1e-5)
    for name, values in network.state_dict().items():
        torch.testing.assert_close(again.state_dict()[name], values, rtol=1e-3, atol=1e-4)


def test_another_file_is_no_network_of_ours(tmp_path):
    (tmp_path / "a.onnx").write_bytes(b"PK nothing")
    with pytest.raises(InputError, match="a network that panoplan model train wrote"):
        reload(tmp_path / "a.onnx")


def test_adapt_needs_a_plan_and_an_output(tmp_path, capsys):
    assert main(["model", "adapt", str(tmp_path), "-o", str(tmp_path / "a.onnx")]) == 2
    assert "--plan PLAN.json" in capsys.readouterr().err
