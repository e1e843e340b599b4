"""Shapes as nodes of a viser scene: a page of calls."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from palpate.view.picture import Bodies, Shape, Strokes, same
from palpate.view.state import Array

MOST_TRIANGLES = 15_000  # of one part at all its places; more are drawn simplified
ROOM = 1.12  # around what is framed
FOV = 0.7  # radians: a long lens, so that lengths nearly compare
BESIDE = 0.8  # of the height: how wide the view is at least, beside the panel


class Scene:
    """Draws lists of shapes, each in place of the one before."""

    def __init__(self, server: Any, *, dimension: int, size: float) -> None:
        """On a viser server, for parts of a dimension and a size."""
        self._server = server
        self._flat = dimension == 2
        self._size = size
        self._drawn: dict[str, tuple[Shape, Any]] = {}
        self._frame: tuple[Array, Array] | None = None
        server.scene.set_up_direction("+y" if self._flat else "+z")
        # Light from all sides shows colours as they are; some from one side shows shapes.
        server.scene.configure_default_lights(False)
        server.scene.configure_environment_map(None)
        server.scene.add_light_ambient("/light/around", intensity=2.2)
        server.scene.add_light_directional("/light/above", intensity=1.6, position=(0.3, -0.6, 1.0))
        server.initial_camera.near, server.initial_camera.far = 1e-3 * size, 1e3 * size

    def draw(self, shapes: Sequence[Shape], clicked: Callable[[int, Any], None] | None = None) -> None:
        """The shapes; `clicked` gets the number of a model and the event."""
        wanted = {shape.name: shape for shape in shapes}
        with self._server.atomic():
            # What is there already stays: it need not go over the wire again.
            for name, (shape, node) in list(self._drawn.items()):
                if name not in wanted or not same(shape, wanted[name]):
                    node.remove()
                    del self._drawn[name]
            for name, shape in wanted.items():
                if name not in self._drawn:
                    self._drawn[name] = shape, self._add(shape, clicked)
        self._server.flush()

    def look_at(self, low: Array, high: Array) -> None:
        """Everyone looks at a box; those who come later too. The same box as before moves nobody."""
        if self._frame is not None and not _differs(self._frame, (low, high)):
            return
        self._frame = (low, high)
        self.look_again()

    def look_again(self) -> None:
        """Everyone looks at the same box once more."""
        if self._frame is None:
            return
        low, high = self._frame
        middle = (low + high) / 2
        if self._flat:
            width, height = (high - low)[:2]
            away = ROOM * max(height, width / BESIDE) / (2.0 * np.tan(FOV / 2))
            position, up = middle + np.array([0.0, -0.06 * away, away]), np.array([0.0, 1.0, 0.0])
        else:
            away = ROOM * 0.42 * float(np.linalg.norm(high - low)) / np.sin(FOV / 2) / min(1.0, BESIDE + 0.1)
            position = middle + away * np.array([0.48, -0.78, 0.41])
            up = np.array([0.0, 0.0, 1.0])
        camera = self._server.initial_camera
        camera.fov, camera.up, camera.position, camera.look_at = FOV, up, position, middle
        for client in self._server.get_clients().values():
            with client.atomic():
                client.camera.up_direction = up
                client.camera.position = position
                client.camera.look_at = middle
                client.camera.fov = FOV

    def _add(self, shape: Shape, clicked: Callable[[int, Any], None] | None) -> Any:
        scene = self._server.scene
        if isinstance(shape, Bodies):
            return self._add_bodies(shape, clicked)
        if isinstance(shape, Strokes):
            return scene.add_line_segments(
                f"/{shape.name}", shape.segments, shape.color, thickness=shape.width, thickness_units="screen"
            )
        return scene.add_label(f"/{shape.name}", shape.text, position=shape.place)

    def _add_bodies(self, shape: Bodies, clicked: Callable[[int, Any], None] | None) -> Any:
        from viser.transforms import SO3

        node = self._server.scene.add_batched_meshes_simple(
            f"/{shape.name}",
            shape.mesh.vertices,
            shape.mesh.triangles,
            SO3.from_matrix(shape.poses[:, :3, :3]).wxyz,
            shape.poses[:, :3, 3],
            batched_scales=shape.scales,
            batched_colors=_linear(shape.color),
            opacity=None if shape.opacity >= 1.0 else shape.opacity,
            flat_shading=True,
            side="front" if shape.closed else "double",
            lod=_simplified(shape),
            cast_shadow=False,
            receive_shadow=False,
        )
        number = shape.model_number
        if number is not None and clicked is not None:
            node.on_click(lambda event: clicked(number, event))
        return node


def _simplified(shape: Bodies) -> Any:
    """How many of the triangles are drawn, from how near on."""
    total = len(shape.mesh.triangles) * len(shape.poses)
    return "off" if total <= MOST_TRIANGLES else ((1e-3, MOST_TRIANGLES / total),)


def _linear(color: tuple[int, int, int]) -> tuple[int, int, int]:
    """The colour as viser takes it of bodies: in proportion to light, where all else is as on the screen."""
    red, green, blue = (round(255.0 * ((value / 255.0 + 0.055) / 1.055) ** 2.4) for value in color)
    return red, green, blue


def _differs(one: tuple[Array, Array], other: tuple[Array, Array]) -> bool:
    """Whether a box is not well seen where the other one is: it leaves it, or fills little of it."""
    size, others = one[1] - one[0], other[1] - other[0]
    leaves = (other[0] < one[0] - 0.05 * size.max()).any() or (other[1] > one[1] + 0.05 * size.max()).any()
    return bool(leaves or others.max() < 0.6 * size.max())
