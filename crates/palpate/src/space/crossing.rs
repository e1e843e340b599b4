//! Closed surfaces that cross themselves.
//!
//! **Bodies that overlap.** Where all goes around the right way, the surface of what is inside is made of what the faces leave
//! of one another: each of its points is on a face, with the face's normal, and where they cross it is reflex, so that no tip rests
//! there. Nothing true is lost. Parts of faces that are inside count as touchable, and distances from inside are no more than
//! they are.
//!
//! **Surfaces turned inside out.** A point that is gone around the wrong way is neither inside nor outside. If there is one that is
//! further from all faces than slacks explain, it is not known what the part is, and it is refused. Points are tried beside
//! each crossing, in the four wedges between the faces: a region that is nowhere near a crossing is not found.

use glam::DVec3;

use super::distance::{on_segment, orient};
use super::model::{Face, Model};
use super::scale::at;
use crate::Error;
use crate::part::Mend;

/// Crossings beside which points are tried, at most; of more, some that are spread evenly.
const MOST_TRIED: usize = 200;

/// Points beside a crossing are this share of the size away, at most.
const FARTHEST: f64 = 0.25;

/// Where an edge passes through a face.
struct Crossing {
    edge: usize,
    face: u32,
    place: DVec3,
}

/// Says where a closed model crosses itself by more than `tol`; refuses it if it is turned inside out there.
pub(super) fn check(model: &Model, tol: f64) -> Result<Option<Mend>, Error> {
    if !model.closed {
        return Ok(None);
    }
    let crossings: Vec<Crossing> =
        (0..model.edges.len()).flat_map(|edge| of_edge(model, edge, tol)).collect();
    let Some(first) = crossings.first() else { return Ok(None) };
    let mut tried = crossings.iter().step_by(crossings.len().div_ceil(MOST_TRIED));
    let granted = model.position_slack.max(tol);
    if let Some(place) = tried.find_map(|crossing| wrong_way(model, crossing, granted)) {
        let problem = "cross one another and are turned inside out there: it is not known what is inside";
        let remedy = "mend the mesh, or say with position_slack= by how much it may be off";
        return Err(Error::new("faces", problem, format!("near {}", at(place)), remedy));
    }
    let text = format!(
        "faces: {} place(s) where an edge passes through a face, the first at {}: inside is what the surface goes around, and \
         faces that are inside count as touchable",
        crossings.len(),
        at(first.place)
    );
    Ok(Some(Mend(text)))
}

/// The faces through which an edge passes, each of them and the rim passed by more than `tol`.
fn of_edge(model: &Model, edge: usize, tol: f64) -> Vec<Crossing> {
    let [from, to] = model.edges[edge].ends.map(|k| model.vertices[k as usize].point);
    let mut found: Vec<Crossing> = Vec::new();
    model.along_segment(from, to, |&[a, b, c], face| {
        let (above, below) = (orient(a, b, c, from), orient(a, b, c, to));
        let around = [orient(from, to, a, b), orient(from, to, b, c), orient(from, to, c, a)];
        let is_beside = above > 0.0 && below > 0.0
            || above < 0.0 && below < 0.0
            || around.iter().any(|&side| side > 0.0) && around.iter().any(|&side| side < 0.0);
        if is_beside || found.iter().any(|known| known.face == face) {
            return true;
        }
        let of_face = &model.faces[face as usize];
        let [start, end] = [from, to].map(|point| of_face.normal.dot(point) - of_face.offset);
        let place = from + start / (start - end) * (to - from);
        if start * end < 0.0 && start.abs().min(end.abs()) > tol && rim_distance(model, of_face, place) > tol
        {
            found.push(Crossing { edge, face, place });
        }
        true
    });
    found.sort_by_key(|crossing| crossing.face);
    found
}

/// The distance from a point to where a face ends.
fn rim_distance(model: &Model, face: &Face, point: DVec3) -> f64 {
    let at = |k: u32| model.vertices[k as usize].point;
    let sides = face.loops.iter().flat_map(|k| k.iter().zip(k.iter().cycle().skip(1)));
    let distances = sides.map(|(&a, &b)| point.distance(on_segment(point, at(a), at(b))));
    distances.fold(f64::INFINITY, f64::min)
}

/// A point beside a crossing that is gone around the wrong way, and further than `granted` from all faces.
fn wrong_way(model: &Model, crossing: &Crossing, granted: f64) -> Option<DVec3> {
    let across = model.faces[crossing.face as usize].normal;
    let normals = model.edges[crossing.edge].faces.into_iter().flatten();
    let out = normals.map(|face| model.faces[face as usize].normal).sum::<DVec3>().try_normalize()?;
    let mut step = 2.0 * granted;
    while step <= FARTHEST * model.size {
        let wedges = [across + out, across - out, out - across, -across - out];
        let mut places = wedges.into_iter().map(|wedge| crossing.place + step * wedge);
        let wrong = |place: &DVec3| model.winding(*place) < 0 && model.nearest(*place).distance > granted;
        if let Some(place) = places.find(wrong) {
            return Some(place);
        }
        step *= 2.0;
    }
    None
}
