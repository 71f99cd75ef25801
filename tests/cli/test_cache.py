from panoplan.cache import Cache, content_key
from panoplan.cli.main import main


def test_the_cache_is_told_and_cleared(tmp_path, monkeypatch, capsys):
    monkeypatch.setenv("PANOPLAN_CACHE", str(tmp_path / "cache"))
    assert main(["cache"]) == 0
    assert "0 results" in capsys.readouterr().out
    for n in range(3):
        Cache(tmp_path / "cache").write(content_key("stage", str(n)), b"x" * 500_000)
    assert main(["cache"]) == 0
    assert "3 results, 1.5 MB" in capsys.readouterr().out
    assert main(["cache", "--clear"]) == 0
    assert "3 results of 1.5 MB removed" in capsys.readouterr().out
    assert Cache(tmp_path / "cache").entries() == []
