//! Cells before a row of chains, and how they fare.

use crate::chains::Row;
use crate::device::RADIUS;
use lbm_ibm::coupling::nalgebra::{Isometry3, UnitQuaternion};
use lbm_ibm::coupling::{Scene, SceneError, UM, Vec3, enclosed_volume};
use lbm_ibm::membrane::{Form, presets};
use serde::Serialize;
use std::error::Error;
use std::f64::consts::FRAC_PI_2;

/// How a cell fared.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Fate {
    /// Its rearmost node is one cell radius behind the row.
    Pass,
    /// It stands still in the row, its middle not behind it.
    Held,
    /// Neither within the time.
    Undecided,
}

/// A cell before the row.
pub struct Subject {
    /// ctc or rbc.
    pub name: &'static str,
    /// Radius, m.
    pub radius: f64,
    pub id: u32,
    pub fate: Option<(Fate, f64)>,
    pub touched: Option<f64>,
    /// Time and mean of the nodes.
    pub track: Vec<(f64, Vec3)>,
    /// Greatest relative change of the volume.
    pub drift: f64,
    pub rest_volume: f64,
    pub gone: bool,
    /// It has not been in this run at all.
    pub absent: bool,
}

impl Subject {
    /// Looks where it is; `row` is the row's middle along the flow (m), slower than `slow` (m/s) over twice `entry` (s) is held.
    pub fn look(&mut self, scene: &Scene, row: f64, slow: f64, entry: f64) -> Result<(), SceneError> {
        let x = scene.body_positions(self.id)?;
        let time = scene.time();
        let nose = x.x.iter().copied().fold(f64::NEG_INFINITY, f64::max) - row;
        let tail = x.x.iter().copied().fold(f64::INFINITY, f64::min) - row;
        self.track.push((time, x.mean()));
        let info = scene.bodies().iter().find(|b| b.id == self.id);
        let volume = info.map_or(self.rest_volume, |b| enclosed_volume(x, &b.triangles));
        self.drift = self.drift.max((volume / self.rest_volume - 1.0).abs());
        if self.touched.is_none() && nose >= -RADIUS {
            self.touched = Some(time);
        }
        if self.fate.is_some() {
            return Ok(());
        }
        if tail >= RADIUS + self.radius {
            self.fate = Some((Fate::Pass, time));
        } else if self.touched.is_some_and(|t| time - t > 2.0 * entry)
            && x.mean().x - row < RADIUS
            && self.speed(2.0 * entry).abs() < slow
        {
            self.fate = Some((Fate::Held, time));
        }
        Ok(())
    }

    /// Mean speed along the flow over the last `time`, s.
    pub fn speed(&self, time: f64) -> f64 {
        let Some(&(now, here)) = self.track.last() else {
            return 0.0;
        };
        let then = self.track.iter().rev().find(|(t, _)| *t <= now - time);
        let (t, x) = then.unwrap_or(&self.track[0]);
        if *t < now { (here.x - x.x) / (now - t) } else { 0.0 }
    }
}

/// A tumour cell before the gap on the left, a red cell on edge before the gap on the right.
pub fn cells(scene: &mut Scene, shift: Vec3, row: &Row) -> Result<Vec<Subject>, Box<dyn Error>> {
    let side = 0.5 * (2.0 * RADIUS + row.gap);
    let on_edge = UnitQuaternion::from_scaled_axis(Vec3::x() * FRAC_PI_2);
    let kinds = [
        (
            "ctc",
            0.5 * presets::CTC_DIAMETER,
            presets::ctc_paper(Form::Paper2011Balanced)?,
            side,
            UnitQuaternion::identity(),
        ),
        (
            "rbc",
            4.0 * UM,
            presets::rbc_paper(Form::Paper2011Balanced)?,
            -side,
            on_edge,
        ),
    ];
    let mut subjects = Vec::new();
    for (name, radius, cell, y, turn) in kinds {
        let place = shift + Vec3::new(-RADIUS - radius - 3.0 * UM, y, 0.0);
        let rest_volume = cell.mesh().volume();
        let id = scene.add_body(cell, &Isometry3::from_parts(place.into(), turn))?;
        subjects.push(Subject {
            name,
            radius,
            id,
            fate: None,
            touched: None,
            track: Vec::new(),
            drift: 0.0,
            rest_volume,
            gone: false,
            absent: false,
        });
    }
    Ok(subjects)
}
