//! faer's sparse Cholesky factorisation.

use faer::dyn_stack::{MemBuffer, MemStack, StackReq};
use faer::perm::Perm;
use faer::sparse::linalg::SupernodalThreshold;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, LltRef, SymbolicCholesky, SymmetricOrdering,
    factorize_symbolic_cholesky,
};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMat};
use faer::{Conj, MatMut, Par, Side};

use super::film_matrix::FilmMatrix;

/// Order of elimination, and how columns are grouped.
#[derive(Clone, Copy)]
pub enum Order {
    /// Approximate minimum degree, by blocks of columns.
    MinimumDegree,
    /// The nested dissection of billow (faer has none), by blocks of columns.
    Dissection,
    /// Approximate minimum degree, entry by entry.
    EntryByEntry,
}

impl Order {
    /// Every order.
    pub const ALL: [Self; 3] = [Self::MinimumDegree, Self::Dissection, Self::EntryByEntry];

    fn name(self) -> &'static str {
        match self {
            Self::MinimumDegree => "supernodal, AMD",
            Self::Dissection => "supernodal, nested dissection",
            Self::EntryByEntry => "simplicial, AMD",
        }
    }
}

/// A factorisation whose symbolic part is done.
pub struct Peer {
    /// Name.
    pub name: &'static str,
    pattern: SymbolicSparseColMat<usize>,
    symbolic: SymbolicCholesky<usize>,
    factor: Vec<f64>,
    memory: MemBuffer,
    par: Par,
}

/// A number of threads.
fn par(threads: usize) -> Par {
    if threads > 1 { Par::rayon(threads) } else { Par::Seq }
}

impl Peer {
    /// The symbolic factorisation of a matrix.
    pub fn new(matrix: &FilmMatrix, order: Order) -> Self {
        let (columns, rows) = (matrix.columns.clone(), matrix.rows.clone());
        let size = columns.len() - 1;
        let pattern = SymbolicSparseColMat::new_checked(size, size, columns, None, rows);
        let permutation = {
            let forward = matrix.order();
            let mut inverse = vec![0; size];
            for (place, unknown) in forward.iter().enumerate() {
                inverse[*unknown] = place;
            }
            Perm::new_checked(forward.into(), inverse.into(), size)
        };
        let (ordering, threshold) = match order {
            Order::MinimumDegree => (SymmetricOrdering::Amd, SupernodalThreshold::FORCE_SUPERNODAL),
            Order::Dissection => (
                SymmetricOrdering::Custom(permutation.as_ref()),
                SupernodalThreshold::FORCE_SUPERNODAL,
            ),
            Order::EntryByEntry => (SymmetricOrdering::Amd, SupernodalThreshold::FORCE_SIMPLICIAL),
        };
        let parameters = CholeskySymbolicParams {
            supernodal_flop_ratio_threshold: threshold,
            ..CholeskySymbolicParams::default()
        };
        let symbolic =
            factorize_symbolic_cholesky(pattern.as_ref(), Side::Lower, ordering, parameters)
                .expect("enough memory");
        let needed = [1, 2].map(|threads| {
            StackReq::any_of(&[
                symbolic.factorize_numeric_llt_scratch::<f64>(par(threads), Default::default()),
                symbolic.solve_in_place_scratch::<f64>(1, par(threads)),
            ])
        });
        let factor = vec![0.0; symbolic.len_val()];
        let memory = MemBuffer::new(StackReq::any_of(&needed));
        Self { name: order.name(), pattern, symbolic, factor, memory, par: Par::Seq }
    }

    /// Sets the number of threads of later calls: 1 or 2.
    pub fn threads(&mut self, threads: usize) {
        self.par = par(threads);
    }

    /// Stored values of the factor.
    pub fn stored(&self) -> usize {
        self.symbolic.len_val()
    }

    /// Factorises the matrix of these values.
    pub fn factor(&mut self, values: &[f64]) {
        let matrix = SparseColMatRef::new(self.pattern.as_ref(), values);
        self.symbolic
            .factorize_numeric_llt(
                &mut self.factor,
                matrix,
                Side::Lower,
                Default::default(),
                self.par,
                MemStack::new(&mut self.memory),
                Default::default(),
            )
            .expect("a positive definite matrix");
    }

    /// The solution by the last factor.
    pub fn solve(&mut self, forces: &[f64]) -> Vec<f64> {
        let mut solution = forces.to_vec();
        let right = MatMut::from_column_major_slice_mut(&mut solution, forces.len(), 1);
        LltRef::new(&self.symbolic, &self.factor).solve_in_place_with_conj(
            Conj::No,
            right,
            self.par,
            MemStack::new(&mut self.memory),
        );
        solution
    }
}
