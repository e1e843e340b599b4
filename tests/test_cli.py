"""The command line on good input: what it prints, what it writes, how it ends."""

import json
import math
import signal
import subprocess
import sys
from pathlib import Path

import ezdxf
import numpy as np
import pytest
from conftest import pose
from jsonschema import Draft202012Validator
from referencing import Registry, Resource

import palpate
from palpate import Contact, Prior
from palpate.cli import main
from palpate.cli.parts import with_flags
from palpate.contacts import write_contacts

PALPATE = [sys.executable, "-m", "palpate.cli"]

SCHEMAS = {
    file.stem: json.loads(file.read_text())
    for file in (Path(palpate.__file__).parent / "schemas").glob("*.json")
}
REGISTRY = Registry().with_resources(
    (schema["$id"], Resource.from_contents(schema)) for schema in SCHEMAS.values()
)

BRACKET = [[0, 0], [80, 0], [80, 15], [20, 15], [20, 60], [0, 60]]
PLATE = [[0, 0], [50, 0], [50, 40], [0, 40]]


def validate(document, schema):
    Draft202012Validator(SCHEMAS[schema], registry=REGISTRY).validate(document)


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """A folder with two parts and with contacts on two faces of one of them, which lies at a known pose."""
    monkeypatch.chdir(tmp_path)
    for name, outer in (("bracket", BRACKET), ("plate", PLATE)):
        model = {"schema": "palpate-model", "version": 1, "name": name, "unit": "mm", "outer": outer}
        Path(f"{name}.json").write_text(json.dumps(model))
    write_contacts("touches.json", touches(), prior=None)
    write_contacts("touches.csv", touches())
    return tmp_path


def touches():
    world_from_model = pose(0.5, 30.0, -10.0)
    rotation, shift = world_from_model[:2, :2], world_from_model[:2, 2]
    places = [((30, 0), (0, -1)), ((0, 20), (-1, 0))]
    return [
        Contact(rotation @ p + shift, rotation @ n, position_error=0.5, normal_error=math.radians(4))
        for p, n in places
    ]


def run(capsys, *arguments):
    """Standard output of the command, which must succeed in silence on standard error."""
    status = main([str(argument) for argument in arguments])
    out, err = capsys.readouterr()
    assert (status, err) == (0, "")
    return out


def test_recognize_says_what_was_found(folder, capsys):
    out = run(capsys, "recognize", "bracket.json", "--contacts", "touches.csv")
    assert out.startswith("2 contacts, 1 model: it is bracket; ")
    found = palpate.recognize(palpate.load_models("bracket.json"), touches())
    rows = [line.split() for line in out.splitlines() if line.split()[1:2] == ["bracket"]]
    assert len(rows) == len(found.hypotheses)
    for row, hypothesis in zip(rows, found.hypotheses, strict=True):
        number, _, interpretations, x, y, angle, turn, shift = row
        assert int(number) == 1 + found.hypotheses.index(hypothesis)
        assert int(interpretations) == hypothesis.interpretation_count
        matrix = hypothesis.world_from_model
        assert (float(x), float(y)) == pytest.approx(tuple(matrix[:2, 2]), abs=6e-4)
        assert float(angle) == pytest.approx(math.degrees(math.atan2(matrix[1, 0], matrix[0, 0])), abs=6e-3)
        # A bound that is printed is rounded up.
        assert 0.0 <= float(turn) - math.degrees(hypothesis.poses.rotation_bound) <= 0.0101
        excursion = max(hypothesis.poses.excursion(vertex) for vertex in hypothesis.model.vertices)
        assert -1e-9 <= float(shift) - excursion <= 0.0101


def test_recognize_among_several(folder, capsys):
    out = run(capsys, "recognize", ".", "--contacts", "touches.csv")
    assert out.startswith("2 contacts, 2 models: one of bracket, plate; ")


def test_recognize_as_json(folder, capsys):
    arguments = ("recognize", "bracket.json", "plate.json", "--contacts", "touches.json")
    document = json.loads(run(capsys, *arguments, "--json", "--list-interpretations", "2", "--stats"))
    validate(document, "recognition-1")
    assert document["models"] == ["bracket", "plate"]
    assert document["readings"] == [{"position_slack": 0.0, "normal_slack_deg": 0.0, "mends": []}] * 2
    assert document["hypothesis_count"] == len(document["hypotheses"])
    assert document["contact_count"] == 2
    assert document["conflict"] is None
    assert len(document["counters"]) == 2
    models = palpate.load_models(["bracket.json", "plate.json"])
    found = palpate.recognize(models, touches())
    assert document["interpretation_count"] == found.interpretation_count
    for entry, hypothesis in zip(document["hypotheses"], found.hypotheses, strict=True):
        assert models[entry["model_number"]] == hypothesis.model
        assert np.array_equal(entry["world_from_model"], hypothesis.world_from_model)
        assert len(entry["interpretations"]) == min(2, hypothesis.interpretation_count)
        for listed in entry["interpretations"]:
            assert len(listed["assignment"]) == 2


def test_csv_and_json_contacts_give_the_same(folder, capsys):
    outs = {
        run(capsys, "recognize", "bracket.json", "--contacts", f"touches.{kind}") for kind in ("csv", "json")
    }
    assert len(outs) == 1


def test_interpretations_are_listed_when_asked_for(folder, capsys):
    without = run(capsys, "recognize", "bracket.json", "--contacts", "touches.csv")
    out = run(capsys, "recognize", "bracket.json", "--contacts", "touches.csv", "--list-interpretations", "1")
    assert "on face" not in without
    assert "\n  1 on face 0, 2 on face 5\n" in out


def test_stats_show_the_counters(folder, capsys):
    out = run(capsys, "recognize", "bracket.json", "plate.json", "--contacts", "touches.csv", "--stats")
    counters = palpate.recognize(palpate.load_models("."), touches()).counters
    row = next(line.split() for line in out.splitlines() if line.split()[:1] == ["nodes"])
    assert row[1:] == [str(counter["nodes"]) for counter in counters]


def test_no_part_explains_the_contacts(folder, capsys):
    Path("far.csv").write_text("x,y,position_error\n0,0,0.1\n30,0,0.1\n1000,0,0.1\n")
    out = run(capsys, "recognize", "bracket.json", "--contacts", "far.csv")
    assert out.startswith("3 contacts, 1 model: no part at any pose explains them.\n")
    assert " can't hold together on any model" in out
    assert "(lines 2 and 4 of the file)" in out or "(lines 3 and 4 of the file)" in out
    assert "\nUsual causes: bounds that are too small, another unit, " in out
    document = json.loads(run(capsys, "recognize", "bracket.json", "--contacts", "far.csv", "--json"))
    validate(document, "recognition-1")
    assert document["hypotheses"] == []
    assert 2 in document["conflict"]


def test_a_search_cut_short_is_said_to_be(folder, capsys):
    arguments = ("recognize", "bracket.json", "--contacts", "touches.csv", "--max-hypotheses", "1")
    document = json.loads(run(capsys, *arguments, "--json"))
    validate(document, "recognition-1")
    reached = document["hypothesis_count"]
    assert (document["complete"], len(document["hypotheses"])) == (False, 1)
    assert reached > 1
    out = run(capsys, *arguments)
    assert f"not all hypotheses were found; {reached} hypotheses reached, the first 1 listed, " in out


def test_a_prior_narrows_the_answer(folder, capsys):
    arguments = ("recognize", "bracket.json", "--contacts", "touches.csv", "--json")
    without = json.loads(run(capsys, *arguments))
    prior = ("--prior-pose", "30,-10,28.6", "--prior-translation", "20", "--prior-rotation-deg", "15")
    narrowed = json.loads(run(capsys, *arguments, *prior))
    assert 1 <= len(narrowed["hypotheses"]) < len(without["hypotheses"])
    for hypothesis in narrowed["hypotheses"]:
        assert abs(hypothesis["x"] - 30) <= 20
        assert abs(hypothesis["angle_deg"] - 28.6) <= 15


def test_a_prior_on_the_command_line_goes_before_the_file_s(folder, capsys):
    write_contacts("prior.json", touches(), prior=Prior(np.eye(3), translation=0.1, rotation=0.01))
    arguments = ("recognize", "bracket.json", "--contacts", "prior.json", "--json")
    assert json.loads(run(capsys, *arguments))["hypotheses"] == []
    assert "on any model given the prior" in run(capsys, *arguments[:-1])
    prior = ("--prior-pose", "30,-10,28.6", "--prior-translation", "20")
    assert json.loads(run(capsys, *arguments, *prior))["hypotheses"] != []


def test_sensor_flags_fill_what_the_file_leaves_out(folder, capsys):
    Path("bare.csv").write_text("x,y,nx,ny\n30,-10,0,-1\n")
    arguments = ("recognize", "bracket.json", "--contacts", "bare.csv", "--position-error", "0.5")
    assert "1 contact, 1 model" in run(capsys, *arguments, "--normal-error-deg", "4")


def test_features_are_chosen(folder, capsys):
    Path("bare.csv").write_text("x,y,position_error\n0,0,0.5\n30,20,0.5\n")
    arguments = (
        "recognize",
        "plate.json",
        "--contacts",
        "bare.csv",
        "--json",
        "--list-interpretations",
        "50",
    )
    for chosen in ("face", "face,vertex"):
        document = json.loads(run(capsys, *arguments, "--features", chosen))
        kinds = {
            kind
            for hypothesis in document["hypotheses"]
            for interpretation in hypothesis["interpretations"]
            for kind, _ in interpretation["assignment"]
        }
        assert kinds == set(chosen.split(","))


def test_units_are_converted(folder, capsys):
    arguments = ("recognize", "bracket.json", "--contacts", "touches.json", "--json")
    in_mm = json.loads(run(capsys, *arguments))
    in_inches = json.loads(run(capsys, *arguments, "--unit", "in"))
    assert in_inches["unit"] == "in"
    assert len(in_inches["hypotheses"]) == len(in_mm["hypotheses"])
    xs = sorted(hypothesis["x"] for hypothesis in in_mm["hypotheses"])
    # The pose of largest slack is found by a search, so it may differ by a little of its set.
    assert sorted(25.4 * hypothesis["x"] for hypothesis in in_inches["hypotheses"]) == pytest.approx(
        xs, abs=2.0
    )


@pytest.mark.parametrize("extra", [(), ("--plot-range", "1")])
def test_recognize_draws(folder, capsys, extra):
    out = run(capsys, "recognize", "bracket.json", "--contacts", "touches.csv", "--plot", "found.svg", *extra)
    assert out.endswith("picture: found.svg\n")
    assert "</svg>" in Path("found.svg").read_text()


def test_models_prints_and_draws(folder, capsys):
    out = run(capsys, "models", "bracket.json", "plate.json", "--plot", "models.png")
    assert "bracket: 6 faces, 6 vertices, closed, size 100 mm" in out
    assert "symmetries: looks the same turned by 180°" in out
    assert "vertices that can't be touched, by number: 3\n" in out
    assert Path("models.png").stat().st_size > 1000


def test_models_as_json(folder, capsys):
    document = json.loads(run(capsys, "models", "bracket.json", "boot", "--json"))
    validate(document, "model-report-1")
    assert [len(model["faces"]) for model in document["models"]] == [6, 13]


@pytest.mark.parametrize("command", ["demo", "recognize", "models", "parts"])
def test_every_command_has_an_example(capsys, command):
    assert f"Example: palpate {command}" in run(capsys, command, "--help")


@pytest.mark.parametrize("command", [(), ("demo",), ("recognize",), ("models",)])
def test_flags_are_listed_without_a_type(capsys, command):
    assert "<bool>" not in run(capsys, *command, "--help")


def test_without_a_command_the_help_is_shown(capsys):
    assert "Usage: palpate" in run(capsys)


def test_the_version_is_the_core_s():
    shown = subprocess.run([*PALPATE, "--version"], capture_output=True, text=True, check=True)
    assert (shown.stdout, shown.stderr) == (f"palpate {palpate.__version__}\n", "")


def test_a_reader_that_goes_away_is_no_fault(folder):
    command = " ".join([*PALPATE, "models", "boot", "--json"])
    shown = subprocess.run(f"{command} | true", shell=True, capture_output=True, text=True, check=False)
    assert shown.stderr == ""


def test_an_interrupt_ends_it_in_silence(folder):
    arguments = ["recognize", "bracket.json", "--contacts", "touches.csv"]
    code = f"""
import signal, sys, time
import palpate.cli.recognize
from palpate.cli import main
from palpate.cli.parts import with_flags

def never_ending(*models_and_contacts, **settings):
    print("ready", flush=True)
    time.sleep(1000)

# A background job of a shell has interrupts ignored, and so would its children.
signal.signal(signal.SIGINT, signal.default_int_handler)
palpate.cli.recognize.recognize_parts = never_ending
sys.exit(main({arguments!r}))
"""
    with subprocess.Popen(
        [sys.executable, "-c", code], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    ) as process:
        assert process.stdout.readline() == "ready\n"
        process.send_signal(signal.SIGINT)
        try:
            out, err = process.communicate(timeout=10)
        except subprocess.TimeoutExpired:
            process.kill()
            raise
    assert (process.returncode, out, err) == (130, "", "")


def test_an_interrupt_while_it_loads_ends_it_in_silence():
    code = """
import sys
import palpate.cli

class Interrupt:
    def find_spec(self, name, path=None, target=None):
        if name == "palpate.cli.app":
            raise KeyboardInterrupt

sys.meta_path.insert(0, Interrupt())
sys.exit(palpate.cli.main(["--version"]))
"""
    shown = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert (shown.returncode, shown.stdout, shown.stderr) == (130, "", "")


def test_more_interpretations_than_can_be_counted(folder, capsys):
    angles = np.linspace(0.0, 2.0 * math.pi, 200, endpoint=False)
    wheel = [[50.0 * math.cos(angle), 50.0 * math.sin(angle)] for angle in angles]
    model = {"schema": "palpate-model", "version": 1, "name": "wheel", "unit": "mm", "outer": wheel}
    Path("wheel.json").write_text(json.dumps(model))
    Path("rim.csv").write_text("x,y\n" + "".join(f"{x},{y}\n" for x, y in wheel[::4]))
    out = run(capsys, "recognize", "wheel.json", "--contacts", "rim.csv", "--position-error", "2")
    assert ": it is wheel; 1 hypothesis, at least " in out
    assert max(map(len, out.splitlines())) <= 110


def write_model(file, outer, **rest):
    model = {"schema": "palpate-model", "version": 1, "name": Path(file).stem, "unit": "mm", "outer": outer}
    Path(file).parent.mkdir(exist_ok=True)
    Path(file).write_text(json.dumps(model | rest))


def test_what_reading_a_model_changed_is_said_with_the_answer(folder, capsys):
    write_model("rough.json", BRACKET[::-1], position_slack=0.25, normal_slack_deg=6.9)
    arguments = ("recognize", "rough.json", "plate.json", "--contacts", "touches.csv")
    out = run(capsys, *arguments)
    (model,) = palpate.load_models("rough.json")
    mends = "".join(f"; mended: {mend}" for mend in model.mends)
    assert model.mends
    assert f"\n  rough: slack 0.25 mm and 6.9°, added to the errors of every contact{mends}\n" in out
    assert "\n  plate" not in out, "there is nothing to say of it"
    document = json.loads(run(capsys, *arguments, "--json"))
    validate(document, "recognition-1")
    assert document["readings"][0] == {
        "position_slack": 0.25,
        "normal_slack_deg": pytest.approx(6.9),
        "mends": model.mends,
    }


def test_mends_come_first_in_what_was_read(folder, capsys):
    write_model("rough.json", BRACKET[::-1], position_slack=0.25)
    lines = run(capsys, "models", "rough.json").splitlines()
    assert lines[0].startswith("rough: 6 faces")
    assert lines[1].startswith("  mended: ")


def test_models_of_one_name_are_told_apart(folder, capsys):
    write_model("A/part.json", BRACKET)
    write_model("B/part.json", [[x, 2 * y] for x, y in BRACKET])
    names = ("A/part.json", "B/part.json")
    arguments = ("recognize", *names, "--contacts", "touches.csv")
    document = json.loads(run(capsys, *arguments, "--json"))
    numbers = [hypothesis["model_number"] for hypothesis in document["hypotheses"]]
    assert set(numbers) == {0, 1}
    out = run(capsys, *arguments, "--plot", "found.svg")
    assert ": one of part (model 1), part (model 2); " in out
    assert "\n  part (model 1): from A/part.json\n  part (model 2): from B/part.json\n" in out
    rows = [line for line in out.splitlines() if line.split()[1:3] == ["part", "(model"]]
    assert [int(row.split()[3].rstrip(")")) - 1 for row in rows] == numbers
    models = run(capsys, "models", *names)
    assert "part (model 2): 6 faces" in models and "  from B/part.json\n" in models


def test_a_model_given_twice_is_said_to_be(folder, capsys):
    arguments = ("recognize", "bracket.json", "bracket.json", "--contacts", "touches.csv")
    assert "bracket (model 2): from bracket.json; the same as model 1: " in run(capsys, *arguments)
    document = json.loads(run(capsys, *arguments, "--json"))
    numbers = [hypothesis["model_number"] for hypothesis in document["hypotheses"]]
    assert numbers == sorted(numbers) and set(numbers) == {0, 1}


@pytest.mark.parametrize("name", ["$5^{", "[red]", ":car:", "部品"])
def test_any_name_is_drawn_and_printed_as_it_is(folder, capsys, name):
    write_model("odd.json", BRACKET, name=name)
    for extra in ((), ("--plot-range", "1")):
        arguments = ("recognize", "odd.json", "--contacts", "touches.csv", "--plot", "found.svg", *extra)
        assert f": it is {name}; " in run(capsys, *arguments)
    assert f"{name}: 6 faces" in run(capsys, "models", "odd.json", "--plot", "odd.png")


@pytest.mark.parametrize("extra", [(), ("--json",)])
@pytest.mark.parametrize("command", ["recognize", "models"])
def test_a_picture_that_fails_leaves_the_answer(folder, capsys, *, monkeypatch, command, extra):
    def fail(figure, path):
        raise OSError(28, "No space left on device", str(path))

    monkeypatch.setattr("palpate.plots.save_figure", fail)
    arguments = {"recognize": ["bracket.json", "--contacts", "touches.csv"], "models": ["boot"]}
    status = main([command, *arguments[command], "--plot", "x.svg", *extra])
    out, err = capsys.readouterr()
    assert (status, err) == (2, "palpate: x.svg: No space left on device\n")
    assert json.loads(out) if extra else len(out.splitlines()) > 1


def test_symmetries_are_in_order_and_many_are_summed_up(folder, capsys):
    for sides, words in ((6, "turned by 60°, 120°, 180°, 240°, 300°"), (45, "multiples of 8°, 45 in a full")):
        angles = np.linspace(0.0, 2.0 * math.pi, sides, endpoint=False)
        write_model("disc.json", [[20 * math.cos(a), 20 * math.sin(a)] for a in angles])
        assert words in run(capsys, "models", "disc.json")


def test_many_untouchable_vertices_are_summed_up(folder, capsys):
    angles = np.linspace(0.0, 2.0 * math.pi, 60, endpoint=False)
    star = [
        [(20 + 9 * (k % 2)) * math.cos(a), (20 + 9 * (k % 2)) * math.sin(a)] for k, a in enumerate(angles)
    ]
    write_model("star.json", star)
    assert "can't be touched, by number: 30 of them, 0, 2, 4, 6, 8 ... 58; --json" in run(
        capsys, "models", "star.json"
    )


def test_tiny_parts_keep_their_digits(folder, capsys):
    write_model("tiny.json", [[1e-6 * x for x in point] for point in BRACKET])
    out = run(capsys, "models", "tiny.json", "--faces")
    assert "0.0000800, 0.0000150" in out
    Path("tiny.csv").write_text("x,y,nx,ny\n0.00003,0,0,-1\n0,0.00002,-1,0\n")
    flags = ("--position-error", "5e-8", "--normal-error-deg", "1")
    rows = run(capsys, "recognize", "tiny.json", "--contacts", "tiny.csv", *flags).splitlines()
    shift = next(float(row.split()[-1]) for row in rows if row.split()[1:2] == ["tiny"])
    assert 0.0 < shift < 1e-5


def write_drawing(file, layers):
    """Each outline on its layer."""
    document = ezdxf.new(setup=True)
    document.units = ezdxf.units.MM
    for layer, outline in layers.items():
        document.modelspace().add_lwpolyline(outline, close=True, dxfattribs={"layer": layer})
    document.saveas(file)


def test_layers_of_drawings_are_chosen(folder, capsys):
    write_drawing("drawn.dxf", {"PART": BRACKET, "FRAME": [[x + 200, y] for x, y in PLATE]})
    assert run(capsys, "models", "drawn.dxf").count(" faces, ") == 2
    assert run(capsys, "models", "drawn.dxf", "--layers", "part").startswith("drawn: 6 faces, ")
    arguments = ("recognize", "drawn.dxf", "--contacts", "touches.csv", "--json", "--layers", "PART, FRAME")
    assert len(json.loads(run(capsys, *arguments))["models"]) == 2
    for layers, message in (
        ("A", "there is no layer "),
        (",", "Invalid value for '--layers': must be names"),
    ):
        assert main(["models", "drawn.dxf", "--layers", layers]) == 2
        assert message in capsys.readouterr().err
    assert with_flags("name them with layers=, or give flattening: 1; players=2") == (
        "name them with --layers, or give --flattening: 1; players=2"
    )


def test_flattening_is_chosen(folder, capsys):
    document = ezdxf.new(setup=True)
    document.units = ezdxf.units.MM
    document.modelspace().add_circle((0, 0), 20)
    document.saveas("ring.dxf")
    counts = []
    for flattening in ("0.05", "0.005"):
        out = run(capsys, "models", "ring.dxf", "--flattening", flattening)
        counts.append(int(out.split("ring: ")[1].split(" faces")[0]))
    assert counts[0] < counts[1]


def test_the_exit_code_is_documented(capsys):
    assert "Exit code 0" in run(capsys, "recognize", "--help")
