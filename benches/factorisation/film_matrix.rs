//! Matrices that billow factorises, and the same matrices as sparse columns.

use std::collections::BTreeMap;

use billow_solver::factorisation::factor::{Elimination, Factor};
use billow_solver::factorisation::plan::{Plan, plan};
use billow_solver::factorisation::unknowns::Unknowns;
use billow_solver::geometry::field::Field;
use billow_solver::geometry::mesh::Shape;
use billow_solver::geometry::shapes::pseudo_random;
use billow_solver::mechanics::film_model::FilmModel;
use billow_solver::mechanics::forces::tangent::{self, Stiffness};
use billow_solver::mechanics::supports::Supports;
use billow_solver::models::film::capsule::film_scene;
use billow_solver::models::film::erected;
use billow_solver::platform::simd::InstructionSet;
use billow_solver::scene::paper;

/// Overpressure of the erected capsule, Pa.
const PRESSURE: f64 = 100.0;
/// Step of the implicit matrix, s.
const STEP: f64 = 1e-3;

/// Where an entry of a face's stiffness is added: place among the values, face, row, column.
type Share = (u32, u32, u8, u8);

/// Size of a factor.
pub struct Fill {
    /// Entries on and below the diagonal.
    pub entries: usize,
    /// Stored values.
    pub stored: usize,
}

/// The matrix of a film: face by face for billow, lower triangle column by column for others.
pub struct FilmMatrix {
    elimination: Elimination,
    factor: Factor,
    plans: Vec<Plan>,
    stiffness: Vec<Stiffness>,
    shift: Vec<f64>,
    /// First entry of each column.
    pub columns: Vec<usize>,
    /// Row of each entry.
    pub rows: Vec<usize>,
    shares: Vec<Share>,
    diagonal: Vec<usize>,
}

impl FilmMatrix {
    /// The matrix of a static equilibrium: the shift grows until it is positive definite.
    pub fn statics(subdivisions: u32) -> Self {
        let scene = paper::capsule(subdivisions, 1.0);
        let mut capsule = erected(InstructionSet::detect(), &scene).expect("a capsule");
        let state = capsule.settle(PRESSURE).expect("an equilibrium");
        let omega = capsule.model.largest_frequency();
        Self::at(
            &capsule.model,
            &capsule.supports,
            &state.positions,
            PRESSURE,
            1e-12 * omega * omega,
        )
    }

    /// The matrix of an implicit step of packed film.
    pub fn implicit(subdivisions: u32) -> Self {
        let scene = paper::capsule(subdivisions, 1.0);
        let shape = Shape::Stowed(scene.design.stowed_height);
        let (film, _) =
            film_scene(InstructionSet::detect(), &scene, shape, 1.0).expect("a capsule");
        let model = FilmModel::of_shell(&film.film.elastic(), &film.shell).expect("a film");
        let positions = Field::of(&film.shell.positions);
        let supports = Supports::new(&film.supports, &positions);
        // BDF2 with equal steps.
        let weight = 1.5 / STEP * (1.5 / STEP);
        Self::at(&model, &supports, &positions, PRESSURE, weight)
    }

    /// K + w M, w in 1/s² from `weight` on in powers of ten until the matrix is positive definite.
    fn at(
        model: &FilmModel,
        supports: &Supports,
        positions: &Field,
        pressure: f64,
        weight: f64,
    ) -> Self {
        let unknowns = Unknowns::new(model, supports);
        let faces = (0..model.elements()).map(|element| {
            let mut stiffness = tangent::elastic(model, positions, element);
            tangent::add_pressure(&mut stiffness, model.triangles[element], positions, pressure);
            stiffness
        });
        let mut matrix = Self {
            elimination: Elimination::new(model, &unknowns, positions),
            factor: Factor::default(),
            plans: plan(model, &unknowns, positions),
            stiffness: faces.collect(),
            shift: Vec::new(),
            columns: Vec::new(),
            rows: Vec::new(),
            shares: Vec::new(),
            diagonal: Vec::new(),
        };
        matrix.list_entries(model, &unknowns);
        for power in 0..20 {
            let weight = weight * f64::powi(10.0, power);
            matrix.shift = unknowns.mass.iter().map(|mass| weight * mass).collect();
            if matrix.factor(InstructionSet::detect()) {
                println!("weight of the mass {weight:.3e} 1/s^2");
                return matrix;
            }
        }
        panic!("no weight makes the matrix positive definite")
    }

    /// Finds the entries of the lower triangle and what is added to each. Every free direction of the capsule is an
    /// axis.
    fn list_entries(&mut self, model: &FilmModel, unknowns: &Unknowns) {
        let mut entries: BTreeMap<(usize, usize), Vec<(u32, u8, u8)>> = BTreeMap::new();
        for (face, nodes) in (0..).zip(&model.triangles) {
            let mut of_face: Vec<(usize, u8)> = Vec::new();
            for (corner, node) in (0..).zip(nodes) {
                for (unknown, direction) in &unknowns.of_node[*node as usize] {
                    let axis = (0..).zip(direction.iter()).find(|(_, part)| **part == 1.0);
                    let (axis, _): (u8, _) = axis.expect("a direction along an axis");
                    of_face.push((*unknown as usize, 3 * corner + axis));
                }
            }
            for (row, from_row) in &of_face {
                for (column, from_column) in of_face.iter().filter(|(column, _)| column <= row) {
                    entries.entry((*column, *row)).or_default().push((
                        face,
                        *from_row,
                        *from_column,
                    ));
                }
            }
        }
        self.columns = vec![0; unknowns.len() + 1];
        self.diagonal = vec![0; unknowns.len()];
        for (place, ((column, row), shares)) in (0_u32..).zip(&entries) {
            self.columns[column + 1] += 1;
            self.rows.push(*row);
            if row == column {
                self.diagonal[*row] = place as usize;
            }
            self.shares.extend(shares.iter().map(|(face, r, c)| (place, *face, *r, *c)));
        }
        for column in 0..unknowns.len() {
            self.columns[column + 1] += self.columns[column];
        }
        // As an assembly by faces would run.
        self.shares.sort_by_key(|(_, face, ..)| *face);
    }

    /// The values of the lower triangle, assembled.
    pub fn values(&self) -> Vec<f64> {
        let mut values = vec![0.0; self.rows.len()];
        for (place, face, row, column) in &self.shares {
            values[*place as usize] +=
                self.stiffness[*face as usize][(usize::from(*row), usize::from(*column))];
        }
        for (place, shift) in self.diagonal.iter().zip(&self.shift) {
            values[*place] += shift;
        }
        values
    }

    /// billow: assembles and factorises. `false` if the matrix is not positive definite.
    pub fn factor(&mut self, set: InstructionSet) -> bool {
        self.elimination.factor(set, &self.stiffness, &self.shift, &mut self.factor)
    }

    /// billow: the solution by the last factor.
    pub fn solve(&mut self, set: InstructionSet, forces: &[f64]) -> Vec<f64> {
        self.elimination.solve(set, &mut self.factor, forces)
    }

    /// A right side.
    pub fn forces(&self) -> Vec<f64> {
        pseudo_random(self.shift.len(), 1).iter().map(|value| value.x).collect()
    }

    /// |A x − f| over |f|.
    pub fn error(&self, solution: &[f64], forces: &[f64]) -> f64 {
        let mut rest: Vec<f64> = forces.iter().map(|force| -force).collect();
        let values = self.values();
        for column in 0..solution.len() {
            for place in self.columns[column]..self.columns[column + 1] {
                let row = self.rows[place];
                rest[row] += values[place] * solution[column];
                if row != column {
                    rest[column] += values[place] * solution[row];
                }
            }
        }
        let norm = |values: &[f64]| values.iter().map(|value| value * value).sum::<f64>().sqrt();
        norm(&rest) / norm(forces)
    }

    /// Entries below the diagonal.
    pub fn below_diagonal(&self) -> usize {
        self.rows.len() - self.diagonal.len()
    }

    /// Size of billow's factor.
    pub fn fill(&self) -> Fill {
        let entries = |plan: &Plan| {
            let pivots = plan.front.pivots;
            pivots * (pivots + 1) / 2 + pivots * (plan.front.size - pivots)
        };
        Fill {
            entries: self.plans.iter().map(entries).sum(),
            // A group holds eight values.
            stored: self.plans.iter().map(|plan| 8 * plan.front.panel_length()).sum(),
        }
    }

    /// billow's order of elimination: nested dissection.
    pub fn order(&self) -> Vec<usize> {
        let eliminated = |plan: &Plan| plan.unknowns[..plan.front.pivots].to_vec();
        self.plans.iter().flat_map(eliminated).map(|unknown| unknown as usize).collect()
    }
}
