"""Contact files: what was touched, what was missed and what was known beforehand, as CSV or JSON.

A CSV file has a header; its columns are `x,y` and, as needed, `kind` (`contact` or `miss`), `nx,ny`,
`position_error`, `normal_error_deg`, `tip_radius`, `path_error`, `approach_x,approach_y`, `start_x,start_y`.
In space each of these points has a third column: `z`, `nz`, `approach_z`, `start_z`.
`x,y` is the centre of the tip; a miss swept from `start_x,start_y` to `x,y`. A blank cell is an absent value,
`#` begins a comment, and the comment `# unit: in` says that the file is in another unit than the models; a
comment that begins with "unit" and can't be understood is refused.
A JSON file is a `palpate-contacts` document (`schemas/contacts-1.json`); it can also hold a prior.

What a file leaves out comes from the arguments; what it says goes before them. Nothing is guessed: a contact
without a bound on its position error is refused.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from palpate._core import Contact, Miss, Prior
from palpate.contacts.csv_file import csv_text, parse_csv
from palpate.contacts.entry import (
    Defaults,
    check_defaults,
    contact_of,
    miss_of,
    mm_per,
    prior_of,
    refuse,
    sheet_of,
    write_text,
)
from palpate.contacts.entry import Sheet as Sheet
from palpate.contacts.json_file import document_of, parse_json


@dataclass(frozen=True)
class Evidence:
    """All that a contact file holds, in the models' unit and radians, ready for `recognize`."""

    contacts: list[Contact]
    misses: list[Miss] = field(default_factory=list[Miss])
    prior: Prior | None = None
    places: list[str] = field(default_factory=list[str])
    """Where each contact stands in its file, `line 3` or `contacts[0]`; empty if they are from none."""


def read_contacts(
    path: str | Path,
    *,
    unit: str = "mm",
    position_error: float | None = None,
    normal_error_deg: float | None = None,
    tip_radius: float | None = None,
    path_error: float | None = None,
) -> Evidence:
    """Contacts, misses and prior of a CSV or JSON file.

    Args:
        path: The file; its suffix, .csv or .json, says which of the two it is.
        unit: The models' unit, in which everything is returned; a file that names another one is converted.
        position_error: For contacts whose own is not in the file. The models' unit, as all lengths here.
        normal_error_deg: For contacts with a normal whose own is not in the file; degrees.
        tip_radius: For entries whose own is not in the file; else 0, a measured surface point.
        path_error: For misses whose own is not in the file; else their position error stands for it.

    Raises:
        ValueError: Naming file, line and column, or the place in the JSON document, or that it is not there.
    """
    path = Path(path)
    if path.is_dir():
        refuse(str(path), "is a folder", "name a .csv or .json file")
    mm_per_unit = mm_per(unit, "unit")
    defaults = Defaults(position_error, normal_error_deg, tip_radius, path_error)
    check_defaults(defaults)
    parse = {".csv": parse_csv, ".json": parse_json}.get(path.suffix.lower())
    if parse is None:
        refuse(path.name, f"suffix {path.suffix!r} is not known", "name the file .csv or .json")
    sheet = parse(path.name, _text_of(path))
    if not sheet.contacts and not sheet.misses:
        refuse(path.name, "no contact and no miss in it", "give at least one contact")
    if sheet.unit is not None:
        sheet = sheet.scaled(mm_per(sheet.unit, f"{path.name}: unit") / mm_per_unit)
    return Evidence(
        [contact_of(entry, defaults) for entry in sheet.contacts],
        [miss_of(entry, defaults) for entry in sheet.misses],
        None if sheet.prior is None else prior_of(sheet.prior),
        [entry.where.removeprefix(path.name).lstrip(",: ") for entry in sheet.contacts],
    )


def write_contacts(
    path: str | Path,
    contacts: Sequence[Contact],
    *,
    misses: Sequence[Miss] = (),
    prior: Prior | None = None,
    unit: str = "mm",
) -> None:
    """Write a contact file, CSV or JSON by its suffix. Reading it back gives equal contacts.

    Raises:
        ValueError: If the suffix is neither, something else is among the contacts or misses, the plane is
            mixed with space, a prior is to go into CSV, which has no place for it, or the file can't be
            written.
    """
    path = Path(path)
    mm_per(unit, "unit")
    sheet = sheet_of(contacts, misses, prior=prior, unit=unit)
    suffix = path.suffix.lower()
    if suffix == ".json":
        text = json.dumps(document_of(sheet), indent=2) + "\n"
    elif suffix == ".csv":
        if prior is not None:
            refuse(path.name, "a CSV file can't hold a prior", "write .json, or leave the prior out")
        text = csv_text(sheet)
    else:
        refuse(path.name, f"suffix {suffix!r} is not known", "name the file .csv or .json")
    write_text(path, text)


def contacts_document(
    contacts: Sequence[Contact], *, misses: Sequence[Miss] = (), prior: Prior | None = None, unit: str = "mm"
) -> dict[str, Any]:
    """The `palpate-contacts` document as plain lists and numbers."""
    mm_per(unit, "unit")
    return document_of(sheet_of(contacts, misses, prior=prior, unit=unit))


def _text_of(path: Path) -> str:
    try:
        return path.read_text(encoding="utf-8-sig")
    except FileNotFoundError:
        refuse(
            str(path),
            "no such file",
            "give a .csv or .json file; at the command line, a bundled part's name stands for its contacts",
        )
    except OSError as error:
        refuse(str(path), f"can't be read: {error.strerror}", "check the file's permissions")
    except UnicodeDecodeError:
        refuse(path.name, "is not UTF-8 text", "save it as UTF-8")
