"""PLY: vertices and polygons, as text or binary, with a header that says how. Its numbers have no unit."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, NoReturn

import numpy as np

from palpate.contacts.entry import refuse
from palpate.solids.mesh import Array, Scene, body_of, check_count
from palpate.solids.polygons import triangulated

_TYPES = {
    "char": "i1", "int8": "i1", "uchar": "u1", "uint8": "u1", "short": "i2", "int16": "i2", "ushort": "u2",
    "uint16": "u2", "int": "i4", "int32": "i4", "uint": "u4", "uint32": "u4", "float": "f4", "float32": "f4",
    "double": "f8", "float64": "f8",
}  # fmt: skip
_ORDERS = {"ascii": "", "binary_little_endian": "<", "binary_big_endian": ">"}
# What files call the corners of a face.
_CORNERS = ("vertex_indices", "vertex_index")
_AGAIN = "export or copy the file again"


@dataclass(frozen=True)
class _Property:
    name: str
    kind: str
    count_kind: str = ""
    """Of a list, the type of its length; empty if it is one number."""


@dataclass
class _Element:
    name: str
    count: int
    properties: list[_Property] = field(default_factory=list[_Property])

    @property
    def is_plain(self) -> bool:
        """Whether all its rows have one length."""
        return not any(entry.count_kind for entry in self.properties)


@dataclass
class _Columns:
    """What is wanted of an element: numbers by property; lists as they come."""

    numbers: dict[str, Array] = field(default_factory=dict[str, Array])
    lists: dict[str, list[list[int]]] = field(default_factory=dict[str, list[list[int]]])


def read_ply(file: str, data: bytes) -> Scene:
    """The body of a PLY file."""
    order, elements, body = _header(file, data)
    found: dict[str, _Columns] = {}
    rows: Any = _Words(file, body) if order == "" else _Bytes(file, body, order)
    for element in elements:
        # Each row has a byte at least.
        if element.count > len(body):
            refuse(file, f"it is cut off: {element.count} rows of {element.name!r} don't fit in it", _AGAIN)
        if element.name == "face":
            check_count(file, element.count)
        found[element.name] = rows.read(element)
    vertex, face = found.get("vertex", _Columns()), found.get("face", _Columns())
    missing = [axis for axis in "xyz" if axis not in vertex.numbers]
    if missing:
        refuse(file, f"its vertices have no {missing[0]}", "export the part again")
    vertices = np.stack([vertex.numbers[axis] for axis in "xyz"], axis=1)
    polygons = next((face.lists[name] for name in _CORNERS if name in face.lists), [])
    scene = Scene()
    if "tristrips" in found:
        refuse(file, "strips of triangles are not read", "export it with faces, or as STL")
    if polygons:
        scene.bodies.append(body_of(file, vertices, triangulated(file, vertices, polygons)))
    return scene


def _header(file: str, data: bytes) -> tuple[str, list[_Element], bytes]:
    head, found, body = data.partition(b"end_header")
    lines = [line.split() for line in head.decode("ascii", errors="replace").splitlines() if line.strip()]
    if not found or not lines or lines[0] != ["ply"]:
        refuse(file, "not a readable PLY file: it has no whole header", "export it again as PLY")
    # The body begins after the line's end, which is one or two bytes.
    body = body[2:] if body.startswith(b"\r\n") else body[1:]
    order: str | None = None
    elements: list[_Element] = []
    for words in lines[1:]:
        match words:
            case ["format", kind, *_] if kind in _ORDERS:
                order = _ORDERS[kind]
            case ["element", name, count] if count.isdecimal():
                elements.append(_Element(name, int(count)))
            case ["property", "list", count_kind, kind, name] if (
                elements and kind in _TYPES and count_kind in _TYPES and _TYPES[count_kind][0] in "iu"
            ):
                elements[-1].properties.append(_Property(name, _TYPES[kind], _TYPES[count_kind]))
            case ["property", kind, name] if elements and kind in _TYPES:
                elements[-1].properties.append(_Property(name, _TYPES[kind]))
            case ["comment" | "obj_info", *_]:
                pass
            case _:
                refuse(file, f"its header has {' '.join(words)[:60]!r}, which is not known", _AGAIN)
    if order is None:
        refuse(file, "its header has no format", _AGAIN)
    return order, elements, body


class _Words:
    """Rows of a text file, one to a line."""

    def __init__(self, file: str, body: bytes) -> None:
        self._file = file
        text = body.decode("ascii", errors="replace")
        self._lines = [line for line in text.splitlines() if line.strip()]
        self._next = 0

    def read(self, element: _Element) -> _Columns:
        lines = self._lines[self._next : self._next + element.count]
        if len(lines) < element.count:
            _refuse_cut(self._file, element, len(lines))
        self._next += element.count
        columns = _empty(element)
        rows: list[list[float]] = []
        for k, line in enumerate(lines):
            where = f"{self._file}: row {k} of {element.name!r}"
            words = line.split()
            try:
                numbers = [float(word) for word in words]
            except ValueError:
                refuse(where, f"{line[:40]!r} has what is no number", _AGAIN)
            row: list[float] = []
            at = 0
            for entry in element.properties:
                if at >= len(numbers):
                    refuse(where, "it is too short", _AGAIN)
                if not entry.count_kind:
                    row.append(numbers[at])
                    at += 1
                    continue
                size = _whole(where, numbers[at])
                members = numbers[at + 1 : at + 1 + size]
                if size < 0 or len(members) < size:
                    refuse(where, "it is too short", _AGAIN)
                if entry.name in _CORNERS:
                    columns.lists[entry.name].append([_whole(where, member) for member in members])
                at += 1 + size
            if at != len(numbers):
                refuse(where, "it is too long", _AGAIN)
            rows.append(row)
        return _with_numbers(columns, element, np.array(rows, dtype=float))


class _Bytes:
    """Rows of a binary file."""

    def __init__(self, file: str, body: bytes, order: str) -> None:
        self._file, self._body, self._order = file, body, order
        self._next = 0

    def read(self, element: _Element) -> _Columns:
        if element.is_plain:
            return self._read_plain(element)
        return self._read_even(element) or self._read_uneven(element)

    def _read_plain(self, element: _Element) -> _Columns:
        row = np.dtype([(f"{k}", self._order + p.kind) for k, p in enumerate(element.properties)])
        there = (len(self._body) - self._next) // row.itemsize if row.itemsize else element.count
        if there < element.count:
            _refuse_cut(self._file, element, there)
        table = np.frombuffer(self._body, dtype=row, count=element.count, offset=self._next)
        self._next += row.itemsize * element.count
        columns = _Columns()
        for k, entry in enumerate(element.properties):
            columns.numbers[entry.name] = table[f"{k}"].astype(float)
        return columns

    def _read_even(self, element: _Element) -> _Columns | None:
        """All rows at once if their lists are as long as those of the first; else None."""
        if not element.count:
            return _empty(element)
        start = self._next
        sizes: list[int] = []
        fields: list[Any] = []
        for k, entry in enumerate(element.properties):
            if not entry.count_kind:
                fields.append((f"{k}", self._order + entry.kind))
                start += np.dtype(entry.kind).itemsize
                continue
            count = self._one(entry.count_kind, start)
            if count is None or not 0 <= count < 1000:
                return None
            sizes.append(count)
            fields.append((f"n{k}", self._order + entry.count_kind))
            fields.append((f"{k}", self._order + entry.kind, (count,)))
            start += np.dtype(entry.count_kind).itemsize + count * np.dtype(entry.kind).itemsize
        row = np.dtype(fields)
        if len(self._body) - self._next < row.itemsize * element.count:
            return None
        table = np.frombuffer(self._body, dtype=row, count=element.count, offset=self._next)
        lists = [k for k, entry in enumerate(element.properties) if entry.count_kind]
        if not all(np.all(table[f"n{k}"] == size) for k, size in zip(lists, sizes, strict=True)):
            return None
        self._next += row.itemsize * element.count
        columns = _Columns()
        for k, entry in enumerate(element.properties):
            if entry.name in _CORNERS and entry.count_kind:
                columns.lists[entry.name] = table[f"{k}"].astype(np.int64).tolist()
            elif not entry.count_kind:
                columns.numbers[entry.name] = table[f"{k}"].astype(float)
        return columns

    def _read_uneven(self, element: _Element) -> _Columns:
        columns = _empty(element)
        rows: list[list[float]] = []
        for k in range(element.count):
            row: list[float] = []
            for entry in element.properties:
                if not entry.count_kind:
                    row += self._take(entry.kind, 1, element, k)
                    continue
                (size,) = self._take(entry.count_kind, 1, element, k)
                members = self._take(entry.kind, int(size), element, k)
                if entry.name in _CORNERS:
                    columns.lists[entry.name].append([int(member) for member in members])
            rows.append(row)
        return _with_numbers(columns, element, np.array(rows, dtype=float))

    def _take(self, kind: str, count: int, element: _Element, row: int) -> list[Any]:  # noqa: PLR0917
        size = np.dtype(kind).itemsize * count
        if count < 0 or len(self._body) - self._next < size:
            _refuse_cut(self._file, element, row)
        taken = np.frombuffer(self._body, dtype=self._order + kind, count=count, offset=self._next)
        self._next += size
        return list(taken.tolist())

    def _one(self, kind: str, at: int) -> int | None:
        if len(self._body) - at < np.dtype(kind).itemsize:
            return None
        return int(np.frombuffer(self._body, dtype=self._order + kind, count=1, offset=at)[0])


def _empty(element: _Element) -> _Columns:
    lists: dict[str, list[list[int]]] = {p.name: [] for p in element.properties if p.count_kind}
    return _Columns({p.name: np.empty(0) for p in element.properties if not p.count_kind}, lists)


def _with_numbers(columns: _Columns, element: _Element, rows: Array) -> _Columns:
    plain = [entry.name for entry in element.properties if not entry.count_kind]
    for name, column in zip(plain, rows.reshape(element.count, len(plain)).T, strict=True):
        columns.numbers[name] = column
    return columns


def _whole(where: str, number: float) -> int:
    if not number.is_integer():
        refuse(where, f"{number:g} is not a whole number", _AGAIN)
    return int(number)


def _refuse_cut(file: str, element: _Element, there: int) -> NoReturn:
    refuse(
        file,
        f"it is cut off: it announces {element.count} rows of {element.name!r} and has {there}",
        _AGAIN,
    )
