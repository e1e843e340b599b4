"""The compiled core. Import these names from `palpate`.

Lengths are in the unit of the models, angles in radians, points and poses in the frame that their name or text says.
`world_from_model` is a homogeneous matrix: `p_world = world_from_model @ p_model`. Arrays that are returned are
read-only. Bad input raises `ValueError`: one line with the argument, what is wrong, its value and the remedy.

Sections (2.1 and so on) are those of R. E. Ellis, *A Tactile Sensing Strategy for Model-Based Object Recognition*, 1987.
"""

from collections.abc import Iterator, Sequence
from typing import Any, ClassVar, Final, Literal, NoReturn, final, overload

from numpy import bool_, float64, uint32
from numpy.typing import ArrayLike, NDArray

__all__ = [
    "AmbiguityBranch",
    "AmbiguityNode",
    "AmbiguityTree",
    "Contact",
    "FirstContact",
    "Hypothesis",
    "Interpretation",
    "Interpretations",
    "Lines",
    "Miss",
    "Model",
    "Outcome",
    "Overlap",
    "Path",
    "PlanReport",
    "PoseSet",
    "Prior",
    "ProjectionSpace",
    "Recognition",
    "Sensor",
    "Sheaf",
    "ThesisPose",
    "Touch",
    "__version__",
    "judge",
    "linearization_error",
    "plan",
    "plan_report",
    "plan_tree",
    "predicted_hit_rate",
    "projection_space",
    "recognize",
    "refuting_moves",
    "verification_path",
    "verification_report",
]

__version__: Final[str]

@final
class Model:
    """A part: its faces, its corners and the motions that map it onto itself (2.1).

    In the plane a face is a line segment, with its outward normal on the right of `start → end`; in space it is flat, its
    loop counter-clockwise as seen from outside, and edges are where faces meet. Made by `polygon` or `segments` in the
    plane, by `mesh` or `facets` in space, or by `palpate.load_models`. Shapes below name the dimension `d`, 2 or 3.
    Immutable; equal if all numbers are equal; can be pickled.
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

    @classmethod
    def mesh(
        cls,
        vertices: ArrayLike,
        triangles: ArrayLike,
        *,
        name: str = "part",
        untouchable: Sequence[int] = (),
        position_slack: float = 0.0,
        normal_slack: float = 0.0,
        mends: Sequence[str] = (),
    ) -> Model:
        """A part in space, bounded by triangles.

        Triangles that lie in one plane and hang together become one face. Doubled vertices, triangles without area,
        repeated ones or two that face each other, corners on the inside of another triangle's edge, triangles wound
        against their neighbours and surfaces turned inside out are mended, and `mends` says so. A closed surface within
        another one bounds a cavity. What corners are off their faces' planes is added to the slacks.

        Corners at which the surface ends are welded if they are no further apart than 5e-7 of the size, or of the distance
        from the origin up to ten sizes: what rounding to single precision may make of one. Corners that all meet are left
        alone. By how much they were moved is in the slacks. Of an open surface no triangles are turned but a few that are
        wound against all others. A closed surface that crosses itself is said to.

        Args:
            vertices: Corners, shape `(n, 3)`, model frame.
            triangles: Numbers of corners, counter-clockwise as seen from outside, shape `(m, 3)`.
            name: What to call it in answers and pictures.
            untouchable: Numbers of triangles as given that are in the way of a probe but never its answer.
            position_slack: How far the true surface may lie from the faces; added to every contact's position error.
            normal_slack: How far the true normal may turn from the faces'; added to every contact's normal error.
            mends: What was mended before, as a reader of files does; put before the model's own.

        Raises:
            ValueError: Another shape, a vertex or triangle number out of range, no triangle that has an area, edges that lie
                beside one another but too far apart to be welded, a surface that is turned inside out where it crosses
                itself, a slack that is negative, any number that is not finite.
        """

    # For readers of files: vertices and triangles, slacks in length and angle, mends.
    @staticmethod
    def _sewn(
        vertices: ArrayLike, triangles: ArrayLike
    ) -> tuple[NDArray[float64], NDArray[uint32], tuple[float, float], list[str]]: ...
    @classmethod
    def facets(
        cls,
        loops: Sequence[ArrayLike] | Sequence[Sequence[ArrayLike]],
        *,
        name: str = "part",
        seams: Sequence[int] = (),
        untouchable: Sequence[int] = (),
        position_slack: float = 0.0,
        normal_slack: float = 0.0,
        mends: Sequence[str] = (),
    ) -> Model:
        """A part in space given by loose faces: it need not be closed (2.1).

        Corners that coincide form one vertex; a corner on the inside of another face's side divides it. Where a side is of
        one face only, its corners are welded as by `mesh`. What corners are off their faces' planes, or were moved, is added
        to the slacks.

        Args:
            loops: Each face by its corners, shape `(k, 3)`, model frame, counter-clockwise as seen from outside; or by a list
                of such loops, the outer one first, then those of its holes.
            name: What to call it in answers and pictures.
            seams: Numbers of faces that are not there: where two pieces of one part meet.
            untouchable: Numbers of faces that are in the way of a probe but never its answer.
            position_slack: How far the true surface may lie from the faces; added to every contact's position error.
            normal_slack: How far the true normal may turn from the faces'; added to every contact's normal error.
            mends: What was mended before, as a reader of files does; put before the model's own.

        Raises:
            ValueError: Another shape, no face that is there, a face without area or whose corners are off its plane, loops
                that cross, a hole outside its face, faces that bound a region from inside, a number out of range or named as
                both seam and untouchable, a slack that is negative, any number that is not finite.
        """

    @property
    def name(self) -> str:
        """Its name."""
    @property
    def dimension(self) -> int:
        """d: 2 in the plane, 3 in space."""
    @property
    def faces(self) -> list[NDArray[float64]]:
        """Corners of each face, model frame, in face-number order.

        In the plane start and end, shape `(2, 2)`; in space the outer loop, shape `(k, 3)`.
        """
    @property
    def face_loops(self) -> list[list[NDArray[float64]]]:
        """The same with the loops of holes, clockwise as seen from outside, after each outer one."""
    @property
    def edges(self) -> list[NDArray[float64]]:
        """Ends of each edge, shape `(2, 3)`, model frame, in edge-number order. None in the plane."""
    @property
    def vertices(self) -> NDArray[float64]:
        """Corners, shape `(k, d)`, model frame, in vertex-number order."""
    @property
    def face_normals(self) -> NDArray[float64]:
        """Unit outward normals, shape `(n, d)`, model frame."""
    @property
    def face_surfaces(self) -> list[Literal["touchable", "untouchable", "seam"]]:
        """What each face is to a probe."""
    @property
    def touchable_edges(self) -> NDArray[bool_]:
        """Whether each edge is convex and both its faces can be touched, shape `(e,)`. Empty in the plane."""
    @property
    def touchable_vertices(self) -> NDArray[bool_]:
        """Whether a tip can rest on each corner: it is convex and its faces can be touched, shape `(k,)`."""
    @property
    def triangles(self) -> NDArray[uint32]:
        """Numbers of corners of triangles that make up all faces but seams, shape `(m, 3)`. Empty in the plane."""
    @property
    def triangle_faces(self) -> NDArray[uint32]:
        """The face of each triangle, shape `(m,)`."""
    @property
    def symmetries(self) -> NDArray[float64]:
        """The motions that map it onto itself, the identity first, shape `(s, d + 1, d + 1)`, model frame.

        Up to rounding in the plane; in space up to that of single precision, in which files have their corners.
        """
    @property
    def symmetry_axes(self) -> list[tuple[NDArray[float64], NDArray[float64]]]:
        """Axes of continuous symmetry: a point and the unit direction of each, shape `(3,)`, model frame.

        Any turn about one maps the part onto itself, within its slacks and the rounding of its corners to single
        precision. A ball has three through its centre; most parts and
        all in the plane have none.
        """
    @property
    def position_slack(self) -> float:
        """Added to every contact's position error."""
    @property
    def normal_slack(self) -> float:
        """Added to every contact's normal error; radians."""
    @property
    def asymmetry(self) -> tuple[float, float]:
        """By how much `symmetries` miss at most: a length, and an angle in radians; rounding, where corners are exact.

        Without a prior a pose stands for its images, and what is said of poses holds with every contact's bounds widened by
        twice of this.
        """
    @property
    def mends(self) -> list[str]:
        """What was mended when it was read and made, one line each."""
    @property
    def size(self) -> float:
        """The largest distance between two of its corners."""
    @property
    def closed(self) -> bool:
        """Whether its faces bound a region, so that inside and outside are known."""
    def first_contact(
        self, world_from_model: ArrayLike, start: ArrayLike, direction: ArrayLike, tip_radius: float = 0.0
    ) -> FirstContact | None:
        """What a round tip meets first on its straight way, the part being at a pose: exact, without any error (3.2).

        A point that meets an edge or a corner meets one of its faces; where a face ends, a round tip that touches it touches the
        face. In space the tip is a ball, and its depth right to 1e-12 of the largest length or coordinate, over the cosine of the
        incidence.

        Args:
            world_from_model: Where the part is, a rigid motion, shape `(d + 1, d + 1)`.
            start: Where the centre of the tip begins, shape `(d,)`, world frame. The tip is to be clear of the part there:
                `distance` of it is above `tip_radius`.
            direction: Direction of travel, shape `(d,)`, world frame, of any length but zero.
            tip_radius: Radius of the tip; zero or more.

        Returns:
            What is met; None if nothing is, however far the tip goes.

        Raises:
            ValueError: Another shape, no rigid motion, a zero direction, a negative radius, a number that is not finite.
        """

    def distance(self, world_from_model: ArrayLike, point: ArrayLike) -> float:
        """How far a point is from the part at a pose; negative inside, if the part is closed.

        Args:
            world_from_model: Where the part is, a rigid motion, shape `(d + 1, d + 1)`.
            point: The point, shape `(d,)`, world frame.

        Raises:
            ValueError: Another shape, no rigid motion, a number that is not finite.
        """
    def __eq__(self, other: object, /) -> bool: ...
    def __hash__(self) -> int: ...
    def __reduce__(self) -> tuple[Any, ...]: ...

@final
class FirstContact:
    """What a tip meets first on its straight way: the answer of `Model.first_contact`.

    Immutable; equal if all numbers are equal.
    """

    @property
    def depth(self) -> float:
        """How far the centre of the tip has gone."""
    @property
    def center(self) -> NDArray[float64]:
        """Where the centre of the tip then is, shape `(d,)`, world frame."""
    @property
    def normal(self) -> NDArray[float64]:
        """Unit outward normal of what is touched, shape `(d,)`, world frame: from an edge or a corner towards the centre of the tip."""
    @property
    def feature(self) -> tuple[Literal["face", "edge", "vertex"], int]:
        """Kind and number of what is touched."""
    @property
    def touchable(self) -> bool:
        """Whether a reading may come from there: not from an untouchable face, the back of a loose one, or their edges and corners."""
    def __eq__(self, other: object, /) -> bool: ...
    __hash__: ClassVar[None]  # type: ignore[assignment]

@final
class Contact:
    """The tip of a probe rests on the part (2.2).

    The tip is a disc, in space a ball, of `tip_radius` whose centre is within `position_error` of `center`; a measured
    surface point is the case of radius zero. All vectors have d coordinates: 2 in the plane, 3 in space. Immutable; equal if all numbers are equal; can be pickled.
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
            point: Sensed point, shape `(d,)`, world frame.
            normal: Sensed outward normal, shape `(d,)`, world frame, of any length but zero; None if not sensed.
            position_error: The true point is within this distance of `point`; zero or more.
            normal_error: The true normal is within this angle of `normal`; radians, at most π/2. Given if and only if
                `normal` is.
            approach: Direction of travel, pointing into the part, shape `(d,)`, world frame, of any length but zero.
            start: Where the guarded move began, shape `(d,)`, world frame: the way from there was free.

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
            center: Sensed centre of the tip, shape `(d,)`, world frame.
            tip_radius: Radius of the tip; zero or more.
            position_error: The true centre is within this distance of `center`; zero or more.
            approach: As for a measured point.
            normal: As for a measured point.
            normal_error: As for a measured point.
            start: Where the centre of the tip began its guarded move, shape `(d,)`, world frame.

        Raises:
            ValueError: As for a measured point, and a negative radius.
        """

    @property
    def center(self) -> NDArray[float64]:
        """Sensed centre of the tip, shape `(d,)`, world frame."""
    @property
    def tip_radius(self) -> float:
        """Radius of the tip; zero for a measured point."""
    @property
    def position_error(self) -> float:
        """Bound on the distance of the true centre."""
    @property
    def normal(self) -> NDArray[float64] | None:
        """Sensed outward normal, made unit, shape `(d,)`, world frame."""
    @property
    def normal_error(self) -> float | None:
        """Bound on the angle of the true normal; radians."""
    @property
    def approach(self) -> NDArray[float64] | None:
        """Direction of travel, made unit, shape `(d,)`, world frame."""
    @property
    def start(self) -> NDArray[float64] | None:
        """Where the guarded move began, shape `(d,)`, world frame."""
    def __eq__(self, other: object, /) -> bool: ...
    def __reduce__(self) -> tuple[Any, ...]: ...
    __hash__: ClassVar[None]  # type: ignore[assignment]

@final
class Miss:
    """A guarded move that touched nothing: the tip swept from `start` to `end` freely.

    Both have d coordinates: 2 in the plane, 3 in space. Immutable; equal if all numbers are equal; can be pickled.
    """

    def __new__(
        cls, start: ArrayLike, end: ArrayLike, *, tip_radius: float = 0.0, path_error: float = 0.0
    ) -> Miss:
        """A free sweep.

        Args:
            start: Where the centre of the tip began, shape `(d,)`, world frame.
            end: Where it ended, shape `(d,)`, world frame.
            tip_radius: Radius of the tip; zero or more.
            path_error: How far the tip may have left its line; zero or more.

        Raises:
            ValueError: Another shape, a negative bound, any number that is not finite.
        """

    @property
    def start(self) -> NDArray[float64]:
        """Where the centre of the tip began, shape `(d,)`, world frame."""
    @property
    def end(self) -> NDArray[float64]:
        """Where it ended, shape `(d,)`, world frame."""
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
    """What is known of the pose beforehand: a range of translations and of rotations.

    Immutable; equal if all numbers are equal; can be pickled.
    """

    def __new__(cls, world_from_model: ArrayLike, *, translation: float, rotation: float) -> Prior:
        """Poses around a middle one.

        Args:
            world_from_model: The middle of the range, a rigid motion, shape `(3, 3)` in the plane, `(4, 4)` in space.
            translation: Each component of the translation is within this of the middle's; zero or more.
            rotation: The rotation is within this angle of the middle's; radians, zero to π (free).

        Raises:
            ValueError: Another shape, a matrix that is no rigid motion, a bound that is negative or not finite.
        """

    @classmethod
    def on_plane(
        cls,
        world_from_model: ArrayLike,
        *,
        translation: float,
        rotation: float,
        height: float,
        tilt: float,
        normal: ArrayLike = (0, 0, 1),
    ) -> Prior:
        """Poses in space of a part that lies on a plane, such as a table, around a middle one.

        Args:
            world_from_model: The middle of the range, a rigid motion, shape `(4, 4)`.
            translation: The translation along the plane is within this of the middle's; zero or more.
            rotation: The turn about the plane's normal, after the tilt, is within this angle; radians, zero to π (free).
            height: The translation along the normal is within this of the middle's; zero or more.
            tilt: The part may tilt by this angle; radians, zero (it lies as in the middle) to π.
            normal: Normal of the plane, shape `(3,)`, world frame, of any length but zero.

        Raises:
            ValueError: Another shape, a matrix that is no rigid motion, a zero normal, a bound that is negative or not finite.
        """

    @property
    def world_from_model(self) -> NDArray[float64]:
        """The middle of the range, shape `(d + 1, d + 1)`."""
    @property
    def translation(self) -> float:
        """Bound on each component of the translation; on a plane, on its length along it."""
    @property
    def rotation(self) -> float:
        """Bound on the rotation; on a plane, about its normal; radians."""
    @property
    def height(self) -> float | None:
        """Bound on the translation along the plane's normal; None of a part that lies on none."""
    @property
    def tilt(self) -> float | None:
        """Bound on the tilt, radians; None of a part that lies on no plane."""
    @property
    def normal(self) -> NDArray[float64] | None:
        """Unit normal of the plane, shape `(3,)`, world frame; None of a part that lies on none."""
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
    time_limit: float | None = None,
    effort: int | None = None,
) -> Recognition:
    """Every model and pose that explains all contacts, keeps clear of all misses, and agrees with the prior (chapter 2).

    Contacts, misses and prior are in the world frame, models each in its own: `p_world = world_from_model @ p_model`.
    Lengths are in the models' unit, whichever it is, angles in radians. If the bounds of the contacts hold, the true model
    and pose are in the answer; and every hypothesis has a pose that satisfies every contact, to the tolerance.

    Args:
        models: The parts that it may be, all of the plane or all of space. Their unit is that of all lengths.
        contacts: What was touched, at least one; their order doesn't change the answer.
        features: Kinds of features that contacts may lie on: some of `"face"`, `"vertex"` and, in space, `"edge"`. None:
            faces, and all other kinds if a tip has a radius.
        misses: Guarded moves that touched nothing.
        prior: What is known of the pose beforehand.
        tolerance: A pose is valid if it is within this share of the part's size; 1e-9 to 0.01.
        max_hypotheses: More than this are not returned, and `Recognition.stopped_by` says so.
        time_limit: Seconds, after which what was not looked at is one last hypothesis of a model, not `proved`, and
            `Recognition.complete` is False.
        effort: Cells of poses to examine for one model, about, 1 or more, where contacts allow so many assignments that poses
            are divided. What is undecided then is a last hypothesis, not `proved`. None: 2,000,000 in the plane, 20,000 in
            space.

    Returns:
        The answer. That no model explains the contacts is an answer too: `hypotheses` is empty, and `conflict` says why.

    Raises:
        ValueError: No models, no contacts, something else among them, an unknown kind of feature, a contact whose
            normal contradicts its approach, a number out of range, the plane mixed with space.
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
        """Whether every hypothesis is here, and proved; if not, `stopped_by` says why."""
    @property
    def stopped_by(self) -> Literal["time", "effort", "tolerance", "hypotheses"] | None:
        """Which limit ended the search before it knew all: the first of these that did, or None.

        `"time"`: the `time_limit`. `"effort"`: what may be examined; a larger `effort=` decides more. `"tolerance"`: at some poses it
        can't be told within `tolerance` whether they explain the contacts; one more contact may. `"hypotheses"`: there are more
        than `max_hypotheses`.
        """
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
        """The pose of largest slack, shape `(d + 1, d + 1)`: the worst reading uses the smallest share of its bounds."""
    @property
    def poses(self) -> PoseSet:
        """All its poses."""
    @property
    def marginal(self) -> bool:
        """Whether it is kept only thanks to the tolerance."""
    @property
    def proved(self) -> bool:
        """Whether a pose is known that explains every contact.

        If not, a search met its limit before it knew whether there is one: the hypothesis is kept, so that nothing true is lost,
        `Recognition.complete` is False, and `world_from_model` and samples are the best guess.
        """

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
    def assignment(self) -> list[tuple[Literal["face", "edge", "vertex"], int]]:
        """Kind and number of the feature that each contact lies on, in the order of the contacts."""
    @property
    def world_from_model(self) -> NDArray[float64]:
        """The pose of largest slack, shape `(d + 1, d + 1)`."""
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

    Poses are `world_from_model`, homogeneous matrices of shape `(d + 1, d + 1)`.
    """

    def contains(self, world_from_model: ArrayLike) -> bool:
        """Whether the pose explains every contact and miss, up to the tolerance: the exact predicate.

        Of a hypothesis, up to the model's symmetry.

        Raises:
            ValueError: Another shape than `(d + 1, d + 1)`, or no rigid motion.
        """

    def sample(self, n: int, seed: int = 0) -> NDArray[float64]:
        """`n` valid poses, spread over the set, shape `(n, d + 1, d + 1)`; the same for the same seed.

        Raises:
            ValueError: `n` or `seed` is negative or not whole, or `n` is above ten million.
        """

    @property
    def rotation_bound(self) -> float:
        """No two poses of the set differ by more; radians, at most π."""
    def excursion(self, point: ArrayLike) -> float:
        """No two poses of the set move this point, shape `(d,)`, model frame, further apart.

        Raises:
            ValueError: Another shape, or a number that is not finite.
        """

    def outline(self, point: ArrayLike) -> NDArray[float64]:
        """A convex polygon that holds every place of this point, shape `(2,)`, model frame, under the poses of the set.

        In the plane only.

        Returns:
            Corners, counter-clockwise, shape `(k, 2)`, world frame.

        Raises:
            ValueError: Another shape, or a number that is not finite; poses in space.
        """

    @property
    def witness(self) -> NDArray[float64]:
        """A pose of the set, shape `(d + 1, d + 1)`: the proof that it is not empty."""
    @property
    def marginal(self) -> bool:
        """Whether every witness needs the tolerance."""
    @property
    def thesis_pose(self) -> ThesisPose | None:
        """The thesis's own pose and bounds of the first assignment (2.2.3, 2.4; in space 2.5).

        None where they are not defined: a contact that is not on a face or has no normal; in the plane all faces parallel, in space
        no three faces independent.
        """

@final
class ThesisPose:
    """The thesis's nominal pose of an interpretation and its bounds (2.2.3, 2.4, 2.5), with its misprints corrected.

    They describe one pose, not the set of all poses; `PoseSet` does that. `docs/accuracy.md` compares the two.
    """

    @property
    def world_from_model(self) -> NDArray[float64]:
        """The nominal pose: `rotation` and `translation`, shape `(d + 1, d + 1)`."""
    @property
    def first_rotation(self) -> float | NDArray[float64] | None:
        """In the plane θ, which takes the first face's normal to its sensed one; radians (2.4).

        In space the matrix by axis and angle from the two data whose normals are nearest to a right angle, shape `(3, 3)`; None if
        their axis is not defined (2.2.3.1).
        """
    @property
    def rotation(self) -> float | NDArray[float64]:
        """In the plane φ, the middle of the rotations that all normals leave; radians (eq. 2.2).

        In space the matrix that fits all normals best by least squares, shape `(3, 3)`.
        """
    @property
    def residual_rotation(self) -> float:
        """In the plane γ, the width of the rotations that all normals leave; radians (2.4.1).

        In space 2Φ, which no two rotations differ by more than that two normals leave (2.5.1).
        """
    @property
    def rotation_error(self) -> float:
        """In the plane half of `residual_rotation`; radians.

        In space the largest turn about the middle of those two normals, from `rotation` and after any roll and pitch, that leaves all
        normals within their errors (eq. 2.4 and 2.5).
        """
    @property
    def translation(self) -> NDArray[float64]:
        """The nominal translation at `rotation`, shape `(d,)`, world frame (eq. 2.1; in space 2.2.3.1)."""
    @property
    def translation_error(self) -> float:
        """`E_T`, the longest half diagonal of the rhombus of translations of the best pair of faces (2.4.2).

        In space that of the parallelepiped of the best three (2.5.2).
        """
    @property
    def translation_region(self) -> NDArray[float64]:
        """Translations at `rotation` that keep each contact within its bound of its face's line or plane: corners, shape `(k, d)`.

        In the plane counter-clockwise (figure 2.6), in space in no order (2.5.2).
        """
    def excursion(self, point: ArrayLike) -> float:
        """`E_q`, how far the point, shape `(2,)`, model frame, moves between the two extreme nominal poses (eq. 2.3).

        A chord, not a bound. In the plane only.

        Raises:
            ValueError: Another shape, or a number that is not finite; poses in space.
        """

@final
class Sensor:
    """Bounds of the next reading (3.3).

    Immutable; equal if all numbers are equal; can be pickled.
    """

    def __new__(
        cls,
        position_error: float,
        normal_error: float | None,
        max_incidence: float,
        tip_radius: float = 0.0,
        path_error: float = 0.0,
        stem: tuple[ArrayLike, float, float] | None = None,
    ) -> Sensor:
        """A sensor of points and, unless `normal_error` is None, of normals.

        Args:
            position_error: The sensed centre of the tip is within this of the true one; a length, zero or more.
            normal_error: The sensed normal is within this angle of the true one; radians, zero to π/2. None: it reads no
                normal.
            max_incidence: Ω, the skid angle: a touch is reliable if the way back is within this of the surface normal;
                radians, between 0 and π/2.
            tip_radius: Radius of the tip; zero or more.
            path_error: How far the tip may leave its line; zero or more.
            stem: What carries the tip, in space: a rod from its centre along a direction, shape `(3,)`, world frame, of any length
                but zero; the rod's radius, zero or more; how far it goes, above zero. It must not touch before the tip does.
                None: nothing that may touch.

        Raises:
            ValueError: A bound that is negative, out of its range or not finite; something else for a stem.
        """

    @property
    def position_error(self) -> float:
        """Bound on the distance of the sensed centre from the true one."""
    @property
    def normal_error(self) -> float | None:
        """Bound on the angle of the sensed normal; radians. None: it reads no normal."""
    @property
    def max_incidence(self) -> float:
        """Ω, the largest reliable incidence; radians."""
    @property
    def tip_radius(self) -> float:
        """Radius of the tip."""
    @property
    def path_error(self) -> float:
        """How far the tip may leave its line."""
    @property
    def stem(self) -> tuple[NDArray[float64], float, float] | None:
        """What carries the tip: unit direction from its centre, shape `(3,)`, world frame, radius and length. None: nothing."""
    def __eq__(self, other: object, /) -> bool: ...
    def __reduce__(self) -> tuple[Any, ...]: ...
    __hash__: ClassVar[None]  # type: ignore[assignment]

def plan(
    hypotheses: Sequence[Hypothesis],
    sensor: Sensor,
    *,
    planner: Literal[
        "auto", "complete", "ellis", "optimized", "linearized", "decoupled", "grimson", "schneiter"
    ] = "auto",
    stop: Literal["perfect"] | tuple[Literal["unique"], int] | tuple[Literal["share"], float] = "perfect",
    workspace: ArrayLike | None = None,
    directions: tuple[ArrayLike, float] | None = None,
    time_limit: float | None = None,
    effort: int | None = None,
    seed: int = 0,
    features: Sequence[str] | None = None,
    avoid_assigned: bool = False,
    margin: float = 1e-3,
    tried: Sequence[tuple[ArrayLike, ArrayLike]] = (),
    cells: int | None = None,
    directions_tried: int | None = None,
) -> Path | None:
    """The straight guarded move that tells the hypotheses apart best (chapter 3).

    What a path tells is for one judge to say, whichever planner proposes it. Over all poses of all hypotheses, the path
    starts clear and is touched first only where a reading is reliable. The best has the smallest `score`; of those that
    are equal, the smallest `expected_score`, the largest `margin`, the shortest way. Same input, same path, unless
    `time_limit` cuts the search short. An interrupt (Ctrl-C) ends it.

    Args:
        hypotheses: `found.hypotheses` of a recognition, or some of them, all of the plane (d = 2) or all of space (d = 3).
            Lengths are in the unit of their models.
        sensor: Bounds of the next reading.
        planner: Where candidates come from. `"auto"`: in the plane evenly spaced directions, quick, then `"grimson"` and
            `"complete"` where these tell nothing; in space many lines at faces and all around, and all others' lines. Of the plane: `"complete"`: all lines; no usable path of
            margin m or more has a better score, or `PlanReport.bound` says how much better at most. `"ellis"`: the
            thesis's search (3.1 to 3.3, 4.1). Of both: `"grimson"`, `"schneiter"`: 5.4.2, 5.4.3. Of space: `"optimized"`
            (5.1, 5.2), `"linearized"` (5.3), `"decoupled"` (5.4.4).
        stop: When a path is good enough (3.4): `"perfect"`, all are separated; `("unique", k)`, it identifies k
            hypotheses, whichever of them is true; `("share", f)`, this share of them, above 0 and at most 1.
        workspace: Two opposite corners, shape `(2, d)`, world frame: paths begin at the border of this rectangle or box.
            None: just outside of all hypotheses.
        directions: A direction of travel, shape `(d,)`, world frame, of any length, and an angle in radians, zero to π:
            only directions within this angle of it are allowed. None: all.
        time_limit: Seconds. The best path found by then is returned.
        effort: Boxes of lines that `"complete"` may examine, lines that the thesis's planners may judge; 1 or more. None:
            two million. A limit that gives the same answer everywhere.
        seed: For the poses that are drawn from the sets.
        features: Kinds of features that may be touched first. None: faces, and edges and vertices if the tip has a radius.
        avoid_assigned: Never touch a face that a contact is assigned to (1.1).
        margin: m, as a share of the largest part's size, 1e-6 to 0.1: paths are wanted that tell the same when they are
            shifted by m.
        tried: Lines that were moved along before, each a start and a direction, shape `(d,)`, world frame. One within m of
            them is no answer, unless it is certain to tell something.
        cells: Grid of `"grimson"`, 8 to 16384 in the plane, to 512 in space, and of `"schneiter"`, to 2048 and 128. None:
            256; in space 32 and 48.
        directions_tried: Directions that `"grimson"` tries, 1 to 7200. None: 72; in space 96.

    Returns:
        The path; None if one hypothesis is left, or if no path was found that can be used: `plan_report` says which.

    Raises:
        ValueError: No hypotheses, something else among them, the plane mixed with space, a planner that is unknown there, a
            number out of range.
    """

def plan_report(
    hypotheses: Sequence[Hypothesis],
    sensor: Sensor,
    *,
    planner: Literal[
        "auto", "complete", "ellis", "optimized", "linearized", "decoupled", "grimson", "schneiter"
    ] = "auto",
    stop: Literal["perfect"] | tuple[Literal["unique"], int] | tuple[Literal["share"], float] = "perfect",
    workspace: ArrayLike | None = None,
    directions: tuple[ArrayLike, float] | None = None,
    time_limit: float | None = None,
    effort: int | None = None,
    seed: int = 0,
    features: Sequence[str] | None = None,
    avoid_assigned: bool = False,
    margin: float = 1e-3,
    tried: Sequence[tuple[ArrayLike, ArrayLike]] = (),
    cells: int | None = None,
    directions_tried: int | None = None,
) -> PlanReport:
    """The path of `plan`, and what is known of the paths that were not found.

    Args:
        hypotheses: As for `plan`.
        sensor: As for `plan`.
        planner: As for `plan`.
        stop: As for `plan`.
        workspace: As for `plan`.
        directions: As for `plan`.
        time_limit: As for `plan`.
        effort: As for `plan`.
        seed: As for `plan`.
        features: As for `plan`.
        avoid_assigned: As for `plan`.
        margin: As for `plan`.
        tried: As for `plan`.
        cells: As for `plan`.
        directions_tried: As for `plan`.

    Raises:
        ValueError: As for `plan`.
    """

def judge(
    hypotheses: Sequence[Hypothesis],
    sensor: Sensor,
    start: ArrayLike,
    direction: ArrayLike,
    length: float | None = None,
    *,
    features: Sequence[str] | None = None,
    avoid_assigned: bool = False,
    margin: float = 1e-3,
    seed: int = 0,
) -> Path:
    """What a line of your own would tell, and whether it can be used (3.3).

    Args:
        hypotheses: As for `plan`.
        sensor: Bounds of the next reading.
        start: Where the centre of the tip begins, shape `(d,)`, world frame.
        direction: Direction of travel, shape `(d,)`, world frame, of any length but zero. A unit vector is kept bit for bit:
            start, direction and length of a path give that path again.
        length: How far to go, above zero. None: past the last possible contact.
        features: Kinds of features that may be touched first. None: faces, and edges and vertices if the tip has a radius.
        avoid_assigned: Whether a face that a contact is assigned to must not be touched first.
        margin: m, as a share of the largest part's size; `Path.margin` is told in eighths of it.
        seed: For the poses over which the expected score is taken.

    Returns:
        The path. If it can't be used, `faults` says why.

    Raises:
        ValueError: No hypotheses, another shape, a zero direction, a length that is not above zero, a number out of range.
    """

def verification_path(
    hypothesis: Hypothesis,
    sensor: Sensor,
    *,
    line: tuple[ArrayLike, ArrayLike] | None = None,
    workspace: ArrayLike | None = None,
    directions: tuple[ArrayLike, float] | None = None,
    time_limit: float | None = None,
    effort: int | None = None,
    features: Sequence[str] | None = None,
    margin: float = 1e-3,
    seed: int = 0,
) -> Path | None:
    """One more touch of a hypothesis that is thought to be the truth, where no contact is assigned yet (6.2).

    It surely touches, if the hypothesis is true; a miss or another reading refutes it. Of the lines that are tried, the one
    that may be shifted farthest: `Path.margin` says how far.

    Args:
        hypothesis: The hypothesis.
        sensor: As for `plan`.
        line: A start and a direction, as of a path: this line alone is tried. That of a path gives the path again.
        workspace: As for `plan`.
        directions: As for `plan`.
        time_limit: As for `plan`.
        effort: So many times a line is judged, with one margin or another; the most promising lines are judged first.
        features: As for `plan`.
        margin: As for `plan`.
        seed: As for `plan`.

    Returns:
        The path; None if none of those that are tried surely touches.

    Raises:
        ValueError: Not a hypothesis, another shape, a number out of range.
    """

def verification_report(
    hypothesis: Hypothesis,
    sensor: Sensor,
    *,
    workspace: ArrayLike | None = None,
    directions: tuple[ArrayLike, float] | None = None,
    time_limit: float | None = None,
    effort: int | None = None,
    features: Sequence[str] | None = None,
    margin: float = 1e-3,
    seed: int = 0,
) -> PlanReport:
    """The path of `verification_path`, and whether the search for it was cut short.

    `PlanReport.why`: `"searched"`, all lines that are tried were looked at; `"time"` or `"effort"`, not all were. Nothing is
    proved of other lines.

    Args:
        hypothesis: As for `verification_path`.
        sensor: As for `plan`.
        workspace: As for `plan`.
        directions: As for `plan`.
        time_limit: As for `plan`.
        effort: As for `verification_path`.
        features: As for `plan`.
        margin: As for `plan`.
        seed: As for `plan`.

    Raises:
        ValueError: As for `verification_path`.
    """

def refuting_moves(
    hypotheses: Sequence[Hypothesis],
    moves: Sequence[tuple[ArrayLike, ArrayLike, float, Sensor, Contact | None]],
) -> list[int | None]:
    """Of each hypothesis the number of the first guarded move that it can't have answered so; None if there is none.

    As `judge(...).outcome_of(contact)` of each move says, quickly.

    Args:
        hypotheses: As for `plan`.
        moves: Each a start, shape `(d,)`, world frame, a direction of any length but zero, the length that the tip was to go at
            most, the bounds of this reading as a sensor, and the contact that was met, or None.

    Raises:
        ValueError: No hypotheses, another shape, a zero direction, a number out of range.
    """

def linearization_error(corners: ArrayLike, slopes: ArrayLike) -> tuple[float, float]:
    """By how much a face is wrong that planner `linearized` flattens to the middle of its heights.

    A line is `(x, y) + z (α, β)` in the chart of a generator, whose Z is the generator's outward normal. Thesis 5.3 as MATH
    rows 85 and 92 correct it; `docs/theory.md` has the proof.

    Args:
        corners: Shape `(k, 3)`, of a flat polygon, in order, in the chart.
        slopes: α and β, shape `(2,)`.

    Returns:
        The shift, a length: no place of the border is seen further than that from where it is. And an upper bound of the area that
        one of both polygons covers, as they are seen, and the other does not.

    Raises:
        ValueError: Another shape, fewer than three corners, a number that is not finite.
    """

def predicted_hit_rate(corners: ArrayLike, slopes: ArrayLike) -> float:
    """The share of lines of these slopes through the rectangle around a face, all equally likely, that hit the face.

    What planner `decoupled` predicts of itself: to either of its two problems a face is as long as its rectangle (thesis
    5.4.4, MATH 2.5).

    Args:
        corners: Shape `(k, 3)`, of a convex piece of the face, in order, in the chart of a generator.
        slopes: α and β, shape `(2,)`.

    Raises:
        ValueError: Another shape, fewer than three corners, a number that is not finite.
    """

@final
class PlanReport:
    """A planner's answer, and what it knows of the paths that it did not find."""

    @property
    def path(self) -> Path | None:
        """The best path found; None if none is needed or none can be used: `why` says which."""
    @property
    def bound(self) -> float:
        """No usable path of margin m or more has a score below this. 1 if nothing was proved."""
    @property
    def proved(self) -> bool:
        """Whether no usable path of margin m or more has a better score than `path`."""
    @property
    def why(
        self,
    ) -> Literal[
        "solved",
        "perfect",
        "enough",
        "best",
        "inseparable",
        "no_usable_path",
        "time",
        "effort",
        "searched",
    ]:
        """Why the planner stopped.

        `"solved"`: one hypothesis is left. `"perfect"`: the path separates all. `"enough"`: it is as good as `stop` asks
        for. `"best"`: proved, no usable path of margin m or more has a better score. `"inseparable"`: proved, none is
        certain to tell anything; `path` may still be expected to. `"no_usable_path"`: proved, none can be used. `"time"`,
        `"effort"`: the search was cut short. `"searched"`: the planner has looked at all that it looks at.
        """
    @property
    def num_judged(self) -> int:
        """Lines that were judged."""
    @property
    def num_boxes(self) -> int:
        """Boxes of lines that `"complete"` examined."""
    @property
    def counters(self) -> dict[str, int] | None:
        """What the planner `"ellis"` did (3.5); None for another.

        `unsensed` and `sensed` faces, `inner_products`, `generators`, `candidates`, `critical_points` and of them
        `critical_kept`, `overlaps`, `paths`; and, by the thesis's formulas, `predicted_inner_products` and
        `predicted_critical_points`.
        """

@final
class Path:
    """A straight guarded move of the tip, and what it would tell (3.3, 3.4).

    Numbers are those of the hypotheses that were given, from 0. Immutable; equal if all numbers are equal.
    """

    @property
    def start(self) -> NDArray[float64]:
        """Where the centre of the tip begins, shape `(d,)`, world frame: clear of all that any hypothesis may occupy."""
    @property
    def direction(self) -> NDArray[float64]:
        """Unit direction of travel, shape `(d,)`, world frame."""
    @property
    def length(self) -> float:
        """How far to go: past the last possible contact. Who gets so far has missed."""
    @property
    def end(self) -> NDArray[float64]:
        """`start + length * direction`, shape `(d,)`, world frame."""
    @property
    def margin(self) -> float:
        """All that it separates stays separated, and it stays usable, when it is shifted by this; to an eighth of m."""
    @property
    def score(self) -> float:
        """The mean over hypotheses k of how many are not separated from k, k included (3.4).

        1: all are separated, whatever the reading. n, their number: nothing is certain.
        """
    @property
    def expected_score(self) -> float:
        """The mean, over poses sampled from the sets, of how many hypotheses their exact readings leave."""
    @property
    def guaranteed(self) -> bool:
        """Whether it can be used and is certain to separate some pair; if not, it may still be expected to tell."""
    @property
    def members(self) -> list[int]:
        """The hypotheses that it is about, in order: all that were given, or those of a node of an ambiguity tree."""
    @property
    def classes(self) -> list[list[int]]:
        """Hypotheses joined by "not separated": the branches of the ambiguity tree."""
    @property
    def no_contact(self) -> list[int]:
        """The hypotheses that a miss leaves."""
    @property
    def outcomes(self) -> list[Outcome]:
        """What each of `members` can answer, in their order."""
    @property
    def fault(self) -> tuple[int, Literal["start", "skid", "untouchable", "kind", "assigned", "stem"]] | None:
        """Why it can't be used, and because of which hypothesis; the first of `faults`. None: it can be used."""
    @property
    def faults(self) -> list[tuple[int, Literal["start", "skid", "untouchable", "kind", "assigned", "stem"]]]:
        """For each hypothesis that makes it unusable, its number and why.

        `"start"`: it does not start clear. `"skid"`: it may be touched first at more than the largest reliable incidence.
        `"untouchable"`: on a face that can't be touched, or on the back of a loose one. `"kind"`: on a feature of a kind
        that may not be touched. `"assigned"`: on a face that a contact is assigned to, which was to be avoided. `"stem"`: the
        stem of the probe may touch it before the tip does.
        """
    def outcome_of(self, contact: Contact | None) -> list[int]:
        """The hypotheses that could have given a reading (3.4).

        Args:
            contact: What was touched, with the sensor's tip radius. Its own bounds don't matter, those of the sensor do.
                None: nothing was touched all along the path.

        Returns:
            Numbers of hypotheses. Empty: the reading is unexpected; recognize again with it.

        Raises:
            ValueError: Something else than a contact, or one with another tip radius.
        """
    def __eq__(self, other: object, /) -> bool: ...
    __hash__: ClassVar[None]  # type: ignore[assignment]

@final
class Outcome:
    """What one hypothesis can answer to a path, over all its poses."""

    @property
    def hypothesis(self) -> int:
        """Its number."""
    @property
    def touches(self) -> list[Touch]:
        """First contacts that the path may make with it, in order of features."""
    @property
    def may_miss(self) -> bool:
        """Whether the path may pass it by."""
    @property
    def fault(self) -> Literal["start", "skid", "untouchable", "kind", "assigned", "stem"] | None:
        """Why it makes the path unusable, as in `Path.faults`."""
    def __eq__(self, other: object, /) -> bool: ...
    __hash__: ClassVar[None]  # type: ignore[assignment]

@final
class Touch:
    """A first contact that a path may make with a hypothesis, somewhere among its poses."""

    @property
    def feature(self) -> tuple[Literal["face", "edge", "vertex"], int]:
        """Kind and number of what is touched."""
    @property
    def depth(self) -> tuple[float, float]:
        """Least and largest way of the tip's centre from the start of the path; the sensor's errors not included."""
    @property
    def normals(self) -> tuple[float, float]:
        """Outward normals at the contact, from one angle counter-clockwise to the other; radians, world frame.

        The second is not below the first, and may be above π. In the plane only.

        Raises:
            ValueError: A touch in space.
        """
    @property
    def normal_cap(self) -> tuple[NDArray[float64], float]:
        """A unit vector, shape `(d,)`, world frame, and the angle from it, radians, within which outward normals at the contact are."""
    def __eq__(self, other: object, /) -> bool: ...
    __hash__: ClassVar[None]  # type: ignore[assignment]

@final
class Lines:
    """Hypotheses made ready for many lines.

    In the plane a line is given by its angle and its offset (3.1), in space by its direction and a point.
    """

    def __new__(
        cls,
        hypotheses: Sequence[Hypothesis],
        sensor: Sensor,
        *,
        workspace: ArrayLike | None = None,
        directions: tuple[ArrayLike, float] | None = None,
        features: Sequence[str] | None = None,
        avoid_assigned: bool = False,
        margin: float = 1e-3,
        seed: int = 0,
    ) -> Lines:
        """For lines through all that the hypotheses may occupy.

        Args:
            hypotheses: As for `plan`.
            sensor: As for `plan`.
            workspace: As for `plan`.
            directions: As for `plan`.
            features: As for `plan`.
            avoid_assigned: As for `plan`.
            margin: As for `plan`.
            seed: As for `plan`.

        Raises:
            ValueError: As for `plan`.
        """

    @property
    def middle(self) -> NDArray[float64]:
        """The middle of a circle or ball around all that any hypothesis may occupy, shape `(d,)`, world frame."""
    @property
    def radius(self) -> float:
        """The radius of that circle or ball."""
    def scores(self, angles: ArrayLike, offsets: ArrayLike) -> NDArray[float64]:
        """In the plane, the scores of a grid of lines; NaN for a line that can't be used.

        Args:
            angles: Of the directions of travel, shape `(a,)`; radians, world frame.
            offsets: How far each line passes to the left of the middle, shape `(b,)`.

        Returns:
            Scores as `Path.score`, shape `(a, b)`.

        Raises:
            ValueError: Another shape, or a number that is not finite; hypotheses in space.
        """

    def judge(self, angle: float, offset: float) -> Path | None:
        """In the plane, all that is to say of one line; None if `workspace` or `directions` don't allow it.

        Args:
            angle: Of the direction of travel; radians, world frame.
            offset: How far the line passes to the left of the middle.

        Raises:
            ValueError: A number that is not finite; hypotheses in space.
        """

    def judge_through(self, direction: ArrayLike, point: ArrayLike) -> Path | None:
        """In space, all that is to say of one line; None if `workspace` or `directions` don't allow it.

        Args:
            direction: Of travel, shape `(3,)`, world frame, of any length.
            point: A point of the line, shape `(3,)`, world frame.

        Raises:
            ValueError: Another shape, a number that is not finite, no direction; hypotheses in the plane.
        """

    def scores_through(self, directions: ArrayLike, points: ArrayLike) -> NDArray[float64]:
        """In space, the scores of many lines; NaN for a line that can't be used.

        Args:
            directions: Of travel, shape `(n, 3)`, world frame, of any length.
            points: A point of each line, shape `(n, 3)`, world frame.

        Returns:
            Scores as `Path.score`, shape `(n,)`.

        Raises:
            ValueError: As `judge_through`; not as many points as directions.
        """

    def least_scores(self, directions: ArrayLike, points: ArrayLike) -> NDArray[float64]:
        """In space, what no score of a line can be below: what it would be if each hypothesis were at one pose.

        It is quick. Of a hypothesis that is not proved (`Hypothesis.proved`) the pose may be none of its own: with one, the
        number is a guess.

        Args:
            directions: As for `scores_through`.
            points: As for `scores_through`.

        Returns:
            Shape `(n,)`; NaN for a line that can't be used, as `workspace`, `directions` or one of these poses says.

        Raises:
            ValueError: As `scores_through`.
        """

def projection_space(
    hypotheses: Sequence[Hypothesis],
    sensor: Sensor,
    generator: tuple[int, int] | None = None,
    *,
    stop: Literal["perfect"] | tuple[Literal["unique"], int] | tuple[Literal["share"], float] = "perfect",
    workspace: ArrayLike | None = None,
    directions: tuple[ArrayLike, float] | None = None,
    time_limit: float | None = None,
    effort: int | None = None,
    seed: int = 0,
    features: Sequence[str] | None = None,
    avoid_assigned: bool = False,
    margin: float = 1e-3,
) -> ProjectionSpace:
    """The projection space of a face, with the best path that the planner `"ellis"` finds through it (3.1 to 3.3).

    In the plane only.

    Args:
        hypotheses: As for `plan`.
        sensor: As for `plan`.
        generator: Numbers of a hypothesis and of a face of its model that no contact is assigned to. None: the one through
            which the best path goes that `"ellis"` finds at all; the one it searches first, if it finds none.
        stop: As for `plan`.
        workspace: As for `plan`.
        directions: As for `plan`.
        time_limit: As for `plan`.
        effort: As for `plan`.
        seed: As for `plan`.
        features: As for `plan`.
        avoid_assigned: As for `plan`.
        margin: As for `plan`.

    Raises:
        ValueError: As for `plan`; a generator that does not exist, can't be touched or has a contact; no generator at all.
    """

@final
class ProjectionSpace:
    """The lines that pierce a face, the generator, and others with it (3.1 to 3.3, figures 3.5 to 3.7).

    In the generator's frame the generator lies on the X axis and its outward normal is +Y. A point of projection space is a
    line of that frame, `x = position + slope * y`, traveled downward. Faces are where the thesis places them: at a nominal
    pose, and at two extreme ones for what is uncertain. That is no guarantee; the judge of `path` gives it.
    """

    @property
    def generator(self) -> tuple[int, int]:
        """The number of its hypothesis, and that of the face."""
    @property
    def world_from_generator(self) -> NDArray[float64]:
        """`p_world = world_from_generator @ p_generator`, shape `(3, 3)`: the face from its end on the left to its start at 0."""
    @property
    def max_slope(self) -> float:
        """The bound on slopes, to either side: the tangent of the largest incidence less half the range of rotations."""
    @property
    def sheaves(self) -> list[Sheaf]:
        """The generator's sheaf, then those of its candidate set: faces that one line may pierce with it (3.1)."""
    @property
    def critical_points(self) -> NDArray[float64]:
        """Where the end of a candidate projects on an end of the generator, shape `(k, 2)`: position and slope (3.2).

        Of the nominal pose, and of slopes within the bounds.
        """
    @property
    def critical_slopes(self) -> NDArray[float64]:
        """The slopes that are examined, shape `(k,)`: zero, those of the critical points, the bounds; from zero outward (4.1).

        Of those that are closer to each other than `margin`, the one nearer to zero.
        """
    def overlaps(self, slope: float) -> list[Overlap]:
        """What the generator shares with all that overlap its left end at a slope, and the same for its right end (4.1).

        By inner projections. Empty, if a path of this slope does not fit through the generator.

        Args:
            slope: Of the lines, in the generator's frame: right for each upward.

        Raises:
            ValueError: A number that is not finite.
        """

    @property
    def path(self) -> Path | None:
        """The best path found through the generator. None: none that can be used, or there is nothing to tell apart."""
    @property
    def path_position(self) -> float | None:
        """Where the line of `path` crosses the X axis of the generator's frame."""
    @property
    def path_slope(self) -> float | None:
        """The slope of `path` in that frame."""

@final
class Sheaf:
    """The lines that meet a face, as a region of projection space (3.2, 3.3.1).

    Immutable; equal if all numbers are equal.
    """

    @property
    def hypothesis(self) -> int:
        """The number of the face's hypothesis."""
    @property
    def face(self) -> int:
        """The number of the face in its model."""
    @property
    def sensed(self) -> bool:
        """Whether a contact is assigned to it."""
    @property
    def ends(self) -> NDArray[float64]:
        """Start and end of the face at the nominal pose, shape `(2, 2)`, generator's frame; moved out by the tip's radius."""
    @property
    def extreme_ends(self) -> NDArray[float64]:
        """The same at the least and the largest rotation, shape `(2, 2, 2)` (3.3.1)."""
    def inner(self, slopes: ArrayLike) -> NDArray[float64]:
        """The inner projection: positions whose lines meet the face at both extreme poses (figure 3.8).

        Args:
            slopes: Of the lines, shape `(n,)`.

        Returns:
            Least and largest position for each slope, shape `(n, 2)`; NaN where there is none.

        Raises:
            ValueError: Another shape, or a number that is not finite.
        """

    def outer(self, slopes: ArrayLike) -> NDArray[float64]:
        """The outer projection: from the first to the last position whose line meets the face at an extreme pose (figure 3.8).

        Args:
            slopes: Of the lines, shape `(n,)`.

        Returns:
            Least and largest position for each slope, shape `(n, 2)`.

        Raises:
            ValueError: Another shape, or a number that is not finite.
        """

    def skids(self, slopes: ArrayLike) -> NDArray[bool_]:
        """Whether lines meet the face at more than the largest reliable incidence, or from behind, at an extreme pose.

        Args:
            slopes: Of the lines, shape `(n,)`.

        Returns:
            One for each slope, shape `(n,)`.

        Raises:
            ValueError: Another shape, or a number that is not finite.
        """

    def __eq__(self, other: object, /) -> bool: ...
    __hash__: ClassVar[None]  # type: ignore[assignment]

@final
class Overlap:
    """Lines of one slope that pierce several faces (3.2, 4.1).

    Immutable; equal if all numbers are equal.
    """

    @property
    def positions(self) -> tuple[float, float] | None:
        """From the least to the largest position that all share; None if they share none."""
    @property
    def sheaves(self) -> list[int]:
        """Places in `ProjectionSpace.sheaves`: the generator's, 0, and those that overlap its end."""
    def __eq__(self, other: object, /) -> bool: ...
    __hash__: ClassVar[None]  # type: ignore[assignment]

def plan_tree(
    hypotheses: Sequence[Hypothesis],
    sensor: Sensor,
    *,
    method: Literal["greedy", "ahead", "optimal"] = "greedy",
    max_nodes: int | None = None,
    planner: Literal[
        "auto", "complete", "ellis", "optimized", "linearized", "decoupled", "grimson", "schneiter"
    ] = "auto",
    stop: Literal["perfect"] | tuple[Literal["unique"], int] | tuple[Literal["share"], float] = "perfect",
    workspace: ArrayLike | None = None,
    directions: tuple[ArrayLike, float] | None = None,
    time_limit: float | None = None,
    effort: int | None = None,
    seed: int = 0,
    features: Sequence[str] | None = None,
    avoid_assigned: bool = False,
    margin: float = 1e-3,
    cells: int | None = None,
    directions_tried: int | None = None,
) -> AmbiguityTree:
    """The ambiguity tree: the next path, whatever the last one met (3.4, 4.1).

    Pose sets are not shrunk within the tree, as they are when one recognizes again after each touch: what it needs is an
    upper bound on what the loop needs. The most ambiguous node comes first.

    Args:
        hypotheses: As for `plan`.
        sensor: As for `plan`.
        method: `"greedy"`: at each node the path whose branches are smallest in the mean. `"ahead"`: the path with which
            the fewest touches are expected, if greedy ones follow it; for up to 128 hypotheses. `"optimal"`: of all trees
            over the paths that were found, the one with the fewest expected touches; for up to 12. Above its number each
            falls back on the one before; `AmbiguityTree.method` says what was done.
        max_nodes: So many nodes get a path at most; the rest are left unexpanded. None: all.
        planner: As for `plan`.
        stop: As for `plan`.
        workspace: As for `plan`.
        directions: As for `plan`.
        time_limit: Seconds, for the whole tree. Nodes that were not planned for by then are left unexpanded.
        effort: As for `plan`, for each node.
        seed: As for `plan`.
        features: As for `plan`.
        avoid_assigned: As for `plan`.
        margin: As for `plan`.
        cells: As for `plan`.
        directions_tried: As for `plan`.

    Returns:
        The tree. Its numbers of hypotheses are their places in `hypotheses`, at every node.

    Raises:
        ValueError: As for `plan`, and an unknown method.
    """

@final
class AmbiguityTree:
    """Which path to take, whatever the paths before have met (3.4).

    Its figures take all hypotheses as equally likely; a leaf of s hypotheses that no path divides counts s - 1 further
    touches.
    """

    @property
    def root(self) -> AmbiguityNode:
        """All hypotheses, and the first path."""
    @property
    def nodes(self) -> list[AmbiguityNode]:
        """All nodes, the root first."""
    @property
    def names(self) -> list[str]:
        """The name of each hypothesis's model."""
    @property
    def method(self) -> Literal["greedy", "ahead", "optimal"]:
        """How the paths were chosen."""
    @property
    def expected_touches(self) -> float:
        """The mean over hypotheses of the touches until they are identified."""
    @property
    def worst_touches(self) -> int:
        """The most touches until a hypothesis is identified."""
    @property
    def max_outcomes(self) -> int:
        """b, at least 2: the most classes that a path has."""
    @property
    def entropy_bound(self) -> float:
        """`log2 n / log2 b`: no tree whose paths have at most b classes has fewer expected touches."""
    @property
    def worst_bound(self) -> int:
        """`log_b n`, rounded up: nor fewer touches in the worst case."""
    @property
    def lower_bound(self) -> float:
        """No tree of usable paths of margin m or more has fewer expected touches, as far as the planner proved it."""
    @property
    def identified(self) -> list[int]:
        """`identified[k]`: how many hypotheses are identified after k touches."""
    @property
    def solved(self) -> bool:
        """Whether every leaf is a single hypothesis."""
    def to_text(self) -> str:
        """Drawn with one line for each branch, as in figure 3.9; `I1` is hypothesis 0, `S1` the first answer."""
    def to_json(self, *, unit: str | None = None) -> str:
        """As a JSON document of the schema `palpate-tree`, version 1. Numbers count from 0.

        Args:
            unit: The unit of the models, for the document to say.
        """

@final
class AmbiguityNode:
    """Hypotheses that are left after some touches, and how to go on."""

    @property
    def number(self) -> int:
        """Its place in `AmbiguityTree.nodes`."""
    @property
    def members(self) -> list[int]:
        """The hypotheses that are left."""
    @property
    def level(self) -> int:
        """Touches before."""
    @property
    def path(self) -> Path | None:
        """The next path; None at a leaf."""
    @property
    def branches(self) -> list[AmbiguityBranch]:
        """The classes of the path, and the unexpected; empty at a leaf."""
    @property
    def status(
        self,
    ) -> Literal["solved", "divided", "inseparable", "no_usable_path", "effort", "unexpanded"]:
        """What becomes of it.

        `"solved"`: one hypothesis is left. `"divided"`: its path divides it. `"inseparable"`: proved, no usable path of
        margin m or more does. `"no_usable_path"`: proved, there is none. `"effort"`: the search was cut short.
        `"unexpanded"`: not planned for, by `max_nodes` or `time_limit`.
        """

@final
class AmbiguityBranch:
    """A class of a path, or the unexpected."""

    @property
    def answers(self) -> Literal["contact", "no_contact", "either", "unexpected"]:
        """Which answers lead here: contacts, a miss, either, or what fits no hypothesis of the node."""
    @property
    def members(self) -> list[int]:
        """The hypotheses that are left; empty for the unexpected."""
    @property
    def node(self) -> AmbiguityNode | None:
        """Where it leads; None for the unexpected: recognize again with what was touched."""
