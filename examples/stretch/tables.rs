//! Tables on the terminal.

use crate::curve::Row;
use crate::measured::PAPER_CTC;
use crate::options::Options;
use crate::release::{Done, FIT, PLASMA};
use lbm_ibm::coupling::{MS, PN, UM, US};

/// The different values of a name, in the order of their first row.
pub fn names<R>(rows: &[R], name: impl Fn(&R) -> &str) -> Vec<&str> {
    let mut seen = Vec::new();
    for row in rows {
        let name = name(row);
        if !seen.contains(&name) {
            seen.push(name);
        }
    }
    seen
}

/// A number with `digits`, in `width` columns; a dash where there is none.
fn cell(value: Option<f64>, unit: f64, width: usize, digits: usize) -> String {
    value.map_or(format!("{:>width$}", "-"), |v| format!("{:width$.digits$}", v / unit))
}

/// A measured mean with its bar, um, and where a computed value lies.
fn bar(value: Option<f64>, mean: Option<f64>, low: Option<f64>, high: Option<f64>) -> String {
    let (Some(low), Some(high)) = (low, high) else {
        return format!("{} {:22}", cell(mean, UM, 6, 2), "");
    };
    let verdict = match value {
        Some(v) if v < low => "below",
        Some(v) if v > high => "above",
        Some(_) => "in",
        None => "-",
    };
    format!(
        "{} ({:5.2} to {:5.2}) {verdict:5}",
        cell(mean, UM, 6, 2),
        low / UM,
        high / UM
    )
}

/// The red blood cell beside the tweezers.
pub fn print_rbc(rows: &[Row]) {
    for form in names(rows, |r| r.form) {
        println!(
            "\nRed blood cell, {form}, {} at each end; tweezers: mean (bar)",
            rows[0].patch
        );
        println!(
            "force_pN  axial_um  tweezers                     transv_um  tweezers                     thick_um   S/S0    V/V0   left_N  net_pN"
        );
        for r in rows.iter().filter(|r| r.form == form) {
            println!(
                "{:8.1}  {}  {}  {}  {}  {} {} {} {} {}",
                r.force / PN,
                cell(r.axial, UM, 8, 2),
                bar(r.axial, r.measured_axial, r.measured_axial_low, r.measured_axial_high),
                cell(r.transverse, UM, 8, 2),
                bar(
                    r.transverse,
                    r.measured_transverse,
                    r.measured_transverse_low,
                    r.measured_transverse_high
                ),
                cell(r.thickness, UM, 8, 2),
                cell(r.area_ratio, 1.0, 7, 4),
                cell(r.volume_ratio, 1.0, 8, 5),
                r.residual.map_or(format!("{:>8}", "-"), |f| format!("{f:8.0e}")),
                cell(r.net_force, PN, 7, 1),
            );
            print_message(r);
        }
    }
}

/// The tumour cell's strain, one column per patch.
pub fn print_ctc(rows: &[Row]) {
    let patches = names(rows, |r| &r.patch);
    for form in names(rows, |r| r.form) {
        println!("\nTumour cell, {form}: strain in %, by the patch that is pulled at each end");
        let head: Vec<_> = patches.iter().map(|p| format!("{p:>14}")).collect();
        println!("force_pN{}    paper", head.concat());
        let own: Vec<&Row> = rows.iter().filter(|r| r.form == form).collect();
        for first in own.iter().filter(|r| r.patch == patches[0]) {
            let at_force = own.iter().filter(|r| r.force == first.force);
            let columns: Vec<_> = at_force
                .map(|r| format!("{}{}", cell(r.strain, 0.01, 13, 1), if is_held(r) { "*" } else { " " }))
                .collect();
            let paper = first.force == PAPER_CTC.0;
            let paper = cell(paper.then_some(PAPER_CTC.1), 0.01, 8, 1).replace('-', " ");
            println!("{:8.1}{} {paper}", first.force / PN, columns.concat());
        }
        for patch in &patches {
            // The first force without an equilibrium says what happens; those beyond it repeat it.
            let failed = own.iter().find(|r| r.patch == *patch && !r.message.is_empty());
            failed.into_iter().for_each(|r| print_message(r));
        }
    }
    if rows.iter().any(is_held) {
        println!(
            "* the membrane's own forces add up to more than the pull: what holds the cell in place shapes it too"
        );
    }
}

/// Whether the force that was taken off the cell evenly is greater than the pull.
fn is_held(row: &Row) -> bool {
    row.net_force.is_some_and(|net| net > row.force && row.force > 0.0)
}

fn print_message(row: &Row) {
    if !row.message.is_empty() {
        println!("  {}: {}", row.patch, row.message);
    }
}

/// The recoveries, and what they leave out.
pub fn print_recoveries(done: &[Done], options: &Options) {
    println!(
        "\nRecovery in plasma at rest ({} mPa s), density {} kg/m3 x {}, tau {}; exponential fitted from {:.0} to {:.0} % of the extension",
        PLASMA.1 * 1e3,
        PLASMA.0,
        options.reynolds_scale,
        options.tau,
        100.0 * FIT.0,
        100.0 * FIT.1
    );
    println!(
        "cell form        force_pN  axial_um (rest)  constant_ms  rms_ln  to_10%_ms  mu*a/G_ms  centre_um  vol_%  dx_um  dt_us   steps     s"
    );
    for d in done {
        let r = &d.recovery;
        println!(
            "{:4} {:11} {:8.1}  {:8.2} ({:4.1})  {} {} {}  {:9.2}  {:9.2}  {:5.2}  {:5.2}  {:5.2} {:7} {:5.1}",
            r.cell,
            r.form,
            r.force / PN,
            r.axial_released / UM,
            r.axial_rest / UM,
            cell(r.time_constant, MS, 11, 2),
            cell(r.fit_error, 1.0, 7, 2),
            cell(r.time_to_tenth, MS, 10, 1),
            r.viscous_time / MS,
            r.centre_drift / UM,
            100.0 * r.volume_drift,
            r.spacing / UM,
            r.time_step / US,
            r.steps,
            d.seconds,
        );
        if !r.message.is_empty() {
            println!("     {}", r.message);
        }
    }
    println!(
        "Only the fluid slows these membranes, so a red cell is back within milliseconds. A real one takes 0.1 s: that is its\n\
         membrane viscosity over its shear modulus, eta_m/mu_s = 0.6 uN s/m over 6 uN/m (Hochmuth, Worthy and Evans 1979),\n\
         and the paper's model has no membrane viscosity. How far to trust this: --reynolds-scale {} halves the density,\n\
         --resolution 0.25 --tau 2.5 --cell rbc the spacing, which brings the red cell back in three quarters of the time.",
        0.5 * options.reynolds_scale
    );
}
