//! Conjugate gradients with a preconditioner P (M. Hestenes, E. Stiefel, 1952).

use super::unknowns::dot;

/// Most products of one solution. Chosen: more cost as much as another Newton step.
const MAX_PRODUCTS: u32 = 100;

/// d of A d = r, a direction of descent, to a residual in the norm of P⁻¹ over that of r. Where A has no positive
/// curvature along a direction, the sum so far. `start`: r and P⁻¹ r; `precondition` and `product` compute P⁻¹ r and A d.
pub fn conjugate_gradients<S>(
    system: &mut S,
    (r, mut z): (&[f64], Vec<f64>),
    max_residual: f64,
    precondition: impl Fn(&mut S, &[f64]) -> Vec<f64>,
    product: impl Fn(&mut S, &[f64]) -> Vec<f64>,
) -> Vec<f64> {
    let mut residual = r.to_vec();
    let mut d = vec![0.0; r.len()];
    let mut along = z.clone();
    let mut size = dot(&residual, &z);
    let enough = max_residual * max_residual * size;
    for index in 0..MAX_PRODUCTS {
        let product = product(system, &along);
        let curvature = dot(&along, &product);
        let positive = curvature > 0.0;
        if !positive {
            return if index == 0 { z } else { d };
        }
        let length = size / curvature;
        for k in 0..d.len() {
            d[k] += length * along[k];
            residual[k] -= length * product[k];
        }
        z = precondition(system, &residual);
        let next = dot(&residual, &z);
        if next <= enough {
            break;
        }
        let share = next / size;
        size = next;
        for (along, z) in along.iter_mut().zip(&z) {
            *along = z + share * *along;
        }
    }
    d
}
