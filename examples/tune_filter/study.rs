//! Cells against the row at every bias field, and what happens when the magnets are switched off.

use crate::chains::{self, Row};
use crate::flow::{Beads, End, Moment, Run};
use crate::options::Options;
use crate::subject::Fate;
use lbm_ibm::coupling::{MS, Soa3, UM};
use serde::Serialize;
use std::error::Error;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;

/// A bias field, its gap, and how the cells fared, in SI.
#[derive(Clone, Debug, Serialize)]
pub struct Point {
    /// Bias field, T.
    pub bias: f64,
    /// Gap of the row, m.
    pub gap: f64,
    /// How each cell fared.
    pub ends: Vec<End>,
    /// Greatest pressure drop over the channel once the flow has developed, Pa.
    pub pressure_drop: f64,
    /// Wall-clock time, s.
    #[serde(skip)]
    pub seconds: f64,
    /// The row, and the cells' nodes at the end (m).
    #[serde(skip)]
    end: (Row, Vec<Option<Soa3>>),
}

/// The fields that separate the cells, T.
#[derive(Clone, Debug, Serialize)]
pub struct Window {
    /// Least field tried at which the red cell passes and the tumour cell does not within the time.
    pub least: f64,
    /// Greatest field tried of which the same holds.
    pub most: f64,
    /// Least field tried above it at which the tumour cell passes, if there is one.
    pub passes: Option<f64>,
    /// Field to take: the middle one of those that separate.
    pub bias: f64,
}

/// What became of the tumour cell and the beads after the magnets were switched off, in SI.
#[derive(Clone, Debug, Serialize)]
pub struct Released {
    /// Bias field before, T.
    pub bias: f64,
    /// Time since, s.
    pub time: f64,
    /// Middle of the tumour cell along the flow from the row's middle then, m.
    pub cell: f64,
    /// Greatest displacement of a bead, m.
    pub beads: f64,
    /// All moments, the coupled ones before included.
    pub moments: Vec<Moment>,
}

impl Point {
    /// How a cell fared.
    pub fn fate(&self, cell: &str) -> Fate {
        let end = self.ends.iter().find(|e| e.cell == cell);
        end.map_or(Fate::Undecided, |e| e.fate)
    }

    /// The red cell has passed and the tumour cell has not, held or still on its way.
    fn separates(&self) -> bool {
        self.fate("rbc") == Fate::Pass && self.fate("ctc") != Fate::Pass
    }
}

/// All bias fields, as many at a time as there are threads; the results are in the order of the fields.
pub fn run_all(options: &Options) -> Result<Vec<Point>, Box<dyn Error>> {
    let threads = options.thread_count();
    let workers = threads.min(options.bias.len()).max(1);
    let next = AtomicUsize::new(0);
    let done: Vec<Mutex<Option<Point>>> = options.bias.iter().map(|_| Mutex::new(None)).collect();
    let work = || -> Result<(), String> {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads / workers).build();
        let pool = pool.map_err(|e| e.to_string())?;
        loop {
            let i = next.fetch_add(1, Ordering::Relaxed);
            let Some(ratio) = options.bias.get(i) else {
                return Ok(());
            };
            let bias = ratio * options.device.sheets();
            let point = pool.install(|| at(options, bias).map_err(|e| e.to_string()))?;
            println!(
                "bias {:.1} mT, gap {:.2} um: rbc {:?}, ctc {:?} ({:.0} s)",
                bias * 1e3,
                point.gap / UM,
                point.fate("rbc"),
                point.fate("ctc"),
                point.seconds
            );
            if let Ok(mut slot) = done[i].lock() {
                *slot = Some(point);
            }
        }
    };
    std::thread::scope(|scope| {
        let handles: Vec<_> = (0..workers).map(|_| scope.spawn(work)).collect();
        handles
            .into_iter()
            .try_for_each(|h| h.join().map_err(|_| "a run has panicked".to_owned())?)
    })?;
    Ok(done.into_iter().filter_map(|d| d.into_inner().ok().flatten()).collect())
}

fn at(options: &Options, bias: f64) -> Result<Point, Box<dyn Error>> {
    let clock = Instant::now();
    let row = chains::at_rest(&options.device, bias, 3.0 * UM)?;
    let mut run = Run::new(&options.device, &options.flow, &row, Beads::Frozen, bias)?;
    run.until_settled(options.time * MS, None)?;
    let developed = run.moments.iter().filter(|m| m.time > 10.0 * MS);
    Ok(Point {
        bias,
        gap: row.gap,
        ends: run.ends(),
        pressure_drop: developed.map(|m| m.pressure_drop).fold(0.0, f64::max),
        seconds: clock.elapsed().as_secs_f64(),
        end: (row.clone(), run.cell_positions()?),
    })
}

/// Which of the fields separate the cells; none if none does.
pub fn window(points: &[Point]) -> Option<Window> {
    let mut good: Vec<f64> = points.iter().filter(|p| p.separates()).map(|p| p.bias).collect();
    good.sort_by(f64::total_cmp);
    let (least, most) = (*good.first()?, *good.last()?);
    let passes = points
        .iter()
        .filter(|p| p.bias > most && p.fate("ctc") == Fate::Pass)
        .map(|p| p.bias)
        .reduce(f64::min);
    Some(Window {
        least,
        most,
        passes,
        bias: good[good.len() / 2],
    })
}

/// From where the tumour cell is held at one of the fields, with beads that can move, then without field.
pub fn release(options: &Options, point: &Point) -> Result<Released, Box<dyn Error>> {
    let ((row, cells), bias) = (&point.end, point.bias);
    let mut run = Run::new(&options.device, &options.flow, row, Beads::Coupled, bias)?;
    run.place_cells(cells)?;
    run.until_settled(options.coupled * MS, None)?;
    let off = run.scene().time();
    run.switch_off();
    run.until_settled(options.release * MS, None)?;
    let last = run.moments.last();
    Ok(Released {
        bias,
        time: run.scene().time() - off,
        cell: last.map_or(f64::NAN, |m| m.ctc),
        beads: last.map_or(f64::NAN, |m| m.bend),
        moments: run.moments,
    })
}
