//! Markers of bodies that are stretched.

use super::{DeltaExchange, part};
use crate::subdivision::{longest, longest_edge};
use crate::surface::{Markers, parts};
use lbm_ibm_coupling::{ExchangeError, Soa3Ref};

impl DeltaExchange {
    /// Divides stretched bodies more finely.
    pub(super) fn close_gaps(&mut self, x: Soa3Ref<'_>, spacing: f64) -> Result<(), ExchangeError> {
        let Markers::Surface { max_gap, max_division } = self.markers else {
            return Ok(());
        };
        let mut changed = false;
        let mut gap = Ok(());
        for s in self.surfaces.iter_mut().filter(|s| !s.edges.is_empty()) {
            let longest = longest(part(x, &s.range), &s.edges);
            let allowed = max_gap * spacing;
            if longest > allowed * s.division as f64 {
                let division = parts(longest, 0.9 * allowed, max_division.max(s.division));
                if division > s.division {
                    s.divide(division);
                    changed = true;
                }
            }
            let gap_in_cells = longest / (spacing * s.division as f64);
            let limit = 1.2 * max_gap;
            if gap_in_cells > limit && gap.is_ok() {
                gap = Err(ExchangeError::MarkerGap {
                    body: s.id,
                    triangle: longest_edge(part(x, &s.range), &s.edges).1,
                    gap_in_cells,
                    limit,
                });
            }
        }
        self.table_is_old |= changed;
        gap
    }
}
