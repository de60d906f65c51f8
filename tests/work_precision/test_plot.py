"""The diagram: what it shows, and that no file is lost or left half-written."""

import sys
from dataclasses import replace
from pathlib import Path
from xml.etree import ElementTree

import pytest
from tests.work_precision.samples import ROWS, made_up
from tests.work_precision.scene_samples import CLOSED
from tests.work_precision.scene_samples import made_up as scene_made_up

from inertia.errors import InertiaError, UsageError
from inertia.plotting import require_plottable
from inertia.work_precision.plot import plot


def words(file: Path) -> str:
    """Return the text of an SVG file."""
    return " ".join(
        "".join(text.itertext()) for text in ElementTree.parse(file).iter("{http://www.w3.org/2000/svg}text")
    )


def test_every_row_is_named_and_the_axes_are_labelled(tmp_path: Path) -> None:
    plot(made_up(1e-2), tmp_path / "trade.svg")
    text = words(tmp_path / "trade.svg")
    for word in ("float64", "double-double", "exact", "1/2", "1/4", "1/8", "1/16"):
        assert word in text
    for label in ("relative error", "time of the integration, ms", "certified bound", "cube.stl", "Difference Engine"):
        assert label in text
    assert "accuracy asked for, 0.01" in text
    assert "recommended" in text


def test_the_same_trade_gives_the_same_file(tmp_path: Path) -> None:
    for name in ("one.svg", "two.svg"):
        plot(made_up(), tmp_path / name)
    assert (tmp_path / "one.svg").read_bytes() == (tmp_path / "two.svg").read_bytes()


def test_a_png_by_its_name(tmp_path: Path) -> None:
    plot(made_up(), tmp_path / "trade.PNG")
    assert (tmp_path / "trade.PNG").read_bytes().startswith(b"\x89PNG\r\n")


def test_a_part_without_simpler_meshes_or_with_errors_of_0_is_drawn(tmp_path: Path) -> None:
    zero = replace(ROWS[0].error, volume=0.0, center_of_mass=0.0, inertia=0.0)
    plot(made_up(rows=(replace(ROWS[0], error=zero), replace(ROWS[2], error=None))), tmp_path / "trade.svg")
    assert "simplified" not in words(tmp_path / "trade.svg")


def test_the_name_of_a_part_is_no_formula_and_needs_no_font(tmp_path: Path) -> None:
    made = made_up()
    name = r"a$b$ 中 $\nothing$.stl"
    source = replace(made.analysis.part.source, path=name)
    part = replace(made.analysis.part, source=source)
    for file in ("trade.svg", "trade.png"):
        plot(replace(made, analysis=replace(made.analysis, part=part)), tmp_path / file)
    assert name in words(tmp_path / "trade.svg")


def test_times_that_nearly_agree_have_names_apart(tmp_path: Path) -> None:
    near = replace(ROWS[2], time=replace(ROWS[1].time, median=1.1 * ROWS[1].time.median))
    plot(made_up(rows=(*ROWS[:2], near)), tmp_path / "trade.svg")
    texts = ElementTree.parse(tmp_path / "trade.svg").iter("{http://www.w3.org/2000/svg}text")
    heights = {text.text: float(text.get("y") or 0) for text in texts if text.text in ("double-double", "exact")}
    assert heights["double-double"] - heights["exact"] > 8


def test_a_file_that_exists_is_kept_unless_forced(tmp_path: Path) -> None:
    file = tmp_path / "trade.svg"
    file.write_text("mine")
    with pytest.raises(UsageError, match="force=True"):
        plot(made_up(), file)
    assert file.read_text() == "mine"
    plot(made_up(), file, force=True)
    assert "float64" in words(file)
    assert list(tmp_path.iterdir()) == [file]


def test_a_failure_leaves_nothing_behind(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(self: Path, content: bytes) -> None:
        self.write_text("<svg>half")
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(Path, "write_bytes", full)
    with pytest.raises(InertiaError, match=r"trade\.svg: No space left"):
        plot(made_up(), tmp_path / "trade.svg")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("name", ["trade", "trade.pdf", "trade.svg.gz"])
def test_other_formats_are_refused(tmp_path: Path, name: str) -> None:
    with pytest.raises(UsageError, match=r"\.svg or \.png"):
        require_plottable(tmp_path / name)


def test_a_missing_folder_is_said_beforehand(tmp_path: Path) -> None:
    with pytest.raises(InertiaError, match=r"trade\.svg: No such file or directory: name a folder"):
        require_plottable(tmp_path / "nowhere" / "trade.svg")


def test_a_folder_of_that_name_is_no_file(tmp_path: Path) -> None:
    (tmp_path / "trade.svg").mkdir()
    with pytest.raises(UsageError, match="directory"):
        require_plottable(tmp_path / "trade.svg", force=True)


def test_a_missing_matplotlib_is_named_with_its_extra(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    with pytest.raises(UsageError, match=r"pip install 'inertia\[plot\]'"):
        require_plottable(tmp_path / "trade.svg")


def test_the_diagram_of_a_scene_names_every_method(tmp_path: Path) -> None:
    for name in ("one.svg", "two.svg"):
        plot(scene_made_up(1e-7), tmp_path / name)
    assert (tmp_path / "one.svg").read_bytes() == (tmp_path / "two.svg").read_bytes()
    text = words(tmp_path / "one.svg")
    for word in (CLOSED, "Taylor", "RK4", "front", "what the planner selects", "accuracy asked for", "attitude error"):
        assert word in text
    with pytest.raises(UsageError, match="force=True"):
        plot(scene_made_up(), tmp_path / "one.svg")
