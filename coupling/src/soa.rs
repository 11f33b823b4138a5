//! Vectors as structure of arrays.

use crate::Vec3;
use std::ops::Range;

/// `n` three-component vectors, one array per component.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Soa3 {
    /// First components.
    pub x: Vec<f64>,
    /// Second components.
    pub y: Vec<f64>,
    /// Third components.
    pub z: Vec<f64>,
}

/// A shared view of a range of a [`Soa3`].
#[derive(Clone, Copy, Debug)]
pub struct Soa3Ref<'a> {
    /// First components.
    pub x: &'a [f64],
    /// Second components.
    pub y: &'a [f64],
    /// Third components.
    pub z: &'a [f64],
}

/// An exclusive view of a range of a [`Soa3`].
#[derive(Debug)]
pub struct Soa3Mut<'a> {
    /// First components.
    pub x: &'a mut [f64],
    /// Second components.
    pub y: &'a mut [f64],
    /// Third components.
    pub z: &'a mut [f64],
}

impl Soa3 {
    /// `n` zero vectors.
    pub fn zeros(n: usize) -> Self {
        Self {
            x: vec![0.0; n],
            y: vec![0.0; n],
            z: vec![0.0; n],
        }
    }

    /// Number of vectors.
    pub fn len(&self) -> usize {
        self.x.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.x.is_empty()
    }

    /// Vector `i`.
    #[inline]
    pub fn get(&self, i: usize) -> Vec3 {
        Vec3::new(self.x[i], self.y[i], self.z[i])
    }

    /// Replaces vector `i`.
    #[inline]
    pub fn set(&mut self, i: usize, v: Vec3) {
        self.x[i] = v.x;
        self.y[i] = v.y;
        self.z[i] = v.z;
    }

    /// Adds to vector `i`.
    #[inline]
    pub fn add(&mut self, i: usize, v: Vec3) {
        self.x[i] += v.x;
        self.y[i] += v.y;
        self.z[i] += v.z;
    }

    /// Appends a vector.
    pub fn push(&mut self, v: Vec3) {
        self.x.push(v.x);
        self.y.push(v.y);
        self.z.push(v.z);
    }

    /// Resizes to `n` vectors, new ones zero.
    pub fn resize(&mut self, n: usize) {
        self.x.resize(n, 0.0);
        self.y.resize(n, 0.0);
        self.z.resize(n, 0.0);
    }

    /// Sets all components to `value`.
    pub fn fill(&mut self, value: f64) {
        self.x.fill(value);
        self.y.fill(value);
        self.z.fill(value);
    }

    /// View of all vectors.
    pub fn view(&self) -> Soa3Ref<'_> {
        self.slice(0..self.len())
    }

    /// Exclusive view of all vectors.
    pub fn view_mut(&mut self) -> Soa3Mut<'_> {
        let n = self.len();
        self.slice_mut(0..n)
    }

    /// View of a range.
    pub fn slice(&self, r: Range<usize>) -> Soa3Ref<'_> {
        Soa3Ref {
            x: &self.x[r.clone()],
            y: &self.y[r.clone()],
            z: &self.z[r],
        }
    }

    /// Exclusive view of a range.
    pub fn slice_mut(&mut self, r: Range<usize>) -> Soa3Mut<'_> {
        Soa3Mut {
            x: &mut self.x[r.clone()],
            y: &mut self.y[r.clone()],
            z: &mut self.z[r],
        }
    }

    /// Iterates over the vectors by value.
    pub fn iter(&self) -> impl Iterator<Item = Vec3> + '_ {
        (0..self.len()).map(|i| self.get(i))
    }
}

impl FromIterator<Vec3> for Soa3 {
    fn from_iter<I: IntoIterator<Item = Vec3>>(vectors: I) -> Self {
        let mut out = Self::default();
        for v in vectors {
            out.push(v);
        }
        out
    }
}

impl Soa3Ref<'_> {
    /// Number of vectors.
    pub fn len(&self) -> usize {
        self.x.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.x.is_empty()
    }

    /// Vector `i`.
    #[inline]
    pub fn get(&self, i: usize) -> Vec3 {
        Vec3::new(self.x[i], self.y[i], self.z[i])
    }

    /// Iterates over the vectors by value.
    pub fn iter(&self) -> impl Iterator<Item = Vec3> + '_ {
        (0..self.len()).map(|i| self.get(i))
    }

    /// Mean of all vectors.
    pub fn mean(&self) -> Vec3 {
        let sum = self.iter().fold(Vec3::zeros(), |s, v| s + v);
        sum / self.len().max(1) as f64
    }
}

impl Soa3Mut<'_> {
    /// Number of vectors.
    pub fn len(&self) -> usize {
        self.x.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.x.is_empty()
    }

    /// Vector `i`.
    #[inline]
    pub fn get(&self, i: usize) -> Vec3 {
        Vec3::new(self.x[i], self.y[i], self.z[i])
    }

    /// Replaces vector `i`.
    #[inline]
    pub fn set(&mut self, i: usize, v: Vec3) {
        self.x[i] = v.x;
        self.y[i] = v.y;
        self.z[i] = v.z;
    }

    /// Adds to vector `i`.
    #[inline]
    pub fn add(&mut self, i: usize, v: Vec3) {
        self.x[i] += v.x;
        self.y[i] += v.y;
        self.z[i] += v.z;
    }

    /// A shorter-lived exclusive view.
    pub fn reborrow(&mut self) -> Soa3Mut<'_> {
        Soa3Mut {
            x: self.x,
            y: self.y,
            z: self.z,
        }
    }
}
