"""The compiled core. Import these names from `palpate`.

Lengths are in the unit of the models, angles in radians, points and poses in the frame that their name or text says.
`world_from_model` is a homogeneous matrix: `p_world = world_from_model @ p_model`. Arrays that are returned are
read-only. Bad input raises `ValueError`: one line with the argument, what is wrong, its value and the remedy.

Sections (2.1 and so on) are those of R. E. Ellis, *A Tactile Sensing Strategy for Model-Based Object Recognition*, 1987.
"""

from collections.abc import Iterator, Sequence
from typing import Any, ClassVar, Final, Literal, NoReturn, final, overload

from numpy import bool_, float64
from numpy.typing import ArrayLike, NDArray

__all__ = [
    "Contact",
    "Hypothesis",
    "Interpretation",
    "Interpretations",
    "Miss",
    "Model",
    "PoseSet",
    "Prior",
    "Recognition",
    "ThesisPose",
    "__version__",
    "recognize",
]

__version__: Final[str]

@final
class Model:
    """A part: its faces, its corners and the motions that map it onto itself (2.1).

    In the plane a face is a line segment, with its outward normal on the right of `start → end`. Made by `polygon`,
    `segments` or `palpate.load_models`. Immutable; equal if all numbers are equal; can be pickled.
    """

    def __new__(cls, *arguments: NoReturn, **keywords: NoReturn) -> Model: ...
    @classmethod
    def polygon(
        cls,
        vertices: ArrayLike,
        *,
        name: str = "part",
        holes: Sequence[ArrayLike] = (),
        untouchable: Sequence[int] = (),
        position_slack: float = 0.0,
        normal_slack: float = 0.0,
        mends: Sequence[str] = (),
    ) -> Model:
        """A part bounded by a closed outline, less its holes.

        Face `k` begins at vertex `k`; the faces of the holes follow those of the outline. Loops that run the wrong
        way round, doubled points and points on straight runs are mended, and `mends` says so.

        Args:
            vertices: Corners in order, shape `(n, 2)`, model frame; the first need not be repeated.
            name: What to call it in answers and pictures.
            holes: Outlines of the holes, each of shape `(k, 2)`.
            untouchable: Numbers of faces as given that are in the way of a probe but never its answer.
            position_slack: How far the true outline may lie from the faces; added to every contact's position error.
            normal_slack: How far the true normal may turn from the faces'; added to every contact's normal error.
            mends: What was mended before, as a reader of files does; put before the model's own.

        Raises:
            ValueError: Fewer than three distinct points, no area, an outline that crosses or touches itself or a hole,
                a hole outside, a face number out of range, a slack that is negative, any number that is not finite.
        """

    @classmethod
    def segments(
        cls,
        segments: ArrayLike,
        *,
        name: str = "part",
        seams: Sequence[int] = (),
        untouchable: Sequence[int] = (),
        position_slack: float = 0.0,
        normal_slack: float = 0.0,
        mends: Sequence[str] = (),
    ) -> Model:
        """A part given by loose faces: it need not be closed (2.1).

        Segments without length are left out, and `mends` says so.

        Args:
            segments: Start and end of each face, shape `(n, 2, 2)`, model frame; outward is on the right.
            name: What to call it in answers and pictures.
            seams: Numbers of segments that are not there: where two pieces of one part meet.
            untouchable: Numbers of segments that are in the way of a probe but never its answer.
            position_slack: How far the true outline may lie from the faces; added to every contact's position error.
            normal_slack: How far the true normal may turn from the faces'; added to every contact's normal error.
            mends: What was mended before, as a reader of files does; put before the model's own.

        Raises:
            ValueError: No segment with a length that is there, a number out of range or named as both seam and
                untouchable, a slack that is negative, any number that is not finite.
        """

    @property
    def name(self) -> str:
        """Its name."""
    @property
    def dimension(self) -> int:
        """2: the plane."""
    @property
    def faces(self) -> list[NDArray[float64]]:
        """Start and end of each face, shape `(2, 2)`, model frame, in face-number order."""
    @property
    def edges(self) -> list[NDArray[float64]]:
        """Empty in the plane."""
    @property
    def vertices(self) -> NDArray[float64]:
        """Corners, shape `(k, 2)`, model frame, in vertex-number order."""
    @property
    def face_normals(self) -> NDArray[float64]:
        """Unit outward normals, shape `(n, 2)`, model frame."""
    @property
    def face_surfaces(self) -> list[Literal["touchable", "untouchable", "seam"]]:
        """What each face is to a probe."""
    @property
    def touchable_vertices(self) -> NDArray[bool_]:
        """Whether each corner is convex and both its faces can be touched, shape `(k,)`."""
    @property
    def symmetries(self) -> NDArray[float64]:
        """The motions that map it onto itself, the identity first, shape `(s, 3, 3)`, model frame."""
    @property
    def symmetry_axes(self) -> list[NDArray[float64]]:
        """Axes of continuous symmetry. Empty in the plane."""
    @property
    def position_slack(self) -> float:
        """Added to every contact's position error."""
    @property
    def normal_slack(self) -> float:
        """Added to every contact's normal error; radians."""
    @property
    def mends(self) -> list[str]:
        """What was mended when it was read and made, one line each."""
    @property
    def size(self) -> float:
        """The largest distance between two of its corners."""
    @property
    def closed(self) -> bool:
        """Whether its faces bound a region, so that inside and outside are known."""
    def __eq__(self, other: object, /) -> bool: ...
    def __hash__(self) -> int: ...
    def __reduce__(self) -> tuple[Any, ...]: ...

@final
class Contact:
    """The tip of a probe rests on the part (2.2).

    The tip is a disc of `tip_radius` whose centre is within `position_error` of `center`; a measured surface point
    is the case of radius zero. Immutable; equal if all numbers are equal; can be pickled.
    """

    def __new__(
        cls,
        point: ArrayLike,
        normal: ArrayLike | None = None,
        *,
        position_error: float,
        normal_error: float | None = None,
        approach: ArrayLike | None = None,
        start: ArrayLike | None = None,
    ) -> Contact:
        """A measured surface point.

        Args:
            point: Sensed point, shape `(2,)`, world frame.
            normal: Sensed outward normal, shape `(2,)`, world frame, of any length but zero; None if not sensed.
            position_error: The true point is within this distance of `point`; zero or more.
            normal_error: The true normal is within this angle of `normal`; radians, at most π/2. Given if and only if
                `normal` is.
            approach: Direction of travel, pointing into the part, shape `(2,)`, world frame, of any length but zero.
            start: Where the guarded move began, shape `(2,)`, world frame: the way from there was free.

        Raises:
            ValueError: Another shape, a zero direction, a negative bound, one of `normal` and `normal_error` alone,
                any number that is not finite.
        """

    @classmethod
    def from_tip(
        cls,
        center: ArrayLike,
        tip_radius: float,
        *,
        position_error: float,
        approach: ArrayLike | None = None,
        normal: ArrayLike | None = None,
        normal_error: float | None = None,
        start: ArrayLike | None = None,
    ) -> Contact:
        """A contact of a round tip.

        Args:
            center: Sensed centre of the tip, shape `(2,)`, world frame.
            tip_radius: Radius of the tip; zero or more.
            position_error: The true centre is within this distance of `center`; zero or more.
            approach: As for a measured point.
            normal: As for a measured point.
            normal_error: As for a measured point.
            start: Where the centre of the tip began its guarded move, shape `(2,)`, world frame.

        Raises:
            ValueError: As for a measured point, and a negative radius.
        """

    @property
    def center(self) -> NDArray[float64]:
        """Sensed centre of the tip, shape `(2,)`, world frame."""
    @property
    def tip_radius(self) -> float:
        """Radius of the tip; zero for a measured point."""
    @property
    def position_error(self) -> float:
        """Bound on the distance of the true centre."""
    @property
    def normal(self) -> NDArray[float64] | None:
        """Sensed outward normal, made unit, shape `(2,)`, world frame."""
    @property
    def normal_error(self) -> float | None:
        """Bound on the angle of the true normal; radians."""
    @property
    def approach(self) -> NDArray[float64] | None:
        """Direction of travel, made unit, shape `(2,)`, world frame."""
    @property
    def start(self) -> NDArray[float64] | None:
        """Where the guarded move began, shape `(2,)`, world frame."""
    def __eq__(self, other: object, /) -> bool: ...
    def __reduce__(self) -> tuple[Any, ...]: ...
    __hash__: ClassVar[None]  # type: ignore[assignment]

@final
class Miss:
    """A guarded move that touched nothing: the tip swept from `start` to `end` freely.

    Immutable; equal if all numbers are equal; can be pickled.
    """

    def __new__(
        cls, start: ArrayLike, end: ArrayLike, *, tip_radius: float = 0.0, path_error: float = 0.0
    ) -> Miss:
        """A free sweep.

        Args:
            start: Where the centre of the tip began, shape `(2,)`, world frame.
            end: Where it ended, shape `(2,)`, world frame.
            tip_radius: Radius of the tip; zero or more.
            path_error: How far the tip may have left its line; zero or more.

        Raises:
            ValueError: Another shape, a negative bound, any number that is not finite.
        """

    @property
    def start(self) -> NDArray[float64]:
        """Where the centre of the tip began, shape `(2,)`, world frame."""
    @property
    def end(self) -> NDArray[float64]:
        """Where it ended, shape `(2,)`, world frame."""
    @property
    def tip_radius(self) -> float:
        """Radius of the tip."""
    @property
    def path_error(self) -> float:
        """How far the tip may have left its line."""
    def __eq__(self, other: object, /) -> bool: ...
    def __reduce__(self) -> tuple[Any, ...]: ...
    __hash__: ClassVar[None]  # type: ignore[assignment]

@final
class Prior:
    """What is known of the pose beforehand: a box of translations and a range of rotations.

    Immutable; equal if all numbers are equal; can be pickled.
    """

    def __new__(cls, world_from_model: ArrayLike, *, translation: float, rotation: float) -> Prior:
        """Poses around a middle one.

        Args:
            world_from_model: The middle of the range, a rigid motion, shape `(3, 3)`.
            translation: Each component of the translation is within this of the middle's; zero or more.
            rotation: The rotation is within this angle of the middle's; radians, zero to π (free).

        Raises:
            ValueError: Another shape, a matrix that is no rigid motion, a bound that is negative or not finite.
        """

    @property
    def world_from_model(self) -> NDArray[float64]:
        """The middle of the range, shape `(3, 3)`."""
    @property
    def translation(self) -> float:
        """Bound on each component of the translation."""
    @property
    def rotation(self) -> float:
        """Bound on the rotation; radians."""
    def __eq__(self, other: object, /) -> bool: ...
    def __reduce__(self) -> tuple[Any, ...]: ...
    __hash__: ClassVar[None]  # type: ignore[assignment]

def recognize(
    models: Sequence[Model],
    contacts: Sequence[Contact],
    *,
    features: Sequence[str] | None = None,
    misses: Sequence[Miss] = (),
    prior: Prior | None = None,
    tolerance: float = 1e-6,
    max_hypotheses: int = 1000,
) -> Recognition:
    """Every model and pose that explains all contacts, keeps clear of all misses, and agrees with the prior (chapter 2).

    Contacts, misses and prior are in the world frame, models each in its own: `p_world = world_from_model @ p_model`.
    Lengths are in the models' unit, whichever it is, angles in radians. If the bounds of the contacts hold, the true model
    and pose are in the answer; and every hypothesis has a pose that satisfies every contact, to the tolerance.

    Args:
        models: The parts that it may be. Their unit is that of all lengths.
        contacts: What was touched, at least one; their order doesn't change the answer.
        features: Kinds of features that contacts may lie on. None: faces, and vertices if a tip has a radius.
        misses: Guarded moves that touched nothing.
        prior: What is known of the pose beforehand.
        tolerance: A pose is valid if it is within this share of the part's size; 1e-9 to 0.01.
        max_hypotheses: More than this are not returned, and `Recognition.complete` says so.

    Returns:
        The answer. That no model explains the contacts is an answer too: `hypotheses` is empty, and `conflict` says why.

    Raises:
        ValueError: No models, no contacts, something else among them, an unknown kind of feature, a contact whose
            normal contradicts its approach, a number out of range.
    """

@final
class Recognition:
    """The answer: every hypothesis, or, if there is none, contacts that can't hold together."""

    @property
    def hypotheses(self) -> list[Hypothesis]:
        """In the order of the models."""
    @property
    def interpretations(self) -> Interpretations:
        """Those of all hypotheses, found as they are asked for."""
    @property
    def interpretation_count(self) -> int:
        """How many there are; at least, where `interpretation_count_exact` is false.

        Without a prior, one of each that a model's symmetries repeat; with a prior every assignment stands for itself.
        """
    @property
    def interpretation_count_exact(self) -> bool:
        """Whether `interpretation_count` is all of them."""
    @property
    def conflict(self) -> list[int] | None:
        """If there is no hypothesis: numbers of contacts that no model and pose explains together.

        The smallest such set up to ten contacts; above, one from which none can be left out. Misses and prior count as
        they are. None if there is a hypothesis, or if the search was cut short.
        """
    @property
    def complete(self) -> bool:
        """Whether every hypothesis is here; if not, there are more than `max_hypotheses` or the search met its limit."""
    @property
    def counters(self) -> list[dict[str, int]]:
        """What was done for each model (3.5).

        `nodes` of the interpretation tree, `pruned_by_distance`, `pruned_by_angle` and `pruned_by_direction` of them,
        `feasible` assignments that passed, `pose_boxes` examined where the tree was too large, and `hypotheses` found,
        those beyond `max_hypotheses` that are not returned included.
        """

@final
class Hypothesis:
    """One answer: interpretations of one model whose poses run into each other, up to the model's symmetry."""

    @property
    def model(self) -> Model:
        """The model, the same object that was given."""
    @property
    def model_number(self) -> int:
        """Its place among the models that were given."""
    @property
    def interpretations(self) -> Interpretations:
        """Its interpretations, found as they are asked for."""
    @property
    def interpretation_count(self) -> int:
        """How many there are; at least, where `interpretation_count_exact` is false.

        Without a prior, one of each that the model's symmetries repeat; with a prior every assignment stands for itself.
        """
    @property
    def interpretation_count_exact(self) -> bool:
        """Whether `interpretation_count` is all of them."""
    @property
    def world_from_model(self) -> NDArray[float64]:
        """The pose of largest slack, shape `(3, 3)`: the worst reading uses the smallest share of its bounds."""
    @property
    def poses(self) -> PoseSet:
        """All its poses."""
    @property
    def marginal(self) -> bool:
        """Whether it is kept only thanks to the tolerance."""

@final
class Interpretation:
    """A model with one feature for each contact, which at least one pose satisfies (2.2)."""

    @property
    def model(self) -> Model:
        """The model, the same object that was given."""
    @property
    def model_number(self) -> int:
        """Its place among the models that were given."""
    @property
    def assignment(self) -> list[tuple[Literal["face", "vertex"], int]]:
        """Kind and number of the feature that each contact lies on, in the order of the contacts."""
    @property
    def world_from_model(self) -> NDArray[float64]:
        """The pose of largest slack, shape `(3, 3)`."""
    @property
    def poses(self) -> PoseSet:
        """All poses that satisfy the assignment."""
    @property
    def marginal(self) -> bool:
        """Whether it is kept only thanks to the tolerance."""

@final
class Interpretations:
    """A lazy sequence of interpretations. Iterating finds them one by one; `[k]` finds all before it as well.

    `len()` is their count; where the count is not exact, it is a lower bound, and iterating goes on beyond.
    """

    def __len__(self) -> int: ...
    def __bool__(self) -> bool: ...
    def __iter__(self) -> Iterator[Interpretation]: ...
    @overload
    def __getitem__(self, key: int, /) -> Interpretation: ...
    @overload
    def __getitem__(self, key: slice, /) -> list[Interpretation]: ...

@final
class PoseSet:
    """All poses of a hypothesis or of an interpretation: a guaranteed enclosure with inner witnesses (2.4).

    Poses are `world_from_model`, homogeneous matrices of shape `(3, 3)`.
    """

    def contains(self, world_from_model: ArrayLike) -> bool:
        """Whether the pose explains every contact and miss, up to the tolerance: the exact predicate.

        Of a hypothesis, up to the model's symmetry.

        Raises:
            ValueError: Another shape than `(3, 3)`, or no rigid motion.
        """

    def sample(self, n: int, seed: int = 0) -> NDArray[float64]:
        """`n` valid poses, spread over the set, shape `(n, 3, 3)`; the same for the same seed.

        Raises:
            ValueError: `n` or `seed` is negative or not whole, or `n` is above ten million.
        """

    @property
    def rotation_bound(self) -> float:
        """No two poses of the set differ by more; radians, at most π."""
    def excursion(self, point: ArrayLike) -> float:
        """No two poses of the set move this point, shape `(2,)`, model frame, further apart.

        Raises:
            ValueError: Another shape, or a number that is not finite.
        """

    def outline(self, point: ArrayLike) -> NDArray[float64]:
        """A convex polygon that holds every place of this point, shape `(2,)`, model frame, under the poses of the set.

        Returns:
            Corners, counter-clockwise, shape `(k, 2)`, world frame.

        Raises:
            ValueError: Another shape, or a number that is not finite.
        """

    @property
    def witness(self) -> NDArray[float64]:
        """A pose of the set, shape `(3, 3)`: the proof that it is not empty."""
    @property
    def marginal(self) -> bool:
        """Whether every witness needs the tolerance."""
    @property
    def thesis_pose(self) -> ThesisPose | None:
        """The thesis's own pose and bounds of the first assignment (2.2.3, 2.4).

        None where they are not defined: a contact on a vertex or without a normal, or all faces parallel.
        """

@final
class ThesisPose:
    """The thesis's nominal pose of an interpretation and its bounds (2.2.3, 2.4), corrected by MATH errata 37-43.

    They describe one pose, not the set of all poses; `PoseSet` does that. `docs/accuracy.md` compares the two.
    """

    @property
    def world_from_model(self) -> NDArray[float64]:
        """The nominal pose: `rotation` and `translation`, shape `(3, 3)`."""
    @property
    def first_rotation(self) -> float:
        """θ, which takes the first face's normal to its sensed one; radians (2.4)."""
    @property
    def rotation(self) -> float:
        """φ, the middle of the rotations that all normals leave; radians (eq. 2.2)."""
    @property
    def residual_rotation(self) -> float:
        """γ, the width of the rotations that all normals leave; radians (2.4.1)."""
    @property
    def translation(self) -> NDArray[float64]:
        """The nominal translation at φ, shape `(2,)`, world frame (eq. 2.1)."""
    @property
    def translation_error(self) -> float:
        """`E_T`, the half diagonal of the rhombus of translations of the best pair of faces (2.4.2)."""
    @property
    def translation_region(self) -> NDArray[float64]:
        """Translations at φ that keep each contact within its bound of its face's line, shape `(k, 2)` (figure 2.6)."""
    def excursion(self, point: ArrayLike) -> float:
        """`E_q`, how far the point, shape `(2,)`, model frame, moves between the two extreme nominal poses (eq. 2.3).

        A chord, not a bound.

        Raises:
            ValueError: Another shape, or a number that is not finite.
        """
