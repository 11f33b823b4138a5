//! The whole state of a fluid as bytes.

use crate::element::{Half, Precision};
use crate::fluid::Fluid;
use lbm_ibm_coupling::FluidError;

/// What a saved state starts with; the last byte is the version of the format.
const MARK: [u8; 8] = *b"lbmfluid";
const VERSION: u64 = 2;

/// Reads from the front of saved bytes.
struct Reader<'a>(&'a [u8]);

impl Reader<'_> {
    fn take<const N: usize>(&mut self) -> Option<[u8; N]> {
        let (first, rest) = self.0.split_first_chunk::<N>()?;
        self.0 = rest;
        Some(*first)
    }

    fn number(&mut self) -> Option<u64> {
        self.take().map(u64::from_le_bytes)
    }

    fn real(&mut self) -> Option<f64> {
        self.take().map(f64::from_le_bytes)
    }

    fn population(&mut self, precision: Precision) -> Option<f64> {
        match precision {
            Precision::F64 => self.real(),
            Precision::F32 => self.take().map(|b| f64::from(f32::from_le_bytes(b))),
            Precision::F16 => self.take().map(|b| f64::from(Half(u16::from_le_bytes(b)).to_f32())),
        }
    }
}

fn misfit(what: impl Into<String>) -> FluidError {
    FluidError::State { what: what.into() }
}

impl Fluid {
    /// What a state has to agree in with the fluid that takes it.
    fn shape_of_state(&self) -> [(&'static str, u64); 9] {
        let [nx, ny, nz] = self.grid.shape.map(|n| n as u64);
        let runs = self.links.runs.iter().flatten().map(|x| u64::from(*x));
        let rows = self.links.rows.iter().flat_map(|r| r.at().map(|n| n as u64));
        let hash = runs.chain(rows).fold(0xcbf2_9ce4_8422_2325_u64, |hash, n| {
            (hash ^ n).wrapping_mul(0x0100_0000_01b3)
        });
        [
            ("format", VERSION),
            ("nodes along x", nx),
            ("nodes along y", ny),
            ("nodes along z", nz),
            ("populations of a node", self.storage.velocities().q() as u64),
            ("bytes of a population", self.storage.precision().bytes() as u64),
            ("links into walls", self.links.wall_links() as u64),
            ("packing of nodes", u64::from(self.storage.is_packed())),
            ("arrangement of fluid nodes", hash),
        ]
    }

    /// Numbers beside the populations.
    fn scalars(&mut self) -> [&mut f64; 12] {
        let [[a, b], [c, d], [e, f]] = &mut self.force;
        let [g, h, i] = &mut self.bodies;
        let [j, k] = &mut self.owed;
        [a, b, c, d, e, f, g, h, i, j, k, &mut self.shrink]
    }

    /// Indices of all populations that a step reads, and of both ends of the links into walls; of packed nodes all that there are.
    fn places_of_state(&self) -> impl Iterator<Item = usize> {
        let nodes = (0..self.links.runs.len()).flat_map(|run| self.links.run(run).map(move |x| (run, x)));
        let (q, arrays) = (self.storage.velocities().q(), self.storage.arrays());
        let place = move |run: usize, i: usize, x: usize| match &self.links.packed {
            Some(packed) => arrays[i] + packed.starts[run] as usize + (x - self.links.run(run).start),
            None => self.incoming(run, i, x),
        };
        let populations = nodes.flat_map(move |(run, x)| (0..q).map(move |i| place(run, i, x)));
        populations.chain(self.links.walls.iter().flat_map(|link| [link.ghost, link.home]))
    }

    /// The state as bytes, for [`Fluid::restore_state`].
    pub(crate) fn state(&self) -> Vec<u8> {
        let precision = self.storage.precision();
        let mut bytes = MARK.to_vec();
        let mut add = |more: &[u8]| bytes.extend_from_slice(more);
        for (_, number) in self.shape_of_state() {
            add(&number.to_le_bytes());
        }
        for number in [
            self.steps,
            u64::from(self.odd),
            u64::from(self.at_rest),
            u64::from(self.flow.is_some()),
        ] {
            add(&number.to_le_bytes());
        }
        let scalars = self
            .force
            .iter()
            .flatten()
            .chain(&self.bodies)
            .chain(&self.owed)
            .chain([&self.shrink]);
        let flow = self.flow.unwrap_or_default();
        let exchanged = self.exchanged.iter().flatten().flatten();
        for number in scalars.chain(&flow).chain(exchanged).chain(&self.more) {
            add(&number.to_le_bytes());
        }
        for index in self.places_of_state() {
            let value = self.storage.get(index);
            match precision {
                Precision::F64 => add(&value.to_le_bytes()),
                Precision::F32 => add(&(value as f32).to_le_bytes()),
                Precision::F16 => add(&Half::from_f32(value as f32).0.to_le_bytes()),
            }
        }
        bytes
    }

    /// Takes a state of [`Fluid::state`].
    pub(crate) fn restore_state(&mut self, bytes: &[u8]) -> Result<(), FluidError> {
        let mut reader = Reader(bytes);
        if reader.take() != Some(MARK) {
            return Err(misfit("it is not the state of such a fluid"));
        }
        for (name, expected) in self.shape_of_state() {
            match reader.number() {
                Some(found) if found == expected => {}
                found => return Err(misfit(format!("its {name}: {found:?}, this fluid's: {expected}"))),
            }
        }
        let populations = self.links.walls.len() * 2 + self.mask.fluid_nodes * self.storage.velocities().q();
        let length =
            populations * self.storage.precision().bytes() + (19 + 4 * self.exchanged.len() + self.more.len()) * 8;
        if reader.0.len() != length {
            return Err(misfit(format!(
                "it has {} bytes too few or too many",
                reader.0.len().abs_diff(length)
            )));
        }
        let short = || misfit("it ends early");
        self.steps = reader.number().ok_or_else(short)?;
        self.odd = reader.number().ok_or_else(short)? != 0;
        self.at_rest = reader.number().ok_or_else(short)? != 0;
        let flows = reader.number().ok_or_else(short)? != 0;
        for scalar in self.scalars() {
            *scalar = reader.real().ok_or_else(short)?;
        }
        let mut flow = [0.0; 3];
        let exchanged = self.exchanged.iter_mut().flatten().flatten();
        for number in flow.iter_mut().chain(exchanged).chain(&mut self.more) {
            *number = reader.real().ok_or_else(short)?;
        }
        self.flow = flows.then_some(flow);
        let precision = self.storage.precision();
        self.storage.clear();
        for index in self.places_of_state() {
            let value = reader.population(precision).ok_or_else(short)?;
            // SAFETY: the index is that of a place in use, and `self` is exclusive.
            unsafe { self.storage.write(index, value) };
        }
        Ok(())
    }
}
