//! The paper's pair of sheets against `charge_sheet_field.csv`.

mod table;

use lbm_ibm_coupling::Vec3;
use lbm_ibm_magnetics::{ChargeSheet, FieldSource, SheetPair};
use table::Table;

#[test]
fn field_to_1e_13_and_gradient_to_1e_11_of_the_largest() {
    let table = Table::read(include_str!("data/charge_sheet_field.csv"));
    let half = [100e-6, 50e-6];
    let pair = SheetPair::opposite(Vec3::zeros(), half, 120e-6, 1.0).unwrap();
    let rows: Vec<_> = table.rows().filter(|r| r.text("config") == "opposite").collect();
    assert_eq!(rows.len(), 100);
    let (mut field, mut gradient, mut largest): (f64, f64, f64) = (0.0, 0.0, 0.0);
    for row in &rows {
        let (b, g) = pair.field_and_gradient(row.vector("x_m", "y_m", "z_m"), 0.0);
        field = field.max((b - row.vector("Bx_T", "By_T", "Bz_T")).amax());
        for (i, j, name) in [
            (0, 0, "dBx_dx"),
            (0, 1, "dBx_dy"),
            (0, 2, "dBx_dz"),
            (1, 1, "dBy_dy"),
            (1, 2, "dBy_dz"),
            (2, 2, "dBz_dz"),
        ] {
            largest = largest.max(row.number(name).abs());
            gradient = gradient.max((g[(i, j)] - row.number(name)).abs());
        }
    }
    println!("B {field:e} T, gradient {:e} of the largest", gradient / largest);
    assert!(field < 1e-13 && gradient < 1e-11 * largest);
}

#[test]
fn equal_sheets_cancel_at_the_centre_and_opposite_ones_double_one() {
    let half = [100e-6, 50e-6];
    let equal = SheetPair::equal(Vec3::zeros(), half, 120e-6, 1.0).unwrap();
    let (b, g) = equal.field_and_gradient(Vec3::zeros(), 0.0);
    assert!(b.amax() < 1e-16 && g.trace().abs() < 1e-11 * g.amax() && g.amax() > 1e3);
    let one = ChargeSheet::new(Vec3::z() * -60e-6, Vec3::x() * half[0], Vec3::y() * half[1], 1.0).unwrap();
    let both = SheetPair::opposite(Vec3::zeros(), half, 120e-6, 1.0).unwrap();
    let at = |s: &dyn FieldSource| s.field(Vec3::zeros(), 0.0).z;
    assert!((at(&both) - 2.0 * at(&one)).abs() < 1e-15);
}
