//! The Pareto front.

/// Which of the points (cost, error) no other point beats, where a factor of `1 + noise` in either says nothing.
///
/// Walked from the cheapest to the dearest: a point that does not err by less than the last one on the front by more than
/// that factor is off, and it takes the place of those that cost as much within that factor. Without noise these are the
/// points of which none costs as little and errs as little, and one of the two less. Points equal in both go together; a
/// point that is not a number is off.
pub fn front(points: &[(f64, f64)], noise: f64) -> Vec<bool> {
    let factor = 1.0 + noise;
    let mut sorted: Vec<_> = points.iter().filter(|p| !p.0.is_nan() && !p.1.is_nan()).collect();
    sorted.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
    let mut kept: Vec<&(f64, f64)> = Vec::new();
    for point in sorted {
        if kept.last().is_some_and(|last| factor * point.1 >= last.1) {
            continue;
        }
        while kept.pop_if(|last| factor * last.0 >= point.0).is_some() {}
        kept.push(point);
    }
    points.iter().map(|p| kept.contains(&p)).collect()
}

#[cfg(test)]
mod tests {
    fn front(points: &[(f64, f64)]) -> Vec<bool> {
        super::front(points, 0.0)
    }

    #[test]
    fn what_is_within_the_noise_is_equal() {
        // 4 % dearer and better; then 4 % dearer and as good, 8 % dearer and 4 % better, 8 % dearer and much better.
        let points = [
            (1.0, 4.0),
            (1.04, 3.0),
            (2.0, 2.0),
            (2.08, 2.0),
            (2.16, 1.93),
            (2.16, 1.0),
        ];
        assert_eq!(super::front(&points, 0.05), [false, true, true, false, false, true]);
        assert_eq!(front(&points), [true, true, true, false, false, true]);
    }

    #[test]
    fn noise_never_leaves_nothing() {
        let points = [(1.0, 1.02), (1.06, 0.99), (1.02, 1.0)];
        assert!(super::front(&points, 0.05).contains(&true));
    }

    #[test]
    fn dominated_points_are_off() {
        let points = [(1.0, 4.0), (2.0, 2.0), (3.0, 3.0), (4.0, 1.0), (5.0, 1.5)];
        assert_eq!(front(&points), [true, true, false, true, false]);
    }

    #[test]
    fn equal_points_are_all_on() {
        assert_eq!(front(&[(1.0, 1.0), (1.0, 1.0), (2.0, 2.0)]), [true, true, false]);
    }

    #[test]
    fn a_tie_in_one_is_won_by_the_other() {
        // As dear but more wrong; as wrong but dearer.
        assert_eq!(front(&[(1.0, 1.0), (1.0, 2.0), (2.0, 1.0)]), [true, false, false]);
    }

    #[test]
    fn the_order_of_points_does_not_matter() {
        let mut points = vec![(1.0, 8.0), (2.0, 4.0), (4.0, 2.0), (8.0, 1.0), (2.0, 8.0), (8.0, 8.0)];
        let count = |p: &[(f64, f64)]| front(p).iter().filter(|f| **f).count();
        assert_eq!(count(&points), 4);
        points.reverse();
        assert_eq!(front(&points), [false, false, true, true, true, true]);
    }

    #[test]
    fn what_is_not_a_number_neither_wins_nor_beats() {
        assert_eq!(
            front(&[(1.0, f64::NAN), (2.0, 1.0), (f64::NAN, 0.0)]),
            [false, true, false]
        );
        assert!(front(&[]).is_empty());
    }
}
