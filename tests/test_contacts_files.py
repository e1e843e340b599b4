"""Contact files: what is written is read back, what can't be meant is refused in one line."""

import json
import math
from pathlib import Path

import jsonschema
import numpy as np
import pytest
from conftest import pose
from hypothesis import given, settings
from hypothesis import strategies as st

import palpate
from palpate import Contact, Miss, Prior
from palpate.contacts import contacts_document, read_contacts, write_contacts

SCHEMAS = Path(palpate.__file__).parent / "schemas"
CONTACTS_SCHEMA = json.loads((SCHEMAS / "contacts-1.json").read_text())

lengths = st.floats(0.0, 1e3)
dimensions = st.sampled_from([2, 3])


def places(dimension):
    return st.tuples(*[st.floats(-1e4, 1e4)] * dimension)


def directions(dimension):
    return st.tuples(*[st.floats(-1.0, 1.0)] * dimension).filter(lambda along: math.hypot(*along) > 1e-3)


@st.composite
def contacts(draw, dimension):
    normal = draw(st.none() | directions(dimension))
    return Contact.from_tip(
        draw(places(dimension)),
        draw(lengths),
        position_error=draw(lengths),
        normal=normal,
        normal_error=None if normal is None else draw(st.floats(0.0, math.pi / 2)),
        approach=draw(st.none() | directions(dimension)),
        start=draw(st.none() | places(dimension)),
    )


@st.composite
def misses(draw, dimension):
    ends = draw(places(dimension)), draw(places(dimension))
    return Miss(*ends, tip_radius=draw(lengths), path_error=draw(lengths))


@st.composite
def evidence(draw):
    """Contacts and misses, all of the plane or all of space."""
    dimension = draw(dimensions)
    some_contacts = draw(st.lists(contacts(dimension), min_size=1, max_size=4))
    return some_contacts, draw(st.lists(misses(dimension), max_size=3))


def assert_alike(one: Contact, other: Contact) -> None:
    # A direction is made unit again when it is read, which may change its last bit.
    for name in ("center", "start"):
        assert np.array_equal(getattr(one, name), getattr(other, name))
    for name in ("normal", "approach"):
        a, b = getattr(one, name), getattr(other, name)
        assert (a is None) == (b is None)
        assert a is None or np.allclose(a, b, rtol=0.0, atol=1e-15)
    assert (one.tip_radius, one.position_error) == (other.tip_radius, other.position_error)
    assert (one.normal_error is None) == (other.normal_error is None)
    assert one.normal_error is None or math.isclose(one.normal_error, other.normal_error, rel_tol=1e-15)


@pytest.mark.parametrize("suffix", ["csv", "json"])
@settings(deadline=None)
@given(given=evidence())
def test_what_is_written_is_read_back(tmp_path_factory, suffix, given):
    some_contacts, some_misses = given
    path = tmp_path_factory.mktemp("files") / f"touches.{suffix}"
    write_contacts(path, some_contacts, misses=some_misses, unit="in")
    found = read_contacts(path, unit="in")
    assert len(found.contacts) == len(some_contacts)
    for one, other in zip(found.contacts, some_contacts, strict=True):
        assert_alike(one, other)
    assert found.misses == some_misses
    assert found.prior is None


@settings(deadline=None)
@given(given=evidence(), rotation=st.floats(0.0, math.pi), lying=st.booleans())
def test_documents_validate(given, rotation, *, lying):
    some_contacts, some_misses = given
    prior = Prior(pose(0.3, 1.0, 2.0), translation=20.0, rotation=rotation)
    if len(some_contacts[0].center) == 3:
        bounds = {"translation": 20.0, "rotation": rotation}
        on_plane = {"height": 1.0, "tilt": 0.1, "normal": (0.0, 1.0, 1.0)}
        prior = Prior.on_plane(np.eye(4), **bounds, **on_plane) if lying else Prior(np.eye(4), **bounds)
    document = contacts_document(some_contacts, misses=some_misses, prior=prior, unit="mm")
    jsonschema.validate(json.loads(json.dumps(document)), CONTACTS_SCHEMA)


def test_schemas_are_schemas():
    files = sorted(SCHEMAS.glob("*.json"))
    assert len(files) >= 4
    for file in files:
        jsonschema.Draft202012Validator.check_schema(json.loads(file.read_text()))


def test_a_prior_is_read_back(tmp_path):
    path = tmp_path / "touches.json"
    prior = Prior(pose(0.3, 1.0, 2.0), translation=20.0, rotation=math.radians(15.0))
    write_contacts(path, [Contact((0, 0), position_error=1.0)], prior=prior)
    assert json.loads(path.read_text())["prior"]["rotation_deg"] == 15.0
    assert read_contacts(path).prior == prior


@pytest.mark.parametrize("normal", [(0, 0, 1), (0, 3, 4)])
def test_a_prior_of_space_is_read_back(tmp_path, normal):
    path = tmp_path / "touches.json"
    middle = np.eye(4)
    middle[:2, :2], middle[:3, 3] = pose(0.3)[:2, :2], (1.0, 2.0, 3.0)
    bounds = {"translation": 20.0, "rotation": math.radians(15.0)}
    lying = Prior.on_plane(middle, **bounds, height=1.5, tilt=math.radians(2.0), normal=normal)
    touched = [Contact((0, 0, 0), position_error=1.0)]
    for prior in (Prior(middle, **bounds), lying):
        write_contacts(path, touched, prior=prior)
        assert read_contacts(path).prior == prior
    assert json.loads(path.read_text())["prior"]["tilt_deg"] == 2.0
    write_contacts(path, touched, prior=lying, unit="cm")
    in_mm = read_contacts(path).prior
    assert (in_mm.height, in_mm.translation, in_mm.tilt) == (15.0, 200.0, lying.tilt)
    assert np.array_equal(in_mm.world_from_model[:3, 3], (10.0, 20.0, 30.0))
    assert np.array_equal(in_mm.normal, lying.normal)


def test_evidence_of_the_plane_and_of_space_is_not_mixed(tmp_path):
    flat, high = Contact((0, 0), position_error=1.0), Contact((0, 0, 0), position_error=1.0)
    miss = Miss((0, 0, 0), (1, 0, 0))
    for path in (tmp_path / "touches.csv", tmp_path / "touches.json"):
        with pytest.raises(
            ValueError, match=r"contacts\[1\]: the plane is mixed with space \(got 3 coord.*; write"
        ):
            write_contacts(path, [flat, high])
        with pytest.raises(
            ValueError, match=r"misses\[0\]: the plane is mixed with space \(got 3 coord.*; write"
        ):
            write_contacts(path, [flat], misses=[miss])
    prior = Prior(np.eye(3), translation=1.0, rotation=0.1)
    with pytest.raises(ValueError, match=r"prior: the plane is mixed with space \(got 2 coord.*; write"):
        write_contacts(tmp_path / "touches.json", [high], prior=prior)
    assert list(tmp_path.iterdir()) == []


def test_a_prior_does_not_go_into_csv(tmp_path):
    prior = Prior(np.eye(3), translation=1.0, rotation=0.1)
    with pytest.raises(ValueError, match="CSV file can't hold a prior"):
        write_contacts(tmp_path / "touches.csv", [Contact((0, 0), position_error=1.0)], prior=prior)


def read(tmp_path, text, suffix="csv", **flags):
    path = tmp_path / f"touches.{suffix}"
    path.write_text(text if isinstance(text, str) else json.dumps(text))
    return read_contacts(path, **flags)


def test_csv_in_full(tmp_path):
    text = """\
# measured on Tuesday
kind,x,y,nx,ny, position_error,normal_error_deg, tip_radius,path_error, approach_x,approach_y, start_x,start_y
contact, 10,5, 0,2, 0.5,4, ,, ,, ,
contact, 20,5, ,, 0.2,, 1.5,, 0,-1, 20,30   # no normal

miss, 0,9, ,, 0.3,, 1.5,, ,, -40,9
miss, 0,8, ,, 0.3,, 1.5,0.1, ,, -40,8
,,,,,,,,,,,,
"""
    found = read(tmp_path, text)
    assert found.contacts == [
        Contact((10, 5), (0, 1), position_error=0.5, normal_error=math.radians(4)),
        Contact.from_tip((20, 5), 1.5, position_error=0.2, approach=(0, -1), start=(20, 30)),
    ]
    assert found.misses == [
        Miss((-40, 9), (0, 9), tip_radius=1.5, path_error=0.3),
        Miss((-40, 8), (0, 8), tip_radius=1.5, path_error=0.1),
    ]


def test_csv_in_space(tmp_path):
    text = """\
kind,x,y,z,nx,ny,nz,position_error,normal_error_deg,tip_radius,approach_x,approach_y,approach_z,start_x,start_y,start_z
contact,10,5,3, 0,0,2, 0.5,4, , ,,, ,,
contact,20,5,3, ,,, 0.2,, 1.5, 0,-1,0, 20,30,3
miss,0,9,3, ,,, 0.3,, 1.5, ,,, -40,9,3
"""
    found = read(tmp_path, text, unit="mm")
    assert found.contacts == [
        Contact((10, 5, 3), (0, 0, 1), position_error=0.5, normal_error=math.radians(4)),
        Contact.from_tip((20, 5, 3), 1.5, position_error=0.2, approach=(0, -1, 0), start=(20, 30, 3)),
    ]
    assert found.misses == [Miss((-40, 9, 3), (0, 9, 3), tip_radius=1.5, path_error=0.3)]
    in_inches = read(tmp_path, "# unit: in\n" + text).contacts[1]
    assert np.allclose(in_inches.start, (508, 762, 76.2)) and np.array_equal(in_inches.approach, (0, -1, 0))


def test_arguments_fill_what_the_file_leaves_out(tmp_path):
    text = "x,y,nx,ny,position_error\n1,2,1,0,\n3,4,,,0.1\n"
    found = read(tmp_path, text, position_error=0.5, normal_error_deg=2.0, tip_radius=3.0)
    assert [contact.position_error for contact in found.contacts] == [0.5, 0.1]
    assert [contact.normal_error for contact in found.contacts] == [math.radians(2.0), None]
    assert [contact.tip_radius for contact in found.contacts] == [3.0, 3.0]


def test_path_error_of_a_miss(tmp_path):
    text = "kind,x,y,start_x,start_y\nmiss,1,0,0,0\n"
    assert read(tmp_path, text).misses[0].path_error == 0.0
    assert read(tmp_path, text, position_error=0.5).misses[0].path_error == 0.5
    assert read(tmp_path, text, position_error=0.5, path_error=0.2).misses[0].path_error == 0.2


def test_lengths_are_converted_to_the_models_unit(tmp_path):
    document = {
        "schema": "palpate-contacts",
        "version": 1,
        "unit": "in",
        "contacts": [
            {"center": [1, 2], "tip_radius": 0.5, "normal": [0, 1], "normal_error_deg": 4, "start": [0, 1]}
        ],
        "misses": [{"start": [0, 0], "end": [1, 0]}],
        "prior": {"world_from_model": pose(0.1, 1.0, 2.0).tolist(), "translation": 1.0, "rotation_deg": 10.0},
    }
    jsonschema.validate(document, CONTACTS_SCHEMA)
    found = read(tmp_path, document, "json", unit="mm", position_error=0.5)
    (contact,) = found.contacts
    assert np.allclose(contact.center, [25.4, 50.8])
    assert np.allclose(contact.start, [0, 25.4])
    assert (contact.tip_radius, contact.position_error) == (12.7, 0.5)  # the argument is in the models' unit
    assert np.array_equal(contact.normal, [0, 1])
    assert np.allclose(found.misses[0].end, [25.4, 0])
    assert found.prior == Prior(pose(0.1, 25.4, 50.8), translation=25.4, rotation=math.radians(10.0))


def test_csv_says_its_unit_in_a_comment(tmp_path):
    text = "# unit: in\nx,y,position_error\n1,0,0.1\n"
    assert np.allclose(read(tmp_path, text).contacts[0].center, [25.4, 0])
    assert np.allclose(read(tmp_path, text, unit="in").contacts[0].center, [1, 0])


@pytest.mark.parametrize(
    "comment",
    [
        "# Units: in",
        "# UNIT: IN",
        "# unit in",
        "#unit;in",
        "#unit:in",
        "# unit = in",
        "# unit: in,,,",
        '"# unit: in, "',
    ],
)
def test_a_unit_may_be_said_in_several_ways(tmp_path, comment):
    text = f"{comment}\nx,y,position_error\n1,0,0.1\n"
    assert np.allclose(read(tmp_path, text).contacts[0].center, [25.4, 0])


def test_a_unit_may_be_said_beside_the_header_and_twice(tmp_path):
    text = "# unit: in\nx,y,position_error # units: in\n1,0,0.1\n"
    assert np.allclose(read(tmp_path, text).contacts[0].center, [25.4, 0])


def test_other_comments_say_no_unit(tmp_path):
    text = "# united\n# the unit is in\nx,y,position_error\n1,0,0.1\n"
    assert np.allclose(read(tmp_path, text).contacts[0].center, [1, 0])


def test_blank_columns_at_the_end_are_left_out(tmp_path):
    text = "x,y,position_error,,\n1,0,0.1,,\n2,0,0.1\n3,0,0.1,,,,\n,,,,\n"
    assert [contact.center[0] for contact in read(tmp_path, text).contacts] == [1, 2, 3]


def test_places_say_where_each_contact_stands(tmp_path):
    rows = ["miss,0,9,1,5,9", "contact,1,2,1,,", "", "contact,3,4,1,,"]
    text = "\n".join(["# a comment", "kind,x,y,position_error,start_x,start_y", *rows])
    assert read(tmp_path, text).places == ["line 4", "line 6"]
    document = json_with(contacts=[{"center": [1, 2], "position_error": 1}] * 2)
    assert read(tmp_path, document, "json").places == ["contacts[0]", "contacts[1]"]


@pytest.mark.parametrize(
    ("argument", "value"),
    [("position_error", -0.5), ("tip_radius", -1.0), ("path_error", math.nan), ("normal_error_deg", 400.0)],
)
def test_bad_arguments_are_not_blamed_on_the_file(tmp_path, argument, value):
    with pytest.raises(ValueError, match=rf"^{argument}: must be .* \(got {value:g}\); give "):
        read(tmp_path, "x,y\n1,2\n", **({"position_error": 1.0} | {argument: value}))


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"contacts": [1]}, "contacts[0]: must be a Contact (got 1); give a list of palpate.Contact"),
        ({"contacts": 1}, "contacts: must be a sequence of Contact (got 1); give a list of palpate.Contact"),
        (
            {"contacts": "ab"},
            "contacts: must be a sequence of Contact (got 'ab'); give a list of palpate.Contact",
        ),
        (
            {"contacts": [], "misses": [None]},
            "misses[0]: must be a Miss (got None); give a list of palpate.Miss",
        ),
        ({"contacts": [], "prior": 3}, "prior: must be a Prior (got 3); give palpate.Prior, or leave it out"),
    ],
)
@pytest.mark.parametrize("suffix", ["csv", "json"])
def test_only_evidence_is_written(tmp_path, suffix, *, arguments, message):
    with pytest.raises(ValueError) as refusal:
        write_contacts(tmp_path / f"x.{suffix}", **arguments)
    assert str(refusal.value) == message
    assert list(tmp_path.iterdir()) == []


def test_a_spreadsheet_s_byte_order_mark_is_no_part_of_the_header(tmp_path):
    assert len(read(tmp_path, "\ufeffx,y,position_error\r\n1,0,0.1\r\n").contacts) == 1


BAD_CSV = [
    ("x,y\n", "touches.csv: no contact and no miss in it"),
    ("x,nx,ny\n1,2,3\n", "touches.csv, line 1, column y: absent from the header"),
    ("x,y,nx\n1,2,3\n", "touches.csv, line 1, column ny: absent from the header"),
    ("x,y,x\n1,2,3\n", "touches.csv, line 1, column x: is there twice"),
    ("x,y,z\n1,2,3\n", "touches.csv, line 2, position_error: absent"),
    ("x,y,z,nx,ny\n1,2,3,0,1\n", "touches.csv, line 1, column nz: absent from the header, though there is z"),
    (
        "x,y,nx,ny,nz\n1,2,0,0,1\n",
        "touches.csv, line 1, column z: absent from the header, though there is nz",
    ),
    ("x,z\n1,2\n", "touches.csv, line 1, column y: absent from the header; give x, y and z"),
    (
        "x,y,z,start_x,start_y\n1,2,3,0,1\n",
        "touches.csv, line 1, column start_z: absent from the header, though there is z",
    ),
    (
        "x,y,z,position_error\n1,2,3,0.5\n4,5,,0.5\n",
        "touches.csv, line 3, column z: blank while its partner is not; give x, y and z, or none of them",
    ),
    (
        "kind,x,y,z,start_x,start_y,start_z\nmiss,1,2,3,,,\n",
        "touches.csv, line 2, column start_x: blank in a miss; a miss swept from its start to x,y,z: ",
    ),
    ("x,y,force\n1,2,3\n", "touches.csv, line 1, column 'force': unknown"),
    ("x,y\n1,2\n", "touches.csv, line 2, position_error: absent"),
    ("x,y,position_error\n1,2,0.5\n\n3,4,\n", "touches.csv, line 4, position_error: absent"),
    (
        "x,y,nx,ny,position_error\n1,2,0,1,0.5\n",
        "touches.csv, line 2, normal_error_deg: absent, though there is a normal",
    ),
    ("x,y,position_error\n1,2\n", "touches.csv, line 2: 2 cells where the header has 3"),
    ("x,y,position_error\n1,5,2,0.5\n", "touches.csv, line 2: 4 cells where the header has 3"),
    ("x,y,position_error\n1,two,0.5\n", "touches.csv, line 2, column y: 'two' is not a finite number"),
    ("x,y,position_error\n1,nan,0.5\n", "touches.csv, line 2, column y: 'nan' is not a finite number"),
    ("x,y,position_error\n1e999,2,0.5\n", "touches.csv, line 2, column x: '1e999' is not a finite number"),
    ("x,y,position_error\n1_0,2,0.5\n", "touches.csv, line 2, column x: '1_0' is not a finite number"),
    ("x,y,position_error\n,2,0.5\n", "touches.csv, line 2, column x: blank while its partner is not"),
    ("x,y,position_error\n,,0.5\n", "touches.csv, line 2, column x: blank"),
    ("x,y,position_error\n1,2,-0.5\n", "touches.csv, line 2: position_error: "),
    ("x,y,position_error,tip_radius\n1,2,1,-1\n", "touches.csv, line 2: tip_radius: "),
    ("x,y,nx,ny,position_error,normal_error_deg\n1,2,0,0,1,4\n", "touches.csv, line 2: normal: "),
    (
        "x,y,nx,ny,position_error,normal_error_deg\n1,2,0,1,1,120\n",
        "touches.csv, line 2, normal_error_deg: must be an angle in degrees, from 0 to 90 (got 120)",
    ),
    ("kind,x,y,position_error\ntap,1,2,0.5\n", "touches.csv, line 2, column kind: unknown kind 'tap'"),
    ("kind,x,y\nmiss,1,2\n", "touches.csv, line 2, column start_x: blank in a miss"),
    (
        "kind,x,y,nx,ny,start_x,start_y\nmiss,1,2,0,1,0,0\n",
        "touches.csv, line 2, column nx: a miss has no normal",
    ),
    ("x;y\n1,5;2\n", "touches.csv, line 1: its columns are separated by semicolons; use commas"),
    ("x\ty\n1\t2\n", "touches.csv, line 1: its columns are separated by tabs; use commas"),
    (
        "73.3,3.4,-0.06,-1.0\n",
        "touches.csv, line 1: numbers where the header should be; begin with a line such as x,y,nx,ny",
    ),
    (
        "1,2,3,0,0,1\n",
        "touches.csv, line 1: numbers where the header should be; begin with a line such as x,y,z,nx",
    ),
    ("1,2,3\n", "touches.csv, line 1: numbers where the header should be; begin with a line such as x,y,z"),
    ("", "touches.csv: no header in it; begin with a line such as x,y,nx,ny, in space x,y,z,nx,ny,nz"),
    (",,\n1,2,3\n", "touches.csv, line 1: the header is blank"),
    ("x,y,position_error,,\n1,2,0.5,,\n3,4,0.5,,7\n", "touches.csv, line 3: 5 cells where the header has 3"),
    ("x,,y\n1,,2\n", "touches.csv, line 1, column '': unknown"),
    ("# Unit: mm; 2024-01-01\nx,y\n1,2\n", "touches.csv, line 1: 'Unit: mm; 2024-01-01' says no unit"),
    ("# units of length are mm\nx,y\n1,2\n", "touches.csv, line 1: 'units of length are mm' says no unit"),
    ("# UNIT\nx,y\n1,2\n", "touches.csv, line 1: 'UNIT' says no unit"),
    ("# unit: mm\n# Unit: in\nx,y\n1,2\n", "touches.csv, line 2: the unit is 'in', before it was 'mm'"),
    (
        "x,y,position_error\n1,2,0.5\n# unit: in\n",
        "touches.csv, line 3: the unit is said after the first row",
    ),
    ("# unit: furlong\nx,y,position_error\n1,2,0.5\n", "touches.csv: unit: unknown unit 'furlong'"),
]


def json_with(**changes):
    document = {"schema": "palpate-contacts", "version": 1, "unit": "mm", "contacts": [{"center": [1, 2]}]}
    return {key: value for key, value in (document | changes).items() if value != "absent"}


def prior_with(**changes):
    prior = {"world_from_model": np.eye(3).tolist(), "translation": 1, "rotation_deg": 10}
    return json_with(prior=prior | changes, contacts=[{"center": [1, 2], "position_error": 1}])


def space_prior_with(**changes):
    document = prior_with(**({"world_from_model": np.eye(4).tolist()} | changes))
    return document | {"contacts": [{"center": [1, 2, 3], "position_error": 1}]}


BAD_JSON = [
    ("{", "touches.json, line 1: not JSON: "),
    ("[" * 100_000, "touches.json: its brackets are nested too deeply"),
    ('{"x": NaN}', "touches.json: NaN is not a finite number"),
    ([], "touches.json: [] is not an object"),
    (json_with(schema="absent"), "touches.json: schema: None is not 'palpate-contacts'"),
    (json_with(schema="palpate-model"), "touches.json: schema: 'palpate-model' is not 'palpate-contacts'"),
    (json_with(version=2), "touches.json: version: 2 can't be read here"),
    (json_with(unit="absent"), "touches.json: unit: None is not a unit"),
    (json_with(unit="parsec"), "touches.json: unit: unknown unit 'parsec'"),
    (json_with(contact=[]), "touches.json: contact: unknown key"),
    (json_with(contacts={}), "touches.json: contacts: {} is not a list"),
    (json_with(contacts=[]), "touches.json: no contact and no miss in it"),
    (json_with(contacts=[5]), "touches.json: contacts[0]: 5 is not an object"),
    (json_with(contacts=[{}]), "touches.json: contacts[0]: center: absent"),
    (json_with(contacts=[{"center": [1, 2, 3]}]), "touches.json: contacts[0], position_error: absent"),
    (
        json_with(contacts=[{"center": [1, 2, 3, 4]}]),
        "touches.json: contacts[0]: center: [1, 2, 3, 4] is not",
    ),
    (
        json_with(contacts=[{"center": [1, 2]}, {"center": [1, 2, 3]}]),
        "touches.json: contacts[1]: center: the plane is mixed with space (got 3 coordinates where",
    ),
    (
        json_with(contacts=[{"center": [1, 2, 3], "normal": [0, 1]}]),
        "touches.json: contacts[0]: normal: the plane is mixed with space (got 2 coordinates where",
    ),
    (
        json_with(misses=[{"start": [0, 0, 0], "end": [1, 0, 0]}]),
        "touches.json: misses[0]: start: the plane is mixed with space",
    ),
    (
        prior_with(world_from_model=np.eye(4).tolist()),
        "touches.json: prior: world_from_model: the plane is mixed with space (got 3 coordinates where",
    ),
    (
        prior_with(height=1, tilt_deg=2),
        "touches.json: prior: height: is of space, the pose of the plane; give",
    ),
    (space_prior_with(height=1), "touches.json: prior: tilt_deg: absent, though there is height; give"),
    (space_prior_with(normal=[0, 0, 1]), "touches.json: prior: height: absent, though there is normal; give"),
    (
        space_prior_with(height=1, tilt_deg=200),
        "touches.json: prior: tilt_deg: must be an angle in degrees, from 0 to 180 (got 200)",
    ),
    (space_prior_with(height=-1, tilt_deg=2), "touches.json: prior: height: "),
    (
        space_prior_with(height=1, tilt_deg=2, normal=[0, 1]),
        "touches.json: prior: normal: [0, 1] is of the plane; give it as [x, y, z]",
    ),
    (
        space_prior_with(world_from_model=[[1, 0, 0], *np.eye(4).tolist()[1:]]),
        "touches.json: prior: world_from_model: [1, 0, 0] is not a row of 4 numbers; give 4 rows",
    ),
    (json_with(contacts=[{"center": "here"}]), 'touches.json: contacts[0]: center: "here" is not a point'),
    (
        json_with(contacts=[{"center": [1, True]}]),
        "touches.json: contacts[0]: center: true is not a finite number",
    ),
    (json_with(contacts=[{"center": [1, 10**400]}]), "touches.json: contacts[0]: center: 1000"),
    (
        json_with(contacts=[{"center": [1, 2], "normall": [0, 1]}]),
        "touches.json: contacts[0]: normall: unknown key",
    ),
    (json_with(), "touches.json: contacts[0], position_error: absent"),
    (json_with(misses=[{"start": [0, 0]}]), "touches.json: misses[0]: end: absent"),
    (prior_with(translation=-1), "touches.json: prior: translation: "),
    (
        prior_with(rotation_deg=200),
        "touches.json: prior: rotation_deg: must be an angle in degrees, from 0 to 180 (got 200)",
    ),
    (
        prior_with(world_from_model=[[1, 0], [0, 1]]),
        "touches.json: prior: world_from_model: [[1, 0], [0, 1]] is not",
    ),
    (
        prior_with(world_from_model=[[1, 0, 0], [0, 1, 0], 7]),
        "touches.json: prior: world_from_model: 7 is not a row",
    ),
    (
        prior_with(world_from_model=[[2, 0, 0], [0, 1, 0], [0, 0, 1]]),
        "touches.json: prior: world_from_model: ",
    ),
    (json_with(prior={}), "touches.json: prior: world_from_model: absent"),
]


@pytest.mark.parametrize(("text", "message"), BAD_CSV)
def test_bad_csv_is_refused(tmp_path, text, message):
    assert_refused(tmp_path, text, suffix="csv", message=message)


@pytest.mark.parametrize(("document", "message"), BAD_JSON)
def test_bad_json_is_refused(tmp_path, document, message):
    assert_refused(tmp_path, document, suffix="json", message=message)


def assert_refused(tmp_path, content, *, suffix, message):
    with pytest.raises(ValueError) as refusal:
        read(tmp_path, content, suffix)
    text = str(refusal.value)
    assert text.startswith(message)
    assert "\n" not in text
    assert ";" in text, "the remedy follows the problem"


@pytest.mark.parametrize("write", [False, True])
def test_other_suffixes_are_refused(tmp_path, write):
    path = tmp_path / "touches.xlsx"
    path.write_text("")
    with pytest.raises(
        ValueError, match=r"touches\.xlsx: suffix '\.xlsx' is not known; name the file \.csv or \.json"
    ):
        if write:
            write_contacts(path, [Contact((0, 0), position_error=1.0)])
        else:
            read_contacts(path)


def test_files_that_are_not_there_are_refused_with_a_remedy(tmp_path):
    with pytest.raises(ValueError, match=r"gone\.csv: no such file; give a \.csv or \.json file"):
        read_contacts(tmp_path / "gone.csv")
    there = [Contact((0, 0), position_error=1.0)]
    with pytest.raises(ValueError, match=r"touches\.csv: its folder is not there; make the folder first"):
        write_contacts(tmp_path / "gone" / "touches.csv", there)
    (tmp_path / "folder.csv").mkdir()
    with pytest.raises(ValueError, match=r"folder\.csv: can't be written: .*; name a file in a folder"):
        write_contacts(tmp_path / "folder.csv", there)


def test_text_that_is_not_utf8_is_refused(tmp_path):
    path = tmp_path / "touches.csv"
    path.write_bytes(b"x,y\xe9\n")
    with pytest.raises(ValueError, match="is not UTF-8 text"):
        read_contacts(path)
