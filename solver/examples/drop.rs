use billow_solver::contact::topology::Topology;
use billow_solver::contact::{self, *};
use billow_solver::course::Phase;
use billow_solver::film_scene::*;
use billow_solver::fold::*;
use billow_solver::gas::Inflow;
use billow_solver::integrate::explicit::*;
use billow_solver::mesh::*;
use billow_solver::scene::*;
use billow_solver::shell::*;
use billow_solver::simd::Path;
use billow_solver::state::Field;
use nalgebra::Vector3;
fn main() {
    let a: Vec<String> = std::env::args().collect();
    let n: u32 = a[1].parse().unwrap();
    let c: f64 = a[2].parse().unwrap();
    let end: f64 = a[3].parse().unwrap();
    let with: bool = a[4] == "1";
    let alt = a.get(5).map_or(false, |x| x == "alt");
    let d = FoldDesign {
        fit: Fit::Cone,
        panels: 6,
        storeys: 3,
        bottom_radius: 0.5,
        top_radius: Some(0.365),
        height: Some(1.0),
        half_angle: None,
        alpha1_over_phi: None,
        chirality: if alt { Chirality::Alternate } else { Chirality::Same },
        stowed_height: 0.04,
        subdivisions: n,
        caps: Caps::Polygon,
    };
    let pat = FoldPattern::new(&d).unwrap();
    let mesh = Mesh::new(&pat, n, Shape::Stowed(0.04)).unwrap();
    let film = Film {
        youngs_modulus: 3.45e9,
        poisson_ratio: 0.3,
        density: 1400.0,
        thickness: 25.4e-6,
        compression: c,
        viscosity: 0.1,
        temperature: 293.0,
    };
    let mut ring = mesh.bottom_ring.clone();
    ring.sort();
    let scene = FilmScene {
        shell: Shell::of_mesh(&mesh),
        velocities: vec![],
        film,
        filling: Filling::Gas {
            supply: GasSupply {
                species: Species { gas_constant: 296.803052, cp: 1038.81068 },
                initial_mass: 0.0,
                windows: vec![],
                ambient_pressure: 0.0,
                heat_transfer: HeatTransfer::Coefficient(0.3),
                leak_area: 0.0,
                discharge_coefficient: 0.6,
            },
            initial_temperature: 293.0,
        },
        supports: vec![FilmSupport {
            name: "r".into(),
            nodes: ring,
            hold: Hold::Components([true; 3]),
            motion: None,
        }],
        gravity: Vector3::zeros(),
        release_time: 0.0,
        solver: FilmSolver {
            cfl: 0.45,
            end_time: 1.0,
            statics: false,
            mass_damping: 0.0,
            step_limit: u64::MAX,
            path: Path::best(),
        },
        outputs: FilmOutputs { sample_interval: 1.0, nodes: vec![], elements: vec![] },
    };
    let (model, mut setting, gas) =
        billow_solver::ladder::film::capsule::constants(&scene).unwrap();
    let places = Field::of(&mesh.positions);
    let topo = Topology::new(places.len(), &mesh.triangles);
    let mean = topo
        .edges
        .iter()
        .map(|e| (mesh.positions[e[0] as usize] - mesh.positions[e[1] as usize]).norm())
        .sum::<f64>()
        / topo.edges.len() as f64;
    let mut law = Law::new(topo.clone(), 1e-9, model.largest_frequency(), mean);
    let mut hist: Vec<f64> = vec![];
    let mut low = [f64::MAX; 2];
    law.pairs_within(&places, mean * 0.1, |p, g| {
        let k = if p.kind == Kind::NodeTriangle { 0 } else { 1 };
        low[k] = low[k].min(g);
        hist.push(g)
    });
    println!(
        "mean edge {:.4} smallest gaps NT {:.3e} EE {:.3e} pairs within {}: {}",
        mean,
        low[0],
        low[1],
        mean * 0.1,
        hist.len()
    );
    law = Law::new(topo.clone(), 0.4 * low[0].max(1e-6), model.largest_frequency(), mean);
    println!("distance {:.3e}", law.distance);
    if with {
        setting.contact = Some(law);
    }
    let v0 = Field::zeros(places.len());
    let mut law2 = setting.contact.clone();
    if let Some(l) = &mut law2 {
        if std::env::var("NOEDGE").is_ok() {
            l.edges = false;
        }
        if let Ok(b) = std::env::var("BOUNDS") {
            l.bounds = b.parse().unwrap();
        }
        if let Ok(b) = std::env::var("DIST") {
            l.distance *= b.parse::<f64>().unwrap();
        }
    }
    setting.contact = law2;
    let mut f = Explicit::new(model, setting, places.clone(), v0, gas);
    if with {
        use billow_solver::audit::passages::*;
        f.watch = Some(Watch::new(
            if n < 3 { Watchfulness::EVERY_STEP } else { Watchfulness::FRAMES },
            &places,
        ));
    }
    let p = Phase { packed: false, inflow: Inflow { mass: 5e-3, mass_temperature: 5e-3 * 293.0 } };
    let t = std::time::Instant::now();
    let e0 = f.ledger();
    let mut next = 0.0;
    let dtout = std::env::var("DT").map_or(end / 30.0, |x| x.parse().unwrap());
    while next < end {
        next += dtout;
        let on = std::env::var("BURST").is_err() || next <= 0.0100001;
        let p = if on { p } else { Phase::default() };
        if let Err(e) = f.advance(next, &p) {
            println!("{e:?}");
            break;
        }
        let l = f.ledger();
        let x = contact::intersections::intersections(&topo, &f.state.places).len();
        let m = &f.state.meeting;
        let ce: f64 = m.contacts.iter().map(|c| c.energy).sum();
        println!(
            "t {:.4} z {:.4} vz {:.2} V {:.4} p {:.1} ke {:.3} visc {:.3} se {:.3} gasw {:.3} cont {:.4} (E {:.4}) taken {:.2e} def {:.2e} | X {} near {} cont {} srch {} imp {} gap {:.1e} steps {} {:.0} ns",
            f.state.time,
            f.state.places.z[mesh.top_centre as usize],
            f.velocities().z[mesh.top_centre as usize],
            f.state.volume,
            f.state.pressure,
            l.kinetic,
            l.viscous_work,
            l.strain,
            l.gas_work,
            l.contact,
            ce,
            m.taken,
            l.defect(&e0),
            x,
            m.near.len(),
            m.contacts.len(),
            m.searches,
            m.impulses,
            m.smallest_gap,
            f.state.steps,
            t.elapsed().as_secs_f64() * 1e9 / f.state.steps as f64 / mesh.triangles.len() as f64
        );
    }
}
