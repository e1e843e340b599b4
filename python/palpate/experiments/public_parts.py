"""Parts that others made, out of public packages, to try recognition on: never committed.

    python -m palpate.experiments.public_parts --folder target/parts --count 120

- `random-urdfs`: 1,000 random things of pybullet's source package (zlib licence), each of convex pieces,
  which are joined to one solid. Needs pip, and manifold3d.
- `kicad`: electronic parts of Debian's kicad-packages3d (CC-BY-SA-4.0 with an exception), STEP files, which
  are made triangles and one surface. Needs apt-get and dpkg-deb, and cascadio, trimesh and manifold3d.

A source that can't be had is said and skipped. What was tried is in `manifest.jsonl` as it comes, so that a
run that was stopped goes on; the order of trying follows from the seed.
"""

from __future__ import annotations

import argparse
import json
import shutil
import subprocess
import sys
import tarfile
import tempfile
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from .solids import Array, Solid, load_obj, read_obj, save_obj, welded

SCHEMA, VERSION = "palpate-parts", 1
ACROSS = 200.0
FEWEST_FACES, MOST_FACES = 20, 400
#: Pieces of a thing were cut apart with gaps: each grows by this share of the thing before they are joined.
GROWTH = 0.01
MOST_BYTES = 400_000  # of a STEP file: larger ones have thousands of faces
WATERTIGHT_ONLY = "not watertight"


class Unavailable(Exception):
    """A source can't be had here; says why."""


@dataclass(frozen=True)
class Source:
    """Where parts come from: `candidates(folder)` names them, `made(folder, names)` makes each a solid."""

    name: str
    license: str
    package: str
    candidates: Callable[[Path], list[str]]
    made: Callable[[Path, list[str]], Iterator[Solid | str]]


def fetch(source: Source, folder: Path, *, count: int, seed: int) -> list[dict[str, Any]]:
    """The rows of the manifest for so many parts of a source; those that are there are not made again.

    Raises:
        Unavailable: If the package or a tool that it needs is missing.
    """
    rows = [row for row in manifest(folder, seed=seed) if row["source"] == source.name]
    kept = [row for row in rows if row["kept"]]
    if len(kept) >= count:
        return kept[:count]
    order = np.random.default_rng(seed).permutation(np.array(source.candidates(folder))).tolist()
    tried = {row["candidate"] for row in rows}
    left = [candidate for candidate in order if candidate not in tried]
    while left and len(kept) < count:
        now, left = left[: 2 * (count - len(kept))], left[2 * (count - len(kept)) :]
        for candidate, solid in zip(now, source.made(folder, now), strict=True):
            row = _row(source, candidate, solid, folder=folder)
            _append(folder, row)
            if row["kept"]:
                kept.append(row)
                if len(kept) == count:
                    break
    return kept


def _row(source: Source, candidate: str, made: Solid | str, *, folder: Path) -> dict[str, Any]:
    """What the manifest says of a candidate; the file of one that is kept is written."""
    row: dict[str, Any] = {"source": source.name, "candidate": candidate, "kept": False}
    if isinstance(made, str):
        return {**row, "why": made}
    if not FEWEST_FACES <= made.num_faces <= MOST_FACES:
        return {**row, "why": f"{made.num_faces} planar faces"}
    if not made.watertight:
        return {**row, "why": WATERTIGHT_ONLY}
    solid = made.moved_to(ACROSS)
    file = f"{source.name}/{solid.name}.obj"
    (folder / file).parent.mkdir(parents=True, exist_ok=True)
    save_obj(folder / file, solid)
    return {
        **row,
        "kept": True,
        "name": solid.name,
        "file": file,
        "faces": solid.num_faces,
        "triangles": len(solid.triangles),
        "watertight": solid.watertight,
        "license": source.license,
        "package": source.package,
    }


def manifest(folder: Path, *, seed: int | None = None) -> list[dict[str, Any]]:
    """The rows of a folder's manifest, those of parts that were refused too.

    Raises:
        ValueError: If it is of another seed or version.
    """
    file = folder / "manifest.jsonl"
    if not file.exists():
        return []
    lines = file.read_bytes().rpartition(b"\n")[0].splitlines()  # a last line that was cut short is none
    header, *rows = [json.loads(line) for line in lines] or [{}]
    if header.get("schema") != SCHEMA or header.get("version") != VERSION:
        raise ValueError(f"folder: {str(file)!r} is not a list of parts of this version; name another folder")
    if seed is not None and header["seed"] != seed:
        raise ValueError(
            f"folder: {str(file)!r} is of seed {header['seed']}, not {seed}; name another folder"
        )
    return rows


def _append(folder: Path, row: dict[str, Any]) -> None:
    file = folder / "manifest.jsonl"
    there = file.read_bytes()
    whole = there[: there.rfind(b"\n") + 1]
    file.write_bytes(whole + json.dumps(row, separators=(",", ":")).encode() + b"\n")


def _begin(folder: Path, seed: int) -> None:
    folder.mkdir(parents=True, exist_ok=True)
    if not manifest(folder, seed=seed):
        header = {"schema": SCHEMA, "version": VERSION, "seed": seed}
        (folder / "manifest.jsonl").write_text(json.dumps(header) + "\n", encoding="utf-8")


def load_parts(folder: Path) -> list[Solid]:
    """All parts that were fetched into a folder, in the order of the manifest."""
    return [load_obj(folder / row["file"], row["name"]) for row in manifest(folder) if row["kept"]]


def _run(*command: str, folder: Path | None = None) -> str:
    """What a command printed.

    Raises:
        Unavailable: If it is not installed or fails.
    """
    if shutil.which(command[0]) is None:
        raise Unavailable(f"{command[0]} is not installed")
    ran = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    if ran.returncode:
        said = (ran.stderr.strip() or ran.stdout.strip()).splitlines()
        raise Unavailable(f"{' '.join(command[:4])} … failed: {said[-1] if said else ran.returncode}")
    return ran.stdout


def _module(name: str) -> Any:
    try:
        return __import__(name)
    except ImportError as error:
        raise Unavailable(f"{name} is not installed: pip install {name}") from error


# Things of pybullet's source package.

PYBULLET = "pybullet==3.2.7"


def _urdf_archive(folder: Path) -> Path:
    archive = folder / "download" / "pybullet-3.2.7.tar.gz"
    if not archive.exists():
        archive.parent.mkdir(parents=True, exist_ok=True)
        pip = (sys.executable, "-m", "pip", "download", "--quiet", "--no-deps", "--no-binary", ":all:")
        _run(*pip, PYBULLET, folder=archive.parent)
    return archive


def _urdf_candidates(folder: Path) -> list[str]:
    _module("manifold3d")
    objects = folder / "download" / "random_urdfs"
    if not objects.exists():
        unpacked = objects.with_suffix(".part")
        unpacked.mkdir(parents=True, exist_ok=True)
        with tarfile.open(_urdf_archive(folder)) as archive:
            for member in archive:
                if "/random_urdfs/" in member.name and member.name.endswith(".obj"):
                    content = archive.extractfile(member)
                    assert content is not None, member.name
                    (unpacked / Path(member.name).name).write_bytes(content.read())
        unpacked.rename(objects)
    return sorted(file.stem for file in objects.glob("*.obj"))


def _urdf_made(folder: Path, names: list[str]) -> Iterator[Solid | str]:
    for name in names:
        text = (folder / "download" / "random_urdfs" / f"{name}.obj").read_text(encoding="utf-8")
        pieces = [vertices[np.unique(faces)] for _, vertices, faces in read_obj(name, text)]
        yield joined(f"urdf-{name}", pieces)


def joined(name: str, pieces: list[Array]) -> Solid | str:
    """One solid of convex pieces, each given by its vertices `(n, 3)`; or why there is none."""
    manifold3d = _module("manifold3d")
    across = float(np.ptp(np.concatenate(pieces), axis=0).max())
    hulls = [manifold3d.Manifold.hull_points(_grown(piece, 0.5 * GROWTH * across)) for piece in pieces]
    whole = manifold3d.Manifold.batch_boolean(hulls, manifold3d.OpType.Add)
    bodies = len(whole.decompose())
    return f"{bodies} bodies" if bodies != 1 else _solid(name, whole, across)


def _grown(piece: Array, by: float) -> Array:
    """The piece with each side of its box moved out."""
    low, high = piece.min(axis=0), piece.max(axis=0)
    half = np.maximum(0.5 * (high - low), 1e-9 * by)
    return np.asarray(0.5 * (low + high) + (piece - 0.5 * (low + high)) * (1.0 + by / half))


# Electronic parts of Debian's kicad-packages3d.

KICAD = "kicad-packages3d"


def _kicad_archive(folder: Path) -> Path:
    downloads = folder / "download"
    downloads.mkdir(parents=True, exist_ok=True)
    for _ in range(2):
        for archive in sorted(downloads.glob(f"{KICAD}_*.deb")):
            return archive
        _run("apt-get", "download", "--quiet", KICAD, folder=downloads)
    raise Unavailable(f"apt-get has no {KICAD}")


def _kicad_candidates(folder: Path) -> list[str]:
    for needed in ("cascadio", "trimesh", "manifold3d"):
        _module(needed)
    names = folder / "download" / "kicad.txt"
    if not names.exists():
        listed = _run("dpkg-deb", "--contents", str(_kicad_archive(folder)))
        lines = [line.split(maxsplit=5) for line in listed.splitlines() if line.endswith(".step")]
        small = sorted(line[5] for line in lines if int(line[2]) <= MOST_BYTES)
        names.write_text("\n".join(small) + "\n", encoding="utf-8")
    return names.read_text(encoding="utf-8").split("\n")[:-1]


def _kicad_made(folder: Path, names: list[str]) -> Iterator[Solid | str]:
    steps = folder / "download" / "step"
    steps.mkdir(parents=True, exist_ok=True)
    missing = [name for name in names if not (steps / name).exists()]
    if missing:
        wanted = steps / "wanted.txt"
        wanted.write_text("\n".join(missing) + "\n", encoding="utf-8")
        read = subprocess.Popen(
            ("dpkg-deb", "--fsys-tarfile", str(_kicad_archive(folder))), stdout=subprocess.PIPE
        )
        unpack = ("tar", "--extract", "--directory", str(steps), "--files-from", str(wanted))
        done = subprocess.run(unpack, stdin=read.stdout, check=False).returncode
        if read.wait() or done:
            raise Unavailable("dpkg-deb and tar could not unpack the parts")
    for name in names:
        yield of_step(steps / name)


def of_step(file: Path) -> Solid | str:
    """The triangles of a STEP file, or why there are none."""
    cascadio, trimesh = _module("cascadio"), _module("trimesh")
    with tempfile.TemporaryDirectory() as folder:
        scene = Path(folder) / "part.glb"
        # Coarse: curved faces become few planes, and the part is these planes from then on.
        if cascadio.step_to_glb(str(file), str(scene), 0.1, 0.8, True):
            return "cascadio can't read it"
        try:
            mesh = trimesh.load_mesh(scene)
        except Exception as error:  # whatever is wrong with one file of thousands
            return f"trimesh can't read it: {type(error).__name__}"
    if not len(mesh.faces):
        return "no faces"
    corners = np.asarray(mesh.vertices, dtype=float)[np.asarray(mesh.faces)]
    return united(welded(f"kicad-{file.stem}", corners))


def united(solid: Solid) -> Solid | str:
    """Its bodies joined to one surface: pins that reach into a housing, say."""
    manifold3d = _module("manifold3d")
    if not solid.watertight:
        return WATERTIGHT_ONLY
    bodies = []
    for body in range(int(solid.bodies.max()) + 1):
        faces = solid.triangles[solid.bodies == body]
        mesh = manifold3d.Mesh64(solid.vertices, faces.astype(np.uint64))
        mesh.merge()
        bodies.append(manifold3d.Manifold(mesh))
    if any(body.status() != manifold3d.Error.NoError for body in bodies):
        return "not a manifold"
    return _solid(solid.name, manifold3d.Manifold.batch_boolean(bodies, manifold3d.OpType.Add), solid.across)


def _solid(name: str, whole: Any, across: float) -> Solid:
    mesh = whole.simplify(1e-4 * across).to_mesh64()
    vertices = np.array(mesh.vert_properties, dtype=float)[:, :3]
    return Solid(name, vertices, np.array(mesh.tri_verts).astype(np.int64))


SOURCES = (
    Source("random-urdfs", "zlib", PYBULLET, _urdf_candidates, _urdf_made),
    Source("kicad", "CC-BY-SA-4.0 with the KiCad library exception", KICAD, _kicad_candidates, _kicad_made),
)


def main(arguments: list[str] | None = None) -> int:
    """The command line; 0 if there are as many parts as were asked for of each source."""
    parser = argparse.ArgumentParser(prog="public_parts", description=(__doc__ or "").splitlines()[0])
    parser.add_argument(
        "--folder", type=Path, default=Path("target/parts"), help="where they go (target/parts)"
    )
    parser.add_argument("--count", type=int, default=120, help="how many of each source (120)")
    parser.add_argument("--seed", type=int, default=0, help="which, and in which order (0)")
    names = [source.name for source in SOURCES]
    parser.add_argument("--source", choices=names, action="append", help="only this one; may be repeated")
    options = parser.parse_args(arguments)
    enough = True
    try:
        _begin(options.folder, options.seed)
        for source in SOURCES:
            if options.source and source.name not in options.source:
                continue
            try:
                kept = fetch(source, options.folder, count=options.count, seed=options.seed)
            except Unavailable as error:
                sys.stderr.write(f"{source.name}: skipped, {error}\n")
                enough = False
                continue
            faces = int(np.median([row["faces"] for row in kept])) if kept else 0
            sys.stdout.write(f"{source.name}: {len(kept)} parts, median {faces} planar faces\n")
            enough &= len(kept) >= options.count
    except ValueError as error:
        parser.error(str(error))
    except KeyboardInterrupt:
        sys.stderr.write("stopped; the same command goes on from here\n")
        return 130
    return 0 if enough else 1


if __name__ == "__main__":
    sys.exit(main())
