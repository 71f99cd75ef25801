import base64
import hashlib
import json
import re
from dataclasses import replace
from html.parser import HTMLParser

import numpy as np
import pytest
import shapely
from tests.exporters.model.painted import painted_plan, write_panoramas
from tests.exporters.storeys import ODD_NAMES, flat, two_storeys
from tests.metrics.plans import FLAT, plan, square

from panoplan.errors import InputError
from panoplan.exporters.report.page import report_html


class Page(HTMLParser):
    """Tags with their attributes, and the text in scripts and style."""

    def __init__(self, text):
        super().__init__()
        self.tags, self.content = [], {}
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        self.tags.append((tag, dict(attrs)))

    def handle_data(self, data):
        self.content.setdefault(self.tags[-1][0] if self.tags else "", []).append(data)


def page_of(made, title="Flat", images=None, model=b"glTF"):
    text = report_html(made, title, images or {}, lambda: model).decode("utf-8")
    page = Page(text)
    scripts = [part.strip() for part in page.content["script"] if part.strip()]
    return text, page, json.loads(scripts[0]), scripts[-1]


def test_it_holds_all_it_shows():
    text, page, data, _ = page_of(two_storeys())
    assert not any("src" in attrs or "href" in attrs for _, attrs in page.tags)
    assert [s["name"] for s in data["storeys"]] == ["Level 0", "Level 1"]
    rooms = [room for storey in data["storeys"] for room in storey["rooms"]]
    assert [room["area"] for room in rooms] == pytest.approx([12, 11.4, 10.44, 12])
    assert rooms[0]["area_sigma"] == 0.2
    assert rooms[0]["walls"][0] == {
        "id": "wall_00", "length": 4.0, "length_sigma": 0.03, "sigma": 0.02,
    }  # fmt: skip
    assert rooms[0]["keyframes"] == ["kf0"]
    assert data["missing"][0]["reason"] == "no closed path"
    assert data["skipped"][0] == {
        "keyframe": "kf9",
        "what": "wall",
        "reason": "seen edge-on",
        "count": 3,
    }
    assert data["scale"]["curve"] == [[0.1, 3.0], [0.5, 1.25]]
    assert "camera height: ± 2.0 %" in data["metres"]
    assert base64.b64decode(data["model"]) == b"glTF"
    assert "MIT" in data["notices"]
    assert len(text) < 3_000_000


def test_only_its_own_script_may_run():
    text, page, _, _ = page_of(flat())
    (policy,) = (
        a["content"] for t, a in page.tags if a.get("http-equiv") == "Content-Security-Policy"
    )
    script = re.findall(r"<script>(.*?)</script>", text, re.DOTALL)
    assert len(script) == 1
    digest = base64.b64encode(hashlib.sha256(script[0].encode()).digest()).decode()
    assert f"script-src 'sha256-{digest}'" in policy
    assert "default-src 'none'" in policy


def test_names_are_data():
    names = [*ODD_NAMES[:2], "</script><img src=x onerror=alert(1)><!--", "x" * 10_000]
    made = plan((*FLAT, square(8, 0, 3.0)), names=names)
    made = replace(made, skipped=(replace(made.skipped[0], reason="</script><b>"),))
    _, page, data, _ = page_of(made, title="</title><script>alert(1)</script>")
    assert [tag for tag, _ in page.tags if tag in ("img", "b")] == []
    assert sum(tag == "script" for tag, _ in page.tags) == 2
    told = [room["name"] for room in data["storeys"][0]["rooms"]]
    assert told[1:3] == names[1:3]
    assert len(told[3]) <= 200
    assert data["title"] == "</title><script>alert(1)</script>"


def test_panoramas_are_made_to_fit(tmp_path):
    made = painted_plan()
    files = write_panoramas(tmp_path, made, width=256)
    _, _, data, _ = page_of(made, images=files)
    assert list(data["panoramas"]) == ["kf0", "kf1"]
    for image in data["panoramas"].values():
        assert base64.b64decode(image).startswith(b"\xff\xd8")


def test_a_label_stays_in_its_room_and_off_the_cameras():
    made = plan((*FLAT, square(20, 0, 0.3)), names=("Living room", "Bath", "Kitchen", "Closet"))
    _, _, data, _ = page_of(made)
    (storey,) = data["storeys"]
    *rooms, closet = storey["rooms"]
    for room in rooms:
        label = room["label"]
        assert "".join(label["lines"][:-1]).replace(" ", "") == room["name"].replace(" ", "")
        assert label["lines"][-1].endswith(" m²")
        half = 0.3 * label["size"] * max(map(len, label["lines"]))
        ends = shapely.LineString(
            [np.array(label["at"]) - (half, 0), np.array(label["at"]) + (half, 0)]
        )
        assert shapely.Polygon(room["rings"][0]).contains(ends)
        for camera in storey["cameras"]:
            assert ends.distance(shapely.Point(camera["position"])) > 0.1
    assert closet["label"] is None


def test_doors_go_through_their_walls():
    _, _, data, _ = page_of(flat())
    (door,) = data["storeys"][0]["apertures"]["doors"]
    assert door["through"] == pytest.approx(0.2)


def test_300_noisy_panoramas_stay_below_25_mb(tmp_path):
    from PIL import Image

    path = tmp_path / "noise.png"
    noise = np.random.default_rng(0).integers(0, 255, (192, 384, 3), dtype=np.uint8)
    Image.fromarray(noise).save(path)
    pose = painted_plan().trajectory[0]
    trajectory = tuple(replace(pose, id=f"k{n}") for n in range(300))
    made = replace(painted_plan(), trajectory=trajectory)
    files = {pose.id: path for pose in trajectory}
    text = report_html(made, "x", files, lambda: b"x" * (3 * 2**20))
    assert len(text) < 25 * 10**6


def test_a_large_model_is_left_out():
    assert page_of(flat(), model=b"x" * (4 * 2**20))[2]["model"] is None


def test_a_plan_in_camera_heights_is_refused():
    with pytest.raises(InputError, match="camera heights"):
        report_html(plan(unit="ch"), "x", {}, bytes)
