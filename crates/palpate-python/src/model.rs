//! Models.

use palpate::{Error, Mend, Surface};
use std::hash::{DefaultHasher, Hash, Hasher};
use std::sync::Arc;

use glam::{DVec2, DVec3};
use numpy::{PyArray1, PyArray2, PyArray3, PyArrayMethods};
use palpate::space::{self, Roundness};
use palpate::{Line, plane};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::PyType;

use crate::convert::{
    self, damaged, flat, members, number, raise, restore, restored, text, vector, vectors, vectors_array,
    whole,
};
use crate::dimension::{AnyModel, In, Vector};
use crate::first_contact::{Met, PyFirstContact};

type Any<'py> = Bound<'py, PyAny>;
type Array1<'py> = Bound<'py, PyArray1<f64>>;
type Array2<'py> = Bound<'py, PyArray2<f64>>;

#[doc = doc!("Model")]
#[pyclass(name = "Model", module = "palpate._core", frozen)]
pub(crate) struct PyModel {
    pub(crate) model: AnyModel,
    recipe: Recipe,
}

/// What a model was made from. Pickles keep this: making it again gives the same model, numbers and mends included.
#[derive(Clone)]
struct Recipe {
    shape: Shape,
    name: String,
    untouchable: Vec<usize>,
    position_slack: f64,
    normal_slack: f64,
    /// Mended by whoever read the file, before the core saw the shape.
    mends: Vec<String>,
}

#[derive(Clone)]
enum Shape {
    Polygon { vertices: Vec<DVec2>, holes: Vec<Vec<DVec2>> },
    Segments { segments: Vec<[DVec2; 2]>, seams: Vec<usize> },
    Mesh { vertices: Vec<DVec3>, triangles: Vec<[u32; 3]> },
    Facets { loops: Vec<Vec<Vec<DVec3>>>, seams: Vec<usize> },
}

/// The arguments that all constructors of a model share.
struct Options<'a, 'py> {
    name: Option<&'a Any<'py>>,
    untouchable: Option<&'a Any<'py>>,
    position_slack: Option<&'a Any<'py>>,
    normal_slack: Option<&'a Any<'py>>,
    mends: Option<&'a Any<'py>>,
}

impl Options<'_, '_> {
    fn model(&self, py: Python<'_>, shape: Shape) -> PyResult<PyModel> {
        Recipe {
            shape,
            name: self.name.map_or_else(|| Ok("part".to_owned()), |name| text("name", name))?,
            untouchable: numbers("untouchable", self.untouchable)?,
            position_slack: self.position_slack.map_or(Ok(0.0), |slack| number("position_slack", slack))?,
            normal_slack: self.normal_slack.map_or(Ok(0.0), |slack| number("normal_slack", slack))?,
            mends: self.mends.map_or(Ok(Vec::new()), texts)?,
        }
        .model(py)
    }
}

impl Recipe {
    fn model(self, py: Python<'_>) -> PyResult<PyModel> {
        let model = py.detach(|| self.made()).map_err(raise)?;
        Ok(PyModel { model, recipe: self })
    }

    fn made(&self) -> Result<AnyModel, Error> {
        let Self { name, untouchable, position_slack, normal_slack, .. } = self;
        let slacks = (*position_slack, *normal_slack);
        let mut model = match &self.shape {
            Shape::Polygon { vertices, holes } => {
                In::Plane(plane::Model::polygon(name, vertices, holes, untouchable, slacks.0, slacks.1)?)
            }
            Shape::Segments { segments, seams } => {
                In::Plane(plane::Model::segments(name, segments, seams, untouchable, slacks.0, slacks.1)?)
            }
            Shape::Mesh { vertices, triangles } => {
                In::Space(space::Model::mesh(name, vertices, triangles, untouchable, slacks.0, slacks.1)?)
            }
            Shape::Facets { loops, seams } => {
                In::Space(space::Model::facets(name, loops, seams, untouchable, slacks.0, slacks.1)?)
            }
        };
        let before = self.mends.iter().cloned().map(Mend);
        either!(&mut model, model => drop(model.mends.splice(0..0, before)));
        Ok(likewise!(model, model => Arc::new(model)))
    }
}

/// Numbers of faces as given; none if left out.
fn numbers(argument: &str, value: Option<&Any<'_>>) -> PyResult<Vec<usize>> {
    let Some(value) = value else { return Ok(Vec::new()) };
    let members = members(argument, value, "face numbers", "give a list of int")?;
    let number = |(k, member)| whole(&format!("{argument}[{k}]"), member, 0).map(|number| number as usize);
    members.iter().enumerate().map(number).collect()
}

/// Notes on what was mended.
fn texts(value: &Any<'_>) -> PyResult<Vec<String>> {
    let members = members("mends", value, "texts", "give a list of str")?;
    members.iter().enumerate().map(|(k, member)| text(&format!("mends[{k}]"), member)).collect()
}

#[pymethods]
impl PyModel {
    #[new]
    #[pyo3(signature = (*_arguments, **_keywords), text_signature = "(*arguments, **keywords)")]
    fn new(_arguments: &Any<'_>, _keywords: Option<&Any<'_>>) -> PyResult<Self> {
        Err(PyTypeError::new_err(
            "make a Model with Model.polygon, segments, mesh or facets, or with load_models",
        ))
    }

    #[doc = doc!("Model.polygon")]
    #[classmethod]
    #[pyo3(
        signature = (vertices, *, name=None, holes=None, untouchable=None, position_slack=None, normal_slack=None, mends=None),
        text_signature = "(vertices, *, name='part', holes=(), untouchable=(), position_slack=0.0, normal_slack=0.0, mends=())"
    )]
    #[expect(clippy::too_many_arguments, reason = "Python's keyword arguments")]
    fn polygon(
        class: &Bound<'_, PyType>,
        vertices: &Any<'_>,
        name: Option<&Any<'_>>,
        holes: Option<&Any<'_>>,
        untouchable: Option<&Any<'_>>,
        position_slack: Option<&Any<'_>>,
        normal_slack: Option<&Any<'_>>,
        mends: Option<&Any<'_>>,
    ) -> PyResult<Self> {
        let vertices = vectors("vertices", vertices)?;
        let holes = holes.map_or(Ok(Vec::new()), |holes| {
            members("holes", holes, "outlines", "give a list of (n, 2) arrays")
        })?;
        let hole = |(k, hole)| vectors(&format!("holes[{k}]"), hole);
        let holes = holes.iter().enumerate().map(hole).collect::<PyResult<_>>()?;
        Options { name, untouchable, position_slack, normal_slack, mends }
            .model(class.py(), Shape::Polygon { vertices, holes })
    }

    #[doc = doc!("Model.segments")]
    #[classmethod]
    #[pyo3(
        signature = (segments, *, name=None, seams=None, untouchable=None, position_slack=None, normal_slack=None, mends=None),
        text_signature = "(segments, *, name='part', seams=(), untouchable=(), position_slack=0.0, normal_slack=0.0, mends=())"
    )]
    #[expect(clippy::too_many_arguments, reason = "Python's keyword arguments")]
    fn segments(
        class: &Bound<'_, PyType>,
        segments: &Any<'_>,
        name: Option<&Any<'_>>,
        seams: Option<&Any<'_>>,
        untouchable: Option<&Any<'_>>,
        position_slack: Option<&Any<'_>>,
        normal_slack: Option<&Any<'_>>,
        mends: Option<&Any<'_>>,
    ) -> PyResult<Self> {
        let shape = Shape::Segments {
            segments: convert::segments("segments", segments)?,
            seams: numbers("seams", seams)?,
        };
        Options { name, untouchable, position_slack, normal_slack, mends }.model(class.py(), shape)
    }

    #[doc = doc!("Model.mesh")]
    #[classmethod]
    #[pyo3(
        signature = (vertices, triangles, *, name=None, untouchable=None, position_slack=None, normal_slack=None, mends=None),
        text_signature = "(vertices, triangles, *, name='part', untouchable=(), position_slack=0.0, normal_slack=0.0, mends=())"
    )]
    #[expect(clippy::too_many_arguments, reason = "Python's keyword arguments")]
    fn mesh(
        class: &Bound<'_, PyType>,
        vertices: &Any<'_>,
        triangles: &Any<'_>,
        name: Option<&Any<'_>>,
        untouchable: Option<&Any<'_>>,
        position_slack: Option<&Any<'_>>,
        normal_slack: Option<&Any<'_>>,
        mends: Option<&Any<'_>>,
    ) -> PyResult<Self> {
        let shape = Shape::Mesh {
            vertices: vectors("vertices", vertices)?,
            triangles: convert::triangles("triangles", triangles)?,
        };
        Options { name, untouchable, position_slack, normal_slack, mends }.model(class.py(), shape)
    }

    /// For readers of files: triangles with their corners welded, what that costs in length and in angle, and what was
    /// mended.
    #[staticmethod]
    #[expect(clippy::type_complexity, reason = "a tuple of Python")]
    fn _sewn<'py>(
        py: Python<'py>,
        vertices: &Any<'py>,
        triangles: &Any<'py>,
    ) -> PyResult<(Array2<'py>, Bound<'py, PyArray2<u32>>, (f64, f64), Vec<String>)> {
        let vertices: Vec<DVec3> = vectors("vertices", vertices)?;
        let triangles = convert::triangles("triangles", triangles)?;
        let sewn = py.detach(|| space::sewn(&vertices, &triangles)).map_err(raise)?;
        let numbers = PyArray1::from_iter(py, sewn.triangles.iter().flatten().copied());
        let numbers = convert::fixed(numbers.reshape([sewn.triangles.len(), 3])?)?;
        let slacks = (sewn.position_slack, sewn.normal_slack);
        let mends = sewn.mends.into_iter().map(|mend| mend.0).collect();
        Ok((vectors_array(py, &sewn.vertices)?, numbers, slacks, mends))
    }

    #[doc = doc!("Model.facets")]
    #[classmethod]
    #[pyo3(
        signature = (loops, *, name=None, seams=None, untouchable=None, position_slack=None, normal_slack=None, mends=None),
        text_signature = "(loops, *, name='part', seams=(), untouchable=(), position_slack=0.0, normal_slack=0.0, mends=())"
    )]
    #[expect(clippy::too_many_arguments, reason = "Python's keyword arguments")]
    fn facets(
        class: &Bound<'_, PyType>,
        loops: &Any<'_>,
        name: Option<&Any<'_>>,
        seams: Option<&Any<'_>>,
        untouchable: Option<&Any<'_>>,
        position_slack: Option<&Any<'_>>,
        normal_slack: Option<&Any<'_>>,
        mends: Option<&Any<'_>>,
    ) -> PyResult<Self> {
        let faces = members("loops", loops, "faces", "give each face by its loop, or by a list of them")?;
        let face = |(k, face)| convert::loops(&format!("loops[{k}]"), face);
        let loops = faces.iter().enumerate().map(face).collect::<PyResult<_>>()?;
        let shape = Shape::Facets { loops, seams: numbers("seams", seams)? };
        Options { name, untouchable, position_slack, normal_slack, mends }.model(class.py(), shape)
    }

    #[doc = doc!("Model.name")]
    #[getter]
    fn name(&self) -> &str {
        either!(&self.model, model => &model.name)
    }

    #[doc = doc!("Model.dimension")]
    #[getter]
    fn dimension(&self) -> usize {
        self.model.dimension()
    }

    #[doc = doc!("Model.faces")]
    #[getter]
    fn faces<'py>(&self, py: Python<'py>) -> PyResult<Vec<Array2<'py>>> {
        match &self.model {
            In::Plane(model) => {
                model.faces.iter().map(|face| vectors_array(py, &[face.start, face.end])).collect()
            }
            In::Space(model) => {
                model.faces.iter().map(|face| corners_array(py, model, &face.loops[0])).collect()
            }
        }
    }

    #[doc = doc!("Model.face_loops")]
    #[getter]
    fn face_loops<'py>(&self, py: Python<'py>) -> PyResult<Vec<Vec<Array2<'py>>>> {
        let In::Space(model) = &self.model else {
            return Ok(self.faces(py)?.into_iter().map(|face| vec![face]).collect());
        };
        let loops = |face: &space::Face| face.loops.iter().map(|one| corners_array(py, model, one)).collect();
        model.faces.iter().map(loops).collect()
    }

    #[doc = doc!("Model.edges")]
    #[getter]
    fn edges<'py>(&self, py: Python<'py>) -> PyResult<Vec<Array2<'py>>> {
        match &self.model {
            In::Plane(_) => Ok(Vec::new()),
            In::Space(model) => model.edges.iter().map(|edge| corners_array(py, model, &edge.ends)).collect(),
        }
    }

    #[doc = doc!("Model.vertices")]
    #[getter]
    fn vertices<'py>(&self, py: Python<'py>) -> PyResult<Array2<'py>> {
        either!(&self.model, model => {
            vectors_array(py, &model.vertices.iter().map(|vertex| vertex.point).collect::<Vec<_>>())
        })
    }

    #[doc = doc!("Model.face_normals")]
    #[getter]
    fn face_normals<'py>(&self, py: Python<'py>) -> PyResult<Array2<'py>> {
        either!(&self.model, model => {
            vectors_array(py, &model.faces.iter().map(|face| face.normal).collect::<Vec<_>>())
        })
    }

    #[doc = doc!("Model.face_surfaces")]
    #[getter]
    fn face_surfaces(&self) -> Vec<&'static str> {
        either!(&self.model, model => model.faces.iter().map(|face| surface_name(face.surface)).collect())
    }

    #[doc = doc!("Model.touchable_edges")]
    #[getter]
    fn touchable_edges<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<bool>>> {
        let touchable = match &self.model {
            In::Plane(_) => Vec::new(),
            In::Space(model) => model.edges.iter().map(|edge| edge.normals.is_some()).collect(),
        };
        convert::fixed(PyArray1::from_vec(py, touchable))
    }

    #[doc = doc!("Model.touchable_vertices")]
    #[getter]
    fn touchable_vertices<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<bool>>> {
        either!(&self.model, model => {
            let touchable = model.vertices.iter().map(|vertex| vertex.normals.is_some());
            convert::fixed(PyArray1::from_iter(py, touchable))
        })
    }

    #[doc = doc!("Model.triangles")]
    #[getter]
    fn triangles<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<u32>>> {
        let corners = self.in_triangles().iter().flat_map(|(corners, _)| *corners);
        convert::fixed(PyArray1::from_iter(py, corners).reshape([self.in_triangles().len(), 3])?)
    }

    #[doc = doc!("Model.triangle_faces")]
    #[getter]
    fn triangle_faces<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<u32>>> {
        convert::fixed(PyArray1::from_iter(py, self.in_triangles().iter().map(|(_, face)| *face)))
    }

    #[doc = doc!("Model.symmetries")]
    #[getter]
    fn symmetries<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray3<f64>>> {
        either!(&self.model, model => {
            let motions: Vec<_> = model.symmetries.iter().map(|symmetry| symmetry.motion).collect();
            convert::poses_array(py, &motions)
        })
    }

    #[doc = doc!("Model.symmetry_axes")]
    #[getter]
    fn symmetry_axes<'py>(&self, py: Python<'py>) -> PyResult<Vec<(Array1<'py>, Array1<'py>)>> {
        let roundness = if let In::Space(model) = &self.model { model.roundness } else { None };
        let axes = match roundness {
            None => Vec::new(),
            Some(Roundness::Axis { point, direction }) => vec![(point, direction)],
            Some(Roundness::Ball { center }) => {
                vec![(center, DVec3::X), (center, DVec3::Y), (center, DVec3::Z)]
            }
        };
        let pair = |(point, direction)| {
            Ok((convert::vector_array(py, point)?, convert::vector_array(py, direction)?))
        };
        axes.into_iter().map(pair).collect()
    }

    #[doc = doc!("Model.position_slack")]
    #[getter]
    fn position_slack(&self) -> f64 {
        either!(&self.model, model => model.position_slack)
    }

    #[doc = doc!("Model.normal_slack")]
    #[getter]
    fn normal_slack(&self) -> f64 {
        either!(&self.model, model => model.normal_slack)
    }

    #[doc = doc!("Model.asymmetry")]
    #[getter]
    fn asymmetry(&self) -> (f64, f64) {
        either!(&self.model, model => model.asymmetry)
    }

    #[doc = doc!("Model.mends")]
    #[getter]
    fn mends(&self) -> Vec<&str> {
        either!(&self.model, model => &model.mends).iter().map(|mend| mend.0.as_str()).collect()
    }

    #[doc = doc!("Model.size")]
    #[getter]
    fn size(&self) -> f64 {
        either!(&self.model, model => model.size)
    }

    #[doc = doc!("Model.closed")]
    #[getter]
    fn closed(&self) -> bool {
        either!(&self.model, model => model.closed)
    }

    #[doc = doc!("Model.first_contact")]
    #[pyo3(signature = (world_from_model, start, direction, tip_radius=None), text_signature = "($self, world_from_model, start, direction, tip_radius=0.0)")]
    fn first_contact(
        &self,
        world_from_model: &Any<'_>,
        start: &Any<'_>,
        direction: &Any<'_>,
        tip_radius: Option<&Any<'_>>,
    ) -> PyResult<Option<PyFirstContact>> {
        let radius = tip_radius.map_or(Ok(0.0), |radius| convert::length("tip_radius", radius))?;
        let found = match &self.model {
            In::Plane(model) => {
                let (pose, line) = placed_line(world_from_model, start, direction)?;
                let found = model.first_contact(pose, &line, radius);
                found.map(|contact| In::Plane(Met { contact, line }))
            }
            In::Space(model) => {
                let (pose, line) = placed_line(world_from_model, start, direction)?;
                let found = model.first_contact(pose, &line, radius);
                found.map(|contact| In::Space(Met { contact, line }))
            }
        };
        Ok(found.map(PyFirstContact))
    }

    #[doc = doc!("Model.distance")]
    fn distance(&self, world_from_model: &Any<'_>, point: &Any<'_>) -> PyResult<f64> {
        match &self.model {
            In::Plane(model) => {
                let pose = convert::pose("world_from_model", world_from_model)?;
                Ok(model.distance(pose, vector("point", point)?))
            }
            In::Space(model) => {
                let pose: space::Pose = convert::pose("world_from_model", world_from_model)?;
                Ok(model.signed_distance(pose.inverse().apply(vector("point", point)?)))
            }
        }
    }

    fn __eq__(&self, other: &Any<'_>) -> bool {
        other.cast::<Self>().is_ok_and(|other| self.model == other.get().model)
    }

    fn __hash__(&self) -> u64 {
        let mut hasher = DefaultHasher::new();
        let num_faces = either!(&self.model, model => model.faces.len());
        (self.name(), num_faces, self.size().to_bits()).hash(&mut hasher);
        hasher.finish()
    }

    fn __repr__(&self) -> String {
        let kind = if self.closed() { "" } else { ", open" };
        let (faces, vertices) = either!(&self.model, model => (model.faces.len(), model.vertices.len()));
        let edges = match &self.model {
            In::Plane(_) => String::new(),
            In::Space(model) => format!(" {} edges,", model.edges.len()),
        };
        let size = convert::decimal(self.size(), convert::decimals(self.size()));
        format!("<Model {:?}: {faces} faces,{edges} {vertices} vertices, size {size}{kind}>", self.name())
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Any<'py>, ModelState)> {
        let Recipe { name, untouchable, position_slack, normal_slack, mends, .. } = self.recipe.clone();
        let (kind, loops, numbers) = self.recipe.shape.state();
        let options = (name, untouchable, position_slack, normal_slack, mends);
        Ok((restore::<Self>(py)?, (kind.to_owned(), loops, numbers, options)))
    }

    /// Undoes `__reduce__`.
    #[classmethod]
    #[expect(clippy::needless_pass_by_value, reason = "as Python hands it over")]
    fn _restore(
        class: &Bound<'_, PyType>,
        kind: &str,
        loops: Vec<Vec<Vec<f64>>>,
        numbers: Vec<usize>,
        options: OptionsState,
    ) -> PyResult<Self> {
        let shape = Shape::again(kind, &loops, numbers)?;
        let (name, untouchable, position_slack, normal_slack, mends) = options;
        Recipe { shape, name, untouchable, position_slack, normal_slack, mends }.model(class.py())
    }
}

impl PyModel {
    /// Numbers of corners and the face of each triangle.
    fn in_triangles(&self) -> &[([u32; 3], u32)] {
        if let In::Space(model) = &self.model { &model.triangles } else { &[] }
    }
}

/// Where a part is, and a line on which it may be met.
fn placed_line<V: Vector>(
    world_from_model: &Any<'_>,
    start: &Any<'_>,
    direction: &Any<'_>,
) -> PyResult<(V::Pose, Line<V>)> {
    let pose = convert::pose("world_from_model", world_from_model)?;
    Ok((
        pose,
        Line { start: vector("start", start)?, direction: convert::direction("direction", direction)? },
    ))
}

/// The places of numbered corners.
fn corners_array<'py>(py: Python<'py>, model: &space::Model, corners: &[u32]) -> PyResult<Array2<'py>> {
    let points: Vec<DVec3> = corners.iter().map(|corner| model.vertices[*corner as usize].point).collect();
    vectors_array(py, &points)
}

impl Shape {
    /// Its kind, the coordinates of its loops by faces, and seams or triangles.
    fn state(&self) -> (&'static str, Vec<Vec<Vec<f64>>>, Vec<usize>) {
        match self {
            Self::Polygon { vertices, holes } => {
                let loops = std::iter::once(vertices).chain(holes).map(|points| flat(points)).collect();
                ("polygon", vec![loops], Vec::new())
            }
            Self::Segments { segments, seams } => {
                let face = |ends: &[DVec2; 2]| vec![flat(ends)];
                ("segments", segments.iter().map(face).collect(), seams.clone())
            }
            Self::Mesh { vertices, triangles } => {
                let numbers = triangles.as_flattened().iter().map(|number| *number as usize);
                ("mesh", vec![vec![flat(vertices)]], numbers.collect())
            }
            Self::Facets { loops, seams } => {
                let face = |face: &Vec<Vec<DVec3>>| face.iter().map(|points| flat(points)).collect();
                ("facets", loops.iter().map(face).collect(), seams.clone())
            }
        }
    }

    /// Undoes `state`.
    fn again(kind: &str, loops: &[Vec<Vec<f64>>], numbers: Vec<usize>) -> PyResult<Self> {
        match (kind, loops) {
            ("polygon", [face]) => {
                let mut loops = face.iter().map(|flat| points(flat)).collect::<PyResult<Vec<_>>>()?;
                let holes = loops.split_off(1.min(loops.len()));
                Ok(Self::Polygon { vertices: loops.pop().unwrap_or_default(), holes })
            }
            ("segments", faces) => {
                let ends = |face: &Vec<Vec<f64>>| {
                    let ends = face.first().map_or(Ok(Vec::new()), |flat| points(flat))?;
                    <[DVec2; 2]>::try_from(ends).map_err(|_| damaged())
                };
                Ok(Self::Segments {
                    segments: faces.iter().map(ends).collect::<PyResult<_>>()?,
                    seams: numbers,
                })
            }
            ("mesh", [face]) => {
                let triangle = |corners: &[usize]| std::array::from_fn(|k| corners[k] as u32);
                let vertices = face.first().map_or(Ok(Vec::new()), |flat| points(flat))?;
                Ok(Self::Mesh { vertices, triangles: numbers.chunks_exact(3).map(triangle).collect() })
            }
            ("facets", faces) => {
                let face = |face: &Vec<Vec<f64>>| face.iter().map(|flat| points(flat)).collect();
                Ok(Self::Facets { loops: faces.iter().map(face).collect::<PyResult<_>>()?, seams: numbers })
            }
            _ => Err(damaged()),
        }
    }
}

/// Points from the numbers of a pickle.
fn points<V: Vector>(flat: &[f64]) -> PyResult<Vec<V>> {
    flat.chunks(V::DIMENSION).map(restored).collect()
}

/// Kind, loops by faces, seams or triangles, and the rest of the recipe.
type ModelState = (String, Vec<Vec<Vec<f64>>>, Vec<usize>, OptionsState);

/// Name, untouchable, position slack, normal slack, mends.
type OptionsState = (String, Vec<usize>, f64, f64, Vec<String>);

/// What a face is to a probe, as Python says it.
fn surface_name(surface: Surface) -> &'static str {
    match surface {
        Surface::Touchable => "touchable",
        Surface::Untouchable => "untouchable",
        Surface::Seam => "seam",
    }
}
