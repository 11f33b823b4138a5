//! What the curves are held against.

use lbm_ibm::coupling::{PN, UM};

/// A diameter in an experiment: mean, and lower and upper end of its error bar where there is one, m.
pub type Bar = (f64, Option<(f64, f64)>);

/// A red blood cell in optical tweezers.
#[derive(Clone, Copy, Debug)]
pub struct Reading {
    /// Force, N.
    pub force: f64,
    /// Diameter along the pull.
    pub axial: Bar,
    /// Diameter across the pull.
    pub transverse: Bar,
}

/// Force, pN; axial mean, low, high; transverse mean, low, high, um. Suresh et al., Acta Biomater. 1 (2005) 15, and Mills
/// et al., Mech. Chem. Biosyst. 1 (2004) 169, as digitised by the authors of HemoCell (UvaCsl/HemoCell, commit d916987,
/// examples/stretchCell/validation).
const TWEEZERS: [[f64; 7]; 12] = [
    [16.0, 9.255, 8.352, 10.097, 6.197, 5.581, 6.813],
    [19.5, 9.584, 8.701, 10.446, 6.279, 5.643, 6.915],
    [31.0, 10.528, 9.625, 11.390, 5.725, 5.130, 6.320],
    [38.0, 11.144, 10.076, 12.293, 5.438, 4.822, 5.992],
    [47.0, 11.862, 10.815, 12.970, 5.068, 4.288, 5.828],
    [67.5, 12.868, 11.883, 13.874, 4.637, 3.939, 5.356],
    [87.6, 13.771, 12.580, 14.982, 4.637, 4.001, 5.273],
    [108.5, 14.346, 12.868, 15.823, 4.596, 3.980, 5.232],
    [130.0, 15.187, 13.894, 16.624, 4.534, 3.878, 5.191],
    [151.0, 15.023, 14.428, 16.870, 4.350, 3.775, 4.986],
    [172.8, 16.070, 14.264, 17.876, 4.596, 4.083, 5.048],
    [193.0, 16.296, 14.489, 18.020, 4.391, 3.755, 4.945],
];

/// The same without a force; no bars are given.
const TWEEZERS_AT_REST: [f64; 2] = [8.58, 7.55];

/// The tweezers' readings in ascending order of force.
pub fn tweezers() -> Vec<Reading> {
    let [axial, transverse] = TWEEZERS_AT_REST.map(|d| (d * UM, None));
    let rest = Reading {
        force: 0.0,
        axial,
        transverse,
    };
    let bar = |mean: f64, low: f64, high: f64| (mean * UM, Some((low * UM, high * UM)));
    let pulled = TWEEZERS.map(|[force, a, a_low, a_high, t, t_low, t_high]| Reading {
        force: force * PN,
        axial: bar(a, a_low, a_high),
        transverse: bar(t, t_low, t_high),
    });
    std::iter::once(rest).chain(pulled).collect()
}

/// Forces on the tumour cell, N; the paper's is one of them.
pub fn optical_stretcher() -> Vec<f64> {
    [
        0.0, 10.0, 20.0, 30.0, 50.0, 78.75, 90.0, 105.0, 150.0, 200.0, 250.0, 333.0,
    ]
    .map(|f| f * PN)
    .to_vec()
}

/// Force (N) and strain to which the paper calibrates its tumour cell: that of modMCF-7 cells in the optical stretcher
/// (Guck et al., Biophys. J. 88 (2005) 3689), at 105 pN x 600/800.
pub const PAPER_CTC: (f64, f64) = (78.75 * PN, 0.30);
