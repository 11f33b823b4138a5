//! Several sources at once.

use super::FieldSource;
use lbm_ibm_coupling::nalgebra::Matrix3;
use lbm_ibm_coupling::{Soa3, Soa3Ref, Vec3};
use std::sync::Arc;

/// The sum of sources.
#[derive(Clone, Default)]
pub struct Sum {
    parts: Vec<Arc<dyn FieldSource>>,
}

impl Sum {
    /// No source: no field.
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds a source.
    pub fn with(mut self, source: impl FieldSource + 'static) -> Self {
        self.parts.push(Arc::new(source));
        self
    }
}

impl FieldSource for Sum {
    fn field(&self, x: Vec3, t: f64) -> Vec3 {
        self.parts.iter().map(|s| s.field(x, t)).sum()
    }

    fn gradient(&self, x: Vec3, t: f64) -> Matrix3<f64> {
        self.parts.iter().map(|s| s.gradient(x, t)).sum()
    }

    fn field_and_gradient(&self, x: Vec3, t: f64) -> (Vec3, Matrix3<f64>) {
        let zero = (Vec3::zeros(), Matrix3::zeros());
        self.parts.iter().fold(zero, |(b, g), s| {
            let (db, dg) = s.field_and_gradient(x, t);
            (b + db, g + dg)
        })
    }

    fn fields(&self, x: Soa3Ref<'_>, t: f64, b: &mut Soa3) {
        b.resize(x.len());
        b.fill(0.0);
        let mut part = Soa3::default();
        for source in &self.parts {
            source.fields(x, t, &mut part);
            part.iter().enumerate().for_each(|(i, f)| b.add(i, f));
        }
    }

    fn fields_and_gradients(&self, x: Soa3Ref<'_>, t: f64, b: &mut Soa3, g: &mut Vec<Matrix3<f64>>) {
        b.resize(x.len());
        b.fill(0.0);
        g.clear();
        g.resize(x.len(), Matrix3::zeros());
        let (mut field, mut gradient) = (Soa3::default(), Vec::new());
        for source in &self.parts {
            source.fields_and_gradients(x, t, &mut field, &mut gradient);
            field.iter().enumerate().for_each(|(i, f)| b.add(i, f));
            g.iter_mut().zip(&gradient).for_each(|(sum, part)| *sum += part);
        }
    }
}
