//! The same cases computed twice.

use super::Finding;
use std::fmt::Write;

/// A table in Markdown of the cases that both runs have: of the quantities that gate in `there` (but for orders of convergence), their
/// number, the greatest error in either run, the greatest difference between the runs, all relative to the scales of `here`,
/// and how many quantities of `here` fail.
pub fn comparison(there: &[Finding], here: &[Finding]) -> String {
    let mut text = String::from(
        "| case | quantities | greatest error, there | here | greatest difference | fail here |\n|---|---|---|---|---|---|\n",
    );
    let mut cases: Vec<&str> = here.iter().map(|f| f.case.as_str()).collect();
    cases.dedup();
    for case in cases {
        let (mut count, mut errors, mut apart) = (0, [0.0_f64; 2], 0.0_f64);
        for new in here.iter().filter(|f| f.case == case) {
            let same = |old: &&Finding| old.case == case && old.row == new.row && old.quantity == new.quantity;
            let Some(old) = there.iter().find(same) else { continue };
            if old.gate.is_none() || old.quantity.starts_with("order") {
                continue;
            }
            count += 1;
            let error = |value: f64| (value - new.reference).abs() / new.scale;
            errors = [errors[0].max(error(old.value)), errors[1].max(error(new.value))];
            apart = apart.max((new.value - old.value).abs() / new.scale);
        }
        let fail = here.iter().filter(|f| f.case == case && !f.pass).count();
        if count > 0 {
            // Writing to a string does not fail.
            let _ = writeln!(
                text,
                "| {case} | {count} | {:.1e} | {:.1e} | {apart:.1e} | {fail} |",
                errors[0], errors[1]
            );
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::validate::Findings;

    #[test]
    fn rows_of_two_runs_are_held_against_each_other() {
        let run = |value: f64| {
            let mut findings = Findings::of("flow");
            findings.check("flux", value, 2.0, 0.1);
            findings.check_at_least("order", value, 3.0);
            findings.report("time", 2.0 * value, 1.0, 1.0);
            findings.found
        };
        let text = comparison(&run(2.02), &run(1.9));
        assert_eq!(text.lines().count(), 3);
        assert!(
            text.ends_with("| flow | 1 | 1.0e-2 | 5.0e-2 | 6.0e-2 | 1 |\n"),
            "{text}"
        );
        assert_eq!(comparison(&[], &run(1.0)).lines().count(), 2);
    }
}
