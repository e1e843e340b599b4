//! What lines of a box may meet first of parts at fixed poses, and which readings are surely alike on all of them.

use crate::part::Surface;
use std::f64::consts::PI;

use arrayvec::ArrayVec;
use glam::DVec2;

use super::complete::LineBox;
use crate::plane::model::Face;
use crate::plane::pose::Pose;
use crate::scene::Scene;
use crate::tree::Range;

/// What every line of a box may meet of a view.
#[derive(Debug, Clone, Default)]
pub(crate) enum Known {
    #[default]
    Nothing,
    Missed,
    /// At most these faces, and surely one of them.
    Faces(ArrayVec<u16, MOST_MET>),
}

/// What the views of two members say on every line of a box.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) enum Pair {
    #[default]
    Open,
    /// Not told apart by any line of margin ≥ m.
    Joined,
    /// No view of one can be shown to be like one of the other, on these lines or on some of them.
    Apart,
}

/// A part at one pose, from the middle of the scene, and how far to the left of its line the tip is.
pub(crate) struct View {
    shift: f64,
    closed: bool,
    middle: DVec2,
    radius: f64,
    faces: Vec<ViewFace>,
    /// Corners and their distances from the middle of the scene.
    corners: Vec<(DVec2, f64)>,
}

/// A face, moved out by the tip's radius.
pub(crate) struct ViewFace {
    ends: [DVec2; 2],
    /// The larger of the ends' distances from the middle of the scene.
    reach: f64,
    normal: DVec2,
    touchable: bool,
}

/// What a line of a box may meet first of a view.
#[derive(Debug, Clone, Default)]
#[expect(clippy::large_enum_variant, reason = "one at a time, on the stack: a box for each would cost more")]
pub(crate) enum Glance {
    /// One of these.
    Met(Meetings),
    /// Nothing, on every line.
    Missed,
    /// Nothing is certain.
    #[default]
    Unsure,
}

/// With more faces that may be met nothing is called certain.
const MOST_MET: usize = 4;

/// A face that may be met: its number among those of the view, its normal, and the depths.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Meeting {
    face: u16,
    normal: DVec2,
    /// On any line of the box.
    depth: Range,
    /// On the middle line, were the face as long as that.
    middle: f64,
    /// The least cosine of the incidence on any line of the box.
    cosine: f64,
}

pub(crate) type Meetings = ArrayVec<Meeting, MOST_MET>;

/// A box of lines as views are seen from it.
pub(crate) struct Frame<'a> {
    scene: &'a Scene,
    aside: f64,
    reach: f64,
    half: f64,
    along: DVec2,
    left: DVec2,
    /// How far a point at distance 1 from the middle moves by the half interval of directions; sine of that interval.
    chord: f64,
    sine: f64,
    cosine: f64,
    /// The cosine of the largest incidence at which a line of margin m can be used, seen from the middle line.
    skid_cosine: f64,
    /// Readings whose depths, and normals, differ by no more are alike for lines of margin m.
    alike_depth: f64,
    alike_cosine: f64,
    begins_outside: bool,
}

impl<'a> Frame<'a> {
    pub fn new(scene: &'a Scene, lines: &LineBox) -> Self {
        let along = DVec2::from_angle(lines.angle);
        let angle_margin = scene.margin / scene.size;
        let skid = (scene.sensor.max_incidence - angle_margin).max(0.0) + lines.half;
        let alike = scene.sensor.normal_error.map_or(PI, |error| 2.0 * (error + angle_margin));
        Self {
            scene,
            aside: lines.aside,
            reach: lines.reach,
            half: lines.half,
            begins_outside: scene.begins_outside(),
            along,
            left: along.perp(),
            chord: 2.0 * (0.5 * lines.half).sin(),
            sine: lines.half.sin(),
            cosine: lines.half.cos(),
            skid_cosine: skid.min(PI).cos(),
            alike_depth: 2.0 * (scene.sensor.position_error + scene.margin),
            alike_cosine: if alike >= PI { -2.0 } else { alike.cos() },
        }
    }

    /// Along the middle line, and to the left of where the tip is, if it is so far to the left of that line.
    fn place(&self, at: DVec2, shift: f64) -> (f64, f64) {
        (self.along.dot(at), self.left.dot(at) - self.aside - shift)
    }

    /// How far a point at `reach` from the middle of the scene moves, seen from the lines of the box.
    fn motion(&self, reach: f64) -> f64 {
        self.reach + self.chord * reach
    }

    /// Whether on some line of the box they may be.
    fn may_be_alike(&self, a: &Meeting, b: &Meeting) -> bool {
        a.normal.dot(b.normal) >= self.alike_cosine
            && a.depth.low - b.depth.high <= self.alike_depth
            && b.depth.low - a.depth.high <= self.alike_depth
    }

    /// Whether on every line of the box the readings, which may be the same on some, are so, were each wrong by its bounds and by m.
    ///
    /// Depths of faces that are nearly parallel differ by nearly the same on all lines: with the incidence i and the
    /// depth t, ∂t/∂s = tan i and ∂t/∂φ = s − t tan i up to sign, and tan i − tan j = sin(i − j) / (cos i cos j).
    fn alike(&self, a: &Meeting, b: &Meeting) -> bool {
        if (a.depth.high - b.depth.low).max(b.depth.high - a.depth.low) <= self.alike_depth {
            return true;
        }
        let cosines = a.cosine * b.cosine;
        if a.cosine <= 0.0 || b.cosine <= 0.0 {
            return false;
        }
        let tangents = a.normal.perp_dot(b.normal).abs() / cosines;
        // How far along a line the first may be met, were it long enough, so that t = T bounds its own change as well.
        let tangent = (1.0 - a.cosine * a.cosine).max(0.0).sqrt() / a.cosine;
        if tangent * self.half > 0.5 {
            return false;
        }
        let grown =
            tangent * self.reach + (self.aside.abs() + self.scene.sensor.path_error + self.reach) * self.half;
        let farthest = (a.middle.abs() + grown) / (1.0 - tangent * self.half);
        // The tip may be off its line by the path error, to one side for the one and to the other for the other.
        let turned = self.alike_depth / b.cosine + 2.0 * self.scene.sensor.path_error;
        let change = tangents * (self.reach + farthest * self.half) + turned * self.half;
        (a.middle - b.middle).abs() + change <= self.alike_depth
    }
}

/// What was seen of a hypothesis from its views so far.
pub(crate) struct Look {
    met: Vec<Meetings>,
    missed: bool,
    unsure: bool,
    /// Around the depths of all.
    depths: Range,
}

impl Default for Look {
    fn default() -> Self {
        Self {
            met: Vec::new(),
            missed: false,
            unsure: false,
            depths: Range { low: f64::INFINITY, high: f64::NEG_INFINITY },
        }
    }
}

impl Look {
    pub fn add(&mut self, glance: Glance) {
        match glance {
            Glance::Met(met) => {
                for Meeting { depth, .. } in &met {
                    self.depths.low = self.depths.low.min(depth.low);
                    self.depths.high = self.depths.high.max(depth.high);
                }
                self.met.push(met);
            }
            Glance::Missed => self.missed = true,
            Glance::Unsure => self.unsure = true,
        }
    }

    /// What the views so far and one more say of the two members on every line of the box.
    pub fn pair(&self, glance: &Glance, frame: &Frame<'_>) -> Pair {
        match glance {
            Glance::Unsure => Pair::Open,
            Glance::Missed if self.missed => Pair::Joined,
            Glance::Missed => self.or_open(Pair::Apart),
            Glance::Met(met) => {
                let near = |Meeting { depth, .. }: &Meeting| {
                    depth.low - self.depths.high <= frame.alike_depth
                        && self.depths.low - depth.high <= frame.alike_depth
                };
                if !met.iter().any(near) {
                    return self.or_open(Pair::Apart);
                }
                let mut pair = Pair::Apart;
                for others in &self.met {
                    let mut all = true;
                    for (a, b) in met.iter().flat_map(|a| others.iter().map(move |b| (a, b))) {
                        if frame.may_be_alike(a, b) {
                            pair = Pair::Open;
                            all = all && frame.alike(a, b);
                        } else {
                            all = false;
                        }
                    }
                    if all {
                        return Pair::Joined;
                    }
                }
                self.or_open(pair)
            }
        }
    }

    /// A view of which nothing is certain leaves the pair open.
    fn or_open(&self, pair: Pair) -> Pair {
        if self.unsure { Pair::Open } else { pair }
    }
}

impl View {
    pub fn new(scene: &Scene, member: usize, pose: Pose, shift: f64) -> Self {
        let model = scene.shadows[member].model();
        let radius = scene.sensor.tip_radius;
        let face = |face: &Face| {
            let normal = pose.rotation.rotate(face.normal);
            let ends = [face.start, face.end].map(|end| pose.apply(end) + radius * normal - scene.middle);
            let reach = ends[0].length().max(ends[1].length());
            ViewFace { ends, reach, normal, touchable: face.surface == Surface::Touchable }
        };
        let faces = model.faces.iter().filter(|face| face.surface != Surface::Seam).map(face).collect();
        let corners: Vec<DVec2> =
            model.vertices.iter().map(|vertex| pose.apply(vertex.point) - scene.middle).collect();
        let middle = corners.iter().sum::<DVec2>() / corners.len() as f64;
        let radius = corners.iter().map(|corner| corner.distance(middle)).fold(0.0, f64::max);
        let corners = corners.into_iter().map(|corner| (corner, corner.length())).collect();
        Self { shift, closed: model.closed, middle, radius, faces, corners }
    }

    /// How far a corner is from where another view of the part has it, at most.
    pub fn moved_from(&self, other: &Self) -> f64 {
        let pairs = self.corners.iter().zip(&other.corners);
        pairs.map(|((here, _), (there, _))| here.distance(*there)).fold(0.0, f64::max)
    }

    /// What lines of the box may meet first, if the box around it has shown `known`. A closed part is met at one of the
    /// faces that look toward the line.
    pub fn glance(&self, frame: &Frame<'_>, known: Option<&Known>) -> Glance {
        match known {
            Some(Known::Missed) => return Glance::Missed,
            Some(Known::Faces(faces)) => {
                return self.met(frame, faces.iter().map(|k| usize::from(*k)), true);
            }
            _ => {}
        }
        let radius = frame.scene.sensor.tip_radius;
        let (_, aside) = frame.place(self.middle, self.shift);
        let clear = self.radius + radius + frame.motion(self.middle.length() + self.radius);
        if aside.abs() > clear {
            return Glance::Missed;
        }
        let (mut num_right, mut num_left) = (0, 0);
        for &(corner, reach) in &self.corners {
            let (_, s) = frame.place(corner, self.shift);
            let motion = frame.motion(reach) + radius;
            num_right += usize::from(s < -motion);
            num_left += usize::from(s > motion);
        }
        let count = self.corners.len();
        if num_right == count || num_left == count {
            return Glance::Missed;
        }
        if radius > 0.0 && num_right + num_left < count {
            return Glance::Unsure;
        }
        self.met(frame, 0..self.faces.len(), self.closed && num_right > 0 && num_left > 0)
    }

    /// The faces, of some, that may be met first, if one of them surely is in the way: one that every line crosses, or any,
    /// where the outline is on both sides of every line.
    fn met(&self, frame: &Frame<'_>, faces: impl Iterator<Item = usize>, straddled: bool) -> Glance {
        let (mut nearest_sure, mut farthest) = (f64::INFINITY, f64::NEG_INFINITY);
        let mut met: ArrayVec<Meeting, 12> = ArrayVec::new();
        let mut touchable = true;
        for number in faces {
            let face = &self.faces[number];
            let speed = face.normal.dot(frame.along);
            if speed >= frame.sine {
                continue;
            }
            let [(t0, s0), (t1, s1)] = face.ends.map(|end| frame.place(end, self.shift));
            let motion = frame.motion(face.reach);
            if s0.min(s1) > motion || s0.max(s1) < -motion {
                continue;
            }
            let depth = crossed_at((t0, s0), (t1, s1), motion);
            if speed < -frame.sine && s0.min(s1) < -motion && s0.max(s1) > motion {
                nearest_sure = nearest_sure.min(depth.high);
            }
            farthest = farthest.max(depth.high);
            touchable &= face.touchable;
            let across = face.normal.dot(frame.left);
            let middle = (face.normal.dot(face.ends[0]) - (frame.aside + self.shift) * across) / speed;
            let cosine = -speed * frame.cosine - across.abs() * frame.sine;
            let meeting = Meeting { face: number as u16, normal: face.normal, depth, middle, cosine };
            if met.try_push(meeting).is_err() {
                return Glance::Unsure;
            }
        }
        if nearest_sure == f64::INFINITY && straddled {
            nearest_sure = farthest;
        }
        // Where lines may begin behind a face, nothing is surely met; nothing met along the whole line stays nothing.
        if !nearest_sure.is_finite() || !touchable || !frame.begins_outside {
            return Glance::Unsure;
        }
        let mut nearest = Meetings::new();
        for meeting in met.iter().filter(|meeting| meeting.depth.low <= nearest_sure) {
            if nearest.try_push(*meeting).is_err() {
                return Glance::Unsure;
            }
        }
        Glance::Met(nearest)
    }
}

/// Depths at which lines of a box may cross a face with these ends: none is farther than `motion` from the middle line
/// where it crosses it, and depths differ by as much again.
fn crossed_at((t0, s0): (f64, f64), (t1, s1): (f64, f64), motion: f64) -> Range {
    let ends = Range { low: t0.min(t1) - motion, high: t0.max(t1) + motion };
    if (s1 - s0).abs() <= 2.0 * motion {
        return ends;
    }
    let slope = (t1 - t0) / (s1 - s0);
    let (at, spread) = (t0 - slope * s0, motion * (1.0 + slope.abs()));
    Range { low: (at - spread).max(ends.low), high: (at + spread).min(ends.high) }
}

impl Glance {
    /// Whether whatever is met is met at too large an incidence for a usable line of margin m.
    pub fn skids(&self, frame: &Frame<'_>) -> bool {
        let skids = |meeting: &Meeting| -meeting.normal.dot(frame.along) < frame.skid_cosine;
        matches!(self, Self::Met(met) if met.iter().all(skids))
    }

    /// What it says of every line of a smaller box.
    pub fn known(&self) -> Known {
        match self {
            Self::Met(met) => Known::Faces(met.iter().map(|meeting| meeting.face).collect()),
            Self::Missed => Known::Missed,
            Self::Unsure => Known::Nothing,
        }
    }
}
