//! What `help()` shows, the texts of `python/palpate/_core.pyi`. Change them there, then write this file anew
//! with `python tests/test_bindings.py`.

/// The text of a class, a function, a method or a property.
macro_rules! doc {
    ("Model") => {
        r"A part: its faces, its corners and the motions that map it onto itself (2.1).

In the plane a face is a line segment, with its outward normal on the right of `start → end`. Made by `polygon`,
`segments` or `palpate.load_models`. Immutable; equal if all numbers are equal; can be pickled."
    };
    ("Model.polygon") => {
        r"A part bounded by a closed outline, less its holes.

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
        a hole outside, a face number out of range, a slack that is negative, any number that is not finite."
    };
    ("Model.segments") => {
        r"A part given by loose faces: it need not be closed (2.1).

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
        untouchable, a slack that is negative, any number that is not finite."
    };
    ("Model.name") => {
        r"Its name."
    };
    ("Model.dimension") => {
        r"2: the plane."
    };
    ("Model.faces") => {
        r"Start and end of each face, shape `(2, 2)`, model frame, in face-number order."
    };
    ("Model.edges") => {
        r"Empty in the plane."
    };
    ("Model.vertices") => {
        r"Corners, shape `(k, 2)`, model frame, in vertex-number order."
    };
    ("Model.face_normals") => {
        r"Unit outward normals, shape `(n, 2)`, model frame."
    };
    ("Model.face_surfaces") => {
        r"What each face is to a probe."
    };
    ("Model.touchable_vertices") => {
        r"Whether each corner is convex and both its faces can be touched, shape `(k,)`."
    };
    ("Model.symmetries") => {
        r"The motions that map it onto itself, the identity first, shape `(s, 3, 3)`, model frame."
    };
    ("Model.symmetry_axes") => {
        r"Axes of continuous symmetry. Empty in the plane."
    };
    ("Model.position_slack") => {
        r"Added to every contact's position error."
    };
    ("Model.normal_slack") => {
        r"Added to every contact's normal error; radians."
    };
    ("Model.mends") => {
        r"What was mended when it was read and made, one line each."
    };
    ("Model.size") => {
        r"The largest distance between two of its corners."
    };
    ("Model.closed") => {
        r"Whether its faces bound a region, so that inside and outside are known."
    };
    ("Contact") => {
        r"The tip of a probe rests on the part (2.2).

The tip is a disc of `tip_radius` whose centre is within `position_error` of `center`; a measured surface point
is the case of radius zero. Immutable; equal if all numbers are equal; can be pickled.

A measured surface point.

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
        any number that is not finite."
    };
    ("Contact.from_tip") => {
        r"A contact of a round tip.

Args:
    center: Sensed centre of the tip, shape `(2,)`, world frame.
    tip_radius: Radius of the tip; zero or more.
    position_error: The true centre is within this distance of `center`; zero or more.
    approach: As for a measured point.
    normal: As for a measured point.
    normal_error: As for a measured point.
    start: Where the centre of the tip began its guarded move, shape `(2,)`, world frame.

Raises:
    ValueError: As for a measured point, and a negative radius."
    };
    ("Contact.center") => {
        r"Sensed centre of the tip, shape `(2,)`, world frame."
    };
    ("Contact.tip_radius") => {
        r"Radius of the tip; zero for a measured point."
    };
    ("Contact.position_error") => {
        r"Bound on the distance of the true centre."
    };
    ("Contact.normal") => {
        r"Sensed outward normal, made unit, shape `(2,)`, world frame."
    };
    ("Contact.normal_error") => {
        r"Bound on the angle of the true normal; radians."
    };
    ("Contact.approach") => {
        r"Direction of travel, made unit, shape `(2,)`, world frame."
    };
    ("Contact.start") => {
        r"Where the guarded move began, shape `(2,)`, world frame."
    };
    ("Miss") => {
        r"A guarded move that touched nothing: the tip swept from `start` to `end` freely.

Immutable; equal if all numbers are equal; can be pickled.

A free sweep.

Args:
    start: Where the centre of the tip began, shape `(2,)`, world frame.
    end: Where it ended, shape `(2,)`, world frame.
    tip_radius: Radius of the tip; zero or more.
    path_error: How far the tip may have left its line; zero or more.

Raises:
    ValueError: Another shape, a negative bound, any number that is not finite."
    };
    ("Miss.start") => {
        r"Where the centre of the tip began, shape `(2,)`, world frame."
    };
    ("Miss.end") => {
        r"Where it ended, shape `(2,)`, world frame."
    };
    ("Miss.tip_radius") => {
        r"Radius of the tip."
    };
    ("Miss.path_error") => {
        r"How far the tip may have left its line."
    };
    ("Prior") => {
        r"What is known of the pose beforehand: a box of translations and a range of rotations.

Immutable; equal if all numbers are equal; can be pickled.

Poses around a middle one.

Args:
    world_from_model: The middle of the range, a rigid motion, shape `(3, 3)`.
    translation: Each component of the translation is within this of the middle's; zero or more.
    rotation: The rotation is within this angle of the middle's; radians, zero to π (free).

Raises:
    ValueError: Another shape, a matrix that is no rigid motion, a bound that is negative or not finite."
    };
    ("Prior.world_from_model") => {
        r"The middle of the range, shape `(3, 3)`."
    };
    ("Prior.translation") => {
        r"Bound on each component of the translation."
    };
    ("Prior.rotation") => {
        r"Bound on the rotation; radians."
    };
    ("recognize") => {
        r"Every model and pose that explains all contacts, keeps clear of all misses, and agrees with the prior (chapter 2).

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
        normal contradicts its approach, a number out of range."
    };
    ("Recognition") => {
        r"The answer: every hypothesis, or, if there is none, contacts that can't hold together."
    };
    ("Recognition.hypotheses") => {
        r"In the order of the models."
    };
    ("Recognition.interpretations") => {
        r"Those of all hypotheses, found as they are asked for."
    };
    ("Recognition.interpretation_count") => {
        r"How many there are; at least, where `interpretation_count_exact` is false.

Without a prior, one of each that a model's symmetries repeat; with a prior every assignment stands for itself."
    };
    ("Recognition.interpretation_count_exact") => {
        r"Whether `interpretation_count` is all of them."
    };
    ("Recognition.conflict") => {
        r"If there is no hypothesis: numbers of contacts that no model and pose explains together.

The smallest such set up to ten contacts; above, one from which none can be left out. Misses and prior count as
they are. None if there is a hypothesis, or if the search was cut short."
    };
    ("Recognition.complete") => {
        r"Whether every hypothesis is here; if not, there are more than `max_hypotheses` or the search met its limit."
    };
    ("Recognition.counters") => {
        r"What was done for each model (3.5).

`nodes` of the interpretation tree, `pruned_by_distance`, `pruned_by_angle` and `pruned_by_direction` of them,
`feasible` assignments that passed, `pose_boxes` examined where the tree was too large, and `hypotheses` found,
those beyond `max_hypotheses` that are not returned included."
    };
    ("Hypothesis") => {
        r"One answer: interpretations of one model whose poses run into each other, up to the model's symmetry."
    };
    ("Hypothesis.model") => {
        r"The model, the same object that was given."
    };
    ("Hypothesis.model_number") => {
        r"Its place among the models that were given."
    };
    ("Hypothesis.interpretations") => {
        r"Its interpretations, found as they are asked for."
    };
    ("Hypothesis.interpretation_count") => {
        r"How many there are; at least, where `interpretation_count_exact` is false.

Without a prior, one of each that the model's symmetries repeat; with a prior every assignment stands for itself."
    };
    ("Hypothesis.interpretation_count_exact") => {
        r"Whether `interpretation_count` is all of them."
    };
    ("Hypothesis.world_from_model") => {
        r"The pose of largest slack, shape `(3, 3)`: the worst reading uses the smallest share of its bounds."
    };
    ("Hypothesis.poses") => {
        r"All its poses."
    };
    ("Hypothesis.marginal") => {
        r"Whether it is kept only thanks to the tolerance."
    };
    ("Interpretation") => {
        r"A model with one feature for each contact, which at least one pose satisfies (2.2)."
    };
    ("Interpretation.model") => {
        r"The model, the same object that was given."
    };
    ("Interpretation.model_number") => {
        r"Its place among the models that were given."
    };
    ("Interpretation.assignment") => {
        r"Kind and number of the feature that each contact lies on, in the order of the contacts."
    };
    ("Interpretation.world_from_model") => {
        r"The pose of largest slack, shape `(3, 3)`."
    };
    ("Interpretation.poses") => {
        r"All poses that satisfy the assignment."
    };
    ("Interpretation.marginal") => {
        r"Whether it is kept only thanks to the tolerance."
    };
    ("Interpretations") => {
        r"A lazy sequence of interpretations. Iterating finds them one by one; `[k]` finds all before it as well.

`len()` is their count; where the count is not exact, it is a lower bound, and iterating goes on beyond."
    };
    ("PoseSet") => {
        r"All poses of a hypothesis or of an interpretation: a guaranteed enclosure with inner witnesses (2.4).

Poses are `world_from_model`, homogeneous matrices of shape `(3, 3)`."
    };
    ("PoseSet.contains") => {
        r"Whether the pose explains every contact and miss, up to the tolerance: the exact predicate.

Of a hypothesis, up to the model's symmetry.

Raises:
    ValueError: Another shape than `(3, 3)`, or no rigid motion."
    };
    ("PoseSet.sample") => {
        r"`n` valid poses, spread over the set, shape `(n, 3, 3)`; the same for the same seed.

Raises:
    ValueError: `n` or `seed` is negative or not whole, or `n` is above ten million."
    };
    ("PoseSet.rotation_bound") => {
        r"No two poses of the set differ by more; radians, at most π."
    };
    ("PoseSet.excursion") => {
        r"No two poses of the set move this point, shape `(2,)`, model frame, further apart.

Raises:
    ValueError: Another shape, or a number that is not finite."
    };
    ("PoseSet.outline") => {
        r"A convex polygon that holds every place of this point, shape `(2,)`, model frame, under the poses of the set.

Returns:
    Corners, counter-clockwise, shape `(k, 2)`, world frame.

Raises:
    ValueError: Another shape, or a number that is not finite."
    };
    ("PoseSet.witness") => {
        r"A pose of the set, shape `(3, 3)`: the proof that it is not empty."
    };
    ("PoseSet.marginal") => {
        r"Whether every witness needs the tolerance."
    };
    ("PoseSet.thesis_pose") => {
        r"The thesis's own pose and bounds of the first assignment (2.2.3, 2.4).

None where they are not defined: a contact on a vertex or without a normal, or all faces parallel."
    };
    ("ThesisPose") => {
        r"The thesis's nominal pose of an interpretation and its bounds (2.2.3, 2.4), corrected by MATH errata 37-43.

They describe one pose, not the set of all poses; `PoseSet` does that. `docs/accuracy.md` compares the two."
    };
    ("ThesisPose.world_from_model") => {
        r"The nominal pose: `rotation` and `translation`, shape `(3, 3)`."
    };
    ("ThesisPose.first_rotation") => {
        r"θ, which takes the first face's normal to its sensed one; radians (2.4)."
    };
    ("ThesisPose.rotation") => {
        r"φ, the middle of the rotations that all normals leave; radians (eq. 2.2)."
    };
    ("ThesisPose.residual_rotation") => {
        r"γ, the width of the rotations that all normals leave; radians (2.4.1)."
    };
    ("ThesisPose.translation") => {
        r"The nominal translation at φ, shape `(2,)`, world frame (eq. 2.1)."
    };
    ("ThesisPose.translation_error") => {
        r"`E_T`, the half diagonal of the rhombus of translations of the best pair of faces (2.4.2)."
    };
    ("ThesisPose.translation_region") => {
        r"Translations at φ that keep each contact within its bound of its face's line, shape `(k, 2)` (figure 2.6)."
    };
    ("ThesisPose.excursion") => {
        r"`E_q`, how far the point, shape `(2,)`, model frame, moves between the two extreme nominal poses (eq. 2.3).

A chord, not a bound.

Raises:
    ValueError: Another shape, or a number that is not finite."
    };
}
