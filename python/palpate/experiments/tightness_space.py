"""The table of tightness in space in docs/accuracy.md, from what the Rust example `tightness_space` measured.

python -m palpate.experiments.tightness_space FIGURES.json docs/accuracy.md
"""

from __future__ import annotations

from .pages import arguments, rewrite
from .tightness import section


def main() -> None:
    """Write the table anew."""
    figures, page = arguments("the table of tightness in space in docs/accuracy.md")
    rewrite(page, "tightness-space", section(figures))


if __name__ == "__main__":
    main()
