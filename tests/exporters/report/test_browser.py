"""The report in headless Chromium, and that its script is built from its sources."""

import json
import shutil
import subprocess
from dataclasses import replace
from pathlib import Path

import pytest
from tests.exporters.model.painted import painted_plan, write_panoramas

from panoplan.exporters.model.glb import plan_glb
from panoplan.exporters.model.surfaces import plan_surfaces
from panoplan.exporters.report.page import report_html

WEB = Path(__file__).parents[3] / "web"
NAME = "<img src=x onerror=alert(1)>"


def node(*words):
    program = shutil.which("node")
    if program is None:
        pytest.skip("no node")
    if not (WEB / "node_modules").is_dir():
        pytest.skip("no web/node_modules: npm ci --prefix web")
    return subprocess.run([program, *words], cwd=WEB, capture_output=True, text=True, timeout=600)


def test_the_script_is_what_its_sources_make():
    done = node("build.mjs", "--check")
    assert done.returncode == 0, done.stderr


def test_it_is_used_as_people_use_it(tmp_path):
    pytest.importorskip("trimesh", reason="the extra 'export' is not installed")
    chromium = shutil.which("chromium")
    if chromium is None:
        pytest.skip("no chromium")
    made = painted_plan()
    made = replace(made, rooms=(replace(made.rooms[0], name=NAME),))
    files = write_panoramas(tmp_path, made, width=256)
    model = plan_glb(made, plan_surfaces(made), {})
    (tmp_path / "report.html").write_bytes(report_html(made, "A flat", files, lambda: model))
    picture = tmp_path / "report.png"
    done = node("browser.mjs", str(tmp_path / "report.html"), str(picture), chromium)
    assert done.returncode == 0, done.stderr
    told = json.loads(done.stdout)
    assert told["errors"] == []
    assert told["requests"] == []
    assert told["axe"] == []
    assert told["title"] == "A flat"
    assert told["hovered"].startswith(NAME)
    assert "12.00 ± 0.20 m²" in told["hovered"]
    assert told["focused"] == NAME
    assert told["scripts"] == 0
    assert told["model"]["turned"]
    assert told["panorama"]["shown"] == "kf0"
    assert told["panorama"]["before"] != told["panorama"]["after"]
    assert told["print"] == ["plan", "rooms"]
    assert picture.read_bytes().startswith(b"\x89PNG")
