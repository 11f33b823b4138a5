//! Charts as SVG: both axes logarithmic, a line per curve, the Pareto front behind them.

use super::{Chart, Row, cases, curves};
use crate::Fault;
use lbm_ibm::output::COLOURS;
use plotters::coord::Shift;
use plotters::coord::ranged1d::{KeyPointHint, NoDefaultFormatting, Ranged, ValueFormatter};
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use std::ops::Range;

type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;

/// Size of a chart, and width of the strip for its legend, pixels.
const SIZE: (u32, u32) = (1000, 560);
const LEGEND: u32 = 250;

/// A ground and an ink that read well on pages of either kind.
const GROUND: RGBColor = RGBColor(250, 250, 248);
const INK: RGBColor = RGBColor(40, 40, 40);
const GRID: RGBColor = RGBColor(205, 205, 200);
const FAINT: RGBColor = RGBColor(232, 232, 228);
/// The band behind the front.
const BAND: RGBColor = RGBColor(255, 214, 90);

/// The colour of a curve.
fn colour(curve: usize) -> RGBColor {
    let [r, g, b] = COLOURS[curve % COLOURS.len()];
    RGBColor(r, g, b)
}

/// Corners of the marks, used in turn with the colours, so that 28 curves differ.
const MARKS: [&[(i32, i32)]; 4] = [
    &[(-2, -5), (2, -5), (5, -2), (5, 2), (2, 5), (-2, 5), (-5, 2), (-5, -2)],
    &[(-4, -4), (4, -4), (4, 4), (-4, 4)],
    &[(0, -6), (5, 4), (-5, 4)],
    &[(0, -6), (6, 0), (0, 6), (-6, 0)],
];

/// An error below this is drawn at this.
const LEAST_ERROR: f64 = f64::EPSILON;

/// Draws rows, `front` saying which are on the front.
pub fn svg(chart: &Chart, rows: &[Row], front: &[bool]) -> Result<String, Fault> {
    let mut svg = String::new();
    {
        let area = SVGBackend::with_string(&mut svg, SIZE).into_drawing_area();
        draw(&area, chart, rows, front).map_err(|e| format!("chart {}: {e}", chart.name))?;
    }
    Ok(svg)
}

/// Place of a row on the axes: logarithms of cost and error.
fn place(row: &Row) -> (f64, f64) {
    (row.cost_s.log10(), row.error.max(LEAST_ERROR).log10())
}

fn draw(area: &Area, chart: &Chart, rows: &[Row], front: &[bool]) -> Result<(), Box<dyn std::error::Error>> {
    area.fill(&GROUND)?;
    let names = curves(rows);
    let (plot, legend) = area.split_horizontally(SIZE.0 - LEGEND);
    draw_legend(&legend, &names)?;
    let [x, y] = [
        Axis::new(rows.iter().map(|r| place(r).0)).with_labels(),
        Axis::new(rows.iter().map(|r| place(r).1)).with_labels(),
    ];
    let mut plane = ChartBuilder::on(&plot)
        .caption(chart.title, ("sans-serif", 21).into_font().color(&INK))
        .margin(14)
        .x_label_area_size(50)
        .y_label_area_size(70)
        .build_cartesian_2d(x, y)?;
    plane
        .configure_mesh()
        .x_desc(chart.cost)
        .y_desc(chart.error)
        .axis_desc_style(("sans-serif", 16).into_font().color(&INK))
        .label_style(("sans-serif", 15).into_font().color(&INK))
        .axis_style(INK)
        .bold_line_style(GRID)
        .light_line_style(FAINT)
        .draw()?;

    let mut best: Vec<_> = rows.iter().zip(front).filter(|(_, f)| **f).map(|(r, _)| r).collect();
    best.sort_by(|a, b| a.cost_s.total_cmp(&b.cost_s));
    for case in cases(rows) {
        let line = best.iter().filter(|r| r.case == case).map(|r| place(r));
        plane.draw_series(LineSeries::new(line, BAND.stroke_width(9)))?;
    }
    for (i, name) in names.iter().enumerate() {
        let points: Vec<_> = rows.iter().filter(|r| r.curve == *name).map(place).collect();
        plane.draw_series(LineSeries::new(points.iter().copied(), colour(i).stroke_width(1)))?;
        plane.draw_series(points.into_iter().map(|p| EmptyElement::at(p) + mark(i)))?;
    }
    plane.draw_series(best.iter().map(|r| Circle::new(place(r), 8, INK.stroke_width(2))))?;
    // Below and left of the front there are no points; labels that would cover each other are left out.
    let style = ("sans-serif", 13)
        .into_font()
        .color(&INK)
        .pos(Pos::new(HPos::Right, VPos::Top));
    let mut last = (i32::MIN / 2, 0);
    for row in best {
        let (x, y) = plane.backend_coord(&place(row));
        if x - last.0 > 8 * row.label.len() as i32 || (y - last.1).abs() > 14 {
            area.draw(&Text::new(row.label.clone(), (x - 8, y + 5), style.clone()))?;
            last = (x, y);
        }
    }
    Ok(())
}

/// The mark of a curve, about the origin.
fn mark(curve: usize) -> Polygon<(i32, i32)> {
    Polygon::new(MARKS[curve % MARKS.len()], colour(curve).filled())
}

/// The legend has a strip of its own, where it hides nothing.
fn draw_legend(area: &Area, names: &[&str]) -> Result<(), Box<dyn std::error::Error>> {
    let style = ("sans-serif", 15).into_font().color(&INK);
    let write = |text: &str, y: i32| area.draw(&Text::new(text.to_owned(), (36, y - 7), style.clone()));
    for (i, name) in names.iter().enumerate() {
        let y = 60 + 21 * i as i32;
        area.draw(&PathElement::new(vec![(4, y), (28, y)], colour(i).stroke_width(1)))?;
        area.draw(&(EmptyElement::at((16, y)) + mark(i)))?;
        write(name, y)?;
    }
    let y = 72 + 21 * names.len() as i32;
    area.draw(&PathElement::new(vec![(4, y), (28, y)], BAND.stroke_width(9)))?;
    area.draw(&Circle::new((16, y), 8, INK.stroke_width(2)))?;
    write("Pareto front", y)?;
    Ok(())
}

/// A logarithmic axis: its ends, as logarithms.
struct Axis {
    low: f64,
    high: f64,
}

impl Axis {
    /// An axis about values (logarithms), with two decades marked or more.
    fn new(values: impl Iterator<Item = f64>) -> Self {
        let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
        if low > high {
            return Self { low: 0.0, high: 1.0 };
        }
        let (low, high) = (low - 0.12, high + 0.12);
        if high.floor() - low.ceil() < 1.0 {
            let low = low.floor();
            return Self {
                low,
                high: high.ceil().max(low + 1.0),
            };
        }
        Self { low, high }
    }

    /// Room at the low end for the labels of points.
    fn with_labels(self) -> Self {
        let low = self.low - 0.09 * (self.high - self.low);
        Self { low, ..self }
    }

    /// Powers of ten that have a label: all, or of many every second, third and so on.
    fn decades(&self) -> Vec<f64> {
        let (first, last) = (self.low.ceil() as i32, self.high.floor() as i32);
        let stride = 1 + (last - first) / 9;
        (first..=last)
            .filter(|k| k.rem_euclid(stride) == 0)
            .map(f64::from)
            .collect()
    }

    /// 2 to 9 times the powers of ten, and powers of ten.
    fn digits(&self) -> Vec<f64> {
        let decades = self.low.floor() as i32..=self.high.ceil() as i32;
        decades
            .flat_map(|k| (1..10).map(move |d| f64::from(k) + f64::from(d).log10()))
            .filter(|v| (self.low..=self.high).contains(v))
            .collect()
    }
}

impl Ranged for Axis {
    type FormatOption = NoDefaultFormatting;
    type ValueType = f64;

    fn map(&self, value: &f64, (first, last): (i32, i32)) -> i32 {
        let part = (value - self.low) / (self.high - self.low);
        first + (part * f64::from(last - first)).round() as i32
    }

    fn key_points<Hint: KeyPointHint>(&self, hint: Hint) -> Vec<f64> {
        if hint.weight().allow_light_points() {
            self.digits()
        } else {
            self.decades()
        }
    }

    fn range(&self) -> Range<f64> {
        self.low..self.high
    }
}

impl ValueFormatter<f64> for Axis {
    fn format_ext(&self, exponent: &f64) -> String {
        power(exponent)
    }
}

/// 10 to the power of `exponent`, as text.
fn power(exponent: &f64) -> String {
    let digit = |c: char| match c {
        '-' => '⁻',
        '1' => '¹',
        '2' => '²',
        '3' => '³',
        '0'..='9' => char::from_u32(0x2070 + c as u32 - '0' as u32).unwrap_or(c),
        _ => c,
    };
    let exponent = exponent.round() as i32;
    format!("10{}", exponent.to_string().chars().map(digit).collect::<String>())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_powers_of_ten() {
        assert_eq!([-12.0, 0.0, 345.0].map(|e| power(&e)), ["10⁻¹²", "10⁰", "10³⁴⁵"]);
    }

    #[test]
    fn an_axis_holds_its_values_and_marks_two_decades() {
        for values in [
            vec![0.3],
            vec![-2.5, -2.4],
            vec![-0.05, 0.05],
            vec![-7.0, 12.0],
            vec![1.0, 2.0],
        ] {
            let axis = Axis::new(values.iter().copied());
            assert!(values.iter().all(|v| (axis.low..=axis.high).contains(v)));
            let ticks = axis.decades();
            assert!((2..=10).contains(&ticks.len()), "{values:?}: {ticks:?}");
            assert!(ticks.iter().all(|t| (axis.low..=axis.high).contains(t)));
        }
    }
}
