"""The thesis's experiments, a few problems of each: the same every time, and true to what they say."""

import json
import math
import re
import xml.etree.ElementTree as Xml
from pathlib import Path

import pytest
from test_cli import validate

import palpate
from palpate.cli import main
from palpate.experiments import drill, object_pairs, printed, random_data, standard_points, thesis
from palpate.experiments.campaign import run, without_times
from palpate.experiments.conduct import conduct
from palpate.experiments.experiment import SEEDS
from palpate.experiments.registry import EXPERIMENTS

XHTML = "{http://www.w3.org/1999/xhtml}"


def rows_of(name, folder, *, problems=1, seed=0, numbers=None):
    one = EXPERIMENTS[name]
    chosen = one.numbers(problems, seed=seed) if numbers is None else numbers
    return run(name, one.settings, chosen, one.task, folder / f"{name}.jsonl")


def cells_of(markdown):
    """The cells of each table of a Markdown text."""
    tables, before = [], False
    for line in markdown.splitlines():
        if line.startswith("|"):
            tables += [] if before else [[]]
            tables[-1].append([cell.strip() for cell in line.strip("| ").split("|")])
        before = line.startswith("|")
    return tables


@pytest.mark.parametrize("name", ["table-4.1", "table-4.2", "table-4.3", "table-4.4"])
def test_rows_are_the_same_twice_and_in_two_chunks(name, tmp_path):
    numbers = EXPERIMENTS[name].numbers(2)[:6]
    whole = rows_of(name, tmp_path, numbers=numbers)
    (tmp_path / "parts").mkdir()
    rows_of(name, tmp_path / "parts", numbers=numbers[:3])
    chunks = rows_of(name, tmp_path / "parts", numbers=numbers)
    assert list(map(without_times, chunks)) == list(map(without_times, whole))
    assert len(whole) == len(numbers) == 6


def test_a_seed_chooses_the_problems_and_few_are_the_first_of_many(tmp_path):
    one = EXPERIMENTS["table-4.4"]
    assert list(one.numbers(1)) == list(one.numbers(2))[:3]
    assert one.numbers(1, seed=2)[0] == 2 * SEEDS
    first, other = (one.task(number, **one.settings) for number in (0, SEEDS))
    assert first["initial_data"] != other["initial_data"]


def test_table_4_1_is_the_thesis_s_where_it_must_be(tmp_path):
    rows = rows_of("table-4.1", tmp_path)
    for row in rows:
        told = printed.TABLE_4_1[row["object"]]
        assert (row["faces"], row["interpretations"]) == (told.faces, told.interpretations)
        assert row["score"] == {"auto": 1.0, "ellis": 1.0}
    (table,) = cells_of(standard_points.markdown(rows))
    assert table[2][:7] == ["robot-hand", "12", "12", "4", "4", "5.6 s", table[2][6]]
    assert len(table) == 2 + 6


def test_table_4_2_has_contacts_that_both_objects_explain(tmp_path):
    rows = rows_of("table-4.2", tmp_path)
    for row, pair in zip(rows, printed.STANDARD_PAIRS, strict=False):
        contacts = object_pairs.common_contacts(pair)
        alone = [len(palpate.recognize(palpate.load_models([name]), contacts).hypotheses) for name in pair]
        assert row["hypotheses"] == alone == list(printed.TABLE_4_2[pair].interpretations)
        for planner in row["planners"].values():
            assert sum(planner["identified"]) == sum(alone) and len(planner["identified"]) > 1
    tables = cells_of(object_pairs.markdown(rows))
    assert [len(table) for table in tables] == [5, 5, 8]


def test_table_4_3_draws_from_every_model_of_every_set(tmp_path):
    rows = rows_of("table-4.3", tmp_path)
    drawn = [(tuple(row["set"]), row["truth"]) for row in rows]
    assert sorted(drawn) == sorted((names, name) for names in printed.SETS for name in names)
    assert all(row["kept"] for row in rows)
    for row in rows:
        assert row["hypotheses"] <= row["passed"]
        assert bool(row["trees"]) == (row["hypotheses"] > 1)
        for tree in row["trees"].values():
            assert 1 <= tree["expected"] <= tree["worst"] <= row["hypotheses"] - 1
    recognition, sixty, three = cells_of(random_data.markdown(rows))
    last = [row for row in rows if tuple(row["set"]) == printed.THESIS_OBJECTS]
    assert recognition[-1][:4] == [
        "all six",
        "6",
        "22.6",
        f"{sum(r['interpretations'] for r in last) / 6:.2f}",
    ]
    many = [row["trees"]["ellis, 60 s"]["worst"] for row in last if row["hypotheses"] > 1]
    assert (sixty[-1][1], sixty[-1][5], sixty[-1][7]) == (
        str(len(many)),
        "1.47",
        f"{sum(many) / len(many):.2f}",
    )
    assert three[-1][1] == str(sum(row["hypotheses"] > 3 for row in last))


def test_table_4_4_accounts_for_the_whole_way(tmp_path):
    for number in range(3):
        names, truths = drill.GROUPS[number]
        result, pose = drill.run(names, truths[0], number, **drill.BROAD)
        scanned, probed = drill.travels(result)
        assert math.isclose(scanned + probed, result.travel) and scanned > 0.0
        corners = palpate.load_models([truths[0]])[0].vertices @ pose[:2, :2].T + pose[:2, 2]
        assert (drill.WORKSPACE[0] < corners).all() and (corners < drill.WORKSPACE[1]).all()
        row = drill.task(number, **EXPERIMENTS["table-4.4"].settings)
        assert math.isclose((row["initial_data"] + row["execution"]) * drill.SPEED, result.travel)
        assert row["kept"] and row["truth"] == truths[0]


@pytest.fixture(scope="module")
def everything(tmp_path_factory):
    folder = tmp_path_factory.mktemp("experiments")
    assert main(["experiment", "all", "--problems", "1", "--out", str(folder)]) == 0
    return folder


def test_the_report_is_one_well_formed_page_that_refers_to_nothing_outside(everything):
    page = Xml.parse(everything / "report.html").getroot()
    headings = [heading.text for heading in page.iter(f"{XHTML}h2")]
    assert headings == [one.title for one in EXPERIMENTS.values() if one.of_thesis]
    sources = [image.get("src") for image in page.iter(f"{XHTML}img")]
    assert len(sources) == 14 + 2 and all(
        source.startswith("data:image/svg+xml;base64,") for source in sources
    )
    links = [link.get("href") for link in page.iter(f"{XHTML}a")]
    assert all(link.startswith("#") for link in links)
    text = (everything / "report.html").read_text()
    assert not re.search(r"(src|href)=\"(?!data:|#)", text) and "url(" not in text and "@import" not in text
    assert "drawn anew" in "".join(page.itertext())


def test_figures_say_what_the_thesis_s_do_and_are_the_same_every_time(everything):
    rows = [json.loads(line) for line in (everything / "figures.jsonl").read_text().splitlines()][1:]
    for row in rows:
        drawn = everything / f"figure-{row['figure']}.svg"
        assert drawn.read_text() == row["svg"] and Xml.fromstring(row["svg"]).tag.endswith("svg")
    facts = {row["figure"]: row["facts"] for row in rows}
    assert facts["4.2"] == {"hypotheses": 4, "classes": 4} and facts["4.6"] == {"hypotheses": 5, "paths": 2}
    assert facts["4.12"]["hypotheses"] == facts["4.15"]["hypotheses"] == 3
    assert facts["4.14"]["hypotheses"] == facts["4.16"]["hypotheses"] == 1
    again = EXPERIMENTS["figures"].task(8)
    assert again["svg"] == rows[8]["svg"]


def test_the_page_of_the_documentation_gets_the_tables(everything, tmp_path):
    (tmp_path / "pictures").mkdir()
    page = tmp_path / "experiments.md"
    page.write_text((Path(__file__).parent.parent / "docs" / "experiments.md").read_text())
    thesis.write(everything, page)
    text = page.read_text()
    for name, one in EXPERIMENTS.items():
        if one.of_thesis:
            rows = [json.loads(line) for line in (everything / f"{name}.jsonl").read_text().splitlines()][1:]
            assert one.table(rows) in text
    assert sorted(path.stem for path in (tmp_path / "pictures").iterdir()) == sorted(thesis.SHOWN)
    assert set(re.findall(r"pictures/(.+)\.svg", text)) == set(thesis.SHOWN)


def test_models_are_drawn_with_their_contacts():
    models = palpate.load_models(["boot", "camera"])
    contacts = [palpate.standard_contacts(model.name) for model in models]
    figure = palpate.plots.plot_models(models, contacts=contacts)
    assert [[text.get_text() for text in axes.texts] for axes in figure.axes] == [["1", "2"], ["1", "2"]]
    with pytest.raises(ValueError, match="contacts: must have a list for each of 2 models"):
        palpate.plots.plot_models(models, contacts=contacts[:1])


def test_json(tmp_path, capsys):
    command = ["experiment", "table-4.4", "--problems", "1", "--seed", "3", "--json", "--out", str(tmp_path)]
    assert main(command) == 0
    document = json.loads(capsys.readouterr().out)
    validate(document, "experiment-1")
    (one,) = document["experiments"]
    assert [row["number"] for row in one["rows"]] == [3 * SEEDS, 3 * SEEDS + 1, 3 * SEEDS + 2]
    assert Path(document["report"]).exists() and all(Path(picture).exists() for picture in one["pictures"])
    assert main(command) == 0  # all rows are there
    assert json.loads(capsys.readouterr().out) == document


BAD = [
    (["table-4.9"], "'table-4.9'"),
    (["table-4.1", "--problems", "5"], "fixed"),
    (["table-4.3", "--problems", "0"], "0"),
    (["table-4.3", "--problems", "many"], "'many'"),
    (["table-4.3", "--seed", "-1"], "-1"),
    (["table-4.4", "--problems", "1", "--cluster", "local:none"], "local:none"),
    (["table-4.4", "--problems", "1", "--out", "taken"], "taken"),
    (["table-4.4", "--problems", "1", "--out", "other"], "other"),
    ([], "NAME"),
]


@pytest.mark.parametrize(("arguments", "named"), BAD)
def test_bad_input_is_one_line(arguments, named, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    Path("taken").write_text("a file\n")
    Path("other").mkdir()
    Path("other/table-4.4.jsonl").write_text("something else\n")
    assert main(["experiment", *arguments]) == 2
    out, err = capsys.readouterr()
    assert out == "" and err.startswith("palpate: ") and err.count("\n") == 1 and named in err


def test_an_unknown_experiment_is_refused():
    with pytest.raises(ValueError, match="no such experiment"):
        conduct("table-9", Path("nowhere"))
    assert not Path("nowhere").exists()
