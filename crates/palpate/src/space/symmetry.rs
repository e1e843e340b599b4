//! The rigid motions that map a solid model onto itself.
//!
//! Each of them keeps the mean of the vertices. It is nearly known from where it takes one flag, a side of a face's loop:
//! the face's normal and the side's direction are a frame. So there are no more of them than flags that look alike; each is
//! tried, and must take every vertex, edge and face onto one of its kind. What it takes where is what makes it a symmetry; its
//! motion is the one that fits that best.
//!
//! **A group.** Recognition takes of all assignments that symmetries take into each other the least, which is well defined only
//! if they are a group. Corners are known to a precision, and what two motions do within it, one after the other, may miss by
//! more. So where features go is what is multiplied, exactly, until nothing new comes; a symmetry is taken only if
//! all that comes with it misses by little enough. What they miss by at most is a slack ([`Symmetries::miss`]).
//!
//! Turns about one axis and half turns across it are as many as the part has sides; beyond [`MOST`] a subgroup stays,
//! the turns by a larger angle that divides the full one. What is lost then is that some poses are not known to be the
//! same; none is taken to be the same wrongly.

use std::collections::{BTreeMap, HashMap};
use std::f64::consts::TAU;

use glam::{DMat3, DVec3};

use super::Pose;
use super::model::{Edge, Face, Symmetry, Vertex};
use super::motions::{Miss, fitted, miss, turn};
use super::regions::TURN_TOL;
use super::spherical::angle;
use super::weld::between;
use crate::part::Surface;

/// The share of the shortest edge by which a corner may be off: it keeps its neighbours apart.
const SHARE: f64 = 0.1;

/// What follows from symmetries may miss by this many times as much as they may.
const PRODUCT: f64 = 2.0;

/// Lengths and areas of flags that look alike agree to this share of the size at least.
const ALIKE: f64 = 1e-6;

/// Motions, at most.
pub(super) const MOST: usize = 1000;

/// Faces, edges and vertices.
#[derive(Clone, Copy)]
pub(super) struct Parts<'a> {
    pub(super) faces: &'a [Face],
    pub(super) edges: &'a [Edge],
    pub(super) vertices: &'a [Vertex],
    pub(super) size: f64,
    /// How well its corners are known: how far a mapped corner may be from its image.
    pub(super) precision: f64,
}

/// A group.
pub(super) struct Symmetries {
    /// All of them, the identity first.
    pub(super) group: Vec<Symmetry>,
    /// By how much they miss, at most. What holds for a pose holds for its images with bounds enlarged by it.
    pub(super) miss: Miss,
}

/// All of them, the identity first, then by where they take the flag. A seam is not there: it has no say, and keeps its
/// number.
pub(super) fn symmetries(parts: Parts) -> Symmetries {
    let mut search = Search::new(parts);
    let base = search.rarest();
    search.prepare(base);
    let flags = search.alike(base);
    let mut group = vec![search.identity()];
    let mut generators: Vec<Symmetry> = Vec::new();
    let mut miss = Miss::default();
    for &flag in &flags {
        let name = search.name(flag);
        if group.iter().any(|symmetry| image(symmetry, search.name(base)) == name) {
            continue;
        }
        let Some(generator) = search.symmetry(search.motion(base, flag)) else { continue };
        generators.push(generator);
        match search.closure(&group, &generators, search.name(base)) {
            Some((larger, worst)) => (group, miss) = (larger, miss.or(worst)),
            None => drop(generators.pop()),
        }
    }
    let places: HashMap<Name, usize> =
        flags.iter().enumerate().map(|(k, flag)| (search.name(*flag), k)).collect();
    group[1..].sort_by_key(|symmetry| {
        let name = image(symmetry, search.name(base));
        (places.get(&name).copied().unwrap_or(usize::MAX), name)
    });
    let group = if group.len() > MOST { subgroup(&group) } else { group };
    Symmetries { group, miss }
}

/// Where a flag's name goes.
fn image(symmetry: &Symmetry, [face, start, end]: Name) -> Name {
    let of_vertex = |k: u32| symmetry.vertices[k as usize];
    [symmetry.faces[face as usize], of_vertex(start), of_vertex(end)]
}

/// A side of a face's loop: face, loop, place.
type Flag = (usize, usize, usize);

/// The same by its face and the vertices of its side.
type Name = [u32; 3];

struct Search<'a> {
    parts: Parts<'a>,
    /// Mean of the vertices that are there.
    center: DVec3,
    /// Whether each vertex belongs to more than seams.
    is_there: Vec<bool>,
    /// How far a mapped corner may be from its image.
    tol: f64,
    /// How far it may be from it before the motion is fitted.
    reach: f64,
    /// Vertices by where they are, in cubes far wider than the tolerance.
    cells: HashMap<[i64; 3], Vec<u32>>,
    /// Faces that a directed side belongs to.
    of_side: HashMap<[u32; 2], Vec<u32>>,
    /// Edges between two vertices, the lower number first.
    of_ends: HashMap<[u32; 2], Vec<u32>>,
}

impl<'a> Search<'a> {
    fn new(parts: Parts<'a>) -> Self {
        // A corner that a face has swallowed is there if it can be touched.
        let mut is_there: Vec<bool> = parts.vertices.iter().map(|vertex| vertex.normals.is_some()).collect();
        let mut of_side: HashMap<[u32; 2], Vec<u32>> = HashMap::new();
        let mut shortest = f64::INFINITY;
        for (number, face) in (0..).zip(parts.faces).filter(|(_, face)| face.surface != Surface::Seam) {
            for outline in &face.loops {
                for (&a, &b) in outline.iter().zip(outline.iter().cycle().skip(1)) {
                    is_there[a as usize] = true;
                    of_side.entry([a, b]).or_default().push(number);
                    let [a, b] = [a, b].map(|k| parts.vertices[k as usize].point);
                    shortest = shortest.min(a.distance(b));
                }
            }
        }
        let mut of_ends: HashMap<[u32; 2], Vec<u32>> = HashMap::new();
        for (number, edge) in (0..).zip(parts.edges) {
            let [a, b] = edge.ends;
            of_ends.entry([a.min(b), a.max(b)]).or_default().push(number);
        }
        let origin = parts.vertices[0].point;
        let there = (0..parts.vertices.len()).filter(|&k| is_there[k]);
        let offsets = there.clone().map(|k| parts.vertices[k].point - origin);
        let center = origin + offsets.sum::<DVec3>() / there.clone().count().max(1) as f64;
        let tol = parts.precision.min(SHARE * shortest);
        Self { parts, center, is_there, tol, reach: tol, cells: HashMap::new(), of_side, of_ends }
    }

    /// Sorts the vertices into cells, once it is known which flag motions are to be told from: by how much a corner
    /// may be off then follows from how well its frame is known.
    fn prepare(&mut self, base: Flag) {
        let [a, b] = self.side(base);
        let reach = (0..self.parts.vertices.len()).filter(|&k| self.is_there[k]);
        let reach = reach.map(|k| self.parts.vertices[k].point.distance(self.center)).fold(0.0, f64::max);
        let turn = 2.0 * (2.0 * self.tol / a.distance(b) + self.turn(base.0));
        self.reach = 2.0 * self.tol + turn * reach;
        for k in (0..self.parts.vertices.len()).filter(|&k| self.is_there[k]) {
            let cell = self.cell(self.parts.vertices[k].point);
            self.cells.entry(cell).or_default().push(k as u32);
        }
    }

    fn turn(&self, face: usize) -> f64 {
        turn(&self.parts.faces[face], self.parts.vertices, self.tol)
    }

    fn cell(&self, point: DVec3) -> [i64; 3] {
        let width = (64.0 * self.tol).max(2.0 * self.reach);
        ((point - self.center) / width).floor().to_array().map(|x| x as i64)
    }

    /// The motion that takes one flag to another.
    fn motion(&self, from: Flag, to: Flag) -> DMat3 {
        self.frame(to) * self.frame(from).transpose()
    }

    fn placed(&self, rotation: DMat3) -> Pose {
        Pose { rotation, translation: self.center - rotation * self.center }
    }

    /// The rotation that fits best where vertices go.
    fn fitted(&self, near: DMat3, of_vertex: &[u32]) -> DMat3 {
        let from_center = |k: usize| self.parts.vertices[k].point - self.center;
        let there = (0..of_vertex.len()).filter(|&k| self.is_there[k]);
        let pairs: Vec<(DVec3, DVec3)> =
            there.map(|k| (from_center(k), from_center(of_vertex[k] as usize))).collect();
        fitted(&pairs, near)
    }

    fn identity(&self) -> Symmetry {
        let numbers = |count: usize| (0..count as u32).collect();
        let Parts { faces, edges, vertices, .. } = self.parts;
        Symmetry {
            motion: Pose::IDENTITY,
            faces: numbers(faces.len()),
            edges: numbers(edges.len()),
            vertices: numbers(vertices.len()),
        }
    }

    /// The ends of a flag's side.
    fn side(&self, (face, outline, place): Flag) -> [DVec3; 2] {
        let outline = &self.parts.faces[face].loops[outline];
        [outline[place], outline[(place + 1) % outline.len()]].map(|k| self.parts.vertices[k as usize].point)
    }

    fn name(&self, (face, outline, place): Flag) -> Name {
        let outline = &self.parts.faces[face].loops[outline];
        [face as u32, outline[place], outline[(place + 1) % outline.len()]]
    }

    fn frame(&self, flag: Flag) -> DMat3 {
        let normal = self.parts.faces[flag.0].normal;
        let [a, b] = self.side(flag);
        let along = (b - a).reject_from_normalized(normal).normalize_or_zero();
        DMat3::from_cols(normal, along, normal.cross(along))
    }

    fn flags(&self, face: usize) -> impl Iterator<Item = Flag> + '_ {
        let loops = self.parts.faces[face].loops.iter().enumerate();
        loops.flat_map(move |(k, outline)| (0..outline.len()).map(move |place| (face, k, place)))
    }

    /// What a motion keeps of a face, and how far each may be off.
    fn marks(&self, face: usize) -> [(f64, f64); 5] {
        let Face { normal, offset, loops, surface, .. } = &self.parts.faces[face];
        let sides = self.flags(face).map(|flag| self.side(flag));
        let origin = self.side((face, 0, 0))[0];
        let (mut length, mut area) = (0.0, 0.0);
        for [a, b] in sides {
            length += a.distance(b);
            area += 0.5 * (a - origin).cross(b - origin).dot(*normal);
        }
        let num_sides: usize = loops.iter().map(Vec::len).sum();
        let kind = 2 * num_sides + usize::from(*surface == Surface::Touchable);
        let least = ALIKE * self.parts.size;
        let off = 2.0 * self.tol;
        let height = offset - normal.dot(self.center);
        [
            (kind as f64, 0.0),
            (length, least.max(2.0 * off * num_sides as f64)),
            (area.abs(), length * least.max(off)),
            (height, least.max(off + 2.0 * self.turn(face) * self.parts.size)),
            (loops.len() as f64, 0.0),
        ]
    }

    /// The faces that look alike, of the fewest flags.
    fn rarest_class(&self) -> Vec<usize> {
        let Parts { faces, .. } = self.parts;
        let there: Vec<usize> = (0..faces.len()).filter(|&k| faces[k].surface != Surface::Seam).collect();
        let marks: BTreeMap<usize, [(f64, f64); 5]> = there.iter().map(|&k| (k, self.marks(k))).collect();
        let mut classes = vec![there];
        #[expect(clippy::needless_range_loop, reason = "of each face in turn")]
        for which in 0..5 {
            let split = |mut class: Vec<usize>| {
                let mark = |k: &usize| marks[k][which];
                class.sort_by(|a, b| mark(a).0.total_cmp(&mark(b).0).then(a.cmp(b)));
                let near = |a: &usize, b: &usize| mark(b).0 - mark(a).0 <= mark(a).1.max(mark(b).1);
                class.chunk_by(near).map(<[usize]>::to_vec).collect::<Vec<_>>()
            };
            classes = classes.into_iter().flat_map(split).collect();
        }
        for class in &mut classes {
            class.sort_unstable();
        }
        let num_flags = |class: &Vec<usize>| class.iter().map(|&k| self.flags(k).count()).sum::<usize>();
        classes.into_iter().min_by_key(|class| (num_flags(class), class[0])).unwrap_or_default()
    }

    /// A flag that looks like few others: the longest side of a face.
    fn rarest(&self) -> Flag {
        let class = self.rarest_class();
        let length = |flag: &Flag| {
            let [a, b] = self.side(*flag);
            a.distance(b)
        };
        let longest = self.flags(class[0]).max_by(|a, b| length(a).total_cmp(&length(b)).then(b.cmp(a)));
        longest.unwrap_or((class[0], 0, 0))
    }

    /// The flags that look like one of the rarest class, in order.
    fn alike(&self, base: Flag) -> Vec<Flag> {
        let look = |flag: Flag| {
            let [a, b] = self.side(flag);
            DVec3::new(a.distance(b), a.distance(self.center), b.distance(self.center))
        };
        let wanted = look(base);
        let most = (ALIKE * self.parts.size).max(4.0 * self.tol);
        let near = |flag: &Flag| (look(*flag) - wanted).abs().max_element() <= most;
        let class = self.rarest_class();
        class.into_iter().flat_map(|face| self.flags(face).filter(near).collect::<Vec<_>>()).collect()
    }

    /// Where a rotation about the center takes everything, if one near it maps the model onto itself.
    fn symmetry(&self, near: DMat3) -> Option<Symmetry> {
        let Parts { faces, edges, vertices, .. } = self.parts;
        let nearest = |k: u32, rotation: DMat3, within: f64| {
            if self.is_there[k as usize] {
                self.vertex_image(k, self.placed(rotation), within)
            } else {
                Some(k)
            }
        };
        let count = vertices.len();
        let roughly: Vec<u32> =
            (0..count as u32).map(|k| nearest(k, near, self.reach)).collect::<Option<_>>()?;
        let rotation = self.fitted(near, &roughly);
        let of_vertex = permutation(count, |k| nearest(k, rotation, PRODUCT * self.tol))?;
        let motion = self.placed(self.fitted(rotation, &of_vertex));
        let of_face = permutation(faces.len(), |k| self.face_image(k, motion, &of_vertex))?;
        let of_edge = permutation(edges.len(), |k| self.edge_image(k, &of_vertex, &of_face))?;
        let symmetry = Symmetry { motion, faces: of_face, edges: of_edge, vertices: of_vertex };
        self.fits(&symmetry, self.tol).map(|_| symmetry)
    }

    /// By how much a symmetry misses, if that is no more than `length`, and it turns no normal by more than planes may be turned.
    fn fits(&self, symmetry: &Symmetry, length: f64) -> Option<Miss> {
        let miss = miss(self.parts.faces, self.parts.vertices, &self.is_there, symmetry);
        (miss.length <= length && miss.turn <= TURN_TOL).then_some(miss)
    }

    /// The group of a smaller one and the last of the generators, and by how much what is new in it misses; `None` if that
    /// is too much.
    fn closure(
        &self,
        group: &[Symmetry],
        generators: &[Symmetry],
        base: Name,
    ) -> Option<(Vec<Symmetry>, Miss)> {
        let mut all = group.to_vec();
        let mut of_name: HashMap<Name, usize> =
            all.iter().enumerate().map(|(k, symmetry)| (image(symmetry, base), k)).collect();
        let (mut next, mut worst) = (0, Miss::default());
        while next < all.len() {
            // Products within the smaller group are in it.
            let first = if next < group.len() { generators.len() - 1 } else { 0 };
            for generator in &generators[first..] {
                let name = image(generator, image(&all[next], base));
                match of_name.get(&name) {
                    Some(&known) if is_product(&all[known], generator, &all[next]) => {}
                    // Two that do the same with one flag, but not with all: corners are too close to one another.
                    Some(_) => return None,
                    None => {
                        let product = self.product(generator, &all[next]);
                        worst = worst.or(self.fits(&product, PRODUCT * self.tol)?);
                        of_name.insert(name, all.len());
                        all.push(product);
                    }
                }
            }
            next += 1;
        }
        Some((all, worst))
    }

    /// What the second and then the first of two symmetries do, by a motion that fits it best.
    fn product(&self, first: &Symmetry, second: &Symmetry) -> Symmetry {
        let through = |first: &[u32], second: &[u32]| -> Vec<u32> {
            second.iter().map(|&k| first[k as usize]).collect()
        };
        let vertices = through(&first.vertices, &second.vertices);
        let rotation = first.motion.rotation * second.motion.rotation;
        Symmetry {
            motion: self.placed(self.fitted(rotation, &vertices)),
            faces: through(&first.faces, &second.faces),
            edges: through(&first.edges, &second.edges),
            vertices,
        }
    }

    fn vertex_image(&self, number: u32, motion: Pose, within: f64) -> Option<u32> {
        let vertex = &self.parts.vertices[number as usize];
        let place = motion.apply(vertex.point);
        let mut nearest: Option<(f64, u32)> = None;
        for cell in between(self.cell(place - within), self.cell(place + within)) {
            for &k in self.cells.get(&cell).into_iter().flatten() {
                let distance = self.parts.vertices[k as usize].point.distance(place);
                if distance <= within && nearest.is_none_or(|best| (distance, k) < best) {
                    nearest = Some((distance, k));
                }
            }
        }
        let (_, image) = nearest?;
        let touchable = |vertex: &Vertex| vertex.normals.is_some();
        (touchable(vertex) == touchable(&self.parts.vertices[image as usize])).then_some(image)
    }

    fn face_image(&self, number: u32, motion: Pose, of_vertex: &[u32]) -> Option<u32> {
        let face = &self.parts.faces[number as usize];
        if face.surface == Surface::Seam {
            return Some(number);
        }
        let normal = motion.rotation * face.normal;
        let [a, b] = [face.loops[0][0], face.loops[0][1]].map(|k| of_vertex[k as usize]);
        let sorted = |face: &Face, image: &dyn Fn(u32) -> u32| {
            let mut corners: Vec<u32> = face.loops.iter().flatten().map(|&k| image(k)).collect();
            corners.sort_unstable();
            corners
        };
        let corners = sorted(face, &|k| of_vertex[k as usize]);
        // That they are joined alike, their edges will show.
        let holds = |image: &&u32| {
            let other = &self.parts.faces[**image as usize];
            other.surface == face.surface
                && angle(other.normal, normal) <= TURN_TOL
                && sorted(other, &|k| k) == corners
        };
        self.of_side.get(&[a, b])?.iter().find(holds).copied()
    }

    fn edge_image(&self, number: u32, of_vertex: &[u32], of_face: &[u32]) -> Option<u32> {
        let edge = &self.parts.edges[number as usize];
        let is_seam = |face: &u32| self.parts.faces[*face as usize].surface == Surface::Seam;
        let there = |edge: &Edge| edge.faces.map(|face| face.filter(|face| !is_seam(face)));
        if there(edge) == [None; 2] {
            return Some(number);
        }
        let sorted = |mut faces: [Option<u32>; 2]| {
            faces.sort_unstable();
            faces
        };
        let wanted = sorted(there(edge).map(|face| face.map(|face| of_face[face as usize])));
        let [a, b] = edge.ends.map(|k| of_vertex[k as usize]);
        let alike = |image: &&u32| {
            let image = &self.parts.edges[**image as usize];
            sorted(there(image)) == wanted && image.normals.is_some() == edge.normals.is_some()
        };
        self.of_ends.get(&[a.min(b), a.max(b)])?.iter().find(alike).copied()
    }
}

/// The images of `0..count`, if there are all and no two are the same.
fn permutation(count: usize, image: impl Fn(u32) -> Option<u32>) -> Option<Vec<u32>> {
    let mut is_taken = vec![false; count];
    let of_each = (0..count as u32).map(|k| {
        let image = image(k)?;
        (!std::mem::replace(&mut is_taken[image as usize], true)).then_some(image)
    });
    of_each.collect()
}

/// Whether a symmetry takes all vertices and faces, and so all edges, where the second and then the first of two others do.
fn is_product(symmetry: &Symmetry, first: &Symmetry, second: &Symmetry) -> bool {
    let through = |all: &[u32], first: &[u32], second: &[u32]| {
        all.iter().zip(second).all(|(&image, &k)| first[k as usize] == image)
    };
    through(&symmetry.vertices, &first.vertices, &second.vertices)
        && through(&symmetry.faces, &first.faces, &second.faces)
}

/// No more than [`MOST`] of a group that is larger, hence one of turns about an axis and maybe of half turns across it.
fn subgroup(group: &[Symmetry]) -> Vec<Symmetry> {
    let least = |a: &&Symmetry, b: &&Symmetry| a.motion.angle().total_cmp(&b.motion.angle());
    let Some(generator) = group[1..].iter().min_by(least) else { return group.to_vec() };
    let axis_of = |motion: &Pose| {
        let m = motion.rotation;
        DVec3::new(m.y_axis.z - m.z_axis.y, m.z_axis.x - m.x_axis.z, m.x_axis.y - m.y_axis.x)
    };
    let Some(axis) = axis_of(&generator.motion).try_normalize() else { return group[..1].to_vec() };
    let least = generator.motion.angle();
    // As it is a group, a remainder of 0 is exact.
    let whole = |angle: f64| (angle / least).round();
    let order = whole(TAU);
    // The turn of a motion about the axis, and whether it keeps the axis' sense.
    let across = axis.any_orthonormal_vector();
    let turn = |symmetry: &Symmetry| {
        let image = symmetry.motion.rotation * across;
        image.dot(axis.cross(across)).atan2(image.dot(across))
    };
    let keeps = |symmetry: &Symmetry| (symmetry.motion.rotation * axis).dot(axis) > 0.0;
    let half_turn = group.iter().find(|symmetry| !keeps(symmetry));
    let most = if half_turn.is_some() { MOST / 2 } else { MOST };
    let kept = (1..=most).rev().find(|&kept| order % kept as f64 == 0.0).unwrap_or(1);
    // Half turns across the axis are kept by how far they are turned from the first of them.
    let from = |symmetry: &Symmetry| if keeps(symmetry) { 0.0 } else { half_turn.map_or(0.0, turn) };
    let is_kept =
        |symmetry: &&Symmetry| whole(turn(symmetry) - from(symmetry)) % (order / kept as f64) == 0.0;
    group.iter().filter(is_kept).cloned().collect()
}
