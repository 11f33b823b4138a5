//! The paper's two calibrations, by the static stretch of its cells.

use lbm_ibm_coupling::ImmersedBody;
use lbm_ibm_membrane::stretch::{Patch, Shape, Stretch, pull};
use lbm_ibm_membrane::{Form, MembraneError, Quality, presets};

/// Force (pN); axial, transverse, thickness (um) of the paper's red blood cell, pulled over a 2 um chord at each end, by
/// another program with the formulas of 2011 on the software's own mesh of 400 nodes.
const RBC: [(f64, [f64; 3]); 11] = [
    (10.0, [9.164, 7.675, 2.6469]),
    (20.0, [10.012, 7.3342, 2.7735]),
    (31.0, [10.8805, 6.9281, 2.8955]),
    (47.0, [12.0569, 6.3643, 3.0141]),
    (67.0, [13.3993, 5.8124, 3.0367]),
    (88.0, [14.7253, 5.3266, 3.0827]),
    (108.0, [15.9126, 4.9768, 3.1619]),
    (130.0, [17.4755, 4.6064, 3.1103]),
    (150.0, [17.9767, 4.4383, 3.2679]),
    (172.0, [18.2911, 4.3449, 3.3509]),
    (193.0, [18.5014, 4.2867, 3.3971]),
];

/// Force (pN) and the bar of the axial diameter (um) in optical tweezers (Mills et al. 2004, Suresh et al. 2005, as
/// digitised by the authors of HemoCell), up to 88 pN.
const TWEEZERS: [(f64, f64, f64); 6] = [
    (19.5, 8.701, 10.450),
    (31.0, 9.625, 11.390),
    (38.0, 10.376, 12.293),
    (47.0, 10.815, 12.970),
    (67.5, 11.883, 13.874),
    (87.6, 12.580, 14.982),
];

/// Force (pN) and axial diameter (um) of the paper's tumour cell, 5 % of the nodes pulled at each end, likewise.
const CTC: [(f64, f64); 5] = [
    (20.0, 18.72),
    (79.0, 20.746),
    (105.0, 21.318),
    (250.0, 23.514),
    (333.0, 24.371),
];

fn red_cell(form: Form) -> Stretch {
    let cell = presets::rbc_paper(form).expect("the paper's cell");
    let ends = Patch::Chord(2e-6).ends(cell.reference()).expect("nodes at the rim");
    Stretch::new(cell, ends)
}

fn tumour_cell(form: Form, share: f64) -> Stretch {
    let cell = presets::ctc_paper(form).expect("the paper's cell");
    let ends = Patch::Fraction(share)
        .ends(cell.reference())
        .expect("nodes at the ends");
    Stretch::new(cell, ends)
}

fn sizes(shape: &Shape) -> [f64; 3] {
    [shape.axial, shape.transverse, shape.thickness].map(|s| s * 1e6)
}

fn near(value: f64, reference: f64, tolerance: f64) -> bool {
    (value / reference - 1.0).abs() < tolerance
}

#[test]
fn red_cell_mesh_has_the_papers_measures() {
    let cell = presets::rbc_paper(Form::Paper2011).expect("the paper's cell");
    let size = cell.mesh().extent() * 1e6;
    let Quality {
        nodes,
        triangles,
        volume,
        area,
        edge_spread,
        least_angle,
        ..
    } = cell.mesh().quality();
    assert_eq!((nodes, triangles), (400, 796));
    assert!(near(volume, 96.56e-18, 0.001) && near(area, 137.58e-12, 0.001));
    assert!(
        near(size.z, 2.476, 0.001) && near(size.x, 8.0, 0.002) && near(size.y, 8.0, 0.002),
        "{size}"
    );
    assert!(
        edge_spread < 0.15 && least_angle.to_degrees() > 35.0,
        "{}",
        cell.mesh().quality()
    );
}

#[test]
fn red_cell_stretches_as_the_paper_calibrated_it() -> Result<(), MembraneError> {
    let (mut paper, mut corrected) = (red_cell(Form::Paper2011), red_cell(Form::Corrected));
    for (force, reference) in RBC {
        let (p, c) = (paper.pull(force * 1e-12)?, corrected.pull(force * 1e-12)?);
        println!(
            "{force} pN: {:.3?}, corrected {:.3?}, reference {reference:.3?} um",
            sizes(&p),
            sizes(&c)
        );
        assert!(p.residual < 1e-13 && c.residual < 1e-13);
        for (size, wanted) in sizes(&p).into_iter().zip(reference) {
            assert!(near(size, wanted, 0.06), "{force} pN: {size} against {wanted} um");
        }
    }
    Ok(())
}

#[test]
fn red_cell_stays_inside_the_tweezers_bars() -> Result<(), MembraneError> {
    let mut cell = red_cell(Form::Paper2011);
    for (force, low, high) in TWEEZERS {
        let axial = cell.pull(force * 1e-12)?.axial * 1e6;
        assert!(
            low < axial && axial < high,
            "{force} pN: {axial:.2} um is not in {low} to {high}"
        );
    }
    Ok(())
}

#[test]
fn tumour_cell_stretches_as_the_paper_calibrated_it() -> Result<(), MembraneError> {
    let mut cell = tumour_cell(Form::Paper2011, 0.05);
    for (force, wanted) in CTC {
        let shape = cell.pull(force * 1e-12)?;
        println!("{force} pN: {:.3?} um, reference {wanted}", sizes(&shape));
        assert!(near(shape.axial * 1e6, wanted, 0.03), "{force} pN");
    }
    Ok(())
}

#[test]
fn tumour_cell_strain_depends_on_the_patch() -> Result<(), MembraneError> {
    let strain = |form, share| {
        let shape = tumour_cell(form, share).pull(79e-12)?;
        Ok::<_, MembraneError>(100.0 * (shape.axial / presets::CTC_DIAMETER - 1.0))
    };
    let [small, middle, large] = [0.02, 0.05, 0.1].map(|share| strain(Form::Paper2011, share));
    let (small, middle, large) = (small?, middle?, large?);
    println!("strain at 79 pN, 2, 5 and 10 % of the nodes: {small:.1}, {middle:.1}, {large:.1} %");
    println!(
        "corrected, 5 and 10 %: {:.1}, {:.1} %",
        strain(Form::Corrected, 0.05)?,
        strain(Form::Corrected, 0.1)?
    );
    assert!((middle - 29.7).abs() < 1.0);
    assert!((small - 35.2).abs() < 3.0 && (large - 24.4).abs() < 1.5);
    Ok(())
}

#[test]
fn a_search_that_does_not_end_says_how_far_it_came() {
    let cell = presets::ctc_paper(Form::Corrected).expect("the paper's cell");
    let ends = Patch::Fraction(0.05).ends(cell.reference()).expect("nodes at the ends");
    let error = Stretch::new(cell.clone(), ends.clone())
        .with_iterations(10)
        .pull(50e-12)
        .expect_err("too few");
    assert!(matches!(error, MembraneError::NoEquilibrium { iterations: 10, residual, .. } if residual > 1e-15));
    assert!(error.to_string().contains("allow more iterations"), "{error}");
    assert!(pull(&cell, ends, 20e-12).is_ok());
    assert!(matches!(
        Patch::Fraction(0.0).ends(cell.reference()),
        Err(MembraneError::EmptyPatch { .. })
    ));
}
