//! The rigid motions that map a solid model onto itself.
//!
//! Each of them keeps the mean of the vertices. It is known from where it takes one flag, a side of a face's loop: the
//! face's normal and the side's direction are a frame. So there are no more of them than flags that look alike; each is
//! tried and must take every vertex, edge and face onto one of its kind. What is a product of known ones is not searched for,
//! only measured.
//!
//! Turns about one axis and half turns across it are as many as the part has sides; beyond [`MOST`] a subgroup stays,
//! the turns by a larger angle that divides the full one. What is lost then is that some poses are not known to be the
//! same; none is taken to be the same wrongly.

use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::f64::consts::TAU;

use glam::{DMat3, DVec3};

use super::Pose;
use super::model::{Edge, Face, Symmetry, Vertex};
use crate::part::Surface;

/// How far a mapped corner may be from its image, as a share of the model's size: far below τ, as what holds for a pose
/// is taken to hold for its images.
const SYMMETRY_TOL: f64 = 1e-9;

/// The angle by which a mapped normal may be off, radians, and the share of the shortest edge by which a corner may.
const SYMMETRY_TURN: f64 = 1e-7;

/// Lengths and areas of flags that look alike agree to this share of the size.
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
}

/// All of them, the identity first, then by where they take the flag. A seam is not there: it has no say, and keeps its
/// number.
pub(super) fn symmetries(parts: Parts) -> Vec<Symmetry> {
    let search = Search::new(parts);
    let base = search.rarest();
    let frame = search.frame(base);
    let motion = |flag: Flag| {
        let rotation = search.frame(flag) * frame.transpose();
        Pose { rotation, translation: search.center - rotation * search.center }
    };
    let flags = search.alike(base);
    let of_name: HashMap<Name, Flag> = flags.iter().map(|&flag| (search.name(flag), flag)).collect();
    let name = search.name(base);
    let mut found = vec![search.identity()];
    let mut known = BTreeSet::from([name]);
    let mut generators: Vec<Symmetry> = Vec::new();
    for &flag in &flags {
        if known.contains(&search.name(flag)) {
            continue;
        }
        let Some(generator) = search.symmetry(motion(flag)) else { continue };
        generators.push(generator);
        // What follows from those known need not be searched for: products, until there are no new ones.
        let mut next = 0;
        while next < found.len() {
            for generator in &generators {
                let product = image(generator, image(&found[next], name));
                if let Some(&flag) = of_name.get(&product)
                    && known.insert(product)
                {
                    found.extend(search.product(motion(flag), generator, &found[next]));
                }
            }
            next += 1;
        }
    }
    let places: HashMap<Name, usize> =
        flags.iter().enumerate().map(|(k, flag)| (search.name(*flag), k)).collect();
    found[1..].sort_by_key(|symmetry| places.get(&image(symmetry, name)).copied());
    if found.len() > MOST { subgroup(&found) } else { found }
}

/// Where a flag's name goes.
fn image(symmetry: &Symmetry, [face, start, end]: Name) -> Name {
    let of_vertex = |k: u32| symmetry.vertices[k as usize];
    [symmetry.faces[face as usize], of_vertex(start), of_vertex(end)]
}

/// By how much they miss: a corner its image, and the normal of a face, radians. What holds for a pose holds for its
/// images with bounds enlarged by it.
pub(super) fn asymmetry(parts: Parts, symmetries: &[Symmetry]) -> (f64, f64) {
    let (mut miss, mut turn) = (0.0_f64, 0.0_f64);
    for Symmetry { motion, faces, vertices, .. } in symmetries.iter().skip(1) {
        for (vertex, &image) in parts.vertices.iter().zip(vertices) {
            // One that only seams have keeps its number.
            let distance = motion.apply(vertex.point).distance(parts.vertices[image as usize].point);
            miss = miss.max(if distance <= SYMMETRY_TOL * parts.size { distance } else { 0.0 });
        }
        for (face, &image) in parts.faces.iter().zip(faces).filter(|(face, _)| face.surface != Surface::Seam)
        {
            turn = turn.max(angle(motion.rotation * face.normal, parts.faces[image as usize].normal));
        }
    }
    (miss, turn)
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
    tol: f64,
    /// Vertices by where they are, in cubes far wider than the tolerance.
    cells: HashMap<[i64; 3], Vec<u32>>,
    /// Faces that a directed side belongs to.
    of_side: HashMap<[u32; 2], Vec<u32>>,
    /// Edges between two vertices, the lower number first.
    of_ends: HashMap<[u32; 2], Vec<u32>>,
}

impl<'a> Search<'a> {
    fn new(parts: Parts<'a>) -> Self {
        let mut is_there = vec![false; parts.vertices.len()];
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
        let tol = (SYMMETRY_TOL * parts.size).min(SYMMETRY_TURN * shortest);
        let mut search = Self { parts, center, is_there, tol, cells: HashMap::new(), of_side, of_ends };
        for k in (0..parts.vertices.len()).filter(|&k| search.is_there[k]) {
            let cell = search.cell(parts.vertices[k].point);
            search.cells.entry(cell).or_default().push(k as u32);
        }
        search
    }

    fn cell(&self, point: DVec3) -> [i64; 3] {
        ((point - self.center) / (64.0 * self.tol)).floor().to_array().map(|x| x as i64)
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

    /// What a motion keeps of a face.
    fn marks(&self, face: usize) -> [f64; 5] {
        let Face { normal, offset, loops, surface, .. } = &self.parts.faces[face];
        let sides = self.flags(face).map(|flag| self.side(flag));
        let origin = self.side((face, 0, 0))[0];
        let (mut length, mut area) = (0.0, 0.0);
        for [a, b] in sides {
            length += a.distance(b);
            area += 0.5 * (a - origin).cross(b - origin).dot(*normal);
        }
        let num_sides: usize = loops.iter().map(Vec::len).sum();
        let kind = (2 * num_sides + usize::from(*surface == Surface::Touchable)) as f64;
        [kind, length, area.abs().sqrt(), offset - normal.dot(self.center), loops.len() as f64]
    }

    /// The faces that look alike, of the fewest flags.
    fn rarest_class(&self) -> Vec<usize> {
        let Parts { faces, size, .. } = self.parts;
        let there: Vec<usize> = (0..faces.len()).filter(|&k| faces[k].surface != Surface::Seam).collect();
        let marks: BTreeMap<usize, [f64; 5]> = there.iter().map(|&k| (k, self.marks(k))).collect();
        let mut classes = vec![there];
        for (which, tol) in [ALIKE, ALIKE * size, ALIKE * size, ALIKE * size, ALIKE].into_iter().enumerate() {
            let split = |mut class: Vec<usize>| {
                class.sort_by(|a, b| marks[a][which].total_cmp(&marks[b][which]).then(a.cmp(b)));
                let near = |a: &usize, b: &usize| marks[b][which] - marks[a][which] <= tol;
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
        let near = |flag: &Flag| (look(*flag) - wanted).abs().max_element() <= ALIKE * self.parts.size;
        let class = self.rarest_class();
        class.into_iter().flat_map(|face| self.flags(face).filter(near).collect::<Vec<_>>()).collect()
    }

    /// Where a motion takes everything, if it maps the model onto itself.
    fn symmetry(&self, motion: Pose) -> Option<Symmetry> {
        let Parts { faces, edges, vertices, .. } = self.parts;
        let of_vertex = permutation(vertices.len(), |k| {
            if self.is_there[k as usize] { self.vertex_image(k, motion) } else { Some(k) }
        })?;
        let of_face = permutation(faces.len(), |k| self.face_image(k, motion, &of_vertex))?;
        let of_edge = permutation(edges.len(), |k| self.edge_image(k, &of_vertex, &of_face))?;
        Some(Symmetry { motion, faces: of_face, edges: of_edge, vertices: of_vertex })
    }

    /// A motion that does the second and then the first of two symmetries, if it fits as well as they do.
    fn product(&self, motion: Pose, first: &Symmetry, second: &Symmetry) -> Option<Symmetry> {
        let through = |first: &[u32], second: &[u32]| second.iter().map(|&k| first[k as usize]).collect();
        let product = Symmetry {
            motion,
            faces: through(&first.faces, &second.faces),
            edges: through(&first.edges, &second.edges),
            vertices: through(&first.vertices, &second.vertices),
        };
        let Parts { faces, vertices, .. } = self.parts;
        let near = |(k, &image): (usize, &u32)| {
            let image = vertices[image as usize].point;
            !self.is_there[k] || motion.apply(vertices[k].point).distance(image) <= self.tol
        };
        let turned = |(face, &image): (&Face, &u32)| {
            face.surface == Surface::Seam
                || angle(motion.rotation * face.normal, faces[image as usize].normal) <= SYMMETRY_TURN
        };
        let fits =
            product.vertices.iter().enumerate().all(near) && faces.iter().zip(&product.faces).all(turned);
        fits.then_some(product)
    }

    fn vertex_image(&self, number: u32, motion: Pose) -> Option<u32> {
        let vertex = &self.parts.vertices[number as usize];
        let place = motion.apply(vertex.point);
        let (low, high) = (self.cell(place - self.tol), self.cell(place + self.tol));
        let mut nearest: Option<(f64, u32)> = None;
        for x in low[0]..=high[0] {
            for y in low[1]..=high[1] {
                for z in low[2]..=high[2] {
                    for &k in self.cells.get(&[x, y, z]).into_iter().flatten() {
                        let distance = self.parts.vertices[k as usize].point.distance(place);
                        if distance <= self.tol && nearest.is_none_or(|best| (distance, k) < best) {
                            nearest = Some((distance, k));
                        }
                    }
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
                && angle(other.normal, normal) <= SYMMETRY_TURN
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

/// The angle between two unit vectors, radians: accurate at either end.
pub(super) fn angle(a: DVec3, b: DVec3) -> f64 {
    a.cross(b).length().atan2(a.dot(b))
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
    // As it is exact, a remainder of 0 is.
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
