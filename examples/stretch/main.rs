mod curve;
mod measured;
mod options;
mod release;
use clap::Parser;
use curve::Pull;
use lbm_ibm::membrane::stretch::Patch;
use options::*;
use release::Release;
fn main() {
    let o = Options::parse();
    let what = std::env::var("WHAT").unwrap_or_default();
    if what == "static" {
        for &s in o.cell.subjects() {
            for &f in &o.form {
                let (ps, fs) = match s {
                    Subject::Rbc => (
                        vec![s.patch()],
                        measured::tweezers().iter().map(|r| r.force).collect::<Vec<_>>(),
                    ),
                    Subject::Ctc => (
                        [0.05, 0.02, 0.1].map(Patch::Fraction).to_vec(),
                        [0.0, 10., 20., 30., 50., 78.75, 105., 150., 200., 250., 333.]
                            .map(|f| f * 1e-12)
                            .to_vec(),
                    ),
                };
                for p in ps {
                    let t = std::time::Instant::now();
                    println!("{s:?} {f:?} {p:?}");
                    let c = Pull {
                        subject: s,
                        form: f,
                        patch: p,
                        forces: fs.clone(),
                    }
                    .curve()
                    .unwrap();
                    for (f, r) in c {
                        match r {
                            Ok(r) => println!(
                                "{:.1} {:.3} {:.3} {:.3} it {} res {:.1e} net {:.1e}",
                                f * 1e12,
                                r.axial * 1e6,
                                r.transverse * 1e6,
                                r.thickness * 1e6,
                                r.iterations,
                                r.residual,
                                r.net_force
                            ),
                            Err(e) => println!("{:.1} {e}", f * 1e12),
                        }
                    }
                    println!("{:.2} s", t.elapsed().as_secs_f64());
                }
            }
        }
    } else {
        for &s in o.cell.subjects() {
            for &f in &o.form {
                let r = Release::new(s, f, &o);
                match r.run(&o.out.join(format!("{}_{}", s.name(), f.name()))) {
                    Ok(d) => {
                        println!("{:#?} {:.1} s n {}", d.recovery, d.seconds, d.moments.len());
                        for m in d.moments.iter().step_by(d.moments.len() / 20 + 1) {
                            println!(
                                "{:.3} ms {:.3} {:.3} {:.3}",
                                m.time * 1e3,
                                m.axial * 1e6,
                                m.transverse * 1e6,
                                m.extension
                            );
                        }
                    }
                    Err(e) => println!("{e}"),
                }
            }
        }
    }
}
