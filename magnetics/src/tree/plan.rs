//! Which boxes meet as a whole and which point by point.

use super::boxes::Boxes;

/// For each target box the source boxes that it takes as a whole, and for each target leaf those it takes point by point.
#[derive(Clone, Debug, Default)]
pub(super) struct Plan {
    pub far: Lists,
    pub near: Lists,
}

/// Lists of numbers, one per box.
#[derive(Clone, Debug, Default)]
pub(super) struct Lists {
    start: Vec<u32>,
    entry: Vec<u32>,
}

impl Lists {
    fn new(count: usize, pairs: &[(u32, u32)]) -> Self {
        let mut start = vec![0u32; count + 1];
        for (a, _) in pairs {
            start[*a as usize + 1] += 1;
        }
        for k in 0..count {
            start[k + 1] += start[k];
        }
        let mut next = start.clone();
        let mut entry = vec![0; pairs.len()];
        for (a, b) in pairs {
            let place = &mut next[*a as usize];
            entry[*place as usize] = *b;
            *place += 1;
        }
        Self { start, entry }
    }

    pub fn of(&self, k: usize) -> &[u32] {
        &self.entry[self.start[k] as usize..self.start[k + 1] as usize]
    }
}

impl Plan {
    /// Two boxes meet as a whole where the sum of their radii is at most `opening` of the distance of their centres and no two
    /// of their points are nearer than `near` (m). Whoever is larger is opened first, both where they are equal: so that with
    /// targets and sources exchanged the plan is the same.
    pub fn new(targets: &Boxes, sources: &Boxes, opening: f64, near: f64) -> Self {
        let (mut far, mut close) = (Vec::new(), Vec::new());
        let mut open = Vec::new();
        if !targets.nodes.is_empty() && !sources.nodes.is_empty() {
            open.push((0usize, 0usize));
        }
        while let Some((a, b)) = open.pop() {
            let (t, s) = (&targets.nodes[a], &sources.nodes[b]);
            let distance = (t.centre - s.centre).norm();
            let size = t.radius + s.radius;
            if size <= opening * distance && distance - size > near {
                far.push((a as u32, b as u32));
                continue;
            }
            let split_target = !t.is_leaf() && (s.is_leaf() || t.radius >= s.radius);
            let split_source = !s.is_leaf() && (t.is_leaf() || s.radius >= t.radius);
            match (split_target, split_source) {
                (false, false) => close.push((a as u32, b as u32)),
                (true, false) => open.extend(t.parts.clone().map(|a| (a, b))),
                (false, true) => open.extend(s.parts.clone().map(|b| (a, b))),
                (true, true) => open.extend(t.parts.clone().flat_map(|a| s.parts.clone().map(move |b| (a, b)))),
            }
        }
        Self {
            far: Lists::new(targets.nodes.len(), &far),
            near: Lists::new(targets.nodes.len(), &close),
        }
    }
}
