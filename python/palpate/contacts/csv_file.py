"""Contacts as CSV: one row for each contact or miss, columns by name."""

from __future__ import annotations

import csv
import math
import re

from palpate.contacts.entry import MM_PER_UNIT, SCALARS, Entry, Point, Sheet, refuse

POINT_COLUMNS = {
    "center": ("x", "y", "z"),
    "normal": ("nx", "ny", "nz"),
    "approach": ("approach_x", "approach_y", "approach_z"),
    "start": ("start_x", "start_y", "start_z"),
}
CENTER, NORMAL, *WAYS = POINT_COLUMNS.values()
COLUMNS = ("kind", *CENTER, *NORMAL, *SCALARS, *(column for way in WAYS for column in way))
# A file that has any of these is of space, and has all of those that go with its other columns.
SPACE_COLUMNS = tuple(columns[2] for columns in POINT_COLUMNS.values())
NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?")  # float() would also take "nan" and "1_000"
# A comment that begins with "unit" is meant to say one: what of it is not understood is refused.
UNIT_COMMENT = re.compile(r"units?(?![a-z])(.*)", re.IGNORECASE)
UNIT_VALUE = re.compile(r"\s*[:=;,]?\s*([a-z]+)[\s;,\"]*", re.IGNORECASE)  # a spreadsheet may add separators


def parse_csv(name: str, text: str) -> Sheet:
    """The sheet of a CSV file called `name`."""
    header: list[str] | None = None
    unit: str | None = None
    contacts: list[Entry] = []
    misses: list[Entry] = []
    for number, line in enumerate(text.splitlines(), start=1):
        where = f"{name}, line {number}"
        bare, comment = _split(line)
        said = _unit(where, comment)
        if said is not None:
            if unit is not None and said != unit:
                refuse(where, f"the unit is {said!r}, before it was {unit!r}", "say one unit for the file")
            if contacts or misses:
                refuse(where, "the unit is said after the first row", "say it above the header")
            unit = said
        cells = _cells(bare)
        if not cells:
            continue
        if header is None:
            header = _header(where, cells)
            continue
        row = _row_of(where, cells, header)
        if row:  # a row of blanks is what spreadsheets leave at the end
            (misses if _kind(where, row) == "miss" else contacts).append(_entry(where, row, header))
    if header is None:
        refuse(name, "no header in it", f"begin with a line such as {_columns_for(0)}")
    return Sheet(unit, contacts, misses)


def csv_text(sheet: Sheet) -> str:
    """The text of a CSV file for `sheet`, with the columns it needs."""
    rows = [_row("contact", entry) for entry in sheet.contacts] + [
        _row("miss", entry) for entry in sheet.misses
    ]
    used = {column for row in rows for column in row} | {"x", "y"}
    columns = [column for column in COLUMNS if column in used and (column != "kind" or sheet.misses)]
    lines = [f"# unit: {sheet.unit}"] if sheet.unit is not None else []
    lines.append(",".join(columns))
    lines += [",".join(row.get(column, "") for column in columns) for row in rows]
    return "\n".join(lines) + "\n"


def _split(line: str) -> tuple[str, str]:
    """What stands before `#`, and the comment after it."""
    bare, _, comment = line.partition("#")
    # A spreadsheet puts a comment that has a comma in it into quotes.
    return ("" if bare.strip() == '"' else bare), comment.strip().strip('"')


def _unit(where: str, comment: str) -> str | None:
    """The unit that a comment says, None if it is about something else."""
    about_unit = UNIT_COMMENT.match(comment)
    if about_unit is None:
        return None
    value = UNIT_VALUE.fullmatch(about_unit[1])
    if value is None:
        known = ", ".join(MM_PER_UNIT)
        refuse(where, f"{comment!r} says no unit that is understood", f"write # unit: and one of {known}")
    return value[1].lower()


def _cells(bare: str) -> list[str]:
    return [cell.strip() for cell in next(csv.reader([bare.strip()]))] if bare.strip() else []


def _header(where: str, cells: list[str]) -> list[str]:
    header = [cell.lower() for cell in cells]
    _refuse_what_is_no_header(where, cells)
    while not header[-1]:  # columns that a spreadsheet adds; the rows must leave them blank
        header.pop()
    for column in header:
        if column not in COLUMNS:
            refuse(f"{where}, column {column!r}", "unknown", f"the columns are {','.join(COLUMNS)}")
        if header.count(column) > 1:
            refuse(f"{where}, column {column}", "is there twice", "remove one of them")
    for columns in _point_columns(header).values():
        missing = [column for column in columns if column not in header]
        if missing and ("x" in columns or len(missing) < len(columns)):
            also = [column for column in SPACE_COLUMNS if column in header]
            why = f", though there is {also[0]}" if also and missing[0] in SPACE_COLUMNS else ""
            refuse(f"{where}, column {missing[0]}", f"absent from the header{why}", _all_or(columns))
    return header


def _point_columns(header: list[str]) -> dict[str, tuple[str, ...]]:
    """The columns of each point, two in the plane and three in space."""
    dimension = 3 if any(column in SPACE_COLUMNS for column in header) else 2
    return {name: columns[:dimension] for name, columns in POINT_COLUMNS.items()}


def _all_or(columns: tuple[str, ...], otherwise: str = "") -> str:
    return f"give {', '.join(columns[:-1])} and {columns[-1]}{otherwise}"


def _refuse_what_is_no_header(where: str, cells: list[str]) -> None:
    """Name the cause where the first row is no header at all."""
    begin = f"begin with a line such as {_columns_for(len([cell for cell in cells if cell]))}"
    for separator, plural in ((";", "semicolons"), ("\t", "tabs")):
        if len(cells) == 1 and separator in cells[0]:
            refuse(where, f"its columns are separated by {plural}", "use commas, and points in decimals")
    if not any(cells):
        refuse(where, "the header is blank", begin)
    if all(NUMBER.fullmatch(cell) for cell in cells if cell):
        refuse(where, "numbers where the header should be", begin)


def _columns_for(count: int) -> str:
    """Columns that so many numbers in a row may be."""
    known = {2: "x,y", 3: "x,y,z", 4: "x,y,nx,ny", 6: "x,y,z,nx,ny,nz"}
    return known.get(count, "x,y,nx,ny, in space x,y,z,nx,ny,nz")


def _row_of(where: str, cells: list[str], header: list[str]) -> dict[str, str]:
    """The cells that are not blank, by column."""
    beyond = [cell for cell in cells[len(header) :] if cell]
    if len(cells) < len(header) or beyond:
        problem = f"{len(cells)} cells where the header has {len(header)}"
        refuse(where, problem, "leave a cell blank for an absent value")
    return {column: cell for column, cell in zip(header, cells, strict=False) if cell}


def _kind(where: str, row: dict[str, str]) -> str:
    kind = row.get("kind", "contact").lower()
    if kind not in ("contact", "miss"):
        refuse(f"{where}, column kind", f"unknown kind {row['kind']!r}", "write contact or miss")
    return kind


def _entry(where: str, row: dict[str, str], header: list[str]) -> Entry:
    named = _point_columns(header).items()
    points = {name: point for name, columns in named if (point := _point(where, row, columns))}
    scalars = {name: _number(where, row, name) for name in SCALARS if name in row}
    if "center" not in points:
        refuse(f"{where}, column x", "blank", "give the place of the tip")
    if _kind(where, row) == "miss":
        if "start" not in points:
            refuse(
                f"{where}, column start_x",
                "blank in a miss",
                f"a miss swept from its start to {','.join(_point_columns(header)['center'])}: give both",
            )
        if "normal" in points:
            refuse(f"{where}, column nx", "a miss has no normal", "leave it blank")
        points["end"] = points.pop("center")
    return Entry(where, points, scalars)


def _point(where: str, row: dict[str, str], columns: tuple[str, ...]) -> Point | None:
    if not any(column in row for column in columns):
        return None
    for column in columns:
        if column not in row:
            problem = "blank while its partner is not"
            refuse(f"{where}, column {column}", problem, _all_or(columns, ", or none of them"))
    return tuple(_number(where, row, column) for column in columns)


def _number(where: str, row: dict[str, str], column: str) -> float:
    value = float(row[column]) if NUMBER.fullmatch(row[column]) else math.nan
    if not math.isfinite(value):
        refuse(
            f"{where}, column {column}",
            f"{row[column]!r} is not a finite number",
            "write it like -12.5 or 1e-3",
        )
    return value


def _row(kind: str, entry: Entry) -> dict[str, str]:
    row = {"kind": kind} | {name: repr(value) for name, value in entry.scalars.items()}
    for name, point in entry.points.items():
        for column, value in zip(POINT_COLUMNS["center" if name == "end" else name], point, strict=False):
            row[column] = repr(value)
    return row
