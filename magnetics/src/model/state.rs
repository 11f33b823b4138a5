//! Solutions from which the next ones start, as bytes.

use lbm_ibm_coupling::nalgebra::Complex;
use lbm_ibm_coupling::{Soa3, StateError, StateReader, StateWriter};

/// Writes an array and its length.
pub(super) fn save_list(list: &Soa3, to: &mut StateWriter) {
    to.count(list.len() as u64);
    to.array(list.view());
}

/// Takes an array of any length.
pub(super) fn restore_list(list: &mut Soa3, from: &mut StateReader<'_>) -> Result<(), StateError> {
    list.resize(from.count()? as usize);
    from.array(list)
}

/// Writes complex numbers, and how many.
pub(super) fn save_complex(list: &[Complex<f64>], to: &mut StateWriter) {
    to.count(list.len() as u64);
    list.iter().for_each(|z| to.numbers(&[z.re, z.im]));
}

/// Takes any number of complex numbers.
pub(super) fn restore_complex(list: &mut Vec<Complex<f64>>, from: &mut StateReader<'_>) -> Result<(), StateError> {
    let number = |from: &mut StateReader<'_>| Ok(Complex::new(from.number()?, from.number()?));
    *list = (0..from.count()?).map(|_| number(from)).collect::<Result<_, _>>()?;
    Ok(())
}
