import pytest

from panoplan.errors import InputError
from panoplan.poses.associate import Panorama, associate


def matched(labels, panoramas):
    association = associate(labels, panoramas, "walk.tum")
    return [None if p is None else p.id for p in association.panoramas], association.rule


def named(*ids):
    return [Panorama(name) for name in ids]


def test_by_id():
    assert matched(["b", "a", "x"], named("a", "b")) == (
        ["b", "a", None],
        "2 of 3 poses matched by id",
    )


@pytest.mark.parametrize("label", ["shot_7", "shot_7.jpg", "images/shot_7.PNG", "shot_7.npz"])
def test_by_file_stem(label):
    panoramas = [Panorama("kitchen", "images/shot_7.jpg"), Panorama("hall", "images/shot_8.jpg")]
    assert matched([label], panoramas) == (["kitchen"], "1 of 1 poses matched by file stem")


def test_by_listed_order():
    panoramas = [Panorama("p9", order=0), Panorama("p4", order=2), Panorama("p1", order=1)]
    assert matched(["2", "00", "1", "17"], panoramas) == (
        ["p4", "p9", "p1", None],
        "3 of 4 poses matched by order",
    )


def test_by_order_of_names_where_there_are_as_many():
    ids, rule = matched(["0.5", "1.0", "7.25"], named("pano_10", "pano_9", "pano_100"))
    assert ids == ["pano_9", "pano_10", "pano_100"]
    assert rule.endswith("by order")


@pytest.mark.parametrize("labels", [["1", "0"], ["a", "b"], ["0", "1", "2"]])
def test_no_order_of_names_without_rising_numbers_or_with_other_counts(labels):
    with pytest.raises(InputError, match="match no layout"):
        associate(labels, named("x", "y"), "walk.tum")


def test_by_time_within_half_the_median_interval():
    labels = ["10.0", "10.2", "10.4", "10.6"]
    ids, rule = matched(labels, named("10.29", "10.65", "12.0"))
    assert ids == [None, "10.29", None, "10.65"]
    assert rule == "2 of 4 poses matched by time"
    ids, _ = matched(labels, named("10.09", "10.31"))
    assert ids == ["10.09", None, "10.31", None]
    with pytest.raises(InputError, match="match no layout"):
        associate(labels, named("10.71", "9.89"), "walk.tum")


def test_by_time_in_nanoseconds_and_with_exponents():
    ids, _ = matched(["1403636579000000000", "1403636579200000000"], named("1403636579190000000"))
    assert ids == [None, "1403636579190000000"]
    ids, _ = matched(["1.0e1", "1.02e1", "1.04e1"], named("10.21"))
    assert ids == [None, "10.21", None]


def test_a_time_keeps_its_decimals():
    # Cut at the dot, "0.5" would be panorama "0".
    with pytest.raises(InputError, match="match no layout"):
        associate(["0.25", "0.5", "1.5"], named("0", "1"), "walk.tum")


def test_two_full_matches_that_disagree_are_ambiguous():
    panoramas = [Panorama("0", order=1), Panorama("1", order=0)]
    with pytest.raises(InputError) as caught:
        associate(["0", "1"], panoramas, "walk.tum")
    told = str(caught.value)
    assert "walk.tum" in told
    assert "the label 0, which is 0 by id and 1 by order" in told


def test_two_full_matches_that_agree_are_fine():
    panoramas = [Panorama("0", order=0), Panorama("1", order=1)]
    assert matched(["1", "0"], panoramas) == (["1", "0"], "2 of 2 poses matched by id")


def test_a_full_match_beats_a_chance_one():
    # Ids are frame numbers; frame 2 happens to be an order as well.
    panoramas = [Panorama("0", order=0), Panorama("2", order=1), Panorama("9", order=2)]
    assert matched(["0", "2", "9"], panoramas)[0] == ["0", "2", "9"]


def test_two_partial_matches_that_disagree_are_ambiguous():
    panoramas = [Panorama("1", order=5), Panorama("2", order=1), Panorama("x", order=9)]
    with pytest.raises(InputError, match="the label 1, which is 1 by id and 2 by order"):
        associate(["1", "2", "77", "78"], panoramas, "walk.tum")


def test_no_match():
    with pytest.raises(InputError, match=r"walk.tum: found labels such as a, b that match no lay"):
        associate(["a", "b"], named("x"), "walk.tum")
    with pytest.raises(InputError, match="there are none"):
        associate(["a"], [], "walk.tum")


def test_names_that_stand_twice():
    with pytest.raises(InputError, match="two panoramas named x"):
        associate(["x"], named("x", "x"), "walk.tum")
    with pytest.raises(InputError, match="two poses labelled x"):
        associate(["x", "x"], named("x"), "walk.tum")


def test_no_panorama_is_given_to_two_poses():
    with pytest.raises(InputError, match="match no layout"):
        associate(["1", "01"], [Panorama("a", order=1), Panorama("b", order=3)], "walk.tum")
