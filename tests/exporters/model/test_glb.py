"""GLB read back by trimesh."""

import io
import json
import struct
import sys

import numpy as np
import pytest
from tests.exporters.model.painted import paint, painted_plan, write_panoramas
from tests.exporters.storeys import flat, two_storeys
from tests.metrics.plans import plan

from panoplan.errors import InputError, MissingExtraError
from panoplan.exporters.model.glb import plan_glb
from panoplan.exporters.model.surfaces import plan_surfaces
from panoplan.exporters.model.texture import pictures, read_photos

trimesh = pytest.importorskip("trimesh", reason="the extra 'export' is not installed")


def plain_glb(made):
    return plan_glb(made, plan_surfaces(made), {})


def scene(data):
    return trimesh.load_scene(io.BytesIO(data), file_type="glb")


def test_a_mesh_a_surface_y_up_in_metres():
    made = scene(plain_glb(flat()))
    assert {"room_01_floor", "room_03_ceiling", "wall_00"} <= set(made.geometry)
    floors = {n: g.area for n, g in made.geometry.items() if n.endswith("_floor") and "room" in n}
    assert list(floors.values()) == pytest.approx([12.0, 11.4, 10.44], rel=1e-3)
    low, high = made.bounds
    assert (low[1], high[1]) == pytest.approx((0.0, 2.5))
    assert (low[0], high[0]) == pytest.approx((0.0, 7.2))
    assert (low[2], high[2]) == pytest.approx((-5.0, 0.0))


def test_materials_are_one_sided_and_normals_are_written():
    data = plain_glb(flat())
    length = struct.unpack("<I", data[12:16])[0]
    head = json.loads(data[20 : 20 + length])
    assert not any(material.get("doubleSided") for material in head["materials"])
    for mesh in head["meshes"]:
        assert "NORMAL" in mesh["primitives"][0]["attributes"]


def test_two_storeys():
    assert scene(plain_glb(two_storeys())).bounds[1][1] == pytest.approx(2.8 + 2.5)


def test_the_same_plan_gives_the_same_bytes():
    assert plain_glb(flat()) == plain_glb(flat())
    assert np.frombuffer(plain_glb(flat())[:4], "S4")[0] == b"glTF"


def test_what_is_missing_is_told(monkeypatch):
    with pytest.raises(InputError, match="camera heights"):
        plain_glb(plan(unit="ch"))
    monkeypatch.setitem(sys.modules, "trimesh", None)
    with pytest.raises(MissingExtraError, match=r"GLB needs trimesh.*panoplan\[export\]"):
        plain_glb(flat())


def test_pictures_are_unlit_textures_at_their_places(tmp_path):
    made = painted_plan()
    surfaces = plan_surfaces(made)
    photos = read_photos(made, write_panoramas(tmp_path, made))
    data = plan_glb(made, surfaces, pictures(surfaces, photos, texel_m=0.05))
    length = struct.unpack("<I", data[12:16])[0]
    head = json.loads(data[20 : 20 + length])
    assert head["extensionsUsed"] == ["KHR_materials_unlit"]
    assert all("KHR_materials_unlit" in material["extensions"] for material in head["materials"])
    assert {image["mimeType"] for image in head["images"]} == {"image/jpeg"}
    for name, mesh in scene(data).geometry.items():
        image = np.asarray(mesh.visual.material.baseColorTexture.convert("RGB"), dtype=float)
        # In the middle of each triangle the texture has the colour that is painted there.
        middles = mesh.vertices[mesh.faces].mean(axis=1)
        u, v = mesh.visual.uv[mesh.faces].mean(axis=1).T
        rows = ((1 - v) * image.shape[0]).astype(int)
        shown = image[rows, (u * image.shape[1]).astype(int)]
        assert np.abs(shown - paint(middles)).max() < 25, name
