//! Models.

use palpate::{Mend, Surface};
use std::hash::{DefaultHasher, Hash, Hasher};
use std::sync::Arc;

use glam::DVec2;
use numpy::{PyArray1, PyArray2, PyArray3};
use palpate::plane::{Line, Model};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::PyType;

use crate::convert::{self, members, number, raise, restore, text, vector, vectors, vectors_array, whole};
use crate::first_contact::PyFirstContact;

type Any<'py> = Bound<'py, PyAny>;
type Pair = (f64, f64);
type Array2<'py> = Bound<'py, PyArray2<f64>>;

#[doc = doc!("Model")]
#[pyclass(name = "Model", module = "palpate._core", frozen)]
pub(crate) struct PyModel {
    pub(crate) model: Arc<Model>,
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
        let made = py.detach(|| {
            let Self { name, untouchable, position_slack, normal_slack, .. } = &self;
            match &self.shape {
                Shape::Polygon { vertices, holes } => {
                    Model::polygon(name, vertices, holes, untouchable, *position_slack, *normal_slack)
                }
                Shape::Segments { segments, seams } => {
                    Model::segments(name, segments, seams, untouchable, *position_slack, *normal_slack)
                }
            }
        });
        let mut model = made.map_err(raise)?;
        model.mends.splice(0..0, self.mends.iter().cloned().map(Mend));
        Ok(PyModel { model: Arc::new(model), recipe: self })
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
        Err(PyTypeError::new_err("make a Model with Model.polygon, Model.segments or load_models"))
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

    #[doc = doc!("Model.name")]
    #[getter]
    fn name(&self) -> &str {
        &self.model.name
    }

    #[doc = doc!("Model.dimension")]
    #[getter]
    #[expect(clippy::unused_self, reason = "parts in space will differ")]
    fn dimension(&self) -> usize {
        2
    }

    #[doc = doc!("Model.faces")]
    #[getter]
    fn faces<'py>(&self, py: Python<'py>) -> PyResult<Vec<Array2<'py>>> {
        self.model.faces.iter().map(|face| vectors_array(py, &[face.start, face.end])).collect()
    }

    #[doc = doc!("Model.edges")]
    #[getter]
    #[expect(clippy::unused_self, reason = "parts in space will differ")]
    fn edges<'py>(&self) -> Vec<Array2<'py>> {
        Vec::new()
    }

    #[doc = doc!("Model.vertices")]
    #[getter]
    fn vertices<'py>(&self, py: Python<'py>) -> PyResult<Array2<'py>> {
        vectors_array(py, &self.model.vertices.iter().map(|vertex| vertex.point).collect::<Vec<_>>())
    }

    #[doc = doc!("Model.face_normals")]
    #[getter]
    fn face_normals<'py>(&self, py: Python<'py>) -> PyResult<Array2<'py>> {
        vectors_array(py, &self.model.faces.iter().map(|face| face.normal).collect::<Vec<_>>())
    }

    #[doc = doc!("Model.face_surfaces")]
    #[getter]
    fn face_surfaces(&self) -> Vec<&'static str> {
        self.model.faces.iter().map(|face| surface_name(face.surface)).collect()
    }

    #[doc = doc!("Model.touchable_vertices")]
    #[getter]
    fn touchable_vertices<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<bool>>> {
        let touchable = self.model.vertices.iter().map(|vertex| vertex.normals.is_some());
        convert::fixed(PyArray1::from_iter(py, touchable))
    }

    #[doc = doc!("Model.symmetries")]
    #[getter]
    fn symmetries<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray3<f64>>> {
        let motions: Vec<_> = self.model.symmetries.iter().map(|symmetry| symmetry.motion).collect();
        convert::poses_array(py, &motions)
    }

    #[doc = doc!("Model.symmetry_axes")]
    #[getter]
    #[expect(clippy::unused_self, reason = "parts in space will differ")]
    fn symmetry_axes<'py>(&self) -> Vec<Array2<'py>> {
        Vec::new()
    }

    #[doc = doc!("Model.position_slack")]
    #[getter]
    fn position_slack(&self) -> f64 {
        self.model.position_slack
    }

    #[doc = doc!("Model.normal_slack")]
    #[getter]
    fn normal_slack(&self) -> f64 {
        self.model.normal_slack
    }

    #[doc = doc!("Model.mends")]
    #[getter]
    fn mends(&self) -> Vec<&str> {
        self.model.mends.iter().map(|mend| mend.0.as_str()).collect()
    }

    #[doc = doc!("Model.size")]
    #[getter]
    fn size(&self) -> f64 {
        self.model.size
    }

    #[doc = doc!("Model.closed")]
    #[getter]
    fn closed(&self) -> bool {
        self.model.closed
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
        let pose = convert::pose("world_from_model", world_from_model)?;
        let line =
            Line { start: vector("start", start)?, direction: convert::direction("direction", direction)? };
        let radius = tip_radius.map_or(Ok(0.0), |radius| convert::length("tip_radius", radius))?;
        let found = self.model.first_contact(pose, &line, radius);
        Ok(found.map(|contact| PyFirstContact { contact, line }))
    }

    #[doc = doc!("Model.distance")]
    fn distance(&self, world_from_model: &Any<'_>, point: &Any<'_>) -> PyResult<f64> {
        let pose = convert::pose("world_from_model", world_from_model)?;
        Ok(self.model.distance(pose, vector("point", point)?))
    }

    fn __eq__(&self, other: &Any<'_>) -> bool {
        other.cast::<Self>().is_ok_and(|other| self.model == other.get().model)
    }

    fn __hash__(&self) -> u64 {
        let mut hasher = DefaultHasher::new();
        (&self.model.name, self.model.faces.len(), self.model.size.to_bits()).hash(&mut hasher);
        hasher.finish()
    }

    fn __repr__(&self) -> String {
        let Model { name, faces, vertices, size, closed, .. } = &*self.model;
        let kind = if *closed { "" } else { ", open" };
        let (faces, vertices) = (faces.len(), vertices.len());
        let size = convert::decimal(*size, convert::decimals(*size));
        format!("<Model {name:?}: {faces} faces, {vertices} vertices, size {size}{kind}>")
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Any<'py>, ModelState)> {
        let recipe = self.recipe.clone();
        let pairs = |points: Vec<DVec2>| points.into_iter().map(Pair::from).collect::<Vec<_>>();
        let (closed, loops, seams) = match recipe.shape {
            Shape::Polygon { vertices, holes } => {
                (true, std::iter::once(vertices).chain(holes).map(pairs).collect(), Vec::new())
            }
            Shape::Segments { segments, seams } => {
                (false, segments.into_iter().map(|ends| pairs(ends.to_vec())).collect(), seams)
            }
        };
        let Recipe { name, untouchable, position_slack, normal_slack, mends, .. } = recipe;
        let state = (closed, loops, seams, (name, untouchable, position_slack, normal_slack, mends));
        Ok((restore::<Self>(py)?, state))
    }

    /// Undoes `__reduce__`.
    #[classmethod]
    fn _restore(
        class: &Bound<'_, PyType>,
        closed: bool,
        loops: Vec<Vec<Pair>>,
        seams: Vec<usize>,
        options: OptionsState,
    ) -> PyResult<Self> {
        let mut loops =
            loops.into_iter().map(|points| points.into_iter().map(DVec2::from).collect::<Vec<_>>());
        let shape = if closed {
            Shape::Polygon { vertices: loops.next().unwrap_or_default(), holes: loops.collect() }
        } else {
            Shape::Segments { segments: loops.map(|ends| [ends[0], ends[1]]).collect(), seams }
        };
        let (name, untouchable, position_slack, normal_slack, mends) = options;
        Recipe { shape, name, untouchable, position_slack, normal_slack, mends }.model(class.py())
    }
}

/// Closed, loops or segments, seams, and the rest of the recipe.
type ModelState = (bool, Vec<Vec<Pair>>, Vec<usize>, OptionsState);

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
