use nalgebra::{DMatrix, Vector2, Vector3};

use super::*;
use crate::geometry::shapes::{grid, joined, moved, pseudo_random};
use crate::scene::{Creases, Film};

/// A film thick enough that its bending shows.
const FILM: Film = Film { compression: 1.0, thickness: 1e-3, ..Film::PAPER_ELASTIC };

fn bending(shell: &Shell, held: impl Fn(u32) -> bool) -> Bending {
    let model = FilmModel::of_shell(&FILM, shell).expect("a film");
    Bending::new(&FILM, &model, shell, InstructionSet::detect(), held)
}

/// A sheet of irregular elements, and positions in which some of its edges are folded beyond the smooth turns.
fn crumpled() -> (Shell, Field) {
    let flat = grid(4, 3, 0.4, 0.3);
    let random = pseudo_random(flat.positions.len(), 5);
    let plane: Vec<Vector2<f64>> =
        flat.positions.iter().zip(&random).map(|(x, r)| x.xy() + 0.02 * r.xy()).collect();
    let mut shell = moved(flat, |x| x);
    for (position, x) in shell.positions.iter_mut().zip(&plane) {
        *position = Vector3::new(x.x, x.y, 0.0);
    }
    shell.reference = shell.triangles.iter().map(|t| t.map(|node| plane[node as usize])).collect();
    let folded = |(x, r): (&Vector3<f64>, &Vector3<f64>)| {
        let along = if x.x > 0.2 { 0.4 - x.x } else { x.x };
        Vector3::new(along, x.y, 0.3 * (x.x - 0.2).abs()) + 0.015 * r
    };
    let positions = shell.positions.iter().zip(&random).map(folded).collect::<Vec<_>>();
    let positions = Field::of(&positions);
    (shell, positions)
}

fn forces(bending: &Bending, positions: &Field, yielded: &[f64]) -> Field {
    let mut forces = Field::zeros(positions.len());
    bending.add_forces(positions, yielded, &mut forces);
    forces
}

#[test]
fn forces_are_minus_the_gradient_of_the_energy_and_move_no_free_body() {
    let (shell, positions) = crumpled();
    for held in [|_: u32| false, |node: u32| node.is_multiple_of(5) || node < 2] {
        let bending = bending(&shell, held);
        let forces = forces(&bending, &positions, &[]);
        let largest = forces.iter().map(|f| f.norm()).fold(0.0, f64::max);
        let turns = |lanes: &Scratch| lanes.turns.iter().fold(0.0_f64, |m, u| m.max(u.abs()));
        let (scratch, _) = bending.moments(&positions, &[]);
        assert!(turns(&scratch) > hinges::largest_slope(), "no edge is folded");
        drop(scratch);
        let step = 1e-6;
        for node in 0..positions.len() {
            for axis in 0..3 {
                let at = |sign: f64| {
                    let mut moved = positions.clone();
                    moved.set(node, positions.get(node) + Vector3::ith(axis, sign * step));
                    bending.energy(&moved, &[])
                };
                let slope = (at(1.0) - at(-1.0)) / (2.0 * step);
                let error = (forces.get(node)[axis] + slope).abs();
                assert!(error < 1e-6 * largest, "node {node}: {error} of {largest}");
            }
        }
        let total: Vector3<f64> = forces.iter().sum();
        let moment: Vector3<f64> =
            positions.iter().zip(forces.iter()).map(|(x, f)| x.cross(&f)).sum();
        assert!(total.norm() < 1e-12 * largest && moment.norm() < 1e-12 * largest);
    }
}

#[test]
fn every_instruction_set_gives_the_same_bits() {
    let (shell, positions) = crumpled();
    let model = FilmModel::of_shell(&FILM, &shell).expect("a film");
    let all = InstructionSet::ALL.into_iter().filter(|set| set.available());
    let of = |set| forces(&Bending::new(&FILM, &model, &shell, set, |_| false), &positions, &[]);
    let found: Vec<Field> = all.map(of).collect();
    assert!(found.windows(2).all(|pair| pair[0] == pair[1]));
}

/// Sheets bent to w = ½ (a x² + b y²) + c x y, whose outer elements are not counted: their edges are free.
#[test]
fn a_constant_curvature_has_the_energy_of_the_plate() {
    let (columns, size) = (16, 1.0);
    let shell = grid(columns, columns, size, size);
    for [a, b, c] in [[1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, -0.5, 0.3]] {
        let small = 1e-4;
        let w = |x: Vector3<f64>| small * (0.5 * (a * x.x * x.x + b * x.y * x.y) + c * x.x * x.y);
        let positions: Vec<_> =
            shell.positions.iter().map(|x| Vector3::new(x.x, x.y, w(*x))).collect();
        let bending = bending(&shell, |_| false);
        let nu = FILM.poisson_ratio;
        let curvature = a * a + b * b + 2.0 * nu * a * b + 2.0 * (1.0 - nu) * c * c;
        let exact = 0.5 * FILM.bending_stiffness() * small * small * curvature;
        let ratio = bending.energy(&Field::of(&positions), &[]) / exact;
        // A free edge has no moment, though its nodes are on the surface: the outer elements relax.
        assert!(
            ratio < 1.0 + 1e-6 && ratio > 1.0 - 4.0 / f64::from(columns),
            "{a} {b} {c}: {ratio}"
        );
    }
}

#[test]
fn a_fold_line_and_separate_pieces_carry_no_moment() {
    let sheet = grid(2, 1, 0.2, 0.1);
    let middle: Vec<u32> = (0_u32..)
        .zip(&sheet.positions)
        .filter(|(_, x)| (x.x - 0.1).abs() < 1e-9)
        .map(|(n, _)| n)
        .collect();
    let folded = Shell { folds: vec![[middle[0], middle[1]]], ..joined(&[sheet]) };
    let bent = moved(folded.clone(), |x| Vector3::new(x.x.min(0.1), x.y, (x.x - 0.1).max(0.0)));
    let energy = |shell: &Shell| bending(shell, |_| false).energy(&Field::of(&bent.positions), &[]);
    assert!(energy(&folded).abs() < 1e-15);
    assert!(energy(&Shell { folds: Vec::new(), ..folded.clone() }) > 1e-3);
}

#[test]
fn a_curved_shell_is_free_of_moments_at_the_start() {
    let sphere = crate::geometry::shapes::icosphere(1, 0.3);
    let positions = Field::of(&sphere.positions);
    let bending = bending(&sphere, |_| false);
    assert!(bending.energy(&positions, &[]).abs() < 1e-20);
    assert!(forces(&bending, &positions, &[]).iter().all(|f| f.norm() < 1e-9));
}

/// K at these positions, and the sum of the patches.
fn stiffness(bending: &Bending, positions: &Field, yielded: &[f64]) -> [DMatrix<f64>; 2] {
    let count = 3 * positions.len();
    let nodes = bending.patches();
    let mut patches = vec![DMatrix::zeros(12, 12); nodes.len()];
    bending.stiffness(positions, yielded, &mut patches);
    let mut sum = DMatrix::zeros(count, count);
    for (nodes, patch) in nodes.iter().zip(&patches) {
        for (i, j) in (0..144).map(|index| (index / 12, index % 12)) {
            let at = |k: usize| 3 * nodes[k / 3] as usize + k % 3;
            sum[(at(i), at(j))] += patch[(i, j)];
        }
    }
    let prepared = Prepared { positions, patches: &patches };
    let mut exact = DMatrix::zeros(count, count);
    for column in 0..count {
        let mut unit = Field::zeros(positions.len());
        unit.set(column / 3, Vector3::ith(column % 3, 1.0));
        let mut product = Field::zeros(positions.len());
        bending.add_product(&prepared, &unit, &mut product);
        for row in 0..count {
            exact[(row, column)] = product.get(row / 3)[row % 3];
        }
    }
    [exact, sum]
}

#[test]
fn the_stiffness_is_the_change_of_the_forces() {
    let (shell, positions) = crumpled();
    let bending = bending(&shell, |_| false);
    let yielded: Vec<f64> =
        pseudo_random(bending.hinges.len(), 3).iter().map(|random| 0.3 * random.x).collect();
    let [exact, _] = stiffness(&bending, &positions, &yielded);
    let step = 1e-6;
    for column in 0..exact.ncols() {
        let (node, axis) = (column / 3, column % 3);
        let at = |sign: f64| {
            let mut moved = positions.clone();
            moved.set(node, positions.get(node) + Vector3::ith(axis, sign * step));
            forces(&bending, &moved, &yielded)
        };
        let (above, below) = (at(1.0), at(-1.0));
        for row in 0..exact.nrows() {
            let change = (above.get(row / 3)[row % 3] - below.get(row / 3)[row % 3]) / (2.0 * step);
            let error = (exact[(row, column)] + change).abs();
            assert!(error < 1e-5 * exact.amax(), "{row} {column}: {error} of {}", exact.amax());
        }
    }
}

#[test]
fn the_patches_bound_the_stiffness_of_flat_film_and_the_frequency_that_of_any() {
    let (shell, folded) = crumpled();
    let model = FilmModel::of_shell(&FILM, &shell).expect("a film");
    let bending = bending(&shell, |_| false);
    let flat = Field::of(&shell.positions);
    let [exact, patches] = stiffness(&bending, &flat, &[]);
    assert!((&exact - exact.transpose()).amax() < 1e-9 * exact.amax());
    assert!(exact.clone().symmetric_eigenvalues().min() > -1e-9 * exact.amax());
    assert!((patches - &exact).symmetric_eigenvalues().min() > -1e-9 * exact.amax());
    let allowed = bending.frequency_squared(&model.mass);
    for positions in [&flat, &folded] {
        let [exact, _] = stiffness(&bending, positions, &[]);
        let root = |k: usize| model.mass[k / 3].sqrt();
        let scaled = DMatrix::from_fn(exact.nrows(), exact.ncols(), |i, j| {
            exact[(i, j)] / (root(i) * root(j))
        });
        let largest = scaled.symmetric_eigenvalues().max();
        assert!(largest <= allowed && largest > 1e-3 * allowed, "{largest} {allowed}");
    }
}

/// Two triangles with this angle between them at their common edge of 0.3 m; the last node is 0.2 m from it.
fn fold(angle: f64) -> Vec<Vector3<f64>> {
    let (sin, cos) = libm::sincos(angle);
    let last = [-0.2 * cos, 0.1, 0.2 * sin];
    [[0.0, 0.0, 0.0], [0.0, 0.3, 0.0], [0.2, 0.1, 0.0], last].map(Vector3::from).to_vec()
}

/// Those triangles with a crease at their edge.
fn creased() -> Shell {
    let start = Shell::relaxed(fold(1.2), vec![[0, 2, 1], [0, 1, 3]]);
    Shell { folds: vec![[0, 1]], ..start }
}

/// Crease and film bend in series.
#[test]
fn a_crease_is_a_hinge_about_its_rest_angle() {
    let shell = creased();
    // Moment over turn; the last node is 0.2 m from the crease.
    let stiffness = |length_scale: f64, rest_angle: Option<f64>, angle: f64| {
        let film = Film { creases: Some(Creases { length_scale, rest_angle }), ..FILM };
        let model = FilmModel::of_shell(&film, &shell).expect("a film");
        let bending = Bending::new(&film, &model, &shell, InstructionSet::detect(), |_| false);
        let moment =
            |angle: f64| forces(&bending, &Field::of(&fold(angle)), &[]).get(3).norm() * 0.2;
        let rest = rest_angle.unwrap_or(1.2);
        assert!(moment(rest) < 1e-12 * moment(rest + 1.0));
        moment(angle) / (angle - rest).abs()
    };
    for rest_angle in [None, Some(0.5)] {
        for angle in [0.1, 0.8, 2.5, 3.0] {
            let of_crease = |length_scale: f64| FILM.bending_stiffness() / length_scale * 0.3;
            let of_film = stiffness(1e-9, rest_angle, angle);
            for length_scale in [0.02, 0.5, 1e3] {
                let both = 1.0 / (1.0 / of_film + 1.0 / of_crease(length_scale));
                let found = stiffness(length_scale, rest_angle, angle);
                assert!(
                    (found / both - 1.0).abs() < 1e-6,
                    "{length_scale} {angle}: {found} {both}"
                );
            }
        }
    }
}

/// Beyond the yield moment the moment stays, and its work is lost; back and forth as in a frictional joint.
#[test]
fn a_crease_yields_and_springs_back() {
    let (shell, largest) = (creased(), 0.01);
    let creases = Some(Creases { length_scale: 1.0, rest_angle: None });
    let film = Film { creases, yield_moment: Some(largest / 0.3), ..FILM };
    let model = FilmModel::of_shell(&film, &shell).expect("a film");
    let bending = Bending::new(&film, &model, &shell, InstructionSet::detect(), |_| false);
    let mut yielded = vec![0.0; bending.yield_values()];
    let elastic = |bending: &Bending, angle: f64, yielded: &[f64]| {
        bending.moments(&Field::of(&fold(angle)), yielded).1[0]
    };
    let stiffness = elastic(&bending, 1.3, &yielded) / 0.1;
    let limit = largest / stiffness;
    assert!(limit < 0.3, "{limit} rad");
    // To 1.2 + 1 rad, back by 0.8 rad, forth again by 0.1 rad.
    let mut lost = 0.0;
    let mut at = 1.2;
    for (target, expected, work) in [
        (2.2, largest, largest * (1.0 - limit)),
        (1.4, -largest, largest * (0.8 - 2.0 * limit)),
        (1.5, -largest + 0.1 * stiffness, 0.0),
    ] {
        let before = lost;
        let start = at;
        for step in 1..=1000 {
            at = start + (target - start) * f64::from(step) / 1000.0;
            let Yielding { work, released } =
                bending.let_yield(&Field::of(&fold(at)), &mut yielded);
            assert!(work >= 0.0 && released >= work);
            lost += work;
        }
        let moment = elastic(&bending, at, &yielded);
        assert!((moment - expected).abs() < 0.011 * largest, "{target}: {moment} of {expected}");
        assert!(
            (lost - before - work).abs() < 0.011 * largest,
            "{target}: {} of {work}",
            lost - before
        );
    }
}

/// The stiffer a crease is against the film beside it, the more rounds it needs.
#[test]
fn a_stiff_crease_yields_within_the_rounds() {
    let shell = creased();
    // A twentieth of the height of the elements.
    let creases = Some(Creases { length_scale: 0.01, rest_angle: None });
    let at = Field::of(&fold(2.2));
    let of = |yield_moment: Option<f64>| {
        let film = Film { creases, yield_moment, ..FILM };
        let model = FilmModel::of_shell(&film, &shell).expect("a film");
        let bending = Bending::new(&film, &model, &shell, InstructionSet::detect(), |_| false);
        let mut yielded = vec![0.0; bending.yield_values()];
        bending.let_yield(&at, &mut yielded);
        bending.moments(&at, &yielded).1[0]
    };
    let elastic = of(None);
    let ratio = of(Some(0.5 * elastic / 0.3)) / (0.5 * elastic);
    assert!((1.0..1.0 + MAX_EXCESS).contains(&ratio), "{ratio}");
}

#[test]
fn no_edge_of_yielding_film_bears_more_than_its_yield_moment() {
    let (shell, positions) = crumpled();
    let model = FilmModel::of_shell(&FILM, &shell).expect("a film");
    let set = InstructionSet::detect();
    let elastic = Bending::new(&FILM, &model, &shell, set, |_| false);
    let moments = elastic.moments(&positions, &[]).1;
    let unyielded = elastic.energy(&positions, &[]);
    let over_length = |moments: &[f64]| {
        let all = moments.iter().zip(&elastic.hinges.lengths);
        all.fold(0.0_f64, |most, (moment, length)| most.max(moment.abs() / length))
    };
    for factor in [0.1, 0.5, 0.9, 1.1] {
        let largest = factor * over_length(&moments);
        let film = Film { yield_moment: Some(largest), ..FILM };
        let bending = Bending::new(&film, &model, &shell, set, |_| false);
        let mut yielded = vec![0.0; bending.yield_values()];
        let Yielding { work, released } = bending.let_yield(&positions, &mut yielded);
        let after = over_length(&bending.moments(&positions, &yielded).1);
        assert!(after < 1.011 * largest, "{factor}: {after} of {largest}");
        assert!(released >= work && work >= 0.0 && (work > 0.0) == (factor < 1.0));
        let energy = bending.energy(&positions, &yielded);
        assert!((energy + released - unyielded).abs() < 1e-9 * unyielded);
    }
}
