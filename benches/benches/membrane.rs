//! Forces of a stretched red cell of 400 nodes: each law, and the whole cell in both forms.

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use lbm_ibm::coupling::{ImmersedBody, Soa3, Vec3};
use lbm_ibm::membrane::{Form, presets};
use std::time::Duration;

fn forces(c: &mut Criterion) {
    let mut group = c.benchmark_group("membrane forces");
    group
        .sample_size(20)
        .measurement_time(Duration::from_secs(1))
        .warm_up_time(Duration::from_millis(300));
    for (form, name) in [(Form::Paper2011, "2011"), (Form::Corrected, "corrected")] {
        let mut cell = presets::rbc_paper(form).expect("a good cell");
        let stretched = |p: Vec3| Vec3::new(1.2 * p.x, 0.9 * p.y, 0.95 * p.z);
        let x: Soa3 = cell.mesh().nodes().iter().map(stretched).collect();
        let (rest, mut force) = (Soa3::zeros(x.len()), Soa3::zeros(x.len()));
        group.throughput(Throughput::Elements(x.len() as u64));
        for law in cell.laws() {
            let mut law = law.clone();
            group.bench_function(format!("{name}: {}", law.name()), |b| {
                b.iter(|| law.add_forces(x.view(), rest.view(), &mut force.view_mut()));
            });
        }
        group.bench_function(format!("{name}: whole cell"), |b| {
            b.iter(|| cell.add_internal_forces(x.view(), rest.view(), &mut force.view_mut()));
        });
    }
    group.finish();
}

criterion_group!(benches, forces);
criterion_main!(benches);
