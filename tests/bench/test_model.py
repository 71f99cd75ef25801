import json

import numpy as np
import pytest
from tests.exporters.model.painted import painted_plan, panorama, write_panoramas

from panoplan.bench import model as model_bench
from panoplan.bench.model import Model, Rendering, psnr
from panoplan.cli.main import main
from panoplan.exporters.model.glb import plan_glb
from panoplan.exporters.model.surfaces import plan_surfaces
from panoplan.exporters.model.texture import pictures, read_photos

pytest.importorskip("trimesh", reason="the extra 'export' is not installed")


def test_a_model_rendered_from_a_camera_looks_as_its_photo(tmp_path):
    made = painted_plan()
    photos = read_photos(made, write_panoramas(tmp_path, made))
    surfaces = plan_surfaces(made)
    model = Model.of(plan_glb(made, surfaces, pictures(surfaces, photos, texel_m=0.02)))
    for photo in photos:
        rendering = model.rendered(photo, width=256)
        true = panorama(photo.place, photo.heading, 256).astype(float)
        counted = rendering.counted(None)
        assert counted[:60].all()
        assert psnr((rendering.colours - true)[counted]) > 30
        for wrong in (true[:, ::-1], true[::-1], np.roll(true, 64, axis=1)):
            assert psnr((rendering.colours - wrong)[counted]) < 20
        # Straight ahead at the horizon, by the picture that was cast.
        row, column = 64, 128
        ray = photo.heading + (column + 0.5) / 256 * 2 * np.pi - np.pi
        x, _, z = photo.place
        ahead = np.array([np.sin(ray), -np.cos(ray)])
        with np.errstate(divide="ignore"):
            walls = [(4 - x) / ahead[0], -x / ahead[0], (-3 - z) / ahead[1], -z / ahead[1]]
        nearest = min(w for w in walls if w > 0)
        assert rendering.depth_m[row, column] == pytest.approx(nearest, rel=1e-3)


def test_what_is_farther_off_than_ten_centimetres_and_the_tripod_do_not_count():
    depth = np.full((8, 16), 2.0)
    depth[2, 3] = np.inf
    true = np.full((16, 32), 2.05)
    true[8:10, 20:22] = 1.8
    counted = Rendering(np.zeros((8, 16, 3)), depth).counted(true)
    left_out = {(2, 3), (4, 10)} | {(row, column) for row in (6, 7) for column in range(16)}
    assert {tuple(k) for k in np.argwhere(~counted).tolist()} == left_out


def test_psnr_of_a_known_error():
    assert psnr(np.full((4, 3), 25.5)) == pytest.approx(20.0)


def test_bench_model_compares_five_cameras_with_and_without_their_photos(
    tmp_path, capsys, monkeypatch
):
    cameras = np.array([[x, y] for x in (1.0, 2.0, 3.0) for y in (1.0, 2.0)])
    made = painted_plan(cameras)
    monkeypatch.setattr(model_bench, "true_poses", lambda folder: None)
    monkeypatch.setattr(model_bench, "metric_plan", lambda scene, config: made)
    write_panoramas(tmp_path, made, width=256)
    command = ["bench", "model", str(tmp_path), "--quiet", "-o", str(tmp_path / "model.json")]
    assert main([*command, "--pictures", str(tmp_path / "shown")]) == 0
    figures = json.loads((tmp_path / "model.json").read_bytes())["figures"]
    assert (figures["photos"], figures["true_depth"]) == (6, False)
    for name in ("all_photos", "without_the_five"):
        rows = figures[name]["cameras"]
        assert [row["id"] for row in rows] == ["kf0", "kf1", "kf2", "kf4", "kf5"]
        assert figures[name]["psnr_db_worst"] == min(row["psnr_db"] for row in rows) > 25
    assert figures["all_photos"]["psnr_db"] > figures["without_the_five"]["psnr_db"]
    assert len(list((tmp_path / "shown").iterdir())) == 10
