//! Invalid films, and the factors of damping. Film forces against their energies, rigid motions, the
//! patch test and the stable step are reference cases of `billow validate`.

use billow_solver::geometry::shapes::sheet;
use billow_solver::geometry::shell::Shell;
use billow_solver::mechanics::film_model::{FilmError, FilmModel};
use billow_solver::mechanics::forces::damping;
use billow_solver::scene::Film;

#[test]
fn invalid_films_are_refused() {
    let piece = sheet(2, 2, 0.1, 0.1);
    let model = |piece: &Shell, nodes| {
        FilmModel::new(&Film::PAPER_ELASTIC, nodes, &piece.triangles, &piece.reference).unwrap_err()
    };
    assert_eq!(model(&piece, 10), FilmError::LooseNode { node: 9 });
    assert!(matches!(model(&piece, 8), FilmError::UnknownNode { nodes: 8, .. }));
    let mut turned = piece.clone();
    turned.reference[3].swap(0, 1);
    assert!(matches!(model(&turned, 9), FilmError::DegenerateElement { element: 3, .. }));
}

#[test]
fn damping_factors_match_their_closed_forms() {
    assert_eq!(damping::kick_factors(0.0, 1e-3), (1.0, 1e-3));
    let (keep, gain) = damping::kick_factors(2.0, 0.5);
    assert!((keep - 1.0 / 3.0).abs() < 1e-15 && (gain - 1.0 / 3.0).abs() < 1e-15);
    assert!((damping::stable_share(0.1) - 0.904_987_562_112_089).abs() < 1e-14);
}
