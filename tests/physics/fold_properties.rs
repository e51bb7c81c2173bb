//! Properties of every feasible fold pattern.

use std::collections::HashMap;
use std::f64::consts::PI;

use billow_solver::geometry::fold::{Caps, Corner};
use billow_solver::geometry::mesh::Part;
use proptest::prelude::*;

use crate::geometry::crossings;
use crate::prelude::*;

/// Designs over N 4-16, M 1-8, cone, ratio, chirality; feasible ones are kept.
fn designs() -> impl Strategy<Value = FoldDesign> {
    let size = (4_u32..=16, 1_u32..=8, 0.2_f64..1.5, 0.3_f64..1.15, 0.4_f64..2.5, 0.1_f64..4.0);
    (size, 0..3, any::<bool>()).prop_map(
        |((panels, storeys, r2, taper, slender, ratio), fit, same)| {
            let (top_radius, height) = (Some(r2 * taper), Some(r2 * slender));
            let alpha1_over_phi = Some(ratio);
            let base = FoldDesign {
                fit: Fit::Cone,
                panels,
                storeys,
                bottom_radius: r2,
                top_radius,
                height,
                half_angle: None,
                alpha1_over_phi: None,
                chirality: if same { Chirality::Same } else { Chirality::Alternate },
                stowed_height: 0.01,
                subdivisions: 1,
                caps: Caps::Polygon,
            };
            match fit {
                0 => base,
                1 => FoldDesign { fit: Fit::Angles, alpha1_over_phi, ..base },
                _ => FoldDesign { fit: Fit::Height, alpha1_over_phi, top_radius: None, ..base },
            }
        },
    )
}

fn patterns() -> impl Strategy<Value = FoldPattern> {
    designs().prop_filter_map("infeasible", |design| FoldPattern::new(&design).ok())
}

/// Signed sector angle from `from` to `to` about `at`, in [0, 2π).
fn sector(
    at: nalgebra::Vector2<f64>,
    from: nalgebra::Vector2<f64>,
    to: nalgebra::Vector2<f64>,
) -> f64 {
    let (u, v) = (from - at, to - at);
    let angle = u.perp(&v).atan2(u.dot(&v));
    if angle < 0.0 { angle + 2.0 * PI } else { angle }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 256, max_global_rejects: 20_000, ..ProptestConfig::default() })]

    #[test]
    fn angles_close_and_fold_flat(pattern in patterns()) {
        let a = &pattern.angles;
        prop_assert!((a.beta1 - a.alpha1 - (a.beta2 - a.alpha2 - (a.theta1 + a.theta2))).abs() < 1e-13, "Eq. 10");
        let n = f64::from(pattern.design.panels);
        prop_assert!((a.alpha1 + a.phi - (PI / 2.0 - PI / n)).abs() < 1e-14, "Eq. 14");
        prop_assert!(pattern.closure_defect() < 1e-12, "closure defect {:e}", pattern.closure_defect());
        let top = pattern.ring_radius(pattern.design.storeys);
        prop_assert!((top / pattern.top_radius - 1.0).abs() < 1e-12);
        let slant = pattern.slant(pattern.design.storeys);
        prop_assert!((slant * pattern.half_angle.cos() / pattern.height - 1.0).abs() < 1e-12);
    }

    #[test]
    fn edges_keep_their_lengths_in_the_flat_state(pattern in patterns()) {
        let panels = pattern.design.panels;
        let polygons = pattern.flat_polygons();
        for facet in pattern.facets() {
            let middle = pattern.erected_angle(facet.corners[0]);
            let developed = facet.corners.map(|c| pattern.developed(c, middle));
            let flat = facet.corners.map(|c| polygons[c.ring as usize].corner(c.corner % panels, panels));
            let lengths = pattern.lengths(facet.storey);
            let known = if facet.on_lower_ring { [lengths.ab, lengths.ad, lengths.ae] } else { [lengths.de, lengths.ad, lengths.ae] };
            let mut drawn = [0, 1, 2].map(|i| (developed[(i + 1) % 3] - developed[i]).norm());
            for i in 0..3 {
                let length = (flat[(i + 1) % 3] - flat[i]).norm();
                // The rounding of the length, and that of the coordinates whose difference it is.
                let allowed = 1e-12 * length + 1e-15 * pattern.bottom_radius;
                prop_assert!((length - drawn[i]).abs() < allowed, "{length} against {}", drawn[i]);
            }
            let mut known = known;
            known.sort_by(f64::total_cmp);
            drawn.sort_by(f64::total_cmp);
            for (d, k) in drawn.iter().zip(known) {
                let allowed = 1e-12 * k + 1e-15 * pattern.bottom_radius;
                prop_assert!((d - k).abs() < allowed, "{d} against {k}");
            }
        }
    }

    /// The theorems of Kawasaki and Maekawa at every interior vertex, checked on the drawn pattern
    /// and the folded shape, not on the formulas.
    #[test]
    fn interior_vertices_fold_flat(pattern in patterns()) {
        let panels = pattern.design.panels;
        let stowed = pattern.stowed_polygons(pattern.design.stowed_height);
        let position = |c: Corner| stowed[c.ring as usize].corner(c.corner % panels, panels);
        for ring in 1..pattern.design.storeys {
            // Corner 2 lies away from the seam; its facets are in the developed plane.
            let vertex = Corner { ring, corner: 2 };
            let middle = pattern.erected_angle(vertex);
            let at = pattern.developed(vertex, middle);
            let mut spokes: Vec<(f64, Corner)> = Vec::new();
            for facet in pattern.facets() {
                if let Some(i) = facet.corners.iter().position(|c| *c == vertex) {
                    let next = facet.corners[(i + 1) % 3];
                    let to = pattern.developed(next, middle);
                    spokes.push((sector(at, at + nalgebra::Vector2::x(), to), next));
                }
            }
            spokes.sort_by(|p, q| p.0.total_cmp(&q.0));
            prop_assert_eq!(spokes.len(), 6, "six fold lines");
            let sectors: Vec<f64> = (0..6).map(|i| {
                let turn = spokes[(i + 1) % 6].0 - spokes[i].0;
                if turn < 0.0 { turn + 2.0 * PI } else { turn }
            }).collect();
            let alternate = sectors[0] + sectors[2] + sectors[4];
            prop_assert!((alternate - PI).abs() < 1e-12, "alternate angles sum to {alternate}");
            // Mountain or valley: on which side of one facet the far corner of the next one lies.
            let mut mountains = 0;
            for i in 0..6 {
                let (before, edge, after) = (spokes[(i + 5) % 6].1, spokes[i].1, spokes[(i + 1) % 6].1);
                let (v, e) = (position(vertex), position(edge));
                let normal = (position(before) - v).cross(&(e - v));
                mountains += usize::from(normal.dot(&(position(after) - v)) < 0.0);
            }
            prop_assert_eq!(mountains, 4, "four mountains, two valleys");
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 96, max_global_rejects: 20_000, ..ProptestConfig::default() })]

    #[test]
    fn meshes_are_closed_and_exact(pattern in patterns(), n in 1_u32..5) {
        let (panels, storeys) = (pattern.design.panels, pattern.design.storeys);
        for shape in [Shape::Flat, Shape::Stowed(0.01), Shape::Erected] {
            let mesh = Mesh::new(&pattern, n, shape).expect("a mesh");
            prop_assert_eq!(mesh.triangles.len() as u32, 2 * panels * (storeys + 1) * n * n);
            let mut directed: HashMap<[u32; 2], usize> = HashMap::new();
            for &[a, b, c] in &mesh.triangles {
                for edge in [[a, b], [b, c], [c, a]] {
                    *directed.entry(edge).or_default() += 1;
                }
            }
            for (&[a, b], &count) in &directed {
                prop_assert!(count == 1 && directed.contains_key(&[b, a]), "edge {a}-{b}");
            }
            let euler = mesh.positions.len() as i64 - directed.len() as i64 / 2 + mesh.triangles.len() as i64;
            prop_assert_eq!(euler, 2);
            let area = mesh.reference_area();
            prop_assert!((area / pattern.film_area() - 1.0).abs() < 1e-12, "{area}");
            for (reference, part) in mesh.reference.iter().zip(&mesh.parts) {
                let [a, b, c] = *reference;
                prop_assert!((b - a).perp(&(c - a)) > 0.0, "{part:?} is inverted");
            }
            if shape != Shape::Flat {
                prop_assert!(mesh.volume() > 0.0);
            }
            // Rolling the developed film to the cone curves facets without strain: chords are never
            // longer than the flat edges.
            if shape == Shape::Erected {
                for ((corners, reference), part) in mesh.corners().zip(&mesh.reference).zip(&mesh.parts) {
                    if matches!(part, Part::Storey(_)) {
                        for i in 0..3 {
                            let chord = (corners[(i + 1) % 3] - corners[i]).norm();
                            let flat = (reference[(i + 1) % 3] - reference[i]).norm();
                            prop_assert!(chord <= flat * (1.0 + 1e-12), "{chord} against {flat}");
                        }
                    }
                }
            }
            prop_assert_eq!(mesh.top_ring.len() as u32, panels * n);
        }
    }

    #[test]
    fn stowed_film_does_not_cross_itself(design in designs(), n in 1_u32..3) {
        for stowed_height in [0.04, 0.01] {
            let design = FoldDesign { stowed_height, ..design.clone() };
            if let Ok(pattern) = FoldPattern::new(&design) {
                let mesh = Mesh::new(&pattern, n, Shape::Stowed(stowed_height)).expect("foldable");
                prop_assert_eq!(crossings(&mesh), 0);
                prop_assert!(mesh.volume() > 0.0);
                let volume = pattern.stowed_volume(stowed_height);
                prop_assert!((mesh.volume() / volume - 1.0).abs() < 1e-12);
            }
        }
    }
}
