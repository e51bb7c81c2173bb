//! Film that hits film, or is squeezed: no passage. Film that slides on film, or adheres to it.
//!
//! ```text
//! passages at any step = 0     intersections = 0     Σ m v = Σ m v at the start
//! friction:  speed loss = μ g t while it slides
//! adhesion:  the sheets separate above the pull-off pressure
//! ```

use super::prelude::*;

/// Contact distance, m.
const DISTANCE: f64 = 2e-3;
/// The same of friction and adhesion, and initial height of the upper sheet, m.
const NEAR: f64 = 1e-3;

fn damped() -> Film {
    Film { numerical_damping: 0.1, ..Film::PAPER_ELASTIC }
}

/// A sheet and an inclined sheet above it, rotated by a quarter turn, as one shell; and the number of
/// nodes of the lower one.
fn two_films() -> (Shell, usize) {
    let low = sheet(5, 4, 0.5, 0.4);
    let turned = |x: Vector3<f64>| Vector3::new(0.45 - x.y, 0.02 + x.x * 0.9, 0.02 + 0.03 * x.x);
    let high = moved(sheet(5, 4, 0.5, 0.4), turned);
    let nodes = low.positions.len();
    let mut whole = joined(&[low, high.clone()]);
    // The upper sheet is free of stress where it starts.
    let flat = Shell::relaxed(high.positions, high.triangles).reference;
    let first = whole.reference.len() - flat.len();
    whole.reference[first..].copy_from_slice(&flat);
    (whole, nodes)
}

/// Two films that collide: both move, or one is at rest.
pub fn films_at_50_m_s(rig: &Rig) -> Outcome {
    let speed = number("films_at_50_m_s/speed");
    let mut judged = Vec::new();
    for (run, speeds) in
        [("both move: ", [0.5 * speed, -0.5 * speed]), ("one moves: ", [speed, 0.0])]
    {
        let (shell, split) = two_films();
        let nodes = shell.positions.len();
        let velocity = |node: usize| Vector3::z() * speeds[usize::from(node >= split)];
        let scene = FilmScene {
            velocities: (0..nodes).map(velocity).collect(),
            contact: Some(monitored_contact(DISTANCE)),
            ..free_film(shell, damped())
        };
        let mut film = rig.start(&scene)?;
        let momentum = |film: &FilmView<'_>| -> Vector3<f64> {
            let all = film.system.model.mass.iter().zip(film.state.velocities.iter());
            all.map(|(mass, velocity)| velocity * *mass).sum()
        };
        let before = momentum(&film.view());
        let scale: f64 =
            (0..nodes).map(|n| film.view().system.model.mass[n] * velocity(n).norm()).sum();
        let record = run_recorded(&mut film, 4e-3, 40, &Phase::default())?;
        let mean = |from: usize, to: usize| {
            film.view().state.velocities.z[from..to].iter().sum::<f64>() / (to - from) as f64
        };
        let separation_speed = mean(split, nodes) - mean(0, split);
        judged.push(Row::at_least(
            &format!("{run}separation speed after the collision, m/s"),
            separation_speed,
            0.0,
        ));
        judged.push(Row::at_most(
            &format!("{run}change of momentum over sum of m v"),
            (momentum(&film.view()) - before).norm() / scale,
            number("contact/momentum_band"),
        ));
        judged.push(record.unrecovered(run));
        judged.extend(record.rows(run, number("contact/ledger_band")));
    }
    Ok(judged)
}

/// A slack, dented bag with a little gas between plates that close to a tenth of its height, so that
/// its walls fold. The dented shape is half the stress-free size: film with compressive stiffness
/// springs out of it at some hundred m/s. For such film, only passages and intersections are judged.
pub fn squeezed_bag(rig: &Rig, compressions: &[f64]) -> Outcome {
    let (radius, closed) = (0.2, 0.03);
    let share = number("squeezed_bag/height");
    let dented = |x: Vector3<f64>| {
        let dent =
            libm::sin(25.0 * x.x + 1.0) * libm::cos(22.0 * x.y) + 0.5 * libm::sin(31.0 * x.z);
        Vector3::new(0.55 * x.x, 0.55 * x.y, 0.65 * x.z) * (1.0 + 0.08 * dent)
    };
    // The reference of the film is the sphere.
    let shell = moved(icosphere(2, radius), dented);
    let tall = shell.positions.iter().map(|x| x.z.abs()).fold(0.0, f64::max);
    let start = tall + 2.0 * DISTANCE;
    let half = |sign: f64| {
        let up = Vector3::z() * sign;
        plate(up * start, -up, Some((up * (share * tall - start), closed)))
    };
    let height = |film: &FilmView<'_>| {
        let z = || film.state.positions.z.iter().copied();
        z().fold(f64::NEG_INFINITY, f64::max) - z().fold(f64::INFINITY, f64::min)
    };
    let mut judged = Vec::new();
    for &compression in compressions {
        let plates = vec![half(1.0), half(-1.0)];
        let scene = FilmScene {
            filling: nitrogen_filling(2e-7, 293.0),
            contact: Some(FilmContact { plates, ..monitored_contact(DISTANCE) }),
            ..free_film(shell.clone(), Film { compression, ..damped() })
        };
        let mut film = rig.start(&scene)?;
        let whole = height(&film.view());
        let record = run_recorded(&mut film, closed, 60, &Phase::default())?;
        let run = format!("c {compression}: ");
        if compression > 0.0 {
            judged.extend(record.counts(&run));
            continue;
        }
        let squeezed = height(&film.view()) / whole;
        judged.push(Row::at_most(&format!("{run}height over initial height"), squeezed, share));
        judged.extend(record.rows(&run, number("contact/ledger_band")));
    }
    Ok(judged)
}

/// A held sheet and a free one above it; and the first node of the upper one.
fn two_sheets(low: Shell, high: Shell) -> (FilmScene, usize) {
    let nodes = low.positions.len();
    let count = u32::try_from(nodes).expect("under 2^32 nodes");
    let scene = FilmScene {
        supports: vec![held((0..count).collect(), "xyz")],
        ..free_film(joined(&[low, high]), damped())
    };
    (scene, nodes)
}

/// A sheet that slides on another one under its weight.
pub fn friction(rig: &Rig) -> Outcome {
    let (mu, band) = (number("friction/coefficient"), number("friction/band"));
    let (gravity, speed, time) = (9.81, 0.5, 0.06);
    let low = moved(sheet(8, 4, 1.0, 0.4), |x| x - Vector3::new(0.2, 0.05, 0.0));
    let high = moved(sheet(3, 2, 0.2, 0.15), |x| x + Vector3::new(0.0, 0.05, NEAR));
    let (scene, split) = two_sheets(low, high);
    let nodes = scene.shell.positions.len();
    let scene = FilmScene {
        velocities: (0..nodes)
            .map(|n| Vector3::x() * if n < split { 0.0 } else { speed })
            .collect(),
        gravity: Vector3::new(0.0, 0.0, -gravity),
        contact: Some(FilmContact { friction: mu, ..monitored_contact(NEAR) }),
        ..scene
    };
    let mut film = rig.start(&scene)?;
    let record = run_recorded(&mut film, time, 20, &Phase::default())?;
    let sum = |of: &dyn Fn(usize) -> f64| -> f64 { (split..nodes).map(of).sum() };
    let mass = sum(&|node| film.view().system.model.mass[node]);
    let momentum =
        sum(&|node| film.view().system.model.mass[node] * film.view().state.velocities.x[node]);
    let lost = speed - momentum / mass;
    let dissipated = film.view().ledger().contact_dissipation;
    let mut judged = vec![
        Row::new("speed loss, m/s", lost, mu * gravity * time, band),
        Row::at_least("energy dissipated by friction, J", dissipated, 0.0),
    ];
    judged.extend(record.rows("", number("contact/ledger_band")));
    Ok(judged)
}

/// Heights of the lowest and the highest node of the upper sheet, m, after a pull (Pa) against this
/// pull-off pressure (Pa).
fn pulled(rig: &Rig, pull: f64, pressure: f64) -> Result<[f64; 2]> {
    let low = sheet(16, 16, 0.4, 0.4);
    let high = moved(sheet(4, 4, 0.2, 0.2), |x| x + Vector3::new(0.104, 0.109, NEAR));
    let (scene, split) = two_sheets(low, high);
    // The pull is an upward weight per area.
    let density = scene.film.density * scene.film.thickness;
    let mut scene = FilmScene {
        gravity: Vector3::new(0.0, 0.0, pull / density),
        contact: Some(FilmContact {
            adhesion: pressure,
            distance: Some(NEAR),
            ..FilmContact::default()
        }),
        ..scene
    };
    scene.solver.mass_damping = 200.0;
    let mut film = rig.start(&scene)?;
    run_recorded(&mut film, 0.05, 10, &Phase::default())?;
    let heights = &film.view().state.positions.z[split..];
    let lowest = heights.iter().copied().fold(f64::INFINITY, f64::min);
    Ok([lowest, heights.iter().copied().fold(0.0, worse)])
}

/// Adhesive sheets, pulled below and above the pull-off pressure.
pub fn adhesion(rig: &Rig) -> Outcome {
    let [pressure, below, above, parted] =
        entry("adhesion", ["pressure", "below", "above", "parted"]);
    let [_, highest] = pulled(rig, below * pressure, pressure)?;
    let [lowest, _] = pulled(rig, above * pressure, pressure)?;
    Ok(vec![
        Row::at_most(
            &format!("{below} of the pull-off pressure: highest node, m"),
            highest,
            parted,
        ),
        Row::at_least(&format!("{above} of the pull-off pressure: lowest node, m"), lowest, parted),
    ])
}
