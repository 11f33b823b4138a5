//! What a case finds.

use lbm_ibm::lbm::Precision;
use serde::{Deserialize, Deserializer, Serialize};
use std::collections::BTreeMap;
use std::time::{Duration, Instant};

/// The tightest gate of a fluid that is stored in 32 bits.
pub const ROUNDED: f64 = 1e-5;

/// One quantity of one row against its reference.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Finding {
    /// Case.
    pub case: String,
    /// Key columns of the row.
    pub row: BTreeMap<String, String>,
    /// What was computed.
    pub quantity: String,
    /// Its value.
    #[serde(deserialize_with = "number")]
    pub value: f64,
    /// What it should be.
    #[serde(deserialize_with = "number")]
    pub reference: f64,
    /// What the error is relative to.
    #[serde(deserialize_with = "number")]
    pub scale: f64,
    /// |value - reference|/scale.
    #[serde(deserialize_with = "number")]
    pub relative_error: f64,
    /// Greatest error that passes; none where the quantity is only reported.
    pub gate: Option<f64>,
    /// Whether it passes.
    pub pass: bool,
    /// Wall-clock seconds.
    pub seconds: f64,
}

/// A number of JSON, which writes those that are not finite as null.
fn number<'de, D: Deserializer<'de>>(from: D) -> Result<f64, D::Error> {
    Ok(Option::deserialize(from)?.unwrap_or(f64::NAN))
}

/// Findings of a case, and the clock of the row under way.
pub struct Findings {
    case: String,
    row: BTreeMap<String, String>,
    clock: Instant,
    precision: Precision,
    /// What was found.
    pub found: Vec<Finding>,
    /// Rows that were left out, because they are slow or for what the case says.
    pub left_out: usize,
}

impl Findings {
    /// Nothing yet.
    pub fn of(case: &str) -> Self {
        Self {
            case: case.to_owned(),
            row: BTreeMap::new(),
            clock: Instant::now(),
            precision: Precision::F64,
            found: Vec::new(),
            left_out: 0,
        }
    }

    /// What the fluid is stored as. In 32 bits gates tighter than 1e-5 are 1e-5, in 16 bits nothing gates.
    pub fn stored(self, precision: Precision) -> Self {
        Self { precision, ..self }
    }

    /// Begins a row; its seconds count from here.
    pub fn begin(&mut self, row: BTreeMap<String, String>) {
        self.row = row;
        self.clock = Instant::now();
    }

    /// Begins a row that has been computed already, in so many seconds.
    pub fn begin_done(&mut self, row: BTreeMap<String, String>, seconds: f64) {
        self.begin(row);
        let spent = Duration::from_secs_f64(seconds);
        self.clock = self.clock.checked_sub(spent).unwrap_or(self.clock);
    }

    /// A quantity with its gate; the error is relative to the reference.
    pub fn check(&mut self, quantity: &str, value: f64, reference: f64, gate: f64) {
        self.push(quantity, value, reference, reference.abs(), Some(gate));
    }

    /// A quantity with its gate; the error is relative to `scale`.
    pub fn check_scaled(&mut self, quantity: &str, value: f64, reference: f64, scale: f64, gate: f64) {
        self.push(quantity, value, reference, scale, Some(gate));
    }

    /// A quantity that has to be at least `least`, such as an order of convergence: the error is how far it falls short.
    pub fn check_at_least(&mut self, quantity: &str, value: f64, least: f64) {
        self.push(quantity, value, least, 1.0, Some(0.0));
        if let Some(last) = self.found.last_mut().filter(|f| f.gate.is_some()) {
            last.gate = Some(0.0);
            last.relative_error = (least - value).max(0.0);
            last.pass = value >= least;
        }
    }

    /// A quantity that is reported and gates nothing.
    pub fn report(&mut self, quantity: &str, value: f64, reference: f64, scale: f64) {
        self.push(quantity, value, reference, scale, None);
    }

    fn push(&mut self, quantity: &str, value: f64, reference: f64, scale: f64, gate: Option<f64>) {
        let relative_error = (value - reference).abs() / scale;
        let gate = gate.and_then(|g| match self.precision {
            Precision::F64 => Some(g),
            Precision::F32 => Some(g.max(ROUNDED)),
            _ => None,
        });
        self.found.push(Finding {
            case: self.case.clone(),
            row: self.row.clone(),
            quantity: quantity.to_owned(),
            value,
            reference,
            scale,
            relative_error,
            gate,
            pass: gate.is_none_or(|g| relative_error <= g),
            seconds: self.clock.elapsed().as_secs_f64(),
        });
    }
}

/// A gate that is `tight` in 64 bits. In 32 bits a rounding in every step acts as a force of 2^-24 of the populations, which the flow
/// answers with `gain` times that much: [`ROUNDED`] and this on top.
pub fn gate_of(precision: Precision, tight: f64, gain: f64) -> f64 {
    match precision {
        Precision::F64 => tight,
        _ => ROUNDED + gain * 2.0_f64.powi(-24),
    }
}

/// Observed order of convergence from errors at two spacings.
pub fn observed_order(coarse: (f64, f64), fine: (f64, f64)) -> f64 {
    (coarse.1 / fine.1).ln() / (coarse.0 / fine.0).ln()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_not_a_number_comes_back_from_json() {
        let mut findings = Findings::of("case");
        findings.report("order", f64::NAN, 2.0, 2.0);
        let json = serde_json::to_string(&findings.found).expect("it can be written");
        let back: Vec<Finding> = serde_json::from_str(&json).expect("it can be read");
        assert!(back[0].value.is_nan() && back[0].reference == 2.0 && back[0].pass);
    }
}
