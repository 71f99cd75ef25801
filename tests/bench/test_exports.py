import json
from dataclasses import replace

import numpy as np
import pytest
from tests.exporters.storeys import flat, two_storeys

from panoplan.bench import exports, readback
from panoplan.cli.main import main
from panoplan.exporters.export import KINDS, ExportOptions, export
from panoplan.exporters.sheet.dimensions import wall_length
from panoplan.exporters.storeys import metric_storeys, room_area
from panoplan.types.truth import GroundTruth, TruePlan, TrueRoom

for library in ("ezdxf", "ifcopenshell", "pdfminer", "trimesh"):
    pytest.importorskip(library, reason="an extra is not installed")


@pytest.fixture(scope="module")
def exported(tmp_path_factory):
    out = tmp_path_factory.mktemp("exported")
    made = flat()
    return made, {kind: export(made, [kind], out / kind, ExportOptions("Flat")) for kind in KINDS}


def areas(made):
    return [float(room_area(room).area) for floor in metric_storeys(made) for room in floor.rooms]


@pytest.mark.parametrize("kind", KINDS)
def test_other_libraries_read_the_plans_areas_in_every_format(exported, kind):
    made, files = exported
    read = readback.AREAS[kind](files[kind])
    assert readback.largest_error(read, areas(made)) < 1e-3
    # A plan of another size is not mistaken for it.
    assert readback.largest_error(read, [1.01 * area for area in areas(made)]) > 5e-3


def test_dimensions_and_complaints_are_read(exported):
    made, files = exported
    _, lengths, faults = readback.dxf(files["dxf"])
    walls = [wall_length(wall) for room in made.rooms for wall in room.walls]
    assert sorted(lengths) == pytest.approx(sorted(walls), abs=1e-3)
    assert faults == 0
    assert readback.ifc(files["ifc"])[1] == 0


def test_what_was_not_read_has_no_error():
    assert readback.largest_error([1.0], [1.0, 2.0]) is None
    assert readback.largest_error([1.0, float("nan")], [1.0]) is None
    assert readback.largest_error([3.0, 1.02, 7.0], [1.0, 3.0]) == pytest.approx(0.02)


def test_bench_exports_times_commands_and_compares_areas(tmp_path, monkeypatch, capsys):
    made = two_storeys()
    true = [
        TrueRoom("a", "Hall", 1.1 * made.rooms[0].polygon),
        TrueRoom("b", "Attic", made.rooms[0].polygon + 50.0),
    ]
    truth = GroundTruth(TruePlan((), tuple(true)), None)
    monkeypatch.setattr(exports, "true_poses", lambda folder: None)
    monkeypatch.setattr(exports, "metric_plan", lambda scene, config: replace(made, trajectory=()))
    monkeypatch.setattr(exports, "read_truth", lambda folder: truth)
    monkeypatch.setattr(exports, "KINDS", ("csv",))
    monkeypatch.setattr(exports, "_RUNS", 1)
    out = tmp_path / "exports.json"
    assert main(["bench", "exports", str(tmp_path), "--quiet", "-o", str(out)]) == 0
    figures = json.loads(out.read_bytes())["figures"]
    row = figures["formats"]["csv"]
    assert 0 < row["cpu_seconds"] < 60
    assert row["bytes"] > 100
    assert row["area_error_percent"] < 0.1
    hall, attic = figures["areas"]
    assert hall["true_m2"] == pytest.approx(1.21 * hall["area_m2"])
    assert attic["area_m2"] is None
    assert np.isfinite(hall["area_sigma_m2"])
