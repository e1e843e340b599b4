"""STEP into GLB, in a process of its own: `python -m palpate.solids.step_process IN OUT LINEAR ANGULAR`.

OpenCASCADE prints to stdout, and a damaged file may end the process that reads it.
"""

from __future__ import annotations

import sys
from pathlib import Path


def main(arguments: list[str]) -> int:
    """0: the file is written; 2: cascadio is not installed; 1: it can't be read."""
    source, target, linear, angular = arguments
    try:
        import cascadio
    except ImportError:
        return 2
    glb = cascadio.load(
        Path(source).read_bytes(),
        file_type="step",
        tol_linear=float(linear),
        tol_angular=float(angular),
        use_parallel=False,  # the same triangles at each run
        include_brep=True,
    )
    if not glb:
        return 1
    Path(target).write_bytes(glb)
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
