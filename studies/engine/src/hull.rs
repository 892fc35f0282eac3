//! Points of a plane → the corners of their convex hull.

/// Returns the corners of the convex hull; two for points on a line.
///
/// A. M. Andrew, Another efficient algorithm for convex hulls in two dimensions, Inf. Process. Lett. 9 (1979) 216–219.
pub fn hull(mut points: Vec<[f64; 2]>) -> Vec<[f64; 2]> {
    points.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
    points.dedup();
    if points.len() < 3 {
        return points;
    }
    let half = |points: &mut dyn Iterator<Item = &[f64; 2]>| {
        let mut chain: Vec<[f64; 2]> = Vec::new();
        for &point in points {
            while let [.., a, b] = chain[..] {
                if turns_left(a, b, point) {
                    break;
                }
                chain.pop();
            }
            chain.push(point);
        }
        // The last point begins the other half.
        chain.pop();
        chain
    };
    [half(&mut points.iter()), half(&mut points.iter().rev())].concat()
}

/// Whether the path a → b → c turns left by more than round-off.
fn turns_left(a: [f64; 2], b: [f64; 2], c: [f64; 2]) -> bool {
    let [first, second] = [[a, b], [a, c]].map(|[from, to]| [to[0] - from[0], to[1] - from[1]]);
    let area = first[0] * second[1] - first[1] * second[0];
    area > 1e-12 * (first[0] * second[1]).abs().max((first[1] * second[0]).abs())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hulls_have_corners_only() {
        let grid: Vec<[f64; 2]> = (0..25).map(|i| [f64::from(i % 5), f64::from(i / 5)]).collect();
        assert_eq!(hull(grid), [[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0]]);
        assert_eq!(hull((0..9).map(|i| [f64::from(i) * 0.1, f64::from(i) * 0.3]).collect()).len(), 2);
    }
}
