import os

from panoplan.cache import Cache, cache_folder, content_key


def test_keys_tell_parts_apart():
    keys = {
        content_key("stage", b"ab", b"c"),
        content_key("stage", b"a", b"bc"),
        content_key("stage", b"abc"),
        content_key("stage 2", b"ab", b"c"),
    }
    assert len(keys) == 4
    assert content_key("stage", "ab", b"c") in keys


def test_what_was_written_is_read(tmp_path):
    cache = Cache(tmp_path / "cache")
    key = content_key("stage", b"x")
    assert cache.read(key) is None
    cache.write(key, b"result")
    assert cache.read(key) == b"result"
    assert Cache(None).read(key) is None


def test_results_used_longest_ago_go_first(tmp_path):
    cache = Cache(tmp_path)
    keys = [content_key("stage", str(n)) for n in range(3)]
    for age, key in enumerate(keys):
        cache.write(key, b"x" * 100)
        os.utime(tmp_path / key[:2] / key[2:], (1000 + age, 1000 + age))
    cache.read(keys[0])
    assert cache.trim(200) == 100
    assert [cache.read(key) is not None for key in keys] == [True, False, True]


def test_a_place_that_cannot_be_written_is_no_cache(tmp_path):
    (tmp_path / "file").write_text("")
    cache = Cache(tmp_path / "file")
    cache.write(content_key("stage"), b"x")
    assert cache.read(content_key("stage")) is None
    assert cache.entries() == []


def test_the_place_is_told_by_the_environment(monkeypatch, tmp_path):
    monkeypatch.setenv("PANOPLAN_CACHE", str(tmp_path / "a"))
    assert cache_folder() == tmp_path / "a"
    monkeypatch.delenv("PANOPLAN_CACHE")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    assert cache_folder() == tmp_path / "panoplan"
