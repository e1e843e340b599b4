//! Pair tables as bytes, to be kept beside the file of the model.
//!
//! Layout, little-endian: magic, version, kinds, a hash of the model, counts of features and of stored pairs, the
//! pairs, a hash of all before. What does not depend on pairs of features is made anew, and not stored.

use glam::DVec3;

use super::model::Model;
use super::tables::{FeatureTables, Kinds};
use crate::Error;
use crate::part::Surface;

/// What the bytes begin with.
const MAGIC: [u8; 8] = *b"palpate3";

/// Raised whenever the layout, or what the ranges mean, changes.
const VERSION: u32 = 2;

/// A stored pair, bytes.
const PAIR: usize = 16;

/// Bytes before the pairs.
const HEADER: usize = 8 + 4 + 4 + 8 + 8 + 8;

impl Model {
    /// Its pair tables of the kinds of features asked for, made if there are none yet, as bytes to be kept with the
    /// model. They hold for the same geometry alone; the name and the slacks don't matter.
    pub fn tables_to_bytes(&self, faces: bool, edges: bool, vertices: bool) -> Vec<u8> {
        let kinds = Kinds { faces, edges, vertices };
        self.feature_tables(kinds).to_bytes(self, kinds)
    }

    /// Takes over pair tables that were kept with the model, unless it has made those already.
    ///
    /// # Errors
    /// If they are truncated, damaged, of another version, or of another model.
    pub fn tables_from_bytes(&self, bytes: &[u8]) -> Result<(), Error> {
        let (kinds, tables) = FeatureTables::from_bytes(self, bytes)?;
        // If another thread was first, it made the same.
        let _ = self.tables.0[usize::from(kinds.number())].set(tables.into());
        Ok(())
    }
}

impl FeatureTables {
    /// As bytes, for [`Self::from_bytes`] with the same model.
    pub fn to_bytes(&self, model: &Model, kinds: Kinds) -> Vec<u8> {
        let mut bytes = Vec::with_capacity(HEADER + PAIR * self.pairs.len() + 8);
        bytes.extend(MAGIC);
        bytes.extend(VERSION.to_le_bytes());
        bytes.extend(u32::from(kinds.number()).to_le_bytes());
        for word in [content(model), self.elements.len() as u64, self.pairs.len() as u64] {
            bytes.extend(word.to_le_bytes());
        }
        bytes.extend(self.pairs.as_flattened().iter().flat_map(|code| code.to_le_bytes()));
        let check = Hash::default().bytes(&bytes).0;
        bytes.extend(check.to_le_bytes());
        bytes
    }

    /// The tables that `bytes` say are of the model, and their kinds.
    ///
    /// # Errors
    /// If they are truncated, damaged, of another version, or of another model.
    pub fn from_bytes(model: &Model, bytes: &[u8]) -> Result<(Kinds, Self), Error> {
        let refuse = |problem: &str| {
            let value = format!("{} bytes", bytes.len());
            Err(Error::new("bytes", problem, value, "make the tables anew, and keep those"))
        };
        let mut rest = Reader(bytes);
        if rest.take::<8>() != Some(MAGIC) {
            return refuse("these are not pair tables of a solid");
        }
        if rest.take().map(u32::from_le_bytes) != Some(VERSION) {
            return refuse("these pair tables are of another version");
        }
        let (Some(kinds), Some(hash), Some(features), Some(pairs)) =
            (rest.take().map(u32::from_le_bytes), rest.word(), rest.word(), rest.word())
        else {
            return refuse("these pair tables are truncated");
        };
        let Some((kept, check)) = bytes.split_last_chunk::<8>() else {
            return refuse("these pair tables are truncated");
        };
        if Hash::default().bytes(kept).0 != u64::from_le_bytes(*check) {
            return refuse("these pair tables are truncated or damaged");
        }
        if kinds > 7 || hash != content(model) {
            return refuse("these pair tables are of another model");
        }
        let kinds = Kinds { faces: kinds & 1 != 0, edges: kinds & 2 != 0, vertices: kinds & 4 != 0 };
        let mut tables = Self::unfilled(model, kinds);
        let count = tables.elements.len();
        let due = if count <= super::tables::MOST_STORED { count * (count + 1) / 2 } else { 0 };
        let stored = rest.0.len().checked_sub(8);
        if features != count as u64 || pairs != due as u64 || stored != Some(due * PAIR) {
            return refuse("these pair tables are of another model");
        }
        let code = |pair: &[u8], k: usize| u16::from_le_bytes([pair[2 * k], pair[2 * k + 1]]);
        let packed =
            rest.0[..due * PAIR].chunks_exact(PAIR).map(|pair| std::array::from_fn(|k| code(pair, k)));
        tables.pairs = packed.collect();
        Ok((kinds, tables))
    }
}

/// Bytes not yet read.
struct Reader<'a>(&'a [u8]);

impl Reader<'_> {
    fn take<const N: usize>(&mut self) -> Option<[u8; N]> {
        let (taken, rest) = self.0.split_first_chunk()?;
        self.0 = rest;
        Some(*taken)
    }

    fn word(&mut self) -> Option<u64> {
        self.take().map(u64::from_le_bytes)
    }
}

/// FNV-1a, 64 bits.
struct Hash(u64);

impl Default for Hash {
    fn default() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }
}

impl Hash {
    fn bytes(self, bytes: &[u8]) -> Self {
        Self(bytes.iter().fold(self.0, |hash, byte| (hash ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01b3)))
    }

    fn number(self, number: u64) -> Self {
        self.bytes(&number.to_le_bytes())
    }

    fn length(self, length: f64) -> Self {
        self.number(length.to_bits())
    }

    fn vectors(self, vectors: &[DVec3]) -> Self {
        let counted = self.number(vectors.len() as u64);
        vectors.iter().fold(counted, |hash, v| hash.length(v.x).length(v.y).length(v.z))
    }

    fn numbers(self, lists: &[Vec<u32>]) -> Self {
        lists.iter().fold(self.number(lists.len() as u64), |hash, list| {
            let counted = hash.number(list.len() as u64);
            list.iter().fold(counted, |hash, number| hash.number(u64::from(*number)))
        })
    }
}

/// A hash of all of the model's geometry that its tables follow from, counts included.
fn content(model: &Model) -> u64 {
    let mut hash = Hash::default().number(model.faces.len() as u64);
    for face in &model.faces {
        let touchable = u64::from(face.surface == Surface::Touchable);
        hash = hash.vectors(&[face.normal]).length(face.offset).number(touchable);
        hash = hash.numbers(&face.loops).numbers(&face.pieces);
    }
    hash = hash.number(model.edges.len() as u64);
    for edge in &model.edges {
        hash = edge.ends.iter().fold(hash, |hash, end| hash.number(u64::from(*end)));
        hash = hash.vectors(edge.normals.as_ref().map_or(&[], |normals| normals));
    }
    hash = hash.number(model.vertices.len() as u64);
    for vertex in &model.vertices {
        hash = hash.vectors(&[vertex.point]).vectors(vertex.normals.as_deref().unwrap_or_default());
    }
    hash.0
}
