//! Charts as SVG.

use super::OutputError;
use plotters::coord::Shift;
use plotters::coord::ranged1d::{Ranged, ValueFormatter};
use plotters::prelude::*;
use std::path::Path;

/// How a series is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mark {
    /// A line through the points.
    Line,
    /// Filled circles.
    Point,
    /// Open circles.
    Open,
}

/// Size of a chart and width of the strip for its legend, pixels.
const SIZE: (u32, u32) = (960, 500);
const LEGEND: u32 = 200;

/// Colours (red, green, blue) that are told apart by all eyes (Okabe and Ito 2008) and read well on light ground, to be used
/// in turn: those of the series of a [`Chart`].
pub const COLOURS: [[u8; 3]; 7] = [
    [0, 114, 178],
    [213, 94, 0],
    [0, 158, 115],
    [204, 121, 167],
    [230, 159, 0],
    [86, 180, 233],
    [90, 90, 90],
];

/// The colour of a series.
fn colour(series: usize) -> RGBColor {
    let [r, g, b] = COLOURS[series % COLOURS.len()];
    RGBColor(r, g, b)
}

struct Series {
    label: String,
    mark: Mark,
    points: Vec<(f64, f64)>,
}

struct Bar {
    x: f64,
    lo: f64,
    hi: f64,
}

/// A chart of y against x; linear axes unless asked otherwise.
pub struct Chart {
    title: String,
    x_label: String,
    y_label: String,
    log: bool,
    series: Vec<Series>,
    bars: Vec<Bar>,
}

impl Chart {
    /// An empty chart.
    pub fn new(title: &str, x_label: &str, y_label: &str) -> Self {
        Self {
            title: title.to_owned(),
            x_label: x_label.to_owned(),
            y_label: y_label.to_owned(),
            log: false,
            series: Vec::new(),
            bars: Vec::new(),
        }
    }

    /// Both axes logarithmic.
    pub fn log_log(mut self) -> Self {
        self.log = true;
        self
    }

    /// Adds a series; points that are not finite are left out.
    pub fn series(mut self, label: &str, mark: Mark, points: impl IntoIterator<Item = (f64, f64)>) -> Self {
        self.series.push(Series {
            label: label.to_owned(),
            mark,
            points: points
                .into_iter()
                .filter(|(x, y)| x.is_finite() && y.is_finite())
                .collect(),
        });
        self
    }

    /// Adds error bars (x, lower end, upper end).
    pub fn error_bars(mut self, bars: impl IntoIterator<Item = (f64, f64, f64)>) -> Self {
        self.bars.extend(bars.into_iter().map(|(x, lo, hi)| Bar { x, lo, hi }));
        self
    }

    /// Writes the chart.
    ///
    /// # Errors
    /// [`OutputError`] with the path.
    pub fn write_svg(&self, path: &Path) -> Result<(), OutputError> {
        let mut svg = String::new();
        {
            let area = SVGBackend::with_string(&mut svg, SIZE).into_drawing_area();
            self.draw(&area).map_err(|e| OutputError::at(path, e.to_string()))?;
        }
        std::fs::write(path, svg).map_err(|e| OutputError::at(path, e))
    }

    fn range(&self, of: impl Fn(&(f64, f64)) -> f64, extra: impl Iterator<Item = f64>) -> (f64, f64) {
        let values = self.series.iter().flat_map(|s| &s.points).map(of).chain(extra);
        let (lo, hi) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), v| (lo.min(v), hi.max(v)));
        if lo > hi {
            return (0.0, 1.0);
        }
        if self.log {
            return (lo * 0.7, hi * 1.4);
        }
        let margin = 0.05 * (hi - lo).max(1e-3 * hi.abs().max(1e-300));
        (lo - margin, hi + margin)
    }

    fn draw(&self, area: &DrawingArea<SVGBackend<'_>, Shift>) -> Result<(), Box<dyn std::error::Error>> {
        area.fill(&WHITE)?;
        let (x0, x1) = self.range(|p| p.0, self.bars.iter().map(|b| b.x));
        let (y0, y1) = self.range(|p| p.1, self.bars.iter().flat_map(|b| [b.lo, b.hi]));
        let (plot, legend) = area.split_horizontally(SIZE.0 - LEGEND);
        self.draw_legend(&legend)?;
        let mut builder = ChartBuilder::on(&plot);
        builder
            .caption(&self.title, ("sans-serif", 20))
            .margin(12)
            .x_label_area_size(45)
            .y_label_area_size(75);
        if self.log {
            self.fill(builder.build_cartesian_2d((x0..x1).log_scale(), (y0..y1).log_scale())?)
        } else {
            self.fill(builder.build_cartesian_2d(x0..x1, y0..y1)?)
        }
    }

    fn fill<'a, X, Y>(
        &self,
        mut chart: ChartContext<'a, SVGBackend<'a>, Cartesian2d<X, Y>>,
    ) -> Result<(), Box<dyn std::error::Error>>
    where
        X: Ranged<ValueType = f64> + ValueFormatter<f64>,
        Y: Ranged<ValueType = f64> + ValueFormatter<f64>,
    {
        chart
            .configure_mesh()
            .x_desc(&self.x_label)
            .y_desc(&self.y_label)
            .x_label_formatter(&number)
            .y_label_formatter(&number)
            .light_line_style(WHITE)
            .draw()?;
        chart.draw_series(
            self.bars
                .iter()
                .map(|b| PathElement::new(vec![(b.x, b.lo), (b.x, b.hi)], BLACK.mix(0.4))),
        )?;
        for (i, s) in self.series.iter().enumerate() {
            let colour = colour(i);
            let points = s.points.iter().copied();
            match s.mark {
                Mark::Line => chart.draw_series(LineSeries::new(points, colour.stroke_width(2)))?,
                Mark::Point => chart.draw_series(points.map(|p| Circle::new(p, 4, colour.filled())))?,
                Mark::Open => chart.draw_series(points.map(|p| Circle::new(p, 4, colour.stroke_width(2))))?,
            };
        }
        Ok(())
    }

    /// The legend has a strip of its own, where it hides nothing.
    fn draw_legend(&self, area: &DrawingArea<SVGBackend<'_>, Shift>) -> Result<(), Box<dyn std::error::Error>> {
        for (i, s) in self.series.iter().enumerate() {
            let (y, colour) = (50 + 20 * i as i32, colour(i));
            match s.mark {
                Mark::Line => area.draw(&PathElement::new(vec![(0, y), (16, y)], colour.stroke_width(2)))?,
                Mark::Point => area.draw(&Circle::new((8, y), 4, colour.filled()))?,
                Mark::Open => area.draw(&Circle::new((8, y), 4, colour.stroke_width(2)))?,
            }
            area.draw(&Text::new(s.label.clone(), (24, y - 6), ("sans-serif", 13)))?;
        }
        Ok(())
    }
}

fn number(v: &f64) -> String {
    match v.abs() {
        a if a != 0.0 && !(1e-3..1e5).contains(&a) => format!("{v:.1e}"),
        _ => {
            let text = format!("{v:.4}");
            text.trim_end_matches('0').trim_end_matches('.').to_owned()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_are_short_and_exact() {
        assert_eq!(number(&0.0), "0");
        assert_eq!(number(&12.5), "12.5");
        assert_eq!(number(&2e-6), "2.0e-6");
    }
}
