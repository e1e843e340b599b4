"""The campaign of space: one family alone, its page, and the same summary again."""

import json
from pathlib import Path

import pytest

from palpate.experiments import campaign_space
from palpate.experiments.solid_problems import FAMILIES, family_of, random_problem

PAGE = Path(__file__).parents[1] / "docs" / "campaign-space.md"


def test_the_family_of_a_seed_is_that_of_its_problem():
    families = [random_problem(seed).family for seed in range(30)]
    assert [family_of(seed) for seed in range(30)] == families
    assert len(set(families)) >= 4


def test_problems_of_a_family_are_the_first_of_it():
    seeds = campaign_space.seeds_of(5, 2, "no-normals")
    first = 2 * 10**9
    assert list(seeds) == [one for one in range(first, seeds[-1] + 1) if family_of(one) == "no-normals"]
    assert len(seeds) == 5
    assert list(campaign_space.seeds_of(3, 2, None)) == [first, first + 1, first + 2]


def run(folder, *, page):
    return campaign_space.main(
        ["--problems", "4", "--seed", "1", "--family", "points", "--out", str(folder), "--page", str(page)]
    )


def test_a_family_alone_is_checked_and_written_to_a_page(tmp_path, capsys):
    page = tmp_path / "page.md"
    page.write_text(
        "# Mine\n\n<!-- made: campaign-space-points -->\n<!-- end: campaign-space-points -->\n\nEnd.\n"
    )
    assert run(tmp_path / "out", page=page) == 0
    file = tmp_path / "out" / "summary.json"
    summary = json.loads(file.read_text())
    mine = summary["families"]["points"]
    assert summary["total"] == {key: value for key, value in mine.items() if value}
    assert not any(counts for family, counts in summary["families"].items() if family != "points")
    assert summary["total"]["problems"] == 4 and summary["faults"] == 0
    assert "second" not in file.read_text()
    assert "seconds of the core, 90 %" in capsys.readouterr().out
    text = page.read_text()
    assert text.startswith("# Mine\n") and text.endswith("\n\nEnd.\n")
    assert "| points | 4 | 100.0 % |" in text and "| all |" not in text
    assert f"| invalid sample | 0 | {summary['total']['poses_checked']} poses checked |" in text
    # Again: from what is on disk.
    file.unlink()
    assert run(tmp_path / "out", page=page) == 0
    assert json.loads(file.read_text()) == summary and page.read_text() == text


def test_a_page_without_the_part_is_refused(tmp_path, capsys):
    page = tmp_path / "page.md"
    page.write_text("# Mine\n")
    with pytest.raises(SystemExit) as ended:
        run(tmp_path / "out", page=page)
    assert ended.value.code == 2
    assert "has no part <!-- made: campaign-space-points -->" in capsys.readouterr().err


def test_the_page_names_the_shares_of_all_families():
    text = PAGE.read_text(encoding="utf-8")
    for family, share in FAMILIES.items():
        assert f"| {family} | {share} % |" in text
    for part in ("campaign-space", "campaign-space-no-normals"):
        assert f"<!-- made: {part} -->" in text
