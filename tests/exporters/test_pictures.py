import subprocess
import sys
from xml.etree import ElementTree

import matplotlib.image
import numpy as np
import pytest
from tests.metrics.plans import FLAT, plan

from panoplan.errors import InputError
from panoplan.exporters.drawing import plan_figure
from panoplan.exporters.pictures import write_picture, write_plan_pictures
from panoplan.exporters.png import write_png
from panoplan.exporters.svg import drawing_scale, write_svg

SVG = "{http://www.w3.org/2000/svg}"


def test_png_is_large_and_not_blank(tmp_path):
    write_png(tmp_path / "plan.png", plan())
    image = matplotlib.image.imread(tmp_path / "plan.png")
    assert max(image.shape[:2]) >= 1600
    assert min(image.shape[:2]) >= 800
    # White at the edges: nothing is cropped there.
    for edge in (image[0], image[-1], image[:, 0], image[:, -1]):
        assert np.all(edge == 1.0)
    assert (image[..., :3].min(axis=2) < 0.5).mean() > 0.005


def test_svg_is_xml_with_a_group_a_layer(tmp_path):
    write_svg(tmp_path / "plan.svg", plan(names=["<Hall> & $a$", "客厅", "Küche"]))
    root = ElementTree.parse(tmp_path / "plan.svg").getroot()
    groups = {node.get("id") for node in root.iter(f"{SVG}g")}
    assert {"rooms", "walls", "openings", "path", "corners", "labels", "scale"} <= groups
    assert {"fill_room_01", "outline_room_03", "doors", "windows"} <= groups
    told = {node.text for node in root.iter(f"{SVG}text")}
    assert {"<Hall> & $a$", "客厅", "Küche", "12.0 m²"} <= told


def test_svg_of_a_metric_plan_is_in_true_scale(tmp_path):
    made = plan()
    assert drawing_scale(made) == 50
    assert drawing_scale(plan((20 * FLAT[0],), ())) == 200
    assert drawing_scale(plan(unit="ch")) is None
    assert drawing_scale(plan((1e5 * FLAT[0],), ())) is None
    write_svg(tmp_path / "plan.svg", made)
    root = ElementTree.parse(tmp_path / "plan.svg").getroot()
    fill = next(node for node in root.iter(f"{SVG}g") if node.get("id") == "fill_room_01")
    path = next(fill.iter(f"{SVG}path")).get("d").replace("M", " ").replace("L", " ")
    points = np.array([float(x) for x in path.replace("z", " ").split()]).reshape(-1, 2)
    width_pt = np.ptp(points[:, 0])
    assert root.get("width").endswith("pt")
    assert width_pt / 72 * 0.0254 == pytest.approx(4.0 / 50, rel=1e-3)


@pytest.mark.parametrize("unit", ["m", "ch"])
def test_pictures_are_the_same_for_the_same_plan(tmp_path, unit):
    first, second = tmp_path / "a", tmp_path / "b"
    for folder in (first, second):
        folder.mkdir()
        write_plan_pictures(folder, plan(unit=unit))
    for name in ("plan.png", "plan.svg"):
        assert (first / name).read_bytes() == (second / name).read_bytes()
    assert b"<dc:date>" not in (first / "plan.svg").read_bytes()


def test_pictures_use_no_global_figure(tmp_path):
    code = (
        "import sys; from pathlib import Path; from tests.metrics.plans import plan;"
        "from panoplan.exporters.pictures import write_plan_pictures;"
        f"write_plan_pictures(Path({str(tmp_path)!r}), plan());"
        "assert 'matplotlib.pyplot' not in sys.modules"
    )
    subprocess.run([sys.executable, "-W", "error", "-c", code], check=True)


def test_drawing_is_not_loaded_before_it_is_needed():
    code = "import sys, panoplan.exporters.pictures; assert 'matplotlib' not in sys.modules"
    subprocess.run([sys.executable, "-c", code], check=True)


def test_other_suffixes_are_refused(tmp_path):
    with pytest.raises(InputError, match=r"\.png or \.svg"):
        write_picture(tmp_path / "plan.jpg", plan_figure(plan()))
    with pytest.raises(InputError, match="can be written"):
        write_png(tmp_path / "missing" / "plan.png", plan())
    assert not list(tmp_path.iterdir())
