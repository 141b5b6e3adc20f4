//! Reduces the number of points of a line.

/// Returns some of the points, in order. The straight lines between them pass every omitted point
/// within `tolerance`. The function makes a single pass, and extends each line as long as one slope
/// fits all points on it. `x` must increase.
pub(super) fn thinned(points: &[(f64, f64)], tolerance: f64) -> Vec<(f64, f64)> {
    let Some(&first) = points.first() else {
        return Vec::new();
    };
    let mut kept = vec![first];
    let (mut start, mut end) = (first, first);
    let (mut least, mut most) = (f64::NEG_INFINITY, f64::INFINITY);
    for &point in &points[1..] {
        let slope = |y: f64, from: (f64, f64)| (y - from.1) / (point.0 - from.0);
        let exact = slope(point.1, start);
        if !(least..=most).contains(&exact) {
            kept.push(end);
            start = end;
            (least, most) = (f64::NEG_INFINITY, f64::INFINITY);
        }
        least = least.max(slope(point.1 - tolerance, start));
        most = most.min(slope(point.1 + tolerance, start));
        end = point;
    }
    if end.0 > start.0 {
        kept.push(end);
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_pass_every_point_within_the_tolerance() {
        let at = |i: u32| {
            (
                f64::from(i),
                (f64::from(i) * 0.05).sin() * 40.0 + f64::from(i % 3) * 0.1,
            )
        };
        let points: Vec<_> = (0..1000).map(at).collect();
        let kept = thinned(&points, 0.25);
        assert!(kept.len() < 300, "{}", kept.len());
        assert_eq!((kept[0], kept[kept.len() - 1]), (points[0], points[999]));
        for (x, y) in points {
            let next = kept.iter().position(|k| k.0 >= x).unwrap();
            let (a, b) = (kept[next.saturating_sub(1)], kept[next]);
            let share = if b.0 > a.0 {
                (x - a.0) / (b.0 - a.0)
            } else {
                1.0
            };
            assert!((a.1 + share * (b.1 - a.1) - y).abs() < 0.25 + 1e-9, "{x}");
        }
    }

    #[test]
    fn few_points_stay() {
        for points in [vec![], vec![(0.0, 1.0)], vec![(0.0, 1.0), (1.0, 5.0)]] {
            assert_eq!(thinned(&points, 0.25), points);
        }
        let steep = [(0.0, 0.0), (1.0, 9.0), (2.0, 0.0)];
        assert_eq!(thinned(&steep, 0.25), steep);
    }
}
