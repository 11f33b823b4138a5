//! Three chains side by side: the gap between them against the bias field, for beads of several susceptibilities.

use crate::options::Options;
use lbm_ibm::coupling::{Soa3, UM, Vec3};
use lbm_ibm::magnetics::{
    Apparent, Auto, Bead, BeadSystem, FieldSource, Intrinsic, MagneticsError, Magnetisation, QuasiStatic, Saturation,
    SaturationShape, SheetPair, Sum, Uniform, chain_gaps, find_chains,
};
use serde::Serialize;
use std::error::Error;

/// Radius of these beads, m; chains in the row, beads in a chain.
const RADIUS: f64 = 5.0 * UM;
const ROW: (usize, usize) = (3, 4);
/// Half lengths of the sheets and the distance between them, m.
const SHEETS: ([f64; 2], f64) = ([40.0 * UM, 60.0 * UM], 80.0 * UM);

/// A point of the chart.
#[derive(Clone, Debug, Serialize)]
pub struct Row {
    /// What the beads are.
    pub beads: String,
    /// Apparent susceptibility of the beads in a weak field.
    pub susceptibility: f64,
    /// Bias field, T.
    pub bias: f64,
    /// Field of the sheets in their middle, T.
    pub sheets: f64,
    /// Gap between the surfaces of two chains, m.
    pub gap: f64,
}

/// The gaps at all biases for all susceptibilities; then for the second of them with beads that saturate at 30 kA/m, and with
/// sheets twice as strong at the same ratio of bias to sheets.
pub fn run(options: &Options) -> Result<Vec<Row>, Box<dyn Error>> {
    let mut rows = Vec::new();
    let field = options.field * 1e-3;
    for &chi in &options.gap_susceptibilities {
        let law = Apparent::new(chi)?;
        curve(options, &format!("chi {chi}"), chi, law.into(), field, &mut rows)?;
    }
    let Some(&chi) = options.gap_susceptibilities.get(1) else {
        return Ok(rows);
    };
    let apparent = Apparent::new(chi)?;
    curve(
        options,
        &format!("chi {chi}, sheets x 2"),
        chi,
        apparent.into(),
        2.0 * field,
        &mut rows,
    )?;
    let law = Saturation::new(SaturationShape::FroehlichKennelly, Intrinsic::from(apparent), 3e4)?;
    curve(
        options,
        &format!("chi {chi}, saturating"),
        chi,
        law.into(),
        field,
        &mut rows,
    )?;
    Ok(rows)
}

fn curve(
    options: &Options,
    name: &str,
    chi: f64,
    law: Magnetisation,
    field: f64,
    rows: &mut Vec<Row>,
) -> Result<(), MagneticsError> {
    let bead = Bead::new(RADIUS, options.density, law)?;
    let mut start = 3.0 * UM;
    for ratio in &options.gap_bias {
        let gap = at_rest(&bead, field, ratio * field, start)?;
        start = gap;
        rows.push(Row {
            beads: name.to_owned(),
            susceptibility: chi,
            bias: ratio * field,
            sheets: field,
            gap,
        });
    }
    Ok(())
}

/// Gap (m) of three upright chains at rest, started from a gap of `start` (m).
fn at_rest(bead: &Bead, field: f64, bias: f64, start: f64) -> Result<f64, MagneticsError> {
    let (half, separation) = SHEETS;
    let unit = SheetPair::opposite(Vec3::zeros(), half, separation, 1.0)?;
    let density = field / unit.field(Vec3::zeros(), 0.0).z;
    let sheets = SheetPair::opposite(Vec3::zeros(), half, separation, density)?;
    let source = Sum::new().with(sheets).with(Uniform::new(Vec3::z() * bias));
    let (chains, n) = ROW;
    let beads = vec![bead.clone(); chains * n];
    let middle = |i: usize, n: usize| i as f64 - 0.5 * (n as f64 - 1.0);
    let place = |c: usize, k: usize| {
        let y = (2.0 * RADIUS + start) * middle(c, chains);
        Vec3::new(0.0, y, 2.001 * RADIUS * middle(k, n))
    };
    let x: Soa3 = (0..chains).flat_map(|c| (0..n).map(move |k| place(c, k))).collect();
    let system = BeadSystem::new(beads.clone(), x, source, Auto::new(), 1e-3)?;
    let plates = Options::plates((2.0 * n as f64 + 0.2) * RADIUS);
    let mut rest = QuasiStatic::new(system.with_walls(plates)).with_tolerance(1e-6);
    rest.relax()?;
    let chains = find_chains(&beads, rest.positions(), 0.02 * RADIUS);
    let gaps = chain_gaps(&chains, &beads, rest.positions(), 20.0 * RADIUS);
    Ok(gaps.into_iter().fold(f64::INFINITY, f64::min))
}

/// Says the gaps, a line for each kind of beads.
pub fn print(rows: &[Row]) {
    println!("gap between chains of 10 um beads, um, against bias over the sheets' field");
    for (k, same) in rows.chunk_by(|a, b| a.beads == b.beads).enumerate() {
        if k == 0 {
            let head: Vec<String> = same.iter().map(|r| format!("{:6.2}", r.bias / r.sheets)).collect();
            println!("  {:24} {}", "", head.join(" "));
        }
        let gaps: Vec<String> = same.iter().map(|r| format!("{:6.2}", r.gap / UM)).collect();
        println!("  {:24} {}", same[0].beads, gaps.join(" "));
    }
}
