use nalgebra::Vector2;
use proptest::prelude::*;

use super::*;
use billow_solver::mechanics::forces::membrane::strain;
use billow_solver::mechanics::material::Regime;
use billow_solver::scene::Film;

/// A sheet of 7 × 5 cells less half of one: 48 nodes, 69 elements, one of them alone in its kite,
/// the last block not full.
fn sheet(compression: f64, loss_factor: f64) -> (FilmModel, Vec<Vector3<f64>>) {
    let film = Film { compression, loss_factor, numerical_damping: 0.1, ..Film::PAPER };
    let position = |i: u32, j: u32| Vector2::new(0.1 * f64::from(i), 0.08 * f64::from(j));
    let flat: Vec<_> = (0..6).flat_map(|j| (0..8).map(move |i| position(i, j))).collect();
    let mut triangles = Vec::new();
    for a in (0..35).map(|cell| cell / 7 * 8 + cell % 7) {
        triangles.extend([[a, a + 1, a + 9], [a, a + 9, a + 8]]);
    }
    triangles.truncate(69);
    let reference: Vec<_> =
        triangles.iter().map(|t: &[u32; 3]| t.map(|node| flat[node as usize])).collect();
    let model = FilmModel::new(&film, flat.len(), &triangles, &reference).expect("a film");
    (model, flat.iter().map(|p| Vector3::new(p.x, p.y, 0.3)).collect())
}

/// All values of the nodes and of the first `kites` kites. The reference step does not compute the
/// elements of zero volume that fill the last block.
fn bits(film: &FilmMotion, kites: usize) -> Vec<u64> {
    let FilmMotion { positions, velocities, forces, histories, creep, .. } = film;
    let (films, areas) = (forces.films(), forces.areas());
    let node_fields = [positions, velocities, &films, &areas];
    node_fields
        .into_iter()
        .flat_map(Field::iter)
        .flat_map(|vector| [vector.x, vector.y, vector.z])
        .chain((0..kites).flat_map(|kite| {
            let stored = histories[kite / WIDTH]
                .iter()
                .flat_map(|history| [history.strain, history.stress, history.numerical_stress]);
            let creep = creep.get(kite / WIDTH).into_iter().flatten().map(|creep| creep.0);
            stored.chain(creep).flatten().map(move |lanes| lanes.0[kite % WIDTH])
        }))
        .map(f64::to_bits)
        .collect()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// Sheets with random stretch, shear and velocities: every regime, compression fraction and
    /// instruction set.
    #[test]
    fn vector_step_gives_the_bits_of_the_reference_step(
        offsets in prop::collection::vec(prop::array::uniform6(-1.0..1.0_f64), 48),
        compression in prop::sample::select(vec![0.0, 0.3, 1.0]),
        loss_factor in prop::sample::select(vec![0.0, 0.05]),
        size in prop::sample::select(vec![1e-5, 1e-3, 0.02]),
        stretch in prop::array::uniform2(0.98..1.02_f64),
        held in 0_usize..48,
        (contact_active, gravity) in (any::<bool>(), any::<bool>()),
    ) {
        let (model, flat) = sheet(compression, loss_factor);
        let position = |(x, offset): (&Vector3<f64>, &[f64; 6])| {
            let x = Vector3::new(x.x * stretch[0], x.y * stretch[1], x.z);
            x + Vector3::new(offset[0], offset[1], offset[2]) * size
        };
        let positions: Vec<_> = flat.iter().zip(&offsets).map(position).collect();
        let positions = Field::of(&positions);
        let velocity =
            |offset: &[f64; 6]| Vector3::new(offset[3], offset[4], offset[5]) * 10.0;
        let velocities = Field::of(&offsets.iter().map(velocity).collect::<Vec<_>>());
        let mut free = FreeComponents::all(48);
        free.set(held, Vector3::new(0.0, 1.0, 0.0));
        let length = 1e-7;
        let parameters = KickParameters {
            overpressure: 120.0,
            gravity: Vector3::new(0.0, 1.0, -9.81) * f64::from(u8::from(gravity)),
            weight_factor: 1.0,
            velocity_factor: 0.999,
            acceleration_factor: length,
            contact_active,
        };
        let start = FilmMotion::new(InstructionSet::Scalar, &model, positions, velocities);
        let mut reference = start.clone();
        let expected: Vec<_> = (0..3)
            .map(|_| reference_step(&model, &parameters, &free, length, &mut reference))
            .collect();
        for set in InstructionSet::ALL {
            let mut film = start.clone();
            for (sums, speed) in &expected {
                let (found, found_speed) =
                    vector_step(set, &model, &parameters, &free, length, &mut film);
                prop_assert_eq!(found.six_volumes.to_bits(), sums.six_volumes.to_bits());
                let (found_damping, damping) =
                    (found.numerical_dissipation, sums.numerical_dissipation);
                prop_assert_eq!(found_damping.to_bits(), damping.to_bits());
                prop_assert_eq!(found.material_loss.to_bits(), sums.material_loss.to_bits());
                prop_assert_eq!(found.largest_stress.to_bits(), sums.largest_stress.to_bits());
                prop_assert_eq!(found_speed.to_bits(), speed.to_bits());
            }
            let kites = model.kites.len();
            prop_assert!(bits(&film, kites) == bits(&reference, kites), "{}", set.name());
        }
    }
}

#[test]
fn stretched_sheets_cover_every_regime() {
    let (model, flat) = sheet(0.0, 0.0);
    let regime = |stretch: [f64; 2]| {
        let stretched = |x: &Vector3<f64>| Vector3::new(x.x * stretch[0], x.y * stretch[1], x.z);
        let positions = Field::of(&flat.iter().map(stretched).collect::<Vec<_>>());
        model.material.regime(strain(&model, &positions, 0))
    };
    assert_eq!(regime([1.01, 1.01]), Regime::Taut);
    assert_eq!(regime([1.01, 0.99]), Regime::Wrinkled);
    assert_eq!(regime([0.99, 0.99]), Regime::Slack);
}
