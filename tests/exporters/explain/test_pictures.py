"""Pictures of an explanation made by hand: two rooms side by side, the second without a shape."""

from dataclasses import replace

import matplotlib.image
import numpy as np
import pytest
from matplotlib.colors import to_rgb
from matplotlib.text import Text
from tests.metrics.plans import LEFT, RIGHT

from panoplan.config import Config, preset
from panoplan.errors import InputError
from panoplan.exporters.drawing import CORNER_COLOUR, PATH_COLOUR
from panoplan.exporters.explain.floors import FITTED_COLOUR, floors_figure
from panoplan.exporters.explain.pictures import forget_explanation, write_explanation
from panoplan.exporters.explain.rooms import rooms_figure
from panoplan.exporters.explain.scale import scale_figure
from panoplan.exporters.explain.views import views_figure
from panoplan.exporters.explain.walls import (
    REASON_COLOURS,
    ROUND_COLOURS,
    rounds_figure,
    walls_figure,
)
from panoplan.exporters.layers import Layer
from panoplan.exporters.png import figure_png
from panoplan.types.explain import (
    Cloud,
    ExplainedFloor,
    ExplainedRoom,
    ExplainedRound,
    ExplainedScale,
    ExplainedView,
    ExplainedWalls,
    Explanation,
    Grouping,
    Raster,
)
from panoplan.types.plan import ScaleEstimate

CELL = 0.1
CAMERAS = np.array([[1.0, 1.0], [3.0, 2.0], [5.0, 1.5], [6.5, 4.0]])


def ring_points(ring, count=40):
    ends = np.roll(ring, -1, axis=0)
    return np.concatenate([np.linspace(a, b, count) for a, b in zip(ring, ends, strict=True)])


def raster(ring, inside, outside):
    low = ring.min(axis=0) - 1.0
    shape = np.ceil((ring.max(axis=0) + 1.0 - low) / CELL).astype(int)
    centres = low + CELL * (np.argwhere(np.ones(shape)) + 0.5)
    within = ((centres > ring.min(axis=0)) & (centres < ring.max(axis=0))).all(axis=1)
    values = np.where(within, inside, outside).reshape(shape)
    return Raster(low, CELL * np.eye(2), values)


def room(number, ring, method):
    made = ExplainedRoom(f"room_{number:02d}", f"Room {number}", raster(ring, 1.0, 0.0), ring, None)
    if method == "ispa":
        edges = np.stack([ring, np.roll(ring, -1, axis=0)], axis=1)
        wall = raster(ring, 0.2, 0.9)
        rounds = [
            ExplainedRound(wall, wall.values < 0.5, ring_points(ring), ring + shift)
            for shift in (0.1, 0.05, 0.0)
        ]
        rejected = (("no plane fits", ring_points(ring[:2]) + 0.3), ("too far", ring + 50.0))
        return replace(made, walls=ExplainedWalls(tuple(edges), rejected, tuple(rounds)))
    pieces = np.split(ring_points(ring), len(ring))
    floor = ExplainedFloor(raster(ring, 0.3, -0.3), tuple(pieces), ring, np.full(len(ring), 0.01))
    return replace(made, floor=floor)


def explanation(method="fusion", unit="m"):
    s = np.linspace(0.1, 3.0, 60)
    curve = np.column_stack([s, np.abs(s - 1.5)])
    used = ScaleEstimate(1.5, "entropy", 0.01, (0.1, 3.0), curve, keyframes_used=4)
    cloud = np.concatenate([ring_points(LEFT), ring_points(RIGHT)])
    clouds = [Cloud(factor * 1.5, factor * cloud) for factor in (0.9, 1.0, 1.1)]
    views = [
        ExplainedView(
            f"kf{k}",
            "room_01" if k < 2 else "room_02",
            0,
            camera,
            ring_points((LEFT, RIGHT)[k // 2]),
        )
        for k, camera in enumerate(CAMERAS)
    ]
    views[2] = replace(views[2], doorway=True)
    grouping = Grouping(0, np.arange(4), np.kron(np.eye(2), np.ones((2, 2))))
    return Explanation(
        unit=unit,
        config=Config() if method == "fusion" else preset("sound"),
        scale=ExplainedScale(used, used, None, tuple(clouds)),
        views=tuple(views),
        rooms=(room(1, LEFT, method), room(2, RIGHT, method)),
        groupings=(grouping,) if method == "fusion" else (),
    )


def pixels(figure, tmp_path):
    path = tmp_path / "figure.png"
    path.write_bytes(figure_png(figure, 1400))
    return matplotlib.image.imread(path)[..., :3]


def count(image, colour):
    """Pixels of about a colour."""
    return int((np.abs(image - np.array(to_rgb(colour))).max(axis=2) < 0.15).sum())


def texts(figure):
    """All that is written outside and inside of layers."""
    found = {text.get_text() for text in figure.findobj(Text)}
    for axes in figure.axes:
        for layer in axes.get_children():
            if isinstance(layer, Layer):
                found |= {mark.get_text() for mark in layer.marks if isinstance(mark, Text)}
    return found


@pytest.mark.parametrize(
    ("method", "names"),
    [
        ("fusion", ["1_scale.png", "2_rooms.png", "3_views.png", "4_floors.png"]),
        (
            "ispa",
            [
                "1_scale.png",
                "2_rooms.png",
                "3_walls.png",
                "4_rounds_room_01.png",
                "4_rounds_room_02.png",
            ],
        ),
    ],
)
def test_a_picture_a_stage_none_of_them_blank(method, names, tmp_path):
    told = []
    folder = tmp_path / "made" / "explain"
    files = write_explanation(folder, explanation(method), lambda *now: told.append(now))
    assert [file.name for file in files] == names == sorted(p.name for p in folder.iterdir())
    assert told == [(k, len(names)) for k in range(len(names))]
    for file in files:
        image = matplotlib.image.imread(file)[..., :3]
        assert max(image.shape) >= 1400
        assert (image.min(axis=2) < 0.9).mean() > 0.01
        # White at the edges: nothing is cut off there.
        for edge in (image[0], image[-1], image[:, 0], image[:, -1]):
            assert np.all(edge == 1.0)


def test_the_scale_is_marked_with_its_sigma_and_range(tmp_path):
    made = explanation()
    figure = scale_figure(made)
    told = texts(figure)
    assert {"s = 1.35 (−10 %)", "s = 1.5, the one used", "s = 1.65 (+10 %)"} <= told
    assert {"used: s = 1.5", "sigma ± 1 % (band)", "range searched 0.1 to 3"} <= told
    image = pixels(figure, tmp_path)
    assert count(image, PATH_COLOUR) > 300
    assert count(image, CORNER_COLOUR) > 100
    whole = next(axes for axes in figure.axes if axes.get_xlabel())
    assert whole.get_xlim() == (0.1, 3.0)


def test_a_given_scale_and_the_adjusted_one_are_told():
    made = explanation()
    given = ScaleEstimate(1.47, "given", keyframes_used=4)
    told = texts(scale_figure(replace(made, scale=replace(made.scale, used=given))))
    assert {"given: unit and camera height known", "layouts alone say 1.5 (+2.04 %)"} <= told
    told = texts(scale_figure(replace(made, scale=replace(made.scale, adjusted_ch_per_su=1.53))))
    assert "cameras adjusted: 1.53 (+2.00 %)" in told
    unknown = ExplainedScale(None, None, None, ())
    assert "The scale is not known." in texts(scale_figure(replace(made, scale=unknown)))


def test_rooms_show_density_and_their_own_cameras(tmp_path):
    made = explanation()
    figure = rooms_figure(made, made.rooms)
    assert {"Room 1", "Room 2", "2 keyframes", "1 m"} <= texts(figure)
    image = pixels(figure, tmp_path)
    # One panel a room; in each two dots of its own.
    left, right = np.array_split(image, 2, axis=1)
    assert min(count(left, CORNER_COLOUR), count(right, CORNER_COLOUR)) > 50
    assert count(image, "#6FA8D6") > 5e4


def test_the_unit_of_lengths_is_that_of_the_plan():
    made = explanation(unit="ch")
    assert "1 camera height" in texts(rooms_figure(made, made.rooms))
    assert any(
        "camera heights of one line" in t.replace("\n", " ")
        for t in texts(walls_figure(explanation("ispa", "ch"), ()))
    )


def test_a_room_without_a_shape_says_why():
    made = explanation()
    lost = replace(
        made.rooms[1],
        polygon=None,
        failure="its walls do not close",
        floor=replace(made.rooms[1].floor, fitted=None, sigmas=None),
    )
    rooms = (made.rooms[0], lost)
    assert "its walls do not close" in texts(floors_figure(replace(made, rooms=rooms), rooms))
    made = explanation("ispa")
    first = made.rooms[0].walls.rounds[0]
    failed = replace(first, candidates=np.empty((0, 2)), corners=None)
    lost = replace(
        made.rooms[0],
        failure="no closed path in round 1",
        walls=replace(made.rooms[0].walls, rounds=(failed,)),
    )
    assert any("no closed path in round 1" in text for text in texts(rounds_figure(made, lost)))


def test_views_have_the_colour_of_their_room_and_the_matrix_its_blocks(tmp_path):
    made = explanation()
    figure = views_figure(made, made.groupings[0])
    matrix = figure.axes[1].images[0].get_array()
    np.testing.assert_array_equal(matrix, made.groupings[0].overlaps)
    names = [label.get_text() for label in figure.axes[1].get_yticklabels()]
    assert names == ["Room 1", "Room 2"]
    assert any("4 views, 1 of them from a doorway" in t.replace("\n", " ") for t in texts(figure))


def test_walls_show_what_was_kept_and_what_was_not(tmp_path):
    made = explanation("ispa")
    figure = walls_figure(made, made.rooms)
    assert {"4 kept, 2 rejected", "6 kept, 2 rejected"} <= texts(figure)
    legend = {text.get_text() for text in figure.legends[0].get_texts()}
    assert {"kept (10)", "rejected, no plane fits (2)", "rejected, too far (2)"} <= legend
    none = explanation("ispa")
    none = replace(
        none, rooms=tuple(replace(r, walls=replace(r.walls, rejected=())) for r in none.rooms)
    )
    orange = np.array(to_rgb(REASON_COLOURS["no plane fits"]))
    seen = [
        int((np.abs(pixels(walls_figure(m, m.rooms), tmp_path) - orange).max(axis=2) < 0.3).sum())
        for m in (made, none)
    ]
    assert seen[0] > seen[1] + 100


def test_each_round_has_its_path(tmp_path):
    made = explanation("ispa")
    figure = rounds_figure(made, made.rooms[0])
    panels = np.array_split(pixels(figure, tmp_path)[150:-100], 3, axis=1)
    seen = np.array([[count(panel, colour) for colour in ROUND_COLOURS] for panel in panels])
    assert (np.diag(seen) > 200).all()
    assert (seen - np.diag(np.diag(seen)) < 20).all()
    assert any("160 candidates, 4 corners" in text for text in texts(figure))


def test_floors_show_the_fitted_walls(tmp_path):
    made = explanation()
    figure = floors_figure(made, made.rooms)
    assert "4 walls, fitted to ± 1.0 cm" in texts(figure)
    assert count(pixels(figure, tmp_path), FITTED_COLOUR) > 200


def test_many_rooms_go_on_several_pages(tmp_path):
    made = explanation()
    rooms = tuple(replace(made.rooms[0], id=f"room_{k:02d}", floor=None) for k in range(21))
    files = write_explanation(tmp_path, replace(made, rooms=rooms, groupings=()))
    assert [file.name for file in files] == ["1_scale.png", "2_rooms_1.png", "2_rooms_2.png"]


def test_pictures_of_an_earlier_explanation_go_and_nothing_else(tmp_path):
    folder = tmp_path / "explain"
    folder.mkdir()
    for name in ("1_scale.png", "4_rounds_room_17.png", "2_rooms_3.png"):
        (folder / name).write_bytes(b"old")
    (folder / "1_scale_notes.txt").write_text("mine")
    forget_explanation(folder)
    assert [path.name for path in folder.iterdir()] == ["1_scale_notes.txt"]
    (folder / "1_scale_notes.txt").unlink()
    (folder / "4_floors.png").write_bytes(b"old")
    forget_explanation(folder)
    assert not folder.exists()
    forget_explanation(folder)


def test_a_file_in_the_folders_place_is_told(tmp_path):
    (tmp_path / "explain").write_text("mine")
    with pytest.raises(InputError, match="folder"):
        write_explanation(tmp_path / "explain", explanation())
