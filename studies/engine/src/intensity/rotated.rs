//! Two horizontal components → the component in any direction, and measures over all directions.

use rocking_records::Record;

use crate::intensity::Measure;
use crate::statistics::quantile;

/// Returns the component at `angle` (degrees) from `record` towards `transverse`. It is `a cos φ + a_t sin φ`.
///
/// Beyond its end the shorter component is zero.
///
/// # Errors
/// An angle that is not finite, or components with different time steps or starts.
pub fn rotated(record: &Record, transverse: &Record, angle: f64) -> Result<Record, String> {
    if !angle.is_finite() {
        return Err(format!("angle {angle}; expected degrees"));
    }
    for (name, first, second) in
        [("time step", record.time_step, transverse.time_step), ("start", record.start_time, transverse.start_time)]
    {
        // The seventh digit of a header may differ.
        if (first - second).abs() > 1e-6 * record.time_step {
            return Err(format!(
                "the {name} is {first} s and, in the transverse record, {second} s; expected the same"
            ));
        }
    }
    let (sin, cos) = libm::sincos(angle.to_radians());
    let sample = |record: &Record, i: usize| record.acceleration.get(i).copied().unwrap_or(0.0);
    let count = record.acceleration.len().max(transverse.acceleration.len());
    let acceleration = (0..count).map(|i| sample(record, i) * cos + sample(transverse, i) * sin).collect();
    let title = format!("{} rotated by {angle} degrees towards {}", record.title, transverse.title);
    Ok(Record { title, acceleration, ..record.clone() })
}

/// Percentiles RotDnn of a measure over the directions of a pair of components. Directions are in steps of one degree over half a turn (D.
/// M. Boore, Orientation-independent, nongeometric-mean measures of seismic intensity from two horizontal components of motion, BSSA 100
/// (2010) 1830–1835). Between two directions they are interpolated linearly.
///
/// `None` for measures that a record in some direction does not have.
///
/// # Errors
/// Those of [`rotated`].
pub fn rot_d<const N: usize>(
    measure: Measure,
    [record, transverse]: [&Record; 2],
    percentiles: [f64; N],
    gravity: f64,
) -> Result<Option<[f64; N]>, String> {
    let values = (0..180).map(|angle| Ok(measure.of(&rotated(record, transverse, f64::from(angle))?, gravity)));
    let Some(mut values) = values.collect::<Result<Option<Vec<f64>>, String>>()? else { return Ok(None) };
    values.sort_by(f64::total_cmp);
    Ok(Some(percentiles.map(|percentile| quantile(&values, percentile / 100.0))))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::intensity::{near, record_of};

    /// A motion along a line at β has a component |cos(φ − β)| at φ. A circular motion has the same in each direction.
    #[test]
    fn motions_along_a_line_and_in_a_circle_have_closed_forms() {
        let beta = 37.0_f64.to_radians();
        let along =
            |factor: f64| record_of(&(0..400).map(|i| factor * (0.05 * f64::from(i)).sin()).collect::<Vec<_>>(), 0.01);
        let line = [along(3.0 * beta.cos()), along(3.0 * beta.sin())];
        for (measure, power) in [(Measure::Pga, 1), (Measure::Pgv, 1), (Measure::Sa(0.5), 1), (Measure::Arias, 2)] {
            let whole = measure.of(&along(3.0), 9.81).unwrap();
            let [least, quarter, median, greatest] =
                rot_d(measure, [&line[0], &line[1]], [0.0, 25.0, 50.0, 100.0], 9.81).unwrap().unwrap();
            near(greatest, whole, 1e-12);
            assert!(least.abs() < 1e-12 * whole, "{measure}: {least}");
            // Of the 180 directions those 45° to both sides of the line are in the middle.
            near(median, 45.0_f64.to_radians().cos().powi(power) * whole, 1e-12);
            // Of the two on either side of a quarter, 22° and 23° from the least, the second is the nearer by 3 to 1.
            let [below, above] = [22.0_f64, 23.0].map(|angle| angle.to_radians().sin().powi(power));
            near(quarter, (0.25 * below + 0.75 * above) * whole, 1e-12);
        }
        let [most, none] = [37.0, 127.0].map(|angle| rotated(&line[0], &line[1], angle).unwrap().acceleration);
        for ((most, none), along) in most.iter().zip(none.iter()).zip(along(3.0).acceleration.iter()) {
            assert!((most - along).abs() < 1e-14 && none.abs() < 1e-14, "{most} along {along}, {none} across");
        }
        let circle = [0.0, 0.5 * std::f64::consts::PI].map(|phase: f64| {
            record_of(&(0..4000).map(|i| (0.002 * f64::from(i) + phase).sin()).collect::<Vec<_>>(), 0.01)
        });
        let [least, greatest] = rot_d(Measure::Pga, [&circle[0], &circle[1]], [0.0, 100.0], 9.81).unwrap().unwrap();
        near(least, 1.0, 1e-6);
        near(greatest, 1.0, 1e-6);
    }

    #[test]
    fn components_of_different_steps_are_refused() {
        let [one, other] = [0.01, 0.02].map(|dt| record_of(&[1.0, 2.0, 0.0], dt));
        let refused = rot_d(Measure::Pga, [&one, &other], [50.0], 9.81).unwrap_err();
        assert_eq!(refused, "the time step is 0.01 s and, in the transverse record, 0.02 s; expected the same");
    }
}
