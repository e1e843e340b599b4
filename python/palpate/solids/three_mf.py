"""3MF: a zip archive of XML, with objects, their places and a unit."""

from __future__ import annotations

import io
import zipfile
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from typing import Any
from xml.etree import ElementTree

import numpy as np

from palpate.contacts.entry import refuse
from palpate.solids.mesh import Array, Body, Scene, body_of, check_count

_MM_PER_UNIT = {
    "micron": 1e-3, "millimeter": 1.0, "centimeter": 10.0, "inch": 25.4, "foot": 304.8, "meter": 1000.0,
}  # fmt: skip
_MODEL_TYPE = "http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"
_AGAIN = "export it again as 3MF, or as STEP or STL"
# An archive that swells to more than this is no part.
_MOST_BYTES = 2**30
_MOST_BODIES = 10_000
# Objects of these types are the part; others hold it while it is printed.
_SOLID_TYPES = ("model", "surface", "solidsupport")

_Key = tuple[str, str]  # the file in the archive, the object's id in it


@dataclass
class _Object:
    name: str
    kind: str
    body: Body | None = None
    parts: list[tuple[_Key, Array]] = field(default_factory=list[tuple[_Key, Array]])


@dataclass
class _Archive:
    file: str
    zip: zipfile.ZipFile
    scale: float = 1.0
    objects: dict[_Key, _Object] = field(default_factory=dict[_Key, _Object])
    build: list[tuple[_Key, Array]] = field(default_factory=list[tuple[_Key, Array]])
    read: set[str] = field(default_factory=set[str])
    left_out: Counter[str] = field(default_factory=Counter[str])


def read_three_mf(file: str, data: bytes, *, mm_per_unit: float) -> Scene:
    """The bodies that a 3MF file places, in its own places, converted to the models' unit."""
    try:
        with zipfile.ZipFile(io.BytesIO(data)) as opened:
            if sum(entry.file_size for entry in opened.infolist()) > _MOST_BYTES:
                refuse(file, "what is packed in it is larger than 1 GB", "export it coarser")
            archive = _Archive(file, opened)
            root = _root(archive)
            _read_model(archive, root, mm_per_unit, is_root=True)
            return _scene(archive, root)
    except (zipfile.BadZipFile, zipfile.LargeZipFile, NotImplementedError, EOFError, OSError) as error:
        refuse(file, f"not a readable 3MF file: {' '.join(str(error).split()) or 'it is damaged'}", _AGAIN)
    except RuntimeError:  # zipfile's word for a password
        refuse(file, "it is encrypted", "export it without a password")
    except Exception as error:
        # Packed bytes that are damaged: each method of packing has its own error.
        if type(error).__module__.partition(".")[0] not in ("zlib", "_lzma", "lzma"):
            raise
        refuse(file, "not a readable 3MF file: it is damaged", _AGAIN)


def _root(archive: _Archive) -> str:
    """The name of the model file that the archive begins with."""
    names = archive.zip.namelist()
    if "_rels/.rels" in names:
        for relation in _xml(archive, "_rels/.rels"):
            if relation.get("Type") == _MODEL_TYPE:
                return _named(archive, relation.get("Target", ""))
    found = [name for name in names if name.lower().endswith(".model")]
    if not found:
        refuse(archive.file, "there is no model in this archive", _AGAIN)
    return found[0]


def _named(archive: _Archive, path: str) -> str:
    wanted = path.lstrip("/").lower()
    for name in archive.zip.namelist():
        if name.lower() == wanted:
            return name
    refuse(archive.file, f"its part {path[:60]!r} is not in the archive", _AGAIN)


def _xml(archive: _Archive, name: str) -> ElementTree.Element:
    text = archive.zip.read(name)
    if b"<!DOCTYPE" in text or b"<!ENTITY" in text:
        refuse(archive.file, f"{name} has a document type, which 3MF forbids", _AGAIN)
    try:
        return ElementTree.fromstring(text)
    except (ElementTree.ParseError, ValueError, LookupError) as error:
        refuse(archive.file, f"{name} is not XML: {error}", _AGAIN)


def _read_model(archive: _Archive, name: str, mm_per_unit: float, *, is_root: bool = False) -> None:
    archive.read.add(name)
    root = _xml(archive, name)
    if _tag(root) != "model":
        refuse(archive.file, f"{name} has <{_tag(root)[:20]}>, not <model>", _AGAIN)
    unit = root.get("unit", "millimeter")
    if unit not in _MM_PER_UNIT:
        refuse(archive.file, f"its unit {unit[:20]!r} is not known", f"it may be {', '.join(_MM_PER_UNIT)}")
    scale = _MM_PER_UNIT[unit] / mm_per_unit
    if is_root:
        archive.scale = scale
    others: set[str] = set()
    for element in root.iter():
        if _tag(element) == "object":
            key = (name, element.get("id", ""))
            archive.objects[key] = made = _object(archive, key, element, scale)
            others |= {other for (other, _), _ in made.parts}
        elif _tag(element) == "item" and is_root:
            archive.build.append(_placed(archive, name, element))
            others.add(archive.build[-1][0][0])
    for other in sorted(others - archive.read):
        _read_model(archive, other, mm_per_unit)


def _object(archive: _Archive, key: _Key, element: ElementTree.Element, scale: float) -> _Object:  # noqa: PLR0917
    made = _Object(element.get("name", ""), element.get("type", "model"))
    for child in element.iter():
        match _tag(child):
            case "mesh":
                made.body = _mesh(archive, child, scale)
            case "component":
                made.parts.append(_placed(archive, key[0], child))
            case "beamlattice" | "displacementmesh" | "booleans" | "levelset" as kind:
                archive.left_out[kind] += 1
            case _:
                pass
    return made


def _mesh(archive: _Archive, mesh: ElementTree.Element, scale: float) -> Body:
    vertices = [child for child in mesh.iter() if _tag(child) == "vertex"]
    triangles = [child for child in mesh.iter() if _tag(child) == "triangle"]
    check_count(archive.file, len(triangles))
    try:
        points = [[float(vertex.attrib[axis]) for axis in "xyz"] for vertex in vertices]
        numbers = [[int(triangle.attrib[corner]) for corner in ("v1", "v2", "v3")] for triangle in triangles]
        return body_of(
            archive.file,
            np.array(points).reshape(-1, 3),
            np.array(numbers, dtype=np.int64).reshape(-1, 3),
            scale=scale,
        )
    except KeyError as error:
        refuse(archive.file, f"a vertex or triangle has no {error}", _AGAIN)
    except OverflowError:
        refuse(archive.file, "the number of a vertex is not one", _AGAIN)
    except ValueError as error:
        if str(error).startswith(archive.file):
            raise
        refuse(archive.file, f"a vertex or triangle has what is no number: {error}", _AGAIN)


def _placed(archive: _Archive, name: str, element: ElementTree.Element) -> tuple[_Key, Array]:
    """The object that an element names, and where it is put: `(4, 3)`, to be multiplied from the right."""
    path = next((value for key, value in element.attrib.items() if key.endswith("}path")), None)
    where = name if path is None else _named(archive, path)
    words = element.get("transform", "1 0 0 0 1 0 0 0 1 0 0 0").split()
    try:
        numbers = np.array([float(word) for word in words]).reshape(4, 3)
    except ValueError:
        refuse(archive.file, f"{' '.join(words)[:40]!r} is not a transform of 12 numbers", _AGAIN)
    return (where, element.get("objectid", "")), numbers


def _scene(archive: _Archive, root: str) -> Scene:
    placed = archive.build
    if not placed:
        parts = {key for made in archive.objects.values() for key, _ in made.parts}
        identity = np.eye(4, 3)
        placed = [(key, identity) for key in archive.objects if key not in parts and key[0] == root]
    scene = Scene()
    for key, model_from_object in placed:
        for body in _bodies(archive, key, model_from_object, ()):
            scene.bodies.append(body)
            if len(scene.bodies) > _MOST_BODIES:
                refuse(archive.file, f"it places more than {_MOST_BODIES} bodies", "export a single part")
    scene.notes += [f"left out: {count} {what}" for what, count in sorted(archive.left_out.items())]
    return scene


def _bodies(  # noqa: PLR0917
    archive: _Archive, key: _Key, model_from_object: Array, around: tuple[_Key, ...]
) -> Iterator[Body]:
    made = archive.objects.get(key)
    if made is None:
        refuse(archive.file, f"it places object {key[1][:20]!r}, which is not in it", _AGAIN)
    if key in around:
        refuse(archive.file, f"object {key[1][:20]!r} is a component of itself", _AGAIN)
    if made.kind not in _SOLID_TYPES:
        archive.left_out[f"object of type {made.kind[:20]}"] += 1
        return
    if made.body is not None and len(made.body.triangles):
        yield _moved(archive, replace(made.body, name=made.name), model_from_object)
    for part, object_from_part in made.parts:
        turned = object_from_part[:3] @ model_from_object[:3]
        shifted = object_from_part[3] @ model_from_object[:3] + model_from_object[3]
        yield from _bodies(archive, part, np.vstack([turned, shifted]), (*around, key))


def _moved(archive: _Archive, body: Body, model_from_object: Array) -> Body:
    vertices = body.vertices @ model_from_object[:3] + archive.scale * model_from_object[3]
    triangles = body.triangles
    if np.linalg.det(model_from_object[:3]) < 0.0:
        triangles = triangles[:, ::-1]  # a mirror image, turned outside out again
    return body_of(archive.file, vertices, triangles, name=body.name)


def _tag(element: Any) -> str:
    """Without its namespace; comments have none."""
    tag = element.tag
    return tag.rpartition("}")[2] if isinstance(tag, str) else ""
