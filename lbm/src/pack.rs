//! Finds the places and links of packed nodes.

use crate::links::{Link, Links};
use crate::maker::Maker;
use crate::marks::Marks;
use crate::packed::Packed;

/// Packed nodes while they are found.
pub struct Packing {
    packed: Packed,
    /// Places of the batch that is filled, population by population.
    places: Vec<u32>,
    filled: usize,
}

impl Packing {
    /// No nodes yet.
    pub fn new(maker: &Maker) -> Self {
        let packed = Packed::new(maker.storage);
        Self {
            places: vec![0; maker.storage.velocities().q() * packed.batch()],
            packed,
            filled: 0,
        }
    }

    /// Adds the runs of row (`j`, `k`), from number `first` on.
    pub fn add_row(&mut self, maker: &Maker, [j, k]: [usize; 2], first: usize, links: &mut Links) {
        for run in first..links.runs.len() {
            let nodes = links.run(run);
            self.packed.add_run(nodes.len());
            for x in nodes {
                self.add_node(maker, [x, j, k], links);
            }
        }
    }

    fn add_node(&mut self, maker: &Maker, node: [usize; 3], links: &mut Links) {
        let ([x, j, k], grid) = (node.map(|i| i as isize), maker.surface.grid);
        let (q, batch, arrays) = (
            maker.storage.velocities().q(),
            self.packed.batch(),
            maker.storage.arrays(),
        );
        let number = maker.storage.place(0, x, j, k) as u32;
        for i in 0..q {
            let [cx, cy, cz] = maker.c(i);
            let source = (!maker.mask.is_solid(x - cx, j - cy, k - cz)).then(|| {
                let [sj, sk] = maker.storage.wrapped(j - cy, k - cz);
                let source = (x - cx).rem_euclid(grid.shape[0] as isize);
                maker.storage.place(0, source, sj, sk) as u32
            });
            if source.is_none() {
                let home = arrays[i] + number as usize;
                maker.add_wall(node, i, Link { ghost: home, home }, links);
            }
            self.places[i * batch + self.filled] = Packed::link(maker.storage, i, number, source);
        }
        self.filled += 1;
        if self.filled == batch {
            self.flush();
        }
    }

    fn flush(&mut self) {
        if self.filled > 0 {
            self.packed.add_batch(&self.places, self.filled);
            self.filled = 0;
        }
    }

    /// Takes what was noted of links, of which only a part is kept.
    pub fn finish(mut self, maker: &Maker, links: &mut Links) {
        self.flush();
        let walls = std::mem::take(&mut links.walls);
        let directions = std::mem::take(&mut links.directions);
        let cuts = std::mem::take(&mut links.cuts);
        let pushes = std::mem::take(&mut links.pushes);
        links.fractions = Vec::new();
        self.packed.links = walls.len();
        let walls = walls.iter().map(|l| l.home).zip(directions);
        links.marks = Marks::new(maker.storage, walls, &pushes, &cuts, self.packed.batch());
        self.packed.shrink();
        links.packed = Some(self.packed);
    }
}
