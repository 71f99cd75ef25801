import pytest
from tests.exporters.storeys import two_storeys
from tests.metrics.plans import plan

from panoplan.errors import InputError
from panoplan.exporters.export import KINDS, ExportOptions, export

pytest.importorskip("ezdxf", reason="the extra 'export' is not installed")


def test_every_kind_is_written(tmp_path):
    made = export(two_storeys(), list(KINDS), tmp_path / "new" / "out", ExportOptions("Flat"))
    names = [path.name for path in made]
    assert names == [
        "sheet_1.svg", "sheet_2.svg", "sheet.pdf", "plan.dxf", "plan.geojson", "plan.ifc",
        "plan.glb", "rooms.csv", "report.html",
    ]  # fmt: skip
    assert sorted(path.name for path in (tmp_path / "new" / "out").iterdir()) == sorted(names)


@pytest.mark.parametrize(
    ("made", "kinds"),
    [(plan(), ["csv", "dwg"]), (plan(), []), (plan(unit="ch"), ["csv"]), (plan((), ()), ["csv"])],
)
def test_where_one_fails_nothing_is_written(tmp_path, made, kinds):
    with pytest.raises(InputError):
        export(made, kinds, tmp_path / "out", ExportOptions("Flat"))
    assert not (tmp_path / "out").exists()
