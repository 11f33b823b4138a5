//! One thread and more give the same bits.

use lbm_ibm::coupling::Lattice;
use lbm_ibm::lbm::Fluid;
use lbm_ibm_benches::scenes::{crowd, on_threads, slit};

/// Bits of all node positions and velocities, of the fluid's velocity and of what drives it.
fn bits(threads: usize, steps: usize, slit_scene: bool) -> Vec<u64> {
    on_threads(threads, || {
        let mut scene = if slit_scene { slit()? } else { crowd(24, 2)? };
        for _ in 0..steps {
            scene.step()?;
        }
        let (x, v) = (scene.positions(), scene.velocities());
        let mut bits: Vec<u64> = [x.x, x.y, x.z, v.x, v.y, v.z]
            .into_iter()
            .flatten()
            .map(|a| a.to_bits())
            .collect();
        let fluid = scene.fluid_as::<Fluid>().ok_or("the scene has lost its fluid")?;
        let flow = fluid.macroscopic().ok_or("the fluid does not show its velocity")?;
        bits.extend(flow.velocity.iter().flatten().map(|a| a.to_bits()));
        bits.push(fluid.body_force().x.to_bits());
        Ok(bits)
    })
    .expect("a scene that runs")
}

#[test]
fn a_cell_in_a_slit() {
    let one = bits(1, 10, true);
    assert!(one == bits(2, 10, true) && one == bits(3, 10, true));
}

#[test]
fn a_crowd_of_spheres() {
    let one = bits(1, 6, false);
    assert!(one == bits(2, 6, false) && one == bits(3, 6, false));
}
